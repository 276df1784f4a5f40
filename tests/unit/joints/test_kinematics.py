"""Planes and wedges judged by hand on a slope of 60/090 with 30 deg of friction."""

import numpy as np
import pytest

from cdem.joints.directions import poles
from cdem.joints.kinematics import MOST_FOR_PAIRS, Slope, intersections, shares

FACE = Slope(60, 90, 30)
APPARENT = np.degrees(np.arctan(np.tan(np.radians(60)) * np.cos(np.radians(10))))  # 59.62 deg


@pytest.mark.parametrize(
    ("dip", "direction", "slides"),
    [
        (45, 90, True),
        (29, 90, False),  # flatter than friction
        (61, 90, False),  # does not daylight
        (45, 109, True),
        (45, 111, False),  # beyond the lateral limit
        (45, 71, True),
        (APPARENT - 0.1, 100, True),
        (APPARENT + 0.1, 100, False),
        (45, 270, False),
    ],
)
def test_planar(dip, direction, slides):
    assert FACE.planar(np.array([dip]), np.array([direction])).tolist() == [slides]


@pytest.mark.parametrize(
    ("dip", "direction", "topples"),
    [(61, 270, True), (59, 270, False), (70, 289, True), (70, 249, False), (70, 90, False)],
)
def test_toppling(dip, direction, topples):
    # Goodman: 90 - slope + friction = 60 deg
    assert FACE.toppling(np.array([dip]), np.array([direction])).tolist() == [topples]


def test_azimuths_beyond_north():
    north = Slope(60, 5, 30)
    assert north.planar(np.array([45.0, 45]), np.array([350.0, 340])).tolist() == [True, False]
    assert north.toppling(np.array([70.0]), np.array([170.0])).tolist() == [True]


def test_wedges():
    # tan plunge = tan 45 cos 45: 35.26 deg towards 090
    plunge, trend = intersections(poles(np.array([45.0, 45]), np.array([45.0, 135])))
    assert plunge == pytest.approx([35.264390], abs=1e-6) and trend == pytest.approx([90])
    assert FACE.wedge(plunge, trend).all()
    assert not Slope(60, 90, 36).wedge(plunge, trend).any()  # friction
    assert not Slope(35, 90, 30).wedge(plunge, trend).any()  # does not daylight
    assert not Slope(60, 270, 30).wedge(plunge, trend).any()  # the other way


def test_shares_of_all_and_of_sets():
    normals = poles(np.array([45.0, 45, 20, 70]), np.array([90.0, 95, 90, 270]))
    means = poles(np.array([45.0, 70]), np.array([92.0, 270]))
    member = np.array([[1, 0, 0], [1, 0, 0], [1, 0, 0], [0, 1, 0]], float)
    found = shares(FACE, normals, means, member)
    assert (found.planar, found.toppling) == (0.5, 0.25)
    assert found.planar_of == pytest.approx([2 / 3, 0]) and found.toppling_of == [0, 1]
    first, second, _, _, slides = found.wedges[0]
    assert (first, second, slides) == (0, 1, False)


def test_many_joints_make_pairs_of_some():
    many = poles(np.linspace(1, 80, 4000), np.linspace(0, 350, 4000))
    assert len(intersections(many)[0]) == MOST_FOR_PAIRS * (MOST_FOR_PAIRS - 1) // 2
