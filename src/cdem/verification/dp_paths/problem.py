"""The cone of Drucker and Prager at its contact with the cone of Mohr and Coulomb."""

import numpy as np

from cdem.run.fields import stress_of
from cdem.verification.triaxial_mc.problem import drive, theory

PATHS = {
    "outer": ("compression", 10, ()),
    "inner": ("extension", 10, ()),
    "plane-strain": (
        "compression",
        35,
        ("loads.supports.1={box: {min: [-1, -1, -1], max: [2, 2, 2]}, fix: [y]}",),
    ),
}
"""By `match`: how it is driven, the dilation angle [deg], more settings."""


def run(study):
    """Each cone on the path on which it is Mohr-Coulomb's, without and with pressure."""
    lines = {}
    for match, (kind, dilation, settings) in PATHS.items():
        for side in (0.0, 2e6):
            simulation, path = drive(
                study, side, kind, f"materials.rock.match={match}",
                f"materials.rock.dilation_angle={dilation}", *settings,
            )  # fmt: skip
            rock = simulation.case.materials["rock"]
            study.check(f"{match}: axial stress, {kind}, sides at {side / 1e6:g} MPa", unit="Pa",
                        theory=theory(rock, side, kind), ours=-stress_of(simulation)[0, 2],
                        within=2e-3 if match == "plane-strain" else 1e-6)  # fmt: skip
            study.check(f"{match}: energy error, sides at {side / 1e6:g} MPa", theory=0,
                        ours=simulation.energies["error"], absolute=True,
                        within=2e-3 if match == "plane-strain" else 1e-4)  # fmt: skip
            lines[f"{match}, sides at {side / 1e6:g} MPa"] = (
                100 * path[0],
                np.array(path[1]) / 1e6,
            )
    study.curve("Axial stress, compression positive", "axial strain [%]", "stress [MPa]", lines)
