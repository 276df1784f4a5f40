"""Faults in `src/cdem/study`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "bracket",
        "a factor's bracket looked for in the wrong direction",
        "src/cdem/study/critical.py",
        "value * WIDER if stable else value / WIDER",
        "value / WIDER if stable else value * WIDER",
        "tests/validation/test_critical.py::test_factor_finds_its_own_bracket",
    ),
    Mutant(
        "steady",
        "a body that a steady force drives is said to creep",
        "src/cdem/study/verdict.py",
        "if now.least > STEADY * half.least else",
        "if now.least > 1.1 * half.least else",
        "tests/validation/test_critical.py::test_critical_friction_angle_is_the_slope",
    ),
]
