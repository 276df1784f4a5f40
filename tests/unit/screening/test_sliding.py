"""Factors of wedges and planes against the closed forms of Hoek & Bray."""

import numpy as np
import pytest
from shared.hills import joint

from cdem.joints.directions import poles
from cdem.joints.kinematics import intersections
from cdem.screening.sliding import (
    BOTH,
    DOWN,
    FIRST,
    KINDS,
    LIFTS,
    PLANE,
    SECOND,
    factors,
    on_one,
    on_two,
    rest_on,
)

WEDGES = [
    ((55, 135, 30), (55, 225, 30), 0.701351),
    ((60, 40, 25), (50, 130, 35), 0.755127),
]


def factor_of(*planes, weight=1.0, cohesive=0.0):
    """Factor under the weight alone."""
    normals = np.array([plane.normal for plane in planes])
    tangents = np.array([plane.tangent for plane in planes])
    return factors(normals, tangents, np.full(len(planes), cohesive), weight * DOWN)[0]


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
    pair = (joint("a", *a), joint("b", *b))
    found = on_two(*pair)
    assert found.kind == "both"
    assert factor_of(*pair) == pytest.approx(by_hand, rel=1e-12)
    assert factor_of(*pair) == pytest.approx(wanted, abs=5e-7)
    assert found.drive == pytest.approx(np.sin(plunge))


def test_a_symmetric_wedge_by_its_angles():
    # F = sin(beta) / sin(xi / 2) tan(phi) / tan(plunge), beta = 90 deg as the wedge stands upright
    dip = np.radians(55)
    plunge = np.arctan(np.tan(dip) * np.cos(np.pi / 4))
    half = np.arccos(np.cos(dip) / np.cos(plunge))  # tilt of each plane about the line
    pair = (joint("a", 55, 135, 30), joint("b", 55, 225, 30))
    wanted = np.tan(np.radians(30)) / np.tan(plunge) / np.cos(half)
    assert factor_of(*pair, weight=7e6) == pytest.approx(wanted, rel=1e-12)


def test_a_wedge_that_leaves_one_plane():
    steep = joint("b", 75, 310, 30)
    for pair, kind in (((joint("a", 45, 245, 32), steep), "first"),
                       ((steep, joint("a", 45, 245, 32)), "second")):  # fmt: skip
        found = on_two(*pair)
        assert found.kind == kind
        assert factor_of(*pair) == pytest.approx(0.624869, abs=5e-7)  # tan 32 / tan 45
        assert factor_of(*pair) == pytest.approx(np.tan(np.radians(32)), rel=1e-12)


def test_a_plane_with_cohesion():
    plane = joint("a", 40, 10, 25)
    found = on_one(plane)
    weight, held = 5e6, 1e6
    wanted = np.tan(np.radians(25)) / np.tan(np.radians(40)) + held / weight / np.sin(
        np.radians(40)
    )
    assert factor_of(plane, weight=weight, cohesive=held) == pytest.approx(wanted, rel=1e-12)
    azimuth = np.degrees(np.arctan2(found.direction[0], found.direction[1]))
    assert azimuth == pytest.approx(10) and found.drive == pytest.approx(np.sin(np.radians(40)))


def test_nothing_slides_on_flat_or_parallel_planes():
    assert on_one(joint("a", 0, 0, 30)) is None
    assert on_two(joint("a", 90, 0, 30), joint("b", 90, 180, 30)) is None
    assert on_two(joint("a", 0, 0, 30), joint("b", 0, 0, 30)) is None


TENT = np.array([joint("a", 55, 135, 30).normal, joint("b", 55, 225, 30).normal])  # falls south


@pytest.mark.parametrize(
    ("force", "kind"),
    [
        ((0, 0, -1), BOTH),
        ((0, -0.5, -1), BOTH),
        ((1, 0, -0.2), SECOND),  # east, off the first plane, which falls to the south-east
        ((-1, 0, -0.2), FIRST),
        ((0, 0, 1), LIFTS),
        ((0, -1, 0.1), LIFTS),
    ],
)
def test_modes_under_any_force(force, kind):
    rest = rest_on(TENT, np.array(force, float))
    assert KINDS[int(rest.kind)] == KINDS[kind]
    # the planes press, and what they do not take goes along them or away from them
    assert (rest.normal >= 0).all()
    assert rest.along == pytest.approx(force + rest.normal @ TENT)
    for own, normal in zip(rest.normal, TENT, strict=True):
        away = normal @ rest.along
        assert abs(away) < 1e-12 if own > 0 else away > -1e-12


def test_many_forces_at_once_are_each_alone():
    forces = np.random.default_rng(1).normal(size=(50, 3))
    glue, tangents = np.array([0.1, 0.3]), np.array([0.5, 0.7])
    many, kinds = factors(TENT, tangents, glue, forces)
    for force, factor, kind in zip(forces, many, kinds, strict=True):
        alone = factors(TENT, tangents, glue, force)
        assert alone[0] == pytest.approx(factor, rel=1e-12) and alone[1] == kind
    assert set(kinds) == {BOTH, FIRST, SECOND, LIFTS}
    assert (many[kinds == LIFTS] == 0).all()


def test_only_planes_in_contact_have_cohesion():
    force, tangents = np.array([-1.0, 0, -0.2]), np.array([0.5, 0.7])
    first, _ = factors(TENT, tangents, np.array([0.1, 0.0]), force)
    assert factors(TENT, tangents, np.array([0.1, 9.0]), force)[0] == first
    single = factors(TENT[:1], tangents[:1], np.array([0.1]), force)
    assert single[0] == pytest.approx(first, rel=1e-12) and single[1] == PLANE
