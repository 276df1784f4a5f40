"""Faults in `src/cdem/study`."""

from mutant_list.mutant import Mutant

FAULTS = [
    Mutant(
        "bracket",
        "a factor's bracket looked for in the wrong direction",
        "src/cdem/study/critical.py",
        "following * WIDER if stable else following / WIDER",
        "following / WIDER if stable else following * WIDER",
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
    Mutant(
        "kept cohesion",
        "a factor with strengths kept forgets the cohesion of a slipping joint",
        "src/cdem/study/strengths.py",
        'for name in ("friction_angle", "cohesion")}\n\n\ndef _interfaces',
        'for name in ("friction_angle",)}\n\n\ndef _interfaces',
        "tests/validation/test_critical.py::test_a_wedge_with_cohesion_at_defaults",
    ),
    Mutant(
        "held start",
        "trials of a factor start from the state with the strengths of the case",
        "src/cdem/study/critical.py",
        "        self._give(HELD)\n",
        "",
        "tests/validation/test_critical.py::test_factor_finds_its_own_bracket",
    ),
    Mutant(
        "slowing body",
        "a body that slows down under a steady force is said to slide",
        "src/cdem/study/verdict.py",
        "        if slower or now.least",
        "        if now.least",
        "tests/unit/study/test_verdict.py",
    ),
]
