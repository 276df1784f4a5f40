"""Friction angle at which a block on a slope begins to slide (Table 1)."""

import numpy as np

from cdem.critical import find_critical, parameter


def theory(gravity):
    """phi = theta [deg]: tan(theta) is the pull along the bed over the push on it."""
    return np.degrees(np.arctan2(np.hypot(gravity[0], gravity[1]), -gravity[2]))


def run(study):
    """Bisection, from a state that rests at 60 degrees."""
    case = study.case()
    found = find_critical(case, parameter("interfaces.default.friction_angle"), (40.0, 50.0),
                          tolerance=0.003, threads=study.threads)  # fmt: skip
    study.check("friction angle, slope of 45 deg", unit="deg", theory=theory(case.loads.gravity),
                paper=44.999, ours=found.value, within=0.002, absolute=True)  # fmt: skip
