"""Bonds that would lose strength faster than they unload are refused."""

import re

import pytest
from scenes import simulate

from cdem.errors import ModelError

SOFT = {
    "law": "softening",
    "friction_angle": 30,
    "cohesion": "6 MPa",
    "tensile_strength": "3 MPa",
    "residual_cohesion": "2 MPa",
    "fracture_energy_1": 100,
    "fracture_energy_2": 300,
}
NORMAL, SHEAR = 3e6**2 / 200, 6e6 * 4e6 / 600  # T^2 / (2 G1), c (c - c_r) / (2 G2)  [Pa/m]


def bar(size=1.0, stages=None, **law):
    """Two cubes, bonded."""
    return simulate(
        [
            {"group": "a", "box": {"size": [size] * 3}},
            {"group": "b", "box": {"size": [size] * 3}, "translate": [0, 0, size]},
        ],
        {"a": {}, "b": {}},
        interfaces={"default": SOFT | law},
        stages=stages,
    )


def test_stiffness_must_be_above_the_fall_of_strength_of_both_modes_together():
    k = NORMAL + SHEAR
    bar(stiffness_n=1.01 * k, stiffness_s=1.01 * k)
    told = "interfaces.default: bonds at (0.5, 0.5, 1) would lose strength faster than they unload"
    with pytest.raises(ModelError, match=re.escape(told)):
        bar(stiffness_n=0.99 * k, stiffness_s=0.99 * k)


def test_the_message_says_what_it_takes():
    k = (NORMAL + SHEAR) / 2
    with pytest.raises(ModelError, match=re.escape("by a factor of 2; it takes bonds 2.02 times")):
        bar(stiffness_n=k, stiffness_s=k)
    least = 10 * 10e9 / (NORMAL + SHEAR)  # height at which 10 E / h is just enough  [m]
    with pytest.raises(ModelError, match=re.escape(f"elements of {least / 1.01:.3g} m at most")):
        bar(size=2 * least)
    bar(size=0.99 * least)


def test_brittle_bonds_may_be_as_soft_as_they_like():
    brittle = {key: SOFT[key] for key in ("friction_angle", "cohesion", "tensile_strength")}
    simulate(
        [{"group": "a", "box": {"size": [1, 1, 1], "divisions": [1, 1, 2]}}],
        {"a": {}},
        model={"split": {"a": "elements"}},
        interfaces={"default": brittle | {"stiffness_n": 1e8, "stiffness_s": 1e8}},
    )
