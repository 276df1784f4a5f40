"""The rigid part of the motion of a block of tets."""

import numpy as np
import pytest

from cdem.mesh.primitives import polyhedron
from cdem.rockfall.blocks import attitude
from cdem.rockfall.rigid import RigidBlock


@pytest.fixture
def box():
    sides = np.array([2.0, 1.0, 0.5])
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * sides
    mesh = polyhedron("block", corners)
    return mesh.points, RigidBlock(mesh.points, mesh.cells["tet4"], 2600.0), sides


def test_energies_of_a_turning_box(box):
    """T = m v2/2 and R = m/24 sum w_i2 (a_j2 + a_k2) for a box that turns about its axes."""
    points, body, sides = box
    assert body.mass == pytest.approx(2600.0, rel=1e-14)
    centre, v, w = sides / 2, np.array([3.0, -4.0, 12.0]), np.array([1.0, 2.0, -3.0])
    motion = body.motion(points, v + np.cross(w, points - centre))
    np.testing.assert_allclose(motion.centre, centre, atol=1e-14)
    np.testing.assert_allclose(motion.velocity, v, rtol=1e-13)
    np.testing.assert_allclose(motion.spin, w, rtol=1e-12)
    squares = sides**2
    assert motion.translation == pytest.approx(0.5 * body.mass * 169, rel=1e-13)
    rotation = body.mass / 24 * (w**2 @ (squares.sum() - squares))
    assert motion.rotation == pytest.approx(rotation, rel=1e-12)


def test_a_box_is_placed_as_it_lies(box):
    points, body, _ = box
    turn = attitude(np.random.default_rng(2))
    there = points @ turn.T + [10.0, -4.0, 7.0]
    np.testing.assert_allclose(body.placed(there), there, atol=1e-12)
    stretched = 1.01 * (there - there.mean(axis=0)) + there.mean(axis=0)
    placed = body.placed(stretched)
    spread = np.linalg.norm(placed - placed.mean(axis=0), axis=1)
    np.testing.assert_allclose(
        spread, np.linalg.norm(points - points.mean(axis=0), axis=1), atol=1e-12
    )


def test_attitudes_are_rotations_of_all_directions():
    random = np.random.default_rng(1)
    turns = np.array([attitude(random) for _ in range(4000)])
    np.testing.assert_allclose(
        turns @ turns.transpose(0, 2, 1), np.eye(3)[None].repeat(4000, 0), atol=1e-12
    )
    np.testing.assert_allclose(np.linalg.det(turns), 1.0)
    # each component of a random unit vector has mean 0 and variance 1/3
    assert np.abs(turns.mean(axis=0)).max() < 5 / np.sqrt(3 * 4000)
    assert np.abs((turns**2).mean(axis=0) - 1 / 3).max() < 0.03
