"""The faults that `tools/mutants.py` plants: a file for each room of the code."""

from mutant_list import (
    bindings,
    blasts,
    case,
    core_base,
    core_bolts,
    core_bonds,
    core_columns,
    core_contact,
    core_diagnostics,
    core_elements,
    core_interfaces,
    core_materials,
    core_model,
    core_nodes,
    core_records,
    core_rest,
    core_run,
    core_surface,
    core_water,
    joints,
    mesh,
    model,
    output,
    package,
    ranks,
    run,
    screening,
    seismic,
    study,
)
from mutant_list.mutant import Mutant

PYTHON = [package, case, mesh, joints, model, run, output, study, screening, seismic, blasts]
CORE = [
    bindings,
    ranks,
    core_rest,
    core_surface,
    core_water,
    core_diagnostics,
    core_contact,
    core_nodes,
    core_model,
    core_bolts,
    core_bonds,
    core_columns,
    core_run,
    core_interfaces,
    core_base,
    core_records,
    core_elements,
    core_materials,
]
"""Rooms whose headers many files include come last."""

MUTANTS: list[Mutant] = [fault for room in PYTHON + CORE for fault in room.FAULTS]
