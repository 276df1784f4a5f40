"""Faults in `core/model`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "checkpoint",
        "a checkpoint leaves out a number",
        "core/model/describe_scalars.hpp",
        'visit(ScalarInfo{.name = "dt_stable", .unit = "s", .meaning = "step that dt grows towards"},'
        "\n        s.dt_stable);",
        "",
        "tests/regression/test_bits.py::test_restored_state_continues_the_growth_of_the_time_step",
    ),
    Mutant(
        "tile places",
        "a tile lists a node again for each of its elements",
        "core/model/tiles.cpp",
        "if (place < first) {",
        "if (place < Index(node.size())) {",
        "tests/core/model/test_tiles.cpp",
    ),
    Mutant(
        "tile corners",
        "a GPU counts the corners of a tile from the first of all elements",
        "core/model/tiles.cpp",
        "(i - first) * e.corners + k);",
        "i * e.corners + k);",
        "tests/core/model/test_tiles.cpp",
    ),
]
