"""Faults in `core/diagnostics`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "held_weight",
        "weight on held components hides the unbalance",
        "core/diagnostics/force_terms.hpp",
        "part(2, f.z)",
        "abs_of(f.z)",
        "tests/core/diagnostics/test_unbalance.cpp",
    ),
    Mutant(
        "edge_energy",
        "shear energy of semi-edges not in the ledger",
        "core/diagnostics/contact_energy.hpp",
        "sum += edge.energy_n + edge.energy_s;",
        "sum += edge.energy_n;",
        "tests/core/contact/force/test_accumulate.cpp",
    ),
]
