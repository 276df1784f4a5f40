"""33 slopes: factors of safety against closed forms and published intervals."""

import tempfile
from pathlib import Path

import numpy as np

from cdem.study.critical import find_critical, strength_reduction
from cdem.study.strengths import keep_strengths
from cdem.verification.slopes.bodies import bodies
from cdem.verification.slopes.finer import finer, stiffer
from cdem.verification.slopes.planes import planes
from cdem.verification.slopes.soil import soil
from cdem.verification.slopes.wedges import wedges

VARIED = ("plane, dry, cohesion", "plane, tension crack full", "long slope, seepage",
          "plane, a fifth of it rock bridges", "step path, friction", "roof wedge, anchored")  # fmt: skip
"""Slopes whose factor is found on three meshes and with rock of four stiffnesses."""

SHOWN = ("plane, tension crack half full", "wedge, cohesion", "block toppling, 16 columns",
         "buttress", "step path, friction")  # fmt: skip
"""Slopes whose failure is drawn."""


def slopes():
    """All slopes, by name."""
    return {s.name: s for s in (*planes(), *wedges(), *bodies(), *soil())}


def theory(name):
    """Factor of safety of a slope, or both edges of its published interval."""
    return slopes()[name].factor


def search(study, slope):
    """What `cdem critical --factor` finds with strengths kept, and all its defaults."""
    with tempfile.TemporaryDirectory() as folder:
        case, _ = keep_strengths(slope.load(Path(folder)))
        return find_critical(
            case, strength_reduction(keep=True), None, tolerance=0.01, threads=study.threads
        )


def run(study):
    """The cheap ones; all, and some with other meshes and stiffnesses, when full."""
    errors = []
    for slope in slopes().values():
        if not (study.full or slope.quick):
            continue
        found = search(study, slope)
        nearest = slope.nearest(found.value)
        errors.append(found.value / nearest - 1)
        study.check(f"{slope.name}, {slope.height:.3g} m", theory=nearest, ours=found.value,
                    within=slope.within)  # fmt: skip
        if slope.name in SHOWN and found.body is not None:
            study.picture(f"{slope.name}, at a factor of {found.failed:.3f}", found.body)
    study.check("median of the errors", theory=0, ours=np.median(np.abs(errors)), within=0.02,
                absolute=True)  # fmt: skip
    study.check("the most unsafe error", theory=0, ours=max(0, *errors), within=0.03, absolute=True)
    if study.full:
        vary(study)


def vary(study):
    """The factor on finer meshes, and in rock that its weight strains by 1e-6 to 2e-3."""
    for name in VARIED:
        slope = slopes()[name]
        others = [(f"{n} x {n} cells a body", finer(slope, n)) for n in (2, 4)]
        others += [(f"rho g H / E = {s:g}", stiffer(slope, s)) for s in (1e-6, 1e-4, 2e-3)]
        for what, other in others:
            study.check(f"{name}, {what}", theory=slope.factor, ours=search(study, other).value,
                        within=0.01)  # fmt: skip
