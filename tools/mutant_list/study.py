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
        "src/cdem/run/behaviour.py",
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
        "src/cdem/run/behaviour.py",
        "    if slower or now.least",
        "    if now.least",
        "tests/unit/study/test_verdict.py",
    ),
    Mutant(
        "hasty failure",
        "a search ends with a failure that nobody has watched to its end",
        "src/cdem/study/critical.py",
        "        if found.trial_that_failed.sure:",
        "        if found.trial_that_failed:",
        "tests/unit/study/test_critical.py",
    ),
    Mutant(
        "stones settle",
        "stones that settle slowly are said to move",
        "src/cdem/run/behaviour.py",
        "half[-1] - half[0] > FAR",
        "half[-1] - half[0] > 0",
        "tests/unit/run/test_behaviour.py",
    ),
    Mutant(
        "kept looks",
        "a resumed run forgets where its static stage began",
        "src/cdem/run/simulation.py",
        '        self.watched = own["simulation.watched"]\n',
        "",
        "tests/unit/run/test_behaviour.py",
    ),
    Mutant(
        "travel of the hold",
        "--travel counts what falls before the search begins",
        "src/cdem/study/critical.py",
        'update={"most_moved": None}',
        "update={}",
        "tests/validation/test_critical.py::test_a_stone_that_falls_before_the_search_is_no_travel",
    ),
]
