"""Weight of the rock above points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.topology import Topology

Floats = NDArray[np.float64]

ASIDE = np.array([0.7320508, 0.4142136]) * 1e-6
"""Lateral shift of points, relative to the model's size: no point is exactly above an edge."""
AT_ONCE = 2_000_000
"""Pairs of a point and a triangle that are computed together."""


def weight_above(topology: Topology, density: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Mass above points, per horizontal area, and the height of the top of the rock.

    Upward faces of each block count positive, others negative: the space between two of them is
    rock, for any blocks, gaps and densities.

    Args:
        topology: Blocks and their faces.
        density: Density by group [kg/m3]; 0 for absent groups.
        points: Points [m], shape (points, 3).

    Returns:
        Mass [kg/m2] and height [m] (-inf without rock above), shape (points,).
    """
    triangle, mass = _triangles(topology, density)
    size = np.ptp(triangle[..., :2].reshape(-1, 2), axis=0).max(initial=0.0)
    at = points[:, :2] + ASIDE * size
    above = np.zeros(len(points))
    top = np.full(len(points), -np.inf)
    for point, corner, of in _near(triangle, mass, at):
        inside = _weights(corner, at[point]).min(axis=0) >= 0
        height = (_weights(corner, points[point, :2]) * corner[..., 2].T).sum(axis=0)
        higher = inside & (height > points[point, 2])
        above += np.bincount(
            point[higher],
            of[higher] * (height[higher] - points[point[higher], 2]),
            minlength=len(points),
        )
        np.maximum.at(top, point[inside], height[inside])
    return above, top


def _triangles(t: Topology, density: Floats) -> tuple[Floats, Floats]:
    """Triangles of faces that bound rock of one density, and their signed density."""
    ends = density[t.face_group] > 0
    a, b = t.pair_faces.reshape(-1, 2).T
    same = density[t.face_group[a]] == density[t.face_group[b]]
    ends[t.pair_faces[same].ravel()] = False
    nodes, of_face = t.face_nodes[ends], density[t.face_group[ends]]
    four = nodes[:, 3] >= 0
    corner = np.concatenate([nodes[:, :3], nodes[four][:, [0, 2, 3]]])
    of = np.concatenate([of_face, of_face[four]])
    x = t.node_position[corner]
    along, across = x[:, 1, :2] - x[:, 0, :2], x[:, 2, :2] - x[:, 0, :2]
    area = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0]
    some = np.abs(area) > 1e-12 * np.ptp(x[..., :2], axis=1).max(axis=1, initial=1e-300) ** 2
    return x[some], (np.sign(area) * of)[some]


def _near(triangle: Floats, mass: Floats, at: Floats):  # type: ignore[no-untyped-def]
    """Points and triangles in the same cells of a grid: numbers of points, corners, masses."""
    if not len(triangle) or not len(at):
        return
    low, high = triangle[..., :2].min(axis=(0, 1)), triangle[..., :2].max(axis=(0, 1))
    cells = int(np.clip(np.sqrt(len(triangle)), 1, 1000))
    step = np.maximum((high - low) / cells, 1e-300)

    def place(x: Floats) -> NDArray[np.int64]:
        return np.clip((x - low) / step, 0, cells - 1).astype(np.int64)

    inside = np.flatnonzero(((at >= low) & (at <= high)).all(axis=1))
    cell_of = place(at[inside]) @ [cells, 1]
    order = np.argsort(cell_of, kind="stable")
    first = np.searchsorted(cell_of[order], np.arange(cells * cells + 1))
    begin, end = place(triangle[..., :2].min(axis=1)), place(triangle[..., :2].max(axis=1))
    wide = end - begin + 1
    owner = np.repeat(np.arange(len(triangle)), wide.prod(axis=1))
    number = np.arange(len(owner)) - np.repeat(np.cumsum(wide.prod(axis=1)), wide.prod(axis=1))
    number += wide.prod(axis=1)[owner]
    row, column = number // wide[owner, 1], number % wide[owner, 1]
    cell = (begin[owner, 0] + row) * cells + begin[owner, 1] + column
    count = first[cell + 1] - first[cell]
    piece = np.cumsum(count) // AT_ONCE
    for part in np.unique(piece):
        some = piece == part
        many = count[some]
        entry = np.repeat(np.flatnonzero(some), many)
        within = np.arange(len(entry)) - np.repeat(np.cumsum(many) - many, many)
        point = inside[order[first[cell[entry]] + within]]
        yield point, triangle[owner[entry]], mass[owner[entry]]


def _weights(corner: Floats, at: Floats) -> Floats:
    """Barycentric coordinates of points in the plans of triangles, shape (3, points)."""
    a, b, c = corner[:, 0, :2], corner[:, 1, :2], corner[:, 2, :2]

    def cross(u: Floats, v: Floats) -> Floats:
        return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]

    whole = cross(b - a, c - a)
    of_b, of_c = cross(at - a, c - a) / whole, cross(b - a, at - a) / whole
    return np.stack([1 - of_b - of_c, of_b, of_c])
