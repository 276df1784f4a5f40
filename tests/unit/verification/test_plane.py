"""Plane meshes of the verification problems: points scattered at random, Delaunay triangles."""

import numpy as np
import pytest

from cdem.verification import plane


def rim_of_disc(count):
    angle = 2 * np.pi * np.arange(count) / count
    return np.column_stack([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("seed", [1, 2])
def test_triangles_fill_a_disc_and_their_circumcircles_are_empty(seed):
    rim = rim_of_disc(24)
    spacing = 2 * np.pi / 24
    points = plane.scatter(rim, spacing, seed, lambda x: np.hypot(*x.T) < 1 - 0.5 * spacing)
    triangles = plane.delaunay(points)

    a, b, c = (points[triangles[:, k]] for k in range(3))
    b, c = b - a, c - a
    area = 0.5 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    assert area.min() > 0  # counter-clockwise
    assert area.sum() == pytest.approx(12 * np.sin(np.pi / 12), rel=1e-12)
    assert len(triangles) == 2 * len(points) - 2 - 24  # Euler
    # the centre is where the distances to all three corners agree: nobody is nearer
    twice = 2 * np.stack([b, c], axis=1)
    centre = np.linalg.solve(twice, (twice**2).sum(axis=2)[..., None] / 4)[..., 0]
    radius = np.hypot(*centre.T)
    distance = np.linalg.norm(points - (a + centre)[:, None], axis=2)
    assert (distance > radius[:, None] - 1e-9).all()


def test_scattered_points_keep_their_distance_and_leave_no_room():
    rim = rim_of_disc(24)
    points = plane.scatter(rim, 0.26, 1, lambda x: np.hypot(*x.T) < 0.87)
    apart = np.linalg.norm(points[:, None] - points, axis=2) + 9 * np.eye(len(points))
    assert apart[24:].min() > 0.8 * 0.26
    grid = np.stack(np.meshgrid(*2 * [np.linspace(-0.6, 0.6, 61)]), axis=-1).reshape(-1, 2)
    nearest = np.linalg.norm(grid[:, None] - points, axis=2).min(axis=1)
    assert nearest.max() < 1.5 * 0.26


def test_the_same_seed_gives_the_same_points():
    def points(seed):
        return plane.scatter(rim_of_disc(24), 0.26, seed, lambda x: np.hypot(*x.T) < 0.87)

    assert np.array_equal(points(3), points(3))
    assert not np.array_equal(points(3)[24:30], points(4)[24:30])
