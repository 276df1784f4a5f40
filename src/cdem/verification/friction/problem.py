"""Friction angle at which a block on a slope begins to slide (Table 1)."""

import numpy as np

from cdem.study.critical import find_critical, parameter

PAPER = "Fig. 15, Table 1"

# cells along a side of the bed, of 3 m, and of the block, of 1 m
MESHES = {"1:1": (3, 1), "1:2": (6, 1), "2:3": (9, 2)}


def theory(gravity):
    """phi = theta [deg]: tan(theta) is the pull along the bed over the push on it."""
    return np.degrees(np.arctan2(np.hypot(gravity[0], gravity[1]), -gravity[2]))


def run(study):
    """Bisection, from a state that rests at 60 degrees; other meshes and influences when full."""

    def limit(*settings):
        """Middle of the bracket [deg]."""
        return find_critical(study.case(*settings), parameter("interfaces.default.friction_angle"),
                             (44.93, 45.11), tolerance=0.003, threads=study.threads).value  # fmt: skip

    exact = theory(study.case().loads.gravity)
    for name, (below, above) in MESHES.items() if study.full else [("1:1", MESHES["1:1"])]:
        divisions = [f"model.blocks.{i}.box.divisions=[{n}, {n}, 1]"
                     for i, n in enumerate((below, above))]  # fmt: skip
        if below > 3 * above:  # the block's own face is touched, and leans; README.md
            divisions.append("interfaces.default.contact_stiffness=10 E/h")
        study.check(f"friction angle, slope of 45 deg, meshes {name}", unit="deg", theory=exact,
                    paper=44.999 if name == "1:1" else None, ours=limit(*divisions), within=0.002,
                    absolute=True)  # fmt: skip
    if study.full:
        study.influences("friction angle", limit, theory=exact, within=0.002, absolute=True,
                         unit="deg")  # fmt: skip
