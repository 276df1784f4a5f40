"""Faults in `core/records`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "series",
        "contacts as stiff as the stiffer side where both count",
        "core/records/interface.hpp",
        "return in_series ? 2 * a * b / (a + b) : max_of(a, b);",
        "return max_of(a, b);",
        "tests/core/contact/force/test_contact_laws.cpp",
    ),
]
