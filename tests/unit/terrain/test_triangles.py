"""Heights of triangulated surfaces, and surfaces without one height at each place."""

import numpy as np
import pytest
from shared.facets import sheet
from shared.slopes import PLANE

from cdem.errors import CaseError
from cdem.terrain.triangles import Triangles

X, Y = np.linspace(0, 90, 10), np.linspace(0, 60, 7)
INSIDE = np.random.default_rng(2).uniform([0, 0], [90, 60], (500, 2))


def plane(x, y):
    return PLANE(np.column_stack([x, y]))


@pytest.mark.parametrize("corner", [(0.0, 0.0), (500_000.0, 5_000_000.0)])
def test_a_plane_is_exact_also_on_a_map(corner):
    points, triangles = sheet(plane, X, Y)
    surface = Triangles(points + [*corner, 0], triangles[:, ::-1])  # any orientation
    at = np.concatenate([INSIDE, points[:, :2]])  # corners and edges too
    assert np.abs(surface(at + corner) - PLANE(at)).max() < 1e-8
    assert surface.low == pytest.approx(corner) and surface.notes == []
    beyond = np.array([[-0.01, 30], [45, 60.01], [1e9, -1e9]]) + corner
    assert np.isnan(surface(beyond)).all()
    assert len(surface(np.zeros((0, 2)))) == 0


def test_it_is_linear_in_each_triangle():
    """The roof |x - 30| over squares whose edges follow the ridge."""
    points, triangles = sheet(lambda x, y: abs(x - 30), X, Y)
    assert Triangles(points, triangles)(INSIDE) == pytest.approx(abs(INSIDE[:, 0] - 30), abs=1e-12)


def test_long_triangles_are_found():
    """A fan of thin triangles around one corner, and one of two triangles in a large surface."""
    angle = np.linspace(0, np.pi / 2, 400)
    rim = np.column_stack([100 * np.cos(angle), 100 * np.sin(angle), 50 + 0 * angle])
    points = np.concatenate([[[0, 0, 0]], rim])
    triangles = [[0, k, k + 1] for k in range(1, 400)]
    at = INSIDE[np.hypot(*INSIDE.T) < 99]
    found = Triangles(points, np.array(triangles))(at)
    assert found == pytest.approx(np.hypot(*at.T) / 2, rel=1e-5)


def test_a_hole_has_no_height():
    points, triangles = sheet(plane, X, Y)
    middle = points[triangles].mean(axis=1)[:, :2]
    hole = (abs(middle - [35, 25]) < 5).all(axis=1)
    surface = Triangles(points, triangles[~hole])
    assert np.isnan(surface(np.array([[33.0, 24.0]])))[0]
    assert np.isfinite(surface(np.array([[29.9, 24.0], [40.1, 26.0]]))).all()


def test_gaps_of_rounding_are_closed():
    points, triangles = sheet(plane, X, Y)
    corners = points[triangles].reshape(-1, 3)
    corners = corners + 1e-5 * np.random.default_rng(3).uniform(-1, 1, corners.shape)
    surface = Triangles(corners, np.arange(len(corners)).reshape(-1, 3))
    assert np.abs(surface(points[:, :2]) - points[:, 2]).max() < 1e-4
    assert np.abs(surface(INSIDE) - PLANE(INSIDE)).max() < 1e-4


def test_a_cliff_of_vertical_triangles_is_left_out_and_told():
    """A step of 10 m at x = 30: 60 m2 x 10 of wall beside 5,400 m2."""
    points, triangles = sheet(lambda x, y: 0 * x, X, Y)
    low = points[triangles].mean(axis=1)[:, 0] < 30
    wall = [[[30, 0, 0], [30, 60, 0], [30, 60, 10]], [[30, 0, 0], [30, 60, 10], [30, 0, 10]]]
    corners = np.concatenate([points[triangles[low]], points[triangles[~low]] + [0, 0, 10], wall])
    surface = Triangles(corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3))
    assert surface(np.array([[29.0, 7], [31.0, 7]])) == pytest.approx([0, 10])
    assert surface.notes == ["2 vertical triangles, 10.00% of its area, are left out"]
    with pytest.raises(CaseError, match="all its triangles are vertical or without area"):
        Triangles(np.array([[0, 0, 0], [0, 1, 0], [0, 0, 1.0]]), np.array([[0, 1, 2]]))


def test_two_heights_are_refused_with_their_place():
    points, triangles = sheet(plane, X, Y)
    twice = np.concatenate([triangles, triangles + len(points)])
    same = Triangles(np.concatenate([points, points]), twice)  # one surface, given twice
    assert same(INSIDE) == pytest.approx(PLANE(INSIDE))
    with pytest.raises(CaseError, match=r"two heights at \(.*\): .* m and .* m; it folds over"):
        Triangles(np.concatenate([points, points + [0, 0, 3.0]]), twice)
    # an overhang: a flap that turns back over the surface at its eastern edge
    flap = np.array([[90, 20, 130.0], [90, 40, 130.0], [70, 30, 150.0]])
    edge = np.concatenate([points, flap])
    more = np.concatenate([triangles, len(points) + np.array([[0, 1, 2]])])
    with pytest.raises(CaseError, match="has two heights at"):
        Triangles(edge, more)
