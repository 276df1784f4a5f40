"""Interface laws in direct shear: two cubes whose nodes are all driven, so tractions are exact."""

import numpy as np
import pytest
from scenes import simulate

STIFFNESS = {"stiffness_n": "1e11 Pa/m", "stiffness_s": "1e11 Pa/m"}
CUBES = [
    {"group": "bed", "box": {"size": [1, 1, 1]}, "translate": [0, 0, -1]},
    {"group": "block", "box": {"size": [1, 1, 1]}},
]


class Shear:
    """A cube on another, pressed within 1 ms, then led along x and z by histories of its speed."""

    def __init__(self, law, pressure, along, up=(), step="10 us"):
        """Histories: rows of time [s] and speed [m/s], a straight line between; pressure [Pa]."""
        down = 2 * pressure / 1e11 / 1e-3
        press = [[0, 0], [0.5e-3, -down], [1e-3, 0]]
        drives = [(["x", "y"], [1, 0, 0], along), (["z"], [0, 0, 1], [*press, *up])]
        self.sim = simulate(
            CUBES,
            {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
            interfaces={"default": STIFFNESS | law},
            time={"step": step},
            loads={
                "velocities": [
                    {"group": "block", "components": axes, "velocity": unit, "history": history}
                    for axes, unit, history in drives
                ]
            },
        )

    def tractions(self):
        """Shear and normal traction on the joint of 1 m2 [Pa], compression positive."""
        state = self.sim.core.fields()
        bed = self.sim.build.nodes_of("bed")
        force = state["node.reaction"].reshape(-1, 4)[bed].sum(axis=0)
        return abs(force[0]), abs(force[2])


RESIDUAL = {
    "law": "residual",
    "friction_angle": 40,
    "cohesion": "3 MPa",
    "tensile_strength": "1 MPa",
    "residual_friction_angle": 30,
    "residual_cohesion": "1 MPa",
}


def test_residual_strength_after_the_peak():
    """tau = c + sigma tan(phi), then c_r + sigma tan(phi_r).

    The pair stays bonded beyond the slip at which others are released, 0.1 % of 0.7 m, until it is
    lifted.
    """
    sigma = 2e6
    slide = [[1e-3, 0], [1.1e-3, 0.1], [0.03, 0.1], [0.0301, 0]]
    lift = [[0.03, 0], [0.0325, 0.4], [0.035, 0]]
    shear = Shear(RESIDUAL, sigma, slide, lift)
    sim = shear.sim
    sim.run_until(1e-3)
    peak, seen = 3e6 + sigma * np.tan(np.radians(40)), 0.0
    while sum(sim.broken.values()) == 0 and sim.time < 2e-3:
        seen = shear.tractions()[0]
        sim.step(1)
    assert seen == pytest.approx(peak, rel=0.03)  # it grows by 2 % in a step
    sim.run_until(0.0299)
    left = sigma * np.tan(np.radians(30))
    assert shear.tractions() == pytest.approx((1e6 + left, sigma), rel=1e-9)
    assert sim.core.fields()["quads.status"][0] == 1
    assert abs(sim.energies["error"]) < 1e-4
    sim.run_until(0.036)
    assert sim.core.fields()["quads.status"][0] == 0
