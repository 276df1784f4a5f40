"""Meshes of cells: short edges closed, tets around the centre of each cell, separate blocks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cdem.joints.convex_cells import Cells
from cdem.mesh.arrays import components
from cdem.mesh.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

LEAST_TET = 1e-10
"""Volume of a tet over its longest edge cubed below which closing an edge is undone."""


def close_short_edges(c: Cells, shortest: float) -> tuple[Cells, int]:
    """Merge the ends of edges shorter than a length; returns the number of removed points.

    A merge that would spoil a cell (open it, or turn a tet of its mesh inside out) is undone; a
    flattened cell is removed.
    """
    ends = np.sort(np.column_stack([c.corner, c.corner[c.following()]]), axis=1)
    ends = ends[np.linalg.norm(np.subtract(*c.points[ends.T]), axis=1) < shortest]
    barred = np.zeros(len(c.points), bool)
    while True:
        ends = ends[~barred[ends].any(axis=1)]
        same = components(len(c.points), ends[:, 0], ends[:, 1])
        closed = _without_flat(replace(c, corner=same[c.corner]))
        bad = _spoilt(closed)
        if len(bad) == 0:
            return closed, int((same != np.arange(len(same))).sum())
        # exclude points that moved into or out of the spoilt cells
        inside = np.isin(c.cell, bad)[c.owner()]
        touched = np.isin(same, same[c.corner[inside]])
        moved = np.bincount(same, minlength=len(same))[same] > 1
        if not (touched & moved & ~barred).any():
            return closed, int((same != np.arange(len(same))).sum())
        barred |= touched & moved


def _without_flat(c: Cells) -> Cells:
    """Remove repeated corners, faces without area and cells with only two faces."""
    keep = c.corner != c.corner[c.following()]
    count = np.bincount(c.owner()[keep], minlength=len(c.cell))
    full = count >= 3
    solid = np.bincount(c.cell[full], minlength=len(c.block)) >= 4
    full &= solid[c.cell]
    return replace(
        c,
        corner=c.corner[keep & full[c.owner()]],
        first=np.concatenate([[0], np.cumsum(count[full])]),
        cell=c.cell[full],
        source=c.source[full],
    )


def _spoilt(c: Cells) -> Ints:
    """Cells that are open, or whose tets are flat or inside out."""
    a, b = c.corner, c.corner[c.following()]
    cell = c.cell[c.owner()]
    forth, back = np.lexsort((b, a, cell)), np.lexsort((a, b, cell))
    differs = (a[forth] != b[back]) | (b[forth] != a[back])
    if differs.any():
        return np.unique(cell[forth][differs])
    points, tets, cells = _tets(c)
    x = points[tets]
    volume = np.linalg.det(x[:, 1:] - x[:, :1]) / 6
    size = np.ptp(x, axis=1).max(axis=1)
    return np.unique(cells[volume < LEAST_TET * size**3])


def _tets(c: Cells) -> tuple[Floats, Ints, Ints]:
    """Tets around the centre of each cell, a single one for a tet: points, tets and their cells."""
    triangles, face = c.triangles()
    cell = c.cell[face]
    origin = np.zeros((len(c.block), 3))
    origin[cell] = c.points[triangles[:, 0]]
    x, y, z = (c.points[triangles[:, k]] - origin[cell] for k in range(3))
    part = np.einsum("ij,ij->i", x, np.cross(y, z))
    count, volume = (np.bincount(cell, w, len(origin)) for w in (None, part))
    moment = np.column_stack([np.bincount(cell, part * s / 4, len(origin)) for s in (x + y + z).T])
    many = np.flatnonzero(count > 4)
    top = np.zeros(len(origin), np.int64)
    top[many] = len(c.points) + np.arange(len(many))
    some = np.where(volume == 0, 1.0, volume)  # a cell without volume is found by its tets
    points = np.concatenate([c.points, origin[many] + moment[many] / some[many, None]])
    # each corner of a tet is on three of its four triangles: the one off the first is the remaining
    # one
    single = np.flatnonzero(count == 4)
    _, first = np.unique(cell, return_index=True)
    is_first = np.zeros(len(cell), bool)
    is_first[first] = True
    total = np.bincount(cell, triangles.sum(axis=1), len(origin)).astype(np.int64) // 3
    total[cell[is_first]] -= triangles[is_first].sum(axis=1)
    top[single] = total[single]
    used = is_first | (count[cell] > 4)
    return points, np.column_stack([triangles[used][:, ::-1], top[cell[used]]]), cell[used]


def to_mesh(
    c: Cells, group_names: Sequence[str], surfaces: Sequence[str], planes: Sequence[str]
) -> Mesh:
    """Mesh all cells with tets; blocks share no points.

    Args:
        c: The cells.
        group_names: Names by group number of the cells.
        surfaces: Names of the surfaces of the uncut body, in order of their bits.
        planes: For each plane, the name of the surface of its faces.
    """
    points, tets, cell = _tets(c)
    triangles, face = c.triangles()

    def own(at: Ints, cells: Ints) -> Ints:
        return c.block[cells][:, None] * len(points) + at

    keys, inverse = np.unique(own(tets, cell), return_inverse=True)
    out = Mesh(
        points[keys % len(points)],
        {"tet4": inverse.reshape(-1, 4)},
        {"tet4": c.group[cell].astype(np.int32)},
        list(group_names),
    )
    corners = np.searchsorted(keys, own(triangles, c.cell[face]))
    source = c.source[face]
    for bit, name in enumerate(surfaces):
        out.surfaces[name] = [corners[(source < 0) & ((-1 - source) >> bit & 1 == 1)]]
    names = np.array([*planes, ""], object)
    of_plane = names[np.where(source >= 0, source, len(planes))]
    for name in dict.fromkeys(planes):
        out.surfaces[name] = [corners[of_plane == name]]
    return out
