"""Convex cells cut by planes.

The crossing of a plane and an edge is computed once for all cells with the edge, and so is the side
of each point, so both sides of a cut always agree: cells stay closed and together fill the original
volume for any planes.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cdem.joints.convex_cells import Cells, Floats, Ints
from cdem.mesh.arrays import along

Part = tuple[Ints, Ints, Ints]
"""Corners of some faces, number of corners of each, and the original faces."""


def cut(
    c: Cells,
    normal: Floats,
    offset: float,
    source: int,
    *,
    among: NDArray[np.bool_],
    thinnest: float = 0.0,
    chance: Callable[[int], Floats] | None = None,
    persistence: float = 1.0,
    only: NDArray[np.bool_] | None = None,
) -> tuple[Cells, int]:
    """Cut blocks by the plane normal . x = offset.

    Args:
        c: The cells.
        normal: Unit normal.
        offset: [m].
        source: Number of the plane, stored with the new faces.
        among: Groups that it may cut.
        thinnest: A block is left whole if it reaches less than this far to one side [m].
        chance: Returns this many random numbers from 0 to 1, one for each block that could be cut.
        persistence: Blocks whose random number is below are cut.
        only: Blocks that it may cut; None: all.

    Returns:
        The new cells, and the number of blocks left whole because a part would be too thin.
    """
    near = c.near
    distance = along(c.points, normal) - offset
    side = (distance > near).astype(np.int8) - (distance < -near).astype(np.int8)
    blocks = c.block[c.cell]
    low, high = np.full(c.blocks, np.inf), np.full(c.blocks, -np.inf)
    at = distance[c.corner]
    np.minimum.at(low, blocks, np.minimum.reduceat(at, c.first[:-1]))
    np.maximum.at(high, blocks, np.maximum.reduceat(at, c.first[:-1]))
    may = np.zeros(c.blocks, bool)
    may[c.block] = among[c.group]
    may &= (low < -near) & (high > near)
    if only is not None:
        may &= only
    thin = may & (np.minimum(-low, high) < thinnest)
    chosen = may & ~thin
    if chance is not None:
        chosen[chosen] = chance(int(chosen.sum())) < persistence
    while chosen.any():
        made, broken = _split(c, distance, side, chosen, source)
        if len(broken) == 0:
            return made, int(thin.sum())
        # sides too small for the plane's crossings to form a single loop: leave those blocks whole
        chosen[broken] = False
        thin[broken] = True
    return c, int(thin.sum())


def _split(
    c: Cells, distance: Floats, side: NDArray[np.int8], chosen: NDArray[np.bool_], source: int
) -> tuple[Cells, Ints]:
    """Cut the chosen blocks; or nothing, with the blocks that cannot be cut."""
    owner, here = c.owner(), chosen[c.block]
    least, most = np.zeros(len(c.block), np.int8), np.zeros(len(c.block), np.int8)
    np.minimum.at(least, c.cell[owner], side[c.corner])
    np.maximum.at(most, c.cell[owner], side[c.corner])
    divided = here & (least < 0) & (most > 0)
    some = divided[c.cell[owner]]
    points, made = _crossings(c, distance, side, some)
    side = np.concatenate([side, np.zeros(len(points) - len(c.points), np.int8)])

    upper = _part(c, side, 1, some, made, owner)
    lower = _part(c, side, -1, some, made, owner)
    where = np.flatnonzero(divided)
    cap, broken = _caps(c, side, upper, lower, where)
    if len(broken):
        return c, np.unique(c.block[broken])
    top = np.zeros(len(c.block), np.int64)
    top[where] = len(c.block) + np.arange(len(where))
    number = np.zeros(c.blocks, np.int64)
    number[chosen] = c.blocks + np.arange(chosen.sum())
    block = np.where(here & (least >= 0) & (most > 0), number[c.block], c.block)

    whole = ~divided[c.cell]
    flat = np.ones(len(c.cell), bool)  # existing faces in the plane belong to the joint
    flat[owner[side[c.corner] != 0]] = False
    flat &= here[c.cell] & (c.source == -1)
    old = np.where(flat, source, c.source)
    loops = [
        (c.corner[~some], np.diff(c.first)[whole], c.cell[whole], old[whole]),
        (lower[0], lower[1], c.cell[lower[2]], c.source[lower[2]]),
        (upper[0], upper[1], top[c.cell[upper[2]]], c.source[upper[2]]),
        (cap[0], cap[1], top[where], np.full(len(where), source)),
        (_turned(*cap), cap[1], where, np.full(len(where), source)),
    ]
    corner, count, cell, kind = (np.concatenate(column) for column in zip(*loops, strict=True))
    return Cells(
        points=points,
        corner=corner,
        first=np.concatenate([[0], np.cumsum(count)]),
        cell=cell,
        source=kind,
        block=np.concatenate([block, number[c.block[where]]]),
        group=np.concatenate([c.group, c.group[where]]),
    ), np.zeros(0, np.int64)


def _crossings(c: Cells, distance: Floats, side: NDArray, some: NDArray) -> tuple[Floats, Ints]:
    """Points with the crossings added, and the crossing after each of some corners (or -1)."""
    a, b = c.corner[some], c.corner[c.following()[some]]
    crossed = side[a] * side[b] < 0
    low, high = np.minimum(a, b)[crossed], np.maximum(a, b)[crossed]
    key, index = np.unique(low * len(c.points) + high, return_inverse=True)
    a, b = key // len(c.points), key % len(c.points)
    way = (distance[a] / (distance[a] - distance[b]))[:, None]
    made = np.full(len(crossed), -1)
    made[crossed] = len(c.points) + index.reshape(-1)
    return np.concatenate([c.points, c.points[a] + way * (c.points[b] - c.points[a])]), made


def _part(
    c: Cells, side: NDArray[np.int8], sign: int, some: NDArray[np.bool_], made: Ints, owner: Ints
) -> Part:
    """Parts of the faces on one side: corners, number of corners of each, and original faces."""
    corner, face = c.corner[some], owner[some]
    kept = np.zeros(len(c.cell), bool)
    kept[face[side[corner] * sign > 0]] = True
    both = np.column_stack([corner, made])
    use = np.column_stack([side[corner] * sign >= 0, made >= 0]) & kept[face][:, None]
    faces, count = np.unique(np.repeat(face, use.sum(axis=1)), return_counts=True)
    return both[use], count, faces


def _caps(
    c: Cells, side: NDArray[np.int8], upper: Part, lower: Part, where: Ints
) -> tuple[tuple[Ints, Ints], Ints]:
    """The new face of each upper part, in order of the divided cells; and cells without one."""
    place = np.full(len(c.block), -1)
    place[where] = np.arange(len(where))

    def edges(part: Part, a: int, b: int) -> tuple[Ints, Ints]:
        corner, count, face = part
        first = np.concatenate([[0], np.cumsum(count)])
        after = np.arange(1, len(corner) + 1)
        after[first[1:] - 1] = first[:-1]
        ends = np.column_stack([corner, corner[after]])
        on = (side[ends] == 0).all(axis=1)
        cell = place[c.cell[np.repeat(face, count)]][on]
        order = np.lexsort((ends[on][:, a], cell))
        return cell[order], ends[on][order][:, [a, b]]

    cell, ends = edges(upper, 1, 0)
    other, back = edges(lower, 0, 1)
    count = np.bincount(cell, minlength=len(where))
    bad = (count < 3) | (count != np.bincount(other, minlength=len(where)))
    if not bad.any():
        bad[cell[(ends != back).any(axis=1)]] = True
        key = cell * len(side) + ends[:, 0]
        bad[cell[1:][key[1:] == key[:-1]]] = True
    if bad.any():
        return (ends[:0, 0], count[:0]), where[bad]
    after = np.searchsorted(key, cell * len(side) + ends[:, 1])  # every end is a start: see above
    rank = np.full(len(cell), -1)
    at = np.concatenate([[0], np.cumsum(count)[:-1]]).astype(np.int64)
    for step in range(int(count.max(initial=0))):
        going = rank[at] < 0
        rank[at[going]] = step
        at = np.where(going, after[at], at)
    bad[cell[rank < 0]] = True  # more than one loop
    return (ends[np.lexsort((rank, cell)), 0], count), where[bad]


def _turned(corner: Ints, count: Ints) -> Ints:
    """The same faces in the opposite orientation."""
    first = np.concatenate([[0], np.cumsum(count)])
    face = np.repeat(np.arange(len(count)), count)
    return corner[first[face] + first[face + 1] - 1 - np.arange(len(corner))]
