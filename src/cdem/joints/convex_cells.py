"""Convex cells of a body, made from a mesh or a polyhedron. All cells share one table of points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.errors import MeshError
from cdem.mesh.blocks import SAME_PLACE, SLANTED
from cdem.mesh.element_shapes import FACES, NODES
from cdem.mesh.mesh import Mesh
from cdem.units import coordinates

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WARPED = 1e-6
"""Largest distance of corners from the plane of a side, relative to its size, for cutting."""


@dataclass
class Cells:
    """Convex polyhedra. Points are shared, faces are not: each cell has its own.

    Attributes:
        points: Positions [m], shape (points, 3).
        corner: Points of all faces, face after face, counter-clockwise seen from outside.
        first: Start of each face's corners, shape (faces + 1,).
        cell: Cell of each face.
        source: Origin of each face: the number of a plane; or -1 - s for a face of the uncut body,
            bit k of s set if it is in named surface k.
        block: Block of each cell; blocks are numbered without gaps.
        group: Group of each cell.
    """

    points: Floats
    corner: Ints
    first: Ints
    cell: Ints
    source: Ints
    block: Ints
    group: Ints

    @property
    def blocks(self) -> int:
        """Number of blocks."""
        return int(self.block.max()) + 1

    @property
    def near(self) -> float:
        """Distance below which a point counts as on a plane [m]: above round-off, below real gaps."""
        return SAME_PLACE * float(np.ptp(self.points, axis=0).max())

    def owner(self) -> Ints:
        """Face of each corner."""
        return np.repeat(np.arange(len(self.cell)), np.diff(self.first))

    def following(self) -> Ints:
        """Index of the corner after each, round its face."""
        after = np.arange(1, len(self.corner) + 1)
        after[self.first[1:] - 1] = self.first[:-1]
        return after

    def triangles(self) -> tuple[Ints, Ints]:
        """Triangles of all faces, and the face of each.

        Equal faces of two cells are divided alike: each face is first put into a form that does not
        depend on its first corner and its orientation.
        """
        count = np.diff(self.first)
        triangles, face = [np.zeros((0, 3), np.int64)], [np.zeros(0, np.int64)]
        for n in np.unique(count).tolist():
            faces = np.flatnonzero(count == n)
            loop = self.corner[self.first[faces][:, None] + np.arange(n)]
            along = self.points[loop] @ SLANTED
            loop, along = (
                np.take_along_axis(a, (along.argmin(axis=1)[:, None] + np.arange(n)) % n, axis=1)
                for a in (loop, along)
            )
            back = along[:, -1] < along[:, 1]
            loop[back, 1:] = loop[back, :0:-1]
            where, local = best_triangles(self.points[loop])
            local = np.where(back[where][:, None], local[:, ::-1], local)
            triangles.append(np.take_along_axis(loop[where], local, axis=1))
            face.append(faces[where])
        return np.concatenate(triangles), np.concatenate(face)

    def volumes(self) -> Floats:
        """Volume of each cell [m3]."""
        triangles, face = self.triangles()
        cell = self.cell[face]
        origin = np.zeros((len(self.block), 3))
        origin[cell] = self.points[triangles[:, 0]]  # any point of the cell
        a, b, c = (self.points[triangles[:, k]] - origin[cell] for k in range(3))
        part = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
        return np.asarray(np.bincount(cell, part, len(self.block)), np.float64)


def best_triangles(x: Floats) -> tuple[Ints, Ints]:
    """Divide plane convex polygons into triangles with the largest possible smallest height.

    Args:
        x: Corners [m], shape (polygons, corners, 3).

    Returns:
        The polygon of each triangle, and its corners by number, in the same orientation.
    """
    polygons, n, _ = x.shape
    best = np.full((polygons, n, n), np.inf)  # for the part from corner i to corner j
    split = np.zeros((polygons, n, n), np.int64)
    for gap in range(2, n):
        for i in range(n - gap):
            j = i + gap
            k = np.arange(i + 1, j)
            area = np.linalg.norm(np.cross(x[:, k] - x[:, [i]], x[:, [j]] - x[:, [i]]), axis=2)
            sides = np.stack([x[:, k] - x[:, [i]], x[:, k] - x[:, [j]]])
            longest = np.linalg.norm(sides, axis=3).max(axis=0)
            longest = np.maximum(longest, np.linalg.norm(x[:, i] - x[:, j], axis=1)[:, None])
            height = area / np.maximum(longest, 1e-300)
            least = np.minimum(np.minimum(best[:, i, k], best[:, k, j]), height)
            split[:, i, j] = k[least.argmax(axis=1)]
            best[:, i, j] = least.max(axis=1)
    owner, corners = [], []
    # polygon, first and last corner of the remaining parts
    left = np.column_stack([np.arange(polygons), np.zeros(polygons, int), np.full(polygons, n - 1)])
    while len(left):
        polygon, start, end = left.T
        middle = split[polygon, start, end]
        owner.append(polygon)
        corners.append(np.column_stack([start, middle, end]))
        left = np.concatenate(
            [np.column_stack([polygon, start, middle]), np.column_stack([polygon, middle, end])]
        )
        left = left[left[:, 2] - left[:, 1] > 1]
    return np.concatenate(owner), np.concatenate(corners)


def from_mesh(mesh: Mesh, group_names: Sequence[str], label: NDArray) -> Cells:
    """Every element as a cell.

    Args:
        mesh: Elements with plane sides.
        group_names: Names by group number.
        label: Block number of every element, shape by shape.

    Raises:
        MeshError: A side is warped.
    """
    number = np.array([list(group_names).index(name) for name in mesh.group_names], np.int64)
    rows, group = [], []
    start = 0
    for shape in NODES:
        cells = mesh.cells.get(shape, np.zeros((0, NODES[shape]), np.int64))
        for face in FACES[shape]:
            row = np.full((len(cells), 5), -1, np.int64)
            row[:, : len(face)] = cells[:, face]
            row[:, 4] = start + np.arange(len(cells))
            rows.append(row)
        group.append(number[mesh.cell_group.get(shape, np.zeros(0, np.int32))])
        start += len(cells)
    every = np.concatenate(rows)
    _refuse_warped(mesh.points, every[:, :4])
    used = every[:, :4] >= 0
    _, block = np.unique(label, return_inverse=True)
    return Cells(
        points=mesh.points,
        corner=every[:, :4][used],
        first=np.concatenate([[0], np.cumsum(used.sum(axis=1))]),
        cell=every[:, 4],
        source=-1 - _surface_bits(every[:, :4], mesh.surfaces),
        block=block.reshape(-1).astype(np.int64),
        group=np.concatenate(group),
    )


def _refuse_warped(points: Floats, faces: Ints) -> None:
    quads = faces[faces[:, 3] >= 0]
    x = points[quads]
    normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    size = np.sqrt(np.linalg.norm(normal, axis=1))
    off = np.abs(np.einsum("ij,ij->i", x[:, 1] - x[:, 0], normal)) / np.maximum(size, 1e-300) ** 2
    bad = np.flatnonzero(off > WARPED * size)
    if len(bad):
        at = coordinates(x[bad[0]].mean(axis=0))
        raise MeshError(
            f"joints cut elements with plane sides only; {len(bad)} of their sides are warped, "
            f"the first at ({at}) by {off[bad[0]]:.3g} m. Use tetrahedra in the groups that joints cut"
        )


def _surface_bits(faces: Ints, surfaces: dict[str, list[Ints]]) -> Ints:
    """Named surfaces of each face, one bit for each."""
    out = np.zeros(len(faces), np.int64)
    keys: dict[tuple[int, ...], int] = {}
    for bit, parts in enumerate(surfaces.values()):
        for part in parts:
            wide = np.pad(part, ((0, 0), (0, 4 - part.shape[1])), constant_values=-1)
            for key in map(tuple, np.sort(wide, axis=1).tolist()):
                keys[key] = keys.get(key, 0) | (1 << bit)
    if keys:
        out[:] = [keys.get(tuple(row), 0) for row in np.sort(faces, axis=1).tolist()]
    return out


def from_polyhedron(points: Floats, faces: Sequence[Sequence[int]], group: int) -> Cells:
    """One cell: a convex polyhedron with its faces, outward."""
    return Cells(
        points=points,
        corner=np.concatenate([np.asarray(f, np.int64) for f in faces]),
        first=np.concatenate([[0], np.cumsum([len(f) for f in faces])]),
        cell=np.zeros(len(faces), np.int64),
        source=np.full(len(faces), -1),
        block=np.zeros(1, np.int64),
        group=np.array([group]),
    )


def join(parts: Sequence[Cells]) -> Cells:
    """All cells together; points are not merged."""
    points = np.cumsum([0] + [len(p.points) for p in parts])
    cells = np.cumsum([0] + [len(p.block) for p in parts])
    blocks = np.cumsum([0] + [p.blocks for p in parts])
    corners = np.cumsum([0] + [len(p.corner) for p in parts])
    numbered = list(enumerate(parts))
    return Cells(
        points=np.concatenate([p.points for p in parts]),
        corner=np.concatenate([p.corner + points[i] for i, p in numbered]),
        first=np.concatenate([[0]] + [p.first[1:] + corners[i] for i, p in numbered]),
        cell=np.concatenate([p.cell + cells[i] for i, p in numbered]),
        source=np.concatenate([p.source for p in parts]),
        block=np.concatenate([p.block + blocks[i] for i, p in numbered]),
        group=np.concatenate([p.group for p in parts]),
    )
