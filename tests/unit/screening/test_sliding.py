"""Factors of wedges and planes against the closed forms of Hoek & Bray."""

import numpy as np
import pytest
from shared.hills import joint

from cdem.joints.directions import poles
from cdem.joints.kinematics import intersections
from cdem.screening.sliding import on_one, on_two

WEDGES = [
    ((55, 135, 30), (55, 225, 30), 0.701351),
    ((60, 40, 25), (50, 130, 35), 0.755127),
]


@pytest.mark.parametrize(("a", "b", "wanted"), WEDGES)
def test_friction_only_wedge(a, b, wanted):
    # Hoek & Bray: F = A tan phi_a + B tan phi_b, A = (cos a - cos b cos n) / (sin s sin^2 n)
    plunge = np.radians(
        intersections(poles(np.array([a[0], b[0]], float), np.array([a[1], b[1]], float)))[0][0]
    )
    na, nb = (joint("", *p).normal for p in (a, b))
    cosine = na @ nb
    dip_a, dip_b = np.radians(a[0]), np.radians(b[0])
    scale = np.sin(plunge) * (1 - cosine**2)
    first = (np.cos(dip_a) - np.cos(dip_b) * cosine) / scale
    second = (np.cos(dip_b) - np.cos(dip_a) * cosine) / scale
    by_hand = first * np.tan(np.radians(a[2])) + second * np.tan(np.radians(b[2]))
    found = on_two(joint("a", *a), joint("b", *b))
    assert found.kind == "both" and min(found.normal) > 0
    assert found.factor(1.0, 0.0) == pytest.approx(by_hand, rel=1e-12)
    assert found.factor(1.0, 0.0) == pytest.approx(wanted, abs=5e-7)
    assert found.drive == pytest.approx(np.sin(plunge))


def test_a_symmetric_wedge_by_its_angles():
    # F = sin(beta) / sin(xi / 2) tan(phi) / tan(plunge), beta = 90 deg as the wedge stands upright
    dip = np.radians(55)
    plunge = np.arctan(np.tan(dip) * np.cos(np.pi / 4))
    half = np.arccos(np.cos(dip) / np.cos(plunge))  # tilt of each plane about the line
    found = on_two(joint("a", 55, 135, 30), joint("b", 55, 225, 30))
    wanted = np.tan(np.radians(30)) / np.tan(plunge) / np.cos(half)
    assert found.factor(7e6, 0.0) == pytest.approx(wanted, rel=1e-12)


def test_a_wedge_that_leaves_one_plane():
    steep = joint("b", 75, 310, 30)
    for pair, kind in (((joint("a", 45, 245, 32), steep), "first"),
                       ((steep, joint("a", 45, 245, 32)), "second")):  # fmt: skip
        found = on_two(*pair)
        assert found.kind == kind
        assert found.factor(1.0, 0.0) == pytest.approx(0.624869, abs=5e-7)  # tan 32 / tan 45
        assert found.factor(1.0, 0.0) == pytest.approx(np.tan(np.radians(32)), rel=1e-12)


def test_a_plane_with_cohesion():
    found = on_one(joint("a", 40, 10, 25))
    weight, held = 5e6, 1e6
    wanted = np.tan(np.radians(25)) / np.tan(np.radians(40)) + held / weight / np.sin(
        np.radians(40)
    )
    assert found.factor(weight, held) == pytest.approx(wanted, rel=1e-12)
    azimuth = np.degrees(np.arctan2(found.direction[0], found.direction[1]))
    assert azimuth == pytest.approx(10) and found.drive == pytest.approx(np.sin(np.radians(40)))


def test_nothing_slides_on_flat_or_parallel_planes():
    assert on_one(joint("a", 0, 0, 30)) is None
    assert on_two(joint("a", 90, 0, 30), joint("b", 90, 180, 30)) is None
    assert on_two(joint("a", 0, 0, 30), joint("b", 0, 0, 30)) is None
