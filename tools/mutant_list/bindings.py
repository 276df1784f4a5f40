"""Faults in `bindings`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "restitution",
        "contacts unload with e instead of e^2",
        "bindings/laws.hpp",
        "interface.returned_n = e_n * e_n;",
        "interface.returned_n = e_n;",
        "tests/validation/test_restitution.py",
    ),
]
