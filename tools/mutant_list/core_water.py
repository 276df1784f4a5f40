"""Faults in `core/water`."""

from mutant_list.mutant import PINNED, Mutant

FAULTS = [
    Mutant(
        "level",
        "a level that does not rise",
        "core/water/data.cpp",
        "now[0] = given[0] + given[5] * lift;",
        "now[0] = given[0];",
        f"{PINNED}[soaked-1]",
    ),
    Mutant(
        "work of water",
        "work of water by the force after the step alone",
        "core/nodes/sum_applied.hpp",
        "const Row mean = 0.5 * (Row::at(own) + sum);",
        "const Row mean = sum;",
        f"{PINNED}[soaked-1]",
    ),
    Mutant(
        "clipped",
        "water that presses on all of a face of which a part is dry",
        "core/water/pressure.hpp",
        "const T whole = T(1.0 / 24) * (sum + p[k]) + below[k];",
        "const T whole = T(1.0 / 24) * (sum + p[k]);",
        "tests/core/water/test_pressure.cpp",
    ),
    Mutant(
        "drained",
        "a joint that keeps its water however wide it opens",
        "core/water/wet_faces.cpp",
        "return away < aperture && ",
        "return ",
        "tests/validation/test_water.py",
    ),
    Mutant(
        "wet face",
        "water of a joint on every face that stands on a wall",
        "core/water/wet_faces.cpp",
        "constexpr Real opposite = -0.7;",
        "constexpr Real opposite = 2;",
        "tests/validation/test_water.py",
    ),
    Mutant(
        "pores",
        "pores that ignore how the element has turned",
        "core/water/pressure.hpp",
        "columns.point_volume.at(q, e)) * cofactor(f));",
        "columns.point_volume.at(q, e)) * identity<T>());",
        "tests/validation/test_water.py",
    ),
]
