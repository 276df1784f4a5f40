"""A bolted block on a plane: factor of safety with the bolt at several angles."""

import numpy as np

from cdem.study.criterion import Criterion
from cdem.study.critical import find_critical, strength_reduction

WEIGHT, DIP, FRICTION = 100e3, 35.0, 30.0  # [N] [deg] [deg]


def theory(tension, angle):
    """Factor of safety; the bolt leans by `angle` from the normal of the plane, up the slope.

    F = (W cos + T cos(angle)) tan(phi) / (W sin - T sin(angle)).
    """
    dip, lean = np.radians([DIP, angle])
    holds = WEIGHT * np.cos(dip) + tension * np.cos(lean)
    drives = WEIGHT * np.sin(dip) - tension * np.sin(lean)
    return holds * np.tan(np.radians(FRICTION)) / drives


def bolt(angle, length=3.4):
    """Setting of a bolt that leans up the slope."""
    head = np.array([0.01, 0.02, 1.0])
    lean = np.radians(angle)
    toe = head - length * np.array([np.sin(lean), 0, np.cos(lean)])
    return f"bolts.0.points={[head.tolist(), [round(float(x), 9) for x in toe]]}"


def factor(study, *settings, far=2e-4):
    """Factor of safety by strength reduction; displacement above `far` of 1.5 m is failure."""
    return find_critical(study.case(*settings), strength_reduction(), (0.5, 2.5), tolerance=1e-3,
                         threads=study.threads, criterion=Criterion(far=far)).value  # fmt: skip


def run(study):
    """Without a bolt, and with one of 40 kN; more angles, and the tension for a factor of 1.5 when full."""
    study.check("factor of safety without a bolt", theory=theory(0, 0), ours=factor(study, "bolts=[]"),
                within=2e-3)  # fmt: skip
    for angle in (0, 15, 30) if study.full else (0, 30):
        study.check(f"factor of safety, bolt at {angle} deg", theory=theory(40e3, angle),
                    ours=factor(study, bolt(angle)), within=5e-3)  # fmt: skip
    study.check("factor of safety, bolt not tensioned", theory=theory(40e3, 30),
                ours=factor(study, bolt(30), "bolts.0.pretension=0", far=5e-3), within=1e-2)  # fmt: skip
    if study.full:
        wanted = "bolt_types.bar.yield_force=67.104 kN", "bolts.0.pretension=67.104 kN"
        study.check("factor of safety with 67.104 kN", theory=1.5, ours=factor(study, *wanted),
                    within=5e-3)  # fmt: skip
