"""Sliding surfaces by their shape, against closed forms."""

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.terrain.files import as_it_is
from cdem.terrain.heights import Plane
from cdem.terrain.surfaces import Ellipsoid, Highest, Spline, fit_plane, through_points

pytest.importorskip("scipy", reason="needs the extra 'terrain'")

STEP = 1.0
X = np.arange(-150, 150 + STEP / 2, STEP)
GRID = np.stack(np.meshgrid(X, X), axis=-1).reshape(-1, 2)
SLOPE = Plane(30, 90, (0, 0, 500))


def depth_below(surface):
    return np.maximum(SLOPE(GRID) - surface(GRID), 0.0)


def test_half_an_ellipsoid_on_a_slope():
    """Centred on the slope and tilted with it: 2/3 pi a b c."""
    d = depth_below(Ellipsoid(np.array([0, 0, 500.0]), np.array([110.0, 70, 25]), 90, 30))
    assert d.sum() * STEP**2 == pytest.approx(2 / 3 * np.pi * 110 * 70 * 25, rel=5e-4)


def test_the_cap_of_an_ellipsoid():
    """Centre d above the slope: pi a b c (2/3 - d/c + (d/c)^3/3), depth c - d normal to it."""
    normal = np.array([0.5, 0, np.sqrt(3) / 2])
    d = depth_below(Ellipsoid([0, 0, 500] + 10 * normal, np.array([110.0, 70, 25]), 90, 30))
    q = 10 / 25
    assert d.sum() * STEP**2 == pytest.approx(
        np.pi * 110 * 70 * 25 * (2 / 3 - q + q**3 / 3), rel=3e-4
    )
    assert d.max() * np.sqrt(3) / 2 == pytest.approx(15, rel=1e-4)


def test_a_wedge_stands_above_both_planes():
    """Planes of dip d that face each other, their line level: a valley whose depth is tan d |y|."""
    both = Highest([Plane(40, 0, (0, 10, 0)), Plane(40, 180, (0, 10, 0))])
    at = np.array([[0, 10], [5, 30], [5, -10.0]])
    assert both(at) == pytest.approx([0, 20 * np.tan(np.radians(40)), 20 * np.tan(np.radians(40))])


def test_a_spline_through_points_of_a_plane_is_that_plane():
    rng = np.random.default_rng(0)
    plane = Plane(24, 110, (0, 0, 470))
    at = rng.uniform(-100, 100, (12, 2)) + [600_000, 5_000_000]
    spline = Spline(np.column_stack([at, plane(at)]))
    there = GRID + [600_000, 5_000_000]
    assert np.abs(spline(there) - plane(there)).max() < 1e-6
    with pytest.raises(CaseError, match="through 2 points needs three or more, not on one line"):
        Spline(np.array([[0, 0, 1], [1, 1, 2.0]]))
    with pytest.raises(CaseError, match="not on one line"):
        Spline(np.array([[0, 0, 1], [1, 1, 2], [2, 2, 1.0]]))


def test_a_plane_through_crown_and_toe():
    rng = np.random.default_rng(0)
    plane, t = Plane(27, 100, (0, 0, 480)), np.linspace(-80, 80, 60)
    at = np.column_stack([np.r_[t * 0 - 90, t * 0 + 70], np.r_[t, t]])
    exact, notes = fit_plane(np.column_stack([at, plane(at)]), "crown.gpkg")
    assert exact.dip == pytest.approx(27, abs=1e-9)
    assert exact.dip_direction == pytest.approx(100, abs=1e-9)
    assert "doubtful" not in notes[0]
    noisy, notes = fit_plane(
        np.column_stack([at, plane(at) + rng.normal(0, 0.5, len(at))]), "crown.gpkg"
    )
    assert noisy.dip == pytest.approx(27, abs=0.1)
    assert noisy.dip_direction == pytest.approx(100, abs=0.3)
    assert "0.43 m off" in notes[0]
    line = np.column_stack([t, 0.01 * rng.normal(size=60), -0.5 * t])
    assert "doubtful" in fit_plane(line, "crown.gpkg")[1][0]
    with pytest.raises(CaseError, match="lie on one line"):
        fit_plane(np.column_stack([t, t, t]), "crown.gpkg")
    with pytest.raises(CaseError, match="is vertical"):
        fit_plane(np.column_stack([t, t * 0, t**2]), "crown.gpkg")


def test_points_of_other_tools_are_read(tmp_path):
    path = tmp_path / "dips.csv"
    path.write_text("X,Y,Elevation,SlopeAngle,Azi\n0,0,100,30,90\n0,10,100,40,180\n")
    surface = through_points(path, {}, as_it_is)
    planes = [Plane(30, 90, (0, 0, 100)), Plane(40, 180, (0, 10, 100))]
    assert surface(GRID) == pytest.approx(np.maximum(planes[0](GRID), planes[1](GRID)))
    path.write_text("x,y,z\n0,0,100\n10,0,90\n0,10,100\n")
    assert through_points(path, {}, as_it_is)(GRID) == pytest.approx(
        Plane(45, 90, (0, 0, 100))(GRID)
    )


@pytest.mark.parametrize(
    ("text", "columns", "message"),
    [
        ("x,y,z,dip,slopeangle\n0,0,1,90,30\n", {}, "AvaFrame's 'dip' is an azimuth counted from"),
        ("x,y,z,dip\n0,0,1,30\n", {}, "no column for dip_direction; name it with 'columns'"),
        ("x,y\n0,0\n", {}, r"no column for z; .*\(it has: x, y\)"),
        ("x,y,z\n0,0,one\n", {}, "point 1 has no number in column 'z'"),
        ("x,y,z\n0,0\n", {}, "row 2 has 2 of 3 columns"),
        ("x,y,z,dip,azi\n0,0,1,120,30\n", {}, r"dips must lie in \[0, 90\) deg, got 120 to 120"),
        ("x,y,z\n0,0,1\n", {"depth": "z"}, "columns are x, y, z, dip, dip_direction, not 'depth'"),
        ("x,y,z\n0,0,1\n", {"z": "h"}, "has no column 'h'; it has: x, y, z"),
        ("", {}, "contains no points"),
    ],
)
def test_bad_points_are_refused(tmp_path, text, columns, message):
    path = tmp_path / "p.csv"
    path.write_text(text)
    with pytest.raises(CaseError, match=message):
        through_points(path, columns, as_it_is)
