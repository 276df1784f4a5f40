"""Points of tets moved onto the plane of a joint that passes close by, so that it cuts no slivers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdem.joints.convex_cells import Cells, Floats, Ints
from cdem.mesh.arrays import along, determinant, lengths, same_rows

CLOSE = 0.2
"""Distance of points that move, over the shortest edge at them."""
ASKEW = 0.5
"""Points slide along other faces if these are less parallel to the plane than this sine."""
ONE_PLANE = 1e-4
"""Faces at a point whose normals differ by a smaller sine are one plane to slide along."""
LEFT = 0.2
"""Volume that a tet keeps at least, over its volume before."""


def onto_plane(
    c: Cells, normal: Floats, offset: float, among: NDArray[np.bool_]
) -> tuple[Cells, int, float]:
    """Move points of tets onto a plane that passes close by, before it cuts.

    Inner points move along the normal. Points in joints, in outer faces and between blocks slide
    along these; where that leads far, or two named surfaces meet, they stay.

    Args:
        c: The cells.
        normal: Unit normal of the plane.
        offset: [m].
        among: Groups that it may cut.

    Returns:
        The cells, the number of points that moved, and how far at most [m].
    """
    distance = along(c.points, normal) - offset
    may = _near_points(c, distance, among)
    if not may.any():
        return c, 0, 0.0
    way = _free_ways(c, may, normal)
    squared = along(way, normal)
    may &= squared > ASKEW**2
    step = np.zeros_like(c.points)
    step[may] = (-distance[may] / squared[may])[:, None] * way[may]
    tets = _tets_at(c, may)
    before = _volumes(c.points, tets)
    while True:
        spoilt = _volumes(c.points + step, tets) < LEFT * before
        spoilt &= step[tets].any(axis=(1, 2))  # others were inside out before
        if not spoilt.any():
            break
        step[tets[spoilt]] = 0.0
    moved = lengths(step)
    count = int((moved > 0).sum())
    return (replace(c, points=c.points + step) if count else c), count, float(moved.max())


def _near_points(c: Cells, distance: Floats, among: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Points next to the plane, but not in it, whose cells are tets that it may cut."""
    close = (np.abs(distance) > c.near) & (
        np.abs(distance) < CLOSE * np.ptp(c.points, axis=0).max()
    )
    owner = c.owner()
    is_tet = np.bincount(c.cell, minlength=len(c.block)) == 4
    is_tet[c.cell[np.diff(c.first) != 3]] = False
    fits = is_tet & among[c.group]
    close[c.corner[~fits[c.cell[owner]]]] = False
    shortest = np.full(len(c.points), np.inf)
    after = c.corner[c.following()]
    ends = close[c.corner] | close[after]
    a, b = c.corner[ends], after[ends]
    edge = lengths(c.points[b] - c.points[a])
    np.minimum.at(shortest, a, edge)
    np.minimum.at(shortest, b, edge)
    shortest[np.isinf(shortest)] = 0.0  # points of cells that are not cut
    return np.asarray(close & (np.abs(distance) < CLOSE * shortest))


def _free_ways(c: Cells, may: NDArray[np.bool_], normal: Floats) -> Floats:
    """The part of a normal along which each point may move, shape (points, 3)."""
    faces = np.flatnonzero(np.logical_or.reduceat(may[c.corner], c.first[:-1]))
    loop = c.corner[c.first[faces][:, None] + np.arange(3)]
    number = same_rows(np.sort(loop, axis=1))
    block = c.block[c.cell[faces]]
    low, high = np.full(number.max() + 1, len(c.block)), np.full(number.max() + 1, -1)
    np.minimum.at(low, number, block)
    np.maximum.at(high, number, block)
    single = np.bincount(number)[number] == 1
    holds = single | (low != high)[number] | (c.source[faces] >= 0)
    faces, loop = faces[holds], loop[holds]
    x = c.points[loop]
    across = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    across /= lengths(across)[:, None]

    way = np.broadcast_to(normal, c.points.shape).copy()
    point, face = loop.ravel(), np.repeat(np.arange(len(faces)), 3)
    order = np.argsort(point, kind="stable")
    point, face = point[order], face[order]
    surface = c.source[faces][face]
    start = np.flatnonzero(np.r_[True, point[1:] != point[:-1]]) if len(point) else point
    turn = np.arange(len(point)) - np.repeat(start, np.diff(start, append=len(point)))
    first = np.repeat(start, np.diff(start, append=len(point)))
    way[point[surface != surface[first]]] = 0.0  # where two surfaces meet
    basis = np.zeros((3, *c.points.shape))
    for k in range(int(turn.max(initial=-1)) + 1):
        at, n = point[turn == k], across[face[turn == k]]
        for b in basis:
            n = n - _dot(n, b[at])[:, None] * b[at]
        size = lengths(n)
        new = size > ONE_PLANE
        at, n = at[new], n[new] / size[new, None]
        empty = np.argmin(np.abs(basis[:, at]).sum(axis=2) > 0, axis=0)
        basis[empty, at] = n
        way[at] -= _dot(way[at], n)[:, None] * n
    return way


def _dot(a: Floats, b: Floats) -> Floats:
    """Dot products of rows."""
    return np.einsum("ix,ix->i", a, b)


def _tets_at(c: Cells, may: NDArray[np.bool_]) -> Ints:
    """Corners of the tets at some points, shape (tets, 4)."""
    touched = np.zeros(len(c.block), bool)
    touched[c.cell[c.owner()[may[c.corner]]]] = True
    faces = np.flatnonzero(touched[c.cell])
    faces = faces[np.argsort(c.cell[faces], kind="stable")]
    corners = c.corner[c.first[faces][:, None] + np.arange(3)].reshape(-1, 4, 3)
    other = corners[:, 1]
    is_new = (other[:, :, None] != corners[:, 0][:, None, :]).all(axis=2)
    apex = other[np.arange(len(other)), is_new.argmax(axis=1)]
    return np.column_stack([corners[:, 0][:, ::-1], apex])


def _volumes(points: Floats, tets: Ints) -> Floats:
    """Six times the volumes of tets, shape (tets,)."""
    x = points[tets]
    return determinant(x[:, 1:] - x[:, :1])
