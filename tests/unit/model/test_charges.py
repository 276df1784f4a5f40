"""Axes of holes from their faces: whole, half and quarter holes, with an end, chambers, flat walls."""

from types import SimpleNamespace

import numpy as np
import pytest

from cdem.model.charges import apart, axis_of

TURN = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
TURN *= np.linalg.det(TURN)
FOOT = np.array([30.0, -7.0, 400.0])


def grid(points, rows, columns):
    """Quads between points of a grid, their normals on the side of (column, row)."""
    i, k = (g.ravel() for g in np.meshgrid(range(rows), range(columns), indexing="ij"))
    low = i * (columns + 1) + k
    quads = np.column_stack([low, low + columns + 1, low + columns + 2, low + 1])
    return points.reshape(-1, 3), quads


def hole(part, *, length=4.0, radius=0.2, around=16, layers=5):
    """Wall of a part of a hole along z; normals look inwards."""
    angle = np.linspace(0, 2 * np.pi * part, round(around * part) + 1)
    z = np.linspace(0, length, layers + 1)
    circle = radius * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    points = np.concatenate(
        [np.broadcast_to(circle, (len(z), *circle.shape)), np.broadcast_to(z[:, None, None], (len(z), len(angle), 1))],
        axis=2,
    )  # fmt: skip
    return grid(points, layers, len(angle) - 1)


def topology(*parts):
    """Faces of all parts, turned and moved; points in one place share it."""
    first = np.cumsum([0, *(len(points) for points, _ in parts)])
    points = np.concatenate([points for points, _ in parts])
    faces = np.concatenate([quads + n for (_, quads), n in zip(parts, first, strict=False)])
    _, place = np.unique(points.round(6), axis=0, return_inverse=True)
    return SimpleNamespace(node_position=points @ TURN.T + FOOT, face_nodes=faces,
                           node_place=place.ravel())  # fmt: skip


def places(t, faces):
    """Ends before they were turned, the lower first."""
    ends = (np.array(axis_of(t, faces)) - FOOT) @ TURN
    return ends[np.argsort(ends[:, 2])]


@pytest.mark.parametrize("part", [1, 0.5, 0.25])
def test_parts_of_a_hole_have_the_axis_of_the_whole(part):
    t = topology(hole(part))
    np.testing.assert_allclose(
        places(t, np.arange(len(t.face_nodes))), [[0, 0, 0], [0, 0, 4]], atol=1e-9
    )


def test_faces_at_the_end_of_a_hole_do_not_count():
    points, quads = hole(1)
    end = np.column_stack([np.arange(0, 16, 2), np.arange(1, 17, 2), np.arange(2, 18, 2),
                           np.full(8, len(points))])[:, [0, 1, 2, 3]]  # fmt: skip
    t = topology((np.vstack([points, [0, 0, 0]]), np.concatenate([quads, end])))
    found = places(t, np.arange(len(t.face_nodes)))
    np.testing.assert_allclose(found, [[0, 0, 0], [0, 0, 4]], atol=1e-9)


@pytest.mark.parametrize("part", [1, 0.25])
def test_a_chamber_is_in_its_middle(part):
    """A sphere, and an octant of one."""
    up = np.linspace(-np.pi / 2 if part == 1 else 0, np.pi / 2, 13)[1:-1]
    round_it = np.linspace(0, 2 * np.pi * part, round(24 * part) + 1)
    u, v = np.meshgrid(up, round_it, indexing="ij")
    points = 3 * np.stack([np.cos(u) * np.cos(v), np.cos(u) * np.sin(v), np.sin(u)], axis=-1)
    t = topology(grid(points, len(up) - 1, len(round_it) - 1))
    found = places(t, np.arange(len(t.face_nodes)))
    np.testing.assert_allclose(found, 0, atol=0.05)
    assert (found[0] == found[1]).all()


def test_a_flat_wall_is_in_its_middle():
    x, y = np.meshgrid([0, 1, 3], [0, 2], indexing="ij")
    t = topology(grid(np.stack([x, y, 0 * x + 5.0], axis=-1), 2, 1))
    np.testing.assert_allclose(places(t, np.arange(2)), [[1.5, 1, 5]] * 2, atol=1e-9)


def test_holes_of_one_surface_are_apart():
    points, quads = hole(1)
    t = topology((points, quads), (points + [9, 0, 0], quads))
    some = np.concatenate([np.arange(3, 160), [0, 1, 2]])  # in any order
    one, other = apart(t, some)
    assert set(one.tolist()) == set(range(80)) and set(other.tolist()) == set(range(80, 160))
    np.testing.assert_allclose(places(t, other), [[9, 0, 0], [9, 0, 4]], atol=1e-9)
