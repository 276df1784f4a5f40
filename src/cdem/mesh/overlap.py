"""Touching faces that do not conform: clip one against the other, distribute the overlap's area.

The points of contact of two overlapping faces (vertices of either inside the other, and crossings of
their edges) are exactly the vertices of the overlap polygon. Bond points there, with areas

    w_i = (A_{i-1} + A_i) / 3 + A / (3 N),

A_i the triangles between the vertices and their mean, carry the polygon's exact area and centroid, so
neither strength nor stiffness depends on which side has the finer mesh.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.arrays import along, in_plane, lengths
from cdem.mesh.topology import Floats, Topology

COPLANAR = 1e-6
"""Faces touch if the distance of their planes over their size, and the sine of their angle, are less."""
LEAST_AREA = 1e-9
"""Overlaps below this fraction of the smaller face are sides that merely touch."""
AT_ONCE = 1_000_000
"""Pairs of boxes that are compared at once."""


@dataclass
class Overlaps:
    """Bonded overlaps; see `Topology` for the meaning and shapes of the arrays."""

    faces: NDArray[np.int32]
    first: NDArray[np.int32]
    weights_a: Floats
    weights_b: Floats
    area: Floats


def find_overlaps(t: Topology, bonded: NDArray[np.bool_]) -> Overlaps:
    """Find all touching, coplanar, opposing, non-conforming faces of bonded kinds."""
    faces, first, weights_a, weights_b, areas = [], [0], [], [], []
    for a, b in _candidates(t, bonded):
        polygon = clip(_corners(t, a), _corners(t, b))
        if polygon is None:
            continue
        area = point_areas(polygon)
        faces.append((a, b))
        first.append(first[-1] + len(area))
        weights_a.append(_weights(_corners(t, a), polygon))
        weights_b.append(_weights(_corners(t, b), polygon))
        areas.append(area)
    return Overlaps(
        np.array(faces, np.int32).reshape(-1, 2),
        np.array(first, np.int32),
        np.concatenate([np.zeros((0, 4)), *weights_a]),
        np.concatenate([np.zeros((0, 4)), *weights_b]),
        np.concatenate([np.zeros(0), *areas]),
    )


def flush_faces(
    t: Topology, kinds: NDArray[np.bool_]
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Faces of other blocks that lie flush with each face, conforming or not.

    Args:
        t: Blocks and faces.
        kinds: Pairs of kinds of faces to include, (kinds, kinds).

    Returns:
        First row of each face, (faces + 1,), and the faces in the rows, ascending.
    """
    conforming = t.pair_faces.reshape(-1, 2)
    asked = kinds[t.face_kind[conforming[:, 0]], t.face_kind[conforming[:, 1]]]
    others = _candidates(t, kinds)
    pairs = np.concatenate([conforming[asked], others]).astype(np.int32).reshape(-1, 2)
    both = np.concatenate([pairs, pairs[:, ::-1]])
    both = both[np.lexsort((both[:, 1], both[:, 0]))]
    first = np.searchsorted(both[:, 0], np.arange(len(t.face_nodes) + 1))
    return first.astype(np.int32), both[:, 1].copy()


def _corners(t: Topology, face: int) -> Floats:
    nodes = t.face_nodes[face]
    return t.node_position[nodes[nodes >= 0]]


