"""Faults in `src/cdem/screening`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "wedge on one plane",
        "a wedge slides down the plane whose fall the other one bars",
        "src/cdem/screening/sliding.py",
        "other.normal @ found[0] > 1e-9",
        "other.normal @ found[0] < -1e-9",
        "tests/unit/screening/test_sliding.py",
    ),
    Mutant(
        "turning body",
        "bodies that turn about the edge of their plane count as sliding",
        "src/cdem/screening/bodies.py",
        'if sliding.kind not in ("first", "second"):',
        "if True:",
        "tests/unit/screening/test_bodies.py",
    ),
]
