"""The ground on triangles, and windows of it."""

import numpy as np
import pytest

from cdem.errors import CdemError
from cdem.rockfall.ground import Ground, read_ground


@pytest.fixture
def ground():
    z = np.random.default_rng(1).normal(size=(7, 9))
    zone = np.zeros((6, 8), np.int16)
    zone[:, 4:] = 1
    return Ground(100.0, 50.0, np.array([2.0, 3.0]), z, zone)


def test_heights_are_those_of_the_triangles_of_the_window(ground):
    mesh, (low, high) = ground.window(ground.low, ground.high)
    assert (low == ground.low).all()
    assert (high == ground.high).all()
    assert mesh.group_names == ["ground_0", "ground_1"]
    assert np.bincount(mesh.cell_group["wedge6"]).tolist() == [48, 48]
    top = mesh.points[mesh.cells["wedge6"][:, 3:]]
    weights = np.random.default_rng(2).dirichlet([1, 1, 1], len(top))
    inside = np.einsum("tk,tki->ti", weights, top)
    height, slope = ground.plane(inside[:, :2])
    np.testing.assert_allclose(height, inside[:, 2], atol=1e-12)
    normal = np.cross(top[:, 1] - top[:, 0], top[:, 2] - top[:, 0])
    assert (normal[:, 2] > 0).all()
    np.testing.assert_allclose(slope, -normal[:, :2] / normal[:, 2:], atol=1e-12)


def test_a_part_has_the_triangles_of_the_whole(ground):
    whole, _ = ground.window(ground.low, ground.high)
    part, (low, high) = ground.window(np.array([103.0, 57.0]), np.array([109.0, 63.0]))
    assert (low.tolist(), high.tolist()) == ([102.0, 56.0], [110.0, 65.0])

    def triangles(mesh):
        corners = mesh.points[mesh.cells["wedge6"][:, 3:]]
        return {tuple(sorted(map(tuple, c))) for c in corners.tolist()}

    assert triangles(part) < triangles(whole)


def test_gaps_and_outside(ground, tmp_path):
    ground.heights[2, 3] = np.nan
    mesh, _ = ground.window(ground.low, ground.high)
    assert len(mesh.cells["wedge6"]) == 2 * (48 - 4)
    assert np.isfinite(mesh.points).all()
    assert np.isnan(ground.height(np.array([[106.1, 56.1], [99.9, 55.0]]))).all()
    ground.write(tmp_path / "ground.npz")
    again = read_ground(tmp_path / "ground.npz")
    np.testing.assert_array_equal(again.heights, ground.heights)
    assert (again.west, again.south, again.step.tolist()) == (100.0, 50.0, [2.0, 3.0])
    (tmp_path / "ground.npz").write_bytes(b"nothing")
    with pytest.raises(CdemError, match="cannot read the ground"):
        read_ground(tmp_path / "ground.npz")
    ground.heights[:] = np.nan
    with pytest.raises(CdemError, match="no ground"):
        ground.window(ground.low, ground.high)