def _candidates(t: Topology, bonded: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Pairs of free faces of different blocks whose boxes meet and whose planes agree, (pairs, 2)."""
    free = np.ones(len(t.face_nodes), bool)
    free[t.pair_faces.ravel()] = False
    free &= np.asarray(bonded.any(axis=1))[t.face_kind]
    ids = np.flatnonzero(free)
    if len(ids) < 2:
        return np.zeros((0, 2), np.int64)
    nodes = t.face_nodes[ids]
    x = t.node_position[np.where(nodes < 0, nodes[:, 2:3], nodes)]
    normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    low, high = x.min(axis=1), x.max(axis=1)
    size = np.linalg.norm(high - low, axis=1)
    low, high = low - COPLANAR * size[:, None], high + COPLANAR * size[:, None]

    # sweep along the longest axis: open boxes began within the largest extent
    axis = int(np.argmax(np.ptp(x.reshape(-1, 3), axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    low, high, normal = low[order], high[order], normal[order]
    x, size, ids = x[order], size[order], ids[order]
    end = np.searchsorted(low[:, axis], high[:, axis], side="right")
    count = end - np.arange(len(ids)) - 1
    middle = x.mean(axis=1)
    found = [np.zeros((0, 2), np.int64)]
    for some in np.array_split(np.arange(len(ids)), 1 + int(count.sum()) // AT_ONCE):
        i = np.repeat(some, count[some])
        j = i + 1 + np.arange(len(i)) - np.repeat(np.cumsum(count[some]) - count[some], count[some])
        for axis in range(3):
            meet = (low[j, axis] <= high[i, axis]) & (high[j, axis] >= low[i, axis])
            i, j = i[meet], j[meet]
        facing = np.einsum("px,px->p", normal[i], normal[j]) < -1 + COPLANAR
        i, j = i[facing], j[facing]
        gap = np.abs(np.einsum("px,px->p", middle[j] - middle[i], normal[i]))
        a, b = ids[i], ids[j]
        touch = gap < COPLANAR * np.minimum(size[i], size[j])
        touch &= t.face_block[a] != t.face_block[b]
        touch &= bonded[t.face_kind[a], t.face_kind[b]]
        found.append(np.sort(np.stack([a, b], axis=1)[touch], axis=1))
    pairs = np.concatenate(found)
    return pairs[np.lexsort(pairs.T[::-1])]


def clip(a: Floats, b: Floats) -> Floats | None:
    """The overlap of two coplanar convex polygons that face each other, or None.

    Args:
        a: Vertices, counter-clockwise seen from outside its block, shape (n, 3) [m].
        b: Vertices of the other, counter-clockwise seen from outside its own block.
    """
    normal = np.cross(a[2] - a[0], a[-1] - a[1])
    least = 0.5 * LEAST_AREA * lengths(normal)
    normal = normal / lengths(normal)
    polygon = b[::-1] - np.outer(along(b[::-1] - a[0], normal), normal)
    for start, end in zip(a, np.roll(a, -1, axis=0), strict=True):
        inward = np.cross(normal, end - start)
        polygon = inner_part(polygon, along(polygon - start, inward))
        if len(polygon) < 3:
            return None
    near = 1e-9 * lengths(a[2] - a[0])
    polygon = polygon[np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1) > near]
    if len(polygon) < 3 or point_areas(polygon).sum() < least:
        return None
    return polygon


def inner_part(polygon: Floats, distance: Floats) -> Floats:
    """The part of a convex polygon where a linear function is not negative, shape (n, 3) [m].

    Args:
        polygon: Vertices, shape (n, 3) [m].
        distance: The function at the vertices, shape (n,).
    """
    kept = []
    for k in range(len(polygon)):
        p, q = distance[k - 1], distance[k]
        if (p < 0) != (q < 0):
            kept.append(polygon[k - 1] + p / (p - q) * (polygon[k] - polygon[k - 1]))
        if q >= 0:
            kept.append(polygon[k])
    return np.reshape(kept, (-1, 3))


def point_areas(polygon: Floats) -> Floats:
    """Share of each vertex of a plane convex polygon in its area [m2]: exact area and centroid."""
    arm = polygon - polygon.mean(axis=0)
    triangle = 0.5 * np.linalg.norm(np.cross(arm, np.roll(arm, -1, axis=0)), axis=1)
    return (np.roll(triangle, 1) + triangle) / 3 + triangle.sum() / (3 * len(polygon))


def _weights(face: Floats, points: Floats) -> Floats:
    """Barycentric or inverse bilinear weights of points on a face, shape (points, 4)."""
    normal = np.cross(face[2] - face[0], face[-1] - face[1])
    normal = normal / lengths(normal)
    out = np.zeros((len(points), 4))
    if len(face) == 3:
        u, v = in_plane(face[1] - face[0], face[2] - face[0], normal, points - face[0])
        out[:, :3] = np.column_stack([1 - u - v, u, v])
        return out
    for row, point in zip(out, points, strict=True):
        u = v = np.asarray(0.5)
        for _ in range(20):
            low = face[0] + u * (face[1] - face[0])
            high = face[3] + u * (face[2] - face[3])
            miss = point - (low + v * (high - low))
            aside = (1 - v) * (face[1] - face[0]) + v * (face[2] - face[3])
            du, dv = in_plane(aside, high - low, normal, miss)
            u, v = u + du, v + dv
            if abs(du) + abs(dv) < 1e-15:
                break
        row[:] = (1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v
    return out
