"""Faults in `core/diagnostics`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "held_weight",
        "weight on held components hides the unbalance",
        "core/diagnostics/unbalance.cpp",
        "(supports.given(i, 2) ? 0 : std::abs(f.z))",
        "std::abs(f.z)",
        "tests/core/diagnostics/test_unbalance.cpp",
    ),
    Mutant(
        "edge_energy",
        "shear energy of semi-edges not in the ledger",
        "core/diagnostics/energy.cpp",
        "sum += edge.energy_n + edge.energy_s;",
        "sum += edge.energy_n;",
        "tests/core/contact/force/test_accumulate.cpp",
    ),
]
