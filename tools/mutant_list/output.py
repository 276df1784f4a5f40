"""Faults in `src/cdem/output`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "runout",
        "front of the run-out measured at the rear end",
        "src/cdem/output/runout_measures.py",
        "(solids.triangles @ way).max() - origin",
        "(solids.triangles @ way).min() - origin",
        "tests/unit/output/test_runout.py",
    ),
]
