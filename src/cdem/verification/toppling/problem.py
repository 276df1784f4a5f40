"""Angle at which a tilted 4:1 column topples (Table 1)."""

import numpy as np

from cdem import view
from cdem.critical import find_critical
from cdem.simulation import Simulation

GRAVITY = 9.81


def theory(width, height):
    """Angle [deg] at which the weight leaves the base over its lower edge: atan(width / height)."""
    return np.degrees(np.arctan2(width, height))


def tilt(case, degrees):
    """Turn gravity instead of the model."""
    angle = np.radians(degrees)
    case.set("loads.gravity", [GRAVITY * np.sin(angle), 0.0, -GRAVITY * np.cos(angle)])


def run(study):
    """Bisection; three indentations when full, since the paper's contacts act at indented points."""
    width, _, height = study.case().model.blocks[1].box.size
    paper = {"vertex": None, "indented": 14.01}
    for action in paper if study.full else ["vertex"]:
        for indentation in (0.01, 0.005) if study.full else (0.01,):
            case = study.case(f"contact.action={action}", f"contact.indentation={indentation}")
            found = find_critical(case, tilt, (13.0, 15.0), tolerance=0.01, threads=study.threads)
            # indented contacts stand on a base that is narrower by the indentation on either side
            base = width * (1 - (indentation if action == "indented" else 0))
            study.check(f"tilt, contacts act at the {action}, indentation {indentation}", unit="deg",
                        theory=theory(base, height), paper=paper[action], ours=found.value,
                        within=0.01, absolute=True)  # fmt: skip
    simulation = Simulation(case, threads=study.threads)
    tilt(simulation.case, 16.0)
    shown = [view.snapshot(simulation)]
    simulation.core.set_gravity(simulation.case.loads.gravity)
    for time in (1.2, 2.0):
        while simulation.time < time:
            simulation.step(100)
        shown.append(view.snapshot(simulation))
    study.picture("A tilt of 16 degrees", *shown)
