"""What the laws remember, as fields by element; models without such a law have none."""

from __future__ import annotations

import numpy as np
from scenes import simulate

from cdem.run.law_fields import state_of, wanted_fields

SOFT = {
    "law": "softening",
    "friction_angle": 30,
    "cohesion": "6 MPa",
    "tensile_strength": "3 MPa",
    "fracture_energy_1": 100,
    "fracture_energy_2": 300,
    "stiffness_n": 3e12,
    "stiffness_s": 2e12,
}
BRITTLE = {"law": "brittle", "friction_angle": 30, "cohesion": "6 MPa", "tensile_strength": "3 MPa"}
HISTORIES = ("quads.history", "spring.history", "spring.history_law", "edge.history")


def pulled(default, pairs=()):
    """Three cubes on one another; the upper two are led apart by 20 um."""
    sim = simulate(
        [
            {"group": g, "box": {"size": [1, 1, 1]}, "translate": [0, 0, z]}
            for z, g in enumerate("abc")
        ],
        {"a": {}, "b": {"fix": ["x", "y", "z"]}, "c": {}},
        interfaces={"default": default, "pairs": list(pairs)},
        loads={"velocities": [{"group": "c", "velocity": [0, 0, 0.01]}]},
        time={"step": "10 us"},
    )
    sim.step(200)
    return sim


def test_damage_is_that_of_the_joints_of_an_element():
    sim = pulled(SOFT)
    a, b, c = state_of(sim, "joint_damage")
    elastic = 3e6 / 3e12  # T / k_n [m]
    expected = (1.99e-5 - elastic) / (200 / 3e6 - elastic)  # of w / w_u, before the last step
    assert a == 0
    assert b == c
    assert abs(c / expected - 1) < 1e-6
    assert wanted_fields(sim.case)[-3:] == ["joint_slip", "joint_damage", "joint_opening"]


def test_a_model_whose_laws_remember_nothing_has_no_histories():
    for law in ("brittle", "residual"):
        sim = pulled(BRITTLE | {"law": law})
        state = sim.core.fields()
        assert [state[name].size for name in HISTORIES] == [0, 0, 0, 0]
        assert not state_of(sim, "joint_slip").any()
        assert wanted_fields(sim.case)[-1] == "piece"


def test_joints_of_another_law_have_nothing_of_the_state():
    sim = pulled(BRITTLE, [{"between": ["b", "c"], **SOFT}])
    a, b, c = state_of(sim, "joint_damage")
    assert a == 0
    assert b == c > 0.2
    sim = pulled(SOFT, [{"between": ["b", "c"], **BRITTLE}])
    assert np.all(state_of(sim, "joint_damage") == 0)
