"""Tower of loose cubes on a tilted bed."""

import numpy as np

from cdem.output.render import snapshot
from cdem.run.simulation import Simulation
from cdem.study.critical import find_critical
from cdem.verification.masonry import tilt

QUICK = False  # a quarter of a minute


def theory(count, width=1.0):
    """Tilt [deg] at which the weight leaves the base: atan(width / height).

    The lowest joint decides: above a joint n cubes topple at atan(1 / n), and n is largest there.
    """
    return np.degrees(np.arctan2(width, count * width))


def run(study):
    """Bisection of the tilt, across the faces and, when full, along the diagonal."""
    case = study.case()
    count = len(case.model.blocks) - 1
    found = find_critical(case, tilt, (10.5, 12.0), tolerance=0.02, threads=study.threads)
    study.check(f"tilt of {count} cubes", unit="deg", theory=theory(count), ours=found.value,
                within=0.03, absolute=True)  # fmt: skip
    if study.full:
        found = find_critical(study.case(), lambda c, a: tilt(c, a, 45), (15.0, 17.0),
                              tolerance=0.02, threads=study.threads)  # fmt: skip
        study.check(f"tilt of {count} cubes along the diagonal", unit="deg", absolute=True,
                    theory=np.degrees(np.arctan(np.sqrt(2) / count)), ours=found.value, within=0.05)  # fmt: skip
    falling = study.case("stages=[{name: fall, mode: dynamic, duration: 4, "
                         "damping: {contact: 0.2, stiffness: 0.2}}]")  # fmt: skip
    tilt(falling, 14.0)
    simulation = Simulation(falling, threads=study.threads)
    shown = [snapshot(simulation)]
    for time in (1.5, 2.2):
        simulation.run_until(time)
        shown.append(snapshot(simulation))
    study.picture("A tilt of 14 degrees: start, 1.5 s, 2.2 s", *shown)
