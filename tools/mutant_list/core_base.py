"""Faults in `core/base`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "listed block",
        "a block that is on the list is looked for behind its place",
        "core/base/sorted.hpp",
        "if (numbers[middle] < number)",
        "if (numbers[middle] <= number)",
        "tests/core/base/test_sorted.cpp",
    ),
    Mutant(
        "exact sum",
        "sums lose half a unit of a digit",
        "core/base/exact_sum.cpp",
        "std::ldexp(1.5, unit + 52)",
        "std::ldexp(1.5, unit + 51)",
        "tests/core/base/test_exact_sum.cpp",
    ),
    Mutant(
        "digits of a number",
        "a device loses the third digit of a number",
        "core/base/exact_sum.hpp",
        "high_ = shift > 0 ? whole >> (64 - shift) : 0;",
        "high_ = 0;",
        "tests/core/base/test_exact_sum.cpp",
    ),
    Mutant(
        "first of the most",
        "of equal numbers the most is any",
        "core/base/primitives.hpp",
        "other == value && of < item",
        "other == value && of > item",
        "tests/core/base/test_primitives.cpp",
    ),
    Mutant(
        "rows",
        "numbers stay in their rows as threads put them there",
        "core/base/primitive_loops.hpp",
        "while (gap < count / 3) gap = 3 * gap + 1;",
        "gap = 0;",
        "tests/core/base/test_primitives.cpp",
    ),
    Mutant(
        "polar",
        "polar rotation with one Newton step fewer",
        "core/base/math.hpp",
        "for (int step = 0; step < 3; ++step)",
        "for (int step = 0; step < 2; ++step)",
        "tests/core/base/test_math.cpp",
    ),
    Mutant(
        "three sweeps",
        "principal axes after three sweeps",
        "core/base/math.hpp",
        "turn < 12",
        "turn < 9",
        "tests/core/base/test_math.cpp",
    ),
]
