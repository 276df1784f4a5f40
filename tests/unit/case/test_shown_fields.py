"""Fields that follow from recorded ones."""

import numpy as np
import pytest

from cdem.case.output_fields import OUTPUT_FIELDS
from cdem.case.shown_fields import SHOWN, YIELDED

STRESS = np.array([[-3e6, -1e6, 2e6, 0, 0, 0], [0, 0, 0, 1e6, 0, 0]])
"""Principal stresses in the axes; pure shear in x, y. Tension positive."""


@pytest.mark.parametrize(
    "name, values",
    [
        ("sigma_1", [2e6, 1e6]),
        ("sigma_2", [-1e6, 0]),
        ("sigma_3", [-3e6, -1e6]),
        ("stress_zz", [2e6, 0]),
        ("stress_xy", [0, 1e6]),
        ("von_mises_stress", [np.sqrt(0.5 * (4 + 9 + 25)) * 1e6, np.sqrt(3) * 1e6]),
    ],
)
def test_of_stress(name, values):
    assert SHOWN[name].values(STRESS) == pytest.approx(values, abs=1e-3)


def test_principal_stress_is_the_same_in_any_frame():
    rng = np.random.default_rng(1)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    t = turn @ np.diag([3.0, -1.0, -8.0]) @ turn.T
    row = np.array([[t[0, 0], t[1, 1], t[2, 2], t[0, 1], t[1, 2], t[2, 0]]])
    assert [SHOWN[f"sigma_{k}"].values(row)[0] for k in (1, 2, 3)] == pytest.approx([3, -1, -8])


def test_a_component_keeps_its_sign():
    rows = np.array([[3.0, -4.0, 0.0]])
    assert SHOWN["velocity"].values(rows) == [5]
    assert SHOWN["velocity_y"].values(rows) == [-4]


@pytest.mark.parametrize(
    "bits, name",
    [
        (0, "never"),
        (4, "shear before"),
        (8 + 4, "tension before"),
        (1 + 4 + 8, "shear now"),
        (2 + 1 + 4 + 8, "tension now"),
        (16 + 64, "shear now"),  # of the weak plane
        (128, "tension before"),
    ],
)
def test_what_flows_now_comes_first(bits, name):
    assert YIELDED[SHOWN["yielded"].values(np.array([bits]))[0]] == name


def test_every_field_that_has_colours_can_be_shown():
    recorded = {field.name for field in OUTPUT_FIELDS if field.colors}
    assert recorded <= {shown.of for shown in SHOWN.values()}
    assert {"stress", "effective_stress", "axial_force"} <= {s.of for s in SHOWN.values()}
