"""Faults in modules of `src/cdem` that lie in no folder."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "other library",
        "a library of another version of cdem is loaded",
        "src/cdem/own_laws.py",
        '"version": __version__,',
        '"version": "",',
        "tests/unit/test_own_laws.py",
    ),
    Mutant(
        "unit",
        "kPa a thousand times too large",
        "src/cdem/units.py",
        '"kPa": 1e3',
        '"kPa": 1e6',
        "tests/unit/test_units.py",
    ),
]
