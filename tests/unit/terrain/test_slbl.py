"""Sloping local base level against its closed forms: k is the Laplacian of the surface.

Circle of radius R: depth k R^2 / 4, volume pi k R^4 / 8; strip of width L: k L^2 / 8; square of side L:
0.0736714 k L^2 and 0.0351443 k L^4 (torsion of a square bar). All hold on any plane.
"""

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.terrain.plan import flat_mesh
from cdem.terrain.slbl import Membrane, OnTriangles, curvature_for

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")

K = 0.01


def membrane(ring, size, ground):
    """Triangles inside a ring."""
    lines = [(np.array([a, b]), 1, 0) for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True)]
    points, triangles, _ = flat_mesh(lines, [size], 0.3)
    edge = np.zeros(len(points), bool)
    pairs = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    ends, count = np.unique(pairs, axis=0, return_counts=True)
    edge[ends[count == 1]] = True
    return Membrane(points, triangles, ground(points), edge)


def slope(points):
    return 500 - np.tan(np.radians(30)) * points[:, 0]


def circle(radius, size):
    t = np.arange(0, 2 * np.pi, size / radius)
    return radius * np.column_stack([np.cos(t), np.sin(t)])


def test_a_circle():
    found = membrane(circle(100.0, 5.0), 5.0, slope)
    s = found.surface(K)
    # of second order in the edge length: 5 m of 100 m
    assert found.depth(s) == pytest.approx(K * 100**2 / 4, rel=3e-3)
    assert found.volume(s) == pytest.approx(np.pi / 8 * K * 100**4, rel=6e-3)
    coarse = membrane(circle(100.0, 10.0), 10.0, slope)
    errors = [1 - m.volume(m.surface(K)) / (np.pi / 8 * K * 100**4) for m in (coarse, found)]
    assert 3 < errors[0] / errors[1] < 5


def test_a_square_and_a_strip():
    side = np.arange(-100, 100, 10.0)
    rest = np.full(len(side), 100.0)
    ring = np.concatenate(
        [np.c_[side, -rest], np.c_[rest, side], np.c_[-side, rest], np.c_[-rest, -side]]
    )
    found = membrane(ring, 10.0, slope)
    s = found.surface(K)
    assert found.depth(s) == pytest.approx(0.0736714 * K * 200**2, rel=3e-3)
    assert found.volume(s) == pytest.approx(0.0351443 * K * 200**4, rel=1e-2)
    strip = membrane(ring * [8.0, 1.0], 12.0, slope)
    assert strip.depth(strip.surface(K)) == pytest.approx(K * 200**2 / 8, rel=3e-3)


def test_it_stays_below_rough_ground_and_above_its_floor():
    rng = np.random.default_rng(1)
    bumps = rng.uniform(-100, 100, (30, 2))

    def rough(points):
        away = np.linalg.norm(points[:, None] - bumps, axis=2)
        return slope(points) - 20 * np.exp(-((away / 15) ** 2)).sum(axis=1)

    found = membrane(circle(100.0, 6.0), 6.0, rough)
    s = found.surface(2e-3)
    assert (s <= found.ground + 1e-9).all()
    touching = (s > found.ground - 1e-9) & ~found.edge
    assert touching.any() and not touching.all()
    # where it is free its Laplacian is k; where it touches, the ground is more hollow
    pull = found._stiffness @ s + 2e-3 * found._weight
    free = ~touching & ~found.edge
    assert np.abs(pull[free]).max() < 1e-9
    assert pull[touching].max() < 1e-6
    found.floor = found.ground - 5.0
    low = found.surface(2e-3)
    assert (low >= found.floor - 1e-9).all()
    assert found.depth(low) == pytest.approx(5.0)
    assert (low >= s - 1e-9).all()


def test_the_curvature_is_found_for_depth_and_volume_and_below_zero():
    found = membrane(circle(100.0, 10.0), 10.0, slope)

    def volume(k):
        return found.volume(found.surface(k))

    k = curvature_for(volume, 2e5, 1e-5, "volume [m3]")
    assert volume(k) == pytest.approx(2e5, rel=1e-8)
    # a dome: a flat surface already cuts off all of it
    dome = membrane(circle(100.0, 10.0), 10.0, lambda p: 500 - 2e-3 * (p**2).sum(axis=1))
    flat = dome.volume(dome.surface(0.0))
    k = curvature_for(lambda k: dome.volume(dome.surface(k)), flat / 4, 1e-5, "volume [m3]")
    # of a dome z = -a r^2 with Laplacian -4 a the part (4 a + k) / 4 a is cut off
    assert k == pytest.approx(-8e-3 * 3 / 4, rel=1e-2)
    found.floor = found.ground - 1.0
    with pytest.raises(CaseError, match=r"no surface has a volume \[m3\] of 2e\+06; the outline"):
        curvature_for(volume, 2e6, 1e-5, "volume [m3]")


def test_heights_on_triangles_are_linear_and_go_on_beyond():
    found = membrane(circle(100.0, 20.0), 20.0, slope)
    heights = OnTriangles(found.points, found.triangles, found.ground)
    at = np.random.default_rng(3).uniform(-120, 120, (500, 2))
    assert np.abs(heights(at) - slope(at)).max() < 1e-9
    assert np.abs(heights(found.points) - found.ground).max() < 1e-9
