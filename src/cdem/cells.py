"""Convex cells of a body: made from a mesh, cut by planes, meshed inside.

All cells share one table of points. A plane's crossing with an edge is found once for all cells that
have the edge, and so is the side on which a point lies, so both sides of a cut always agree: cells stay
closed and together fill what was there, whatever the planes do.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.errors import MeshError
from cdem.mesh import Mesh
from cdem.shapes import NODES
from cdem.topology import FACES, SAME_PLACE, SLANTED

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

WARPED = 1e-6
"""How far the corners of a side may lie off its plane, over its size, to be cut."""


@dataclass
class Cells:
    """Convex polyhedra. Points are shared, faces are not: each cell has its own.

    Attributes:
        points: [m], shape (points, 3).
        corner: Points of all faces, face after face, counter-clockwise seen from outside.
        first: Start of each face's corners, shape (faces + 1,).
        cell: Cell of each face.
        source: What made each face: the number of a plane; or -1 - s for a face of the uncut body,
            bit k of s telling whether it is in named surface k.
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
        """Distance below which a point is on a plane [m]: above round-off, below anything meant."""
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

        Equal faces of two cells are divided alike, for a face is first put into a form that does not
        depend on where its corners begin and which way they run.
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
    """Divide plane convex polygons into triangles whose least height is as large as it can be.

    Args:
        x: Corners [m], shape (polygons, corners, 3).

    Returns:
        The polygon of each triangle, and its corners by number, running the same way.
    """
    polygons, n, _ = x.shape
    best = np.full((polygons, n, n), np.inf)  # of the part from corner i to corner j
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
    # polygon, first and last corner of the parts that are left to divide
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
        group_names: Names of the groups to number by.
        label: A number of its block for every element, shapes one after the other.

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
        at = ", ".join(f"{v:.6g}" for v in x[bad[0]].mean(axis=0))
        raise MeshError(
            f"joints cut elements with plane sides only; {len(bad)} of their sides are warped, "
            f"the first at ({at}) by {off[bad[0]]:.3g} m. Use tetrahedra in the groups that joints cut"
        )


def _surface_bits(faces: Ints, surfaces: dict[str, list[Ints]]) -> Ints:
    """Which named surfaces each face is in, one bit for each."""
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


# ---------------------------------------------------------------------- cutting


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
) -> tuple[Cells, int]:
    """Cut blocks by the plane normal . x = offset.

    Args:
        c: The cells.
        normal: Unit normal.
        offset: [m].
        source: Number of the plane, kept by the faces that it makes.
        among: Which groups it may cut.
        thinnest: A block is left whole if it reaches less than this far to one side [m].
        chance: Gives so many random numbers from 0 to 1, one for each block that could be cut.
        persistence: Blocks whose number is below are cut.

    Returns:
        The cells now, and how many blocks were left whole because a part would be too thin.
    """
    near = c.near
    distance = c.points @ normal - offset
    side = (distance > near).astype(np.int8) - (distance < -near).astype(np.int8)
    blocks = c.block[c.cell]
    low, high = np.full(c.blocks, np.inf), np.full(c.blocks, -np.inf)
    at = distance[c.corner]
    np.minimum.at(low, blocks, np.minimum.reduceat(at, c.first[:-1]))
    np.maximum.at(high, blocks, np.maximum.reduceat(at, c.first[:-1]))
    may = np.zeros(c.blocks, bool)
    may[c.block] = among[c.group]
    may &= (low < -near) & (high > near)
    thin = may & (np.minimum(-low, high) < thinnest)
    chosen = may & ~thin
    if chance is not None:
        chosen[chosen] = chance(int(chosen.sum())) < persistence
    while chosen.any():
        made, broken = _split(c, distance, side, chosen, source)
        if len(broken) == 0:
            return made, int(thin.sum())
        # sides so small that the plane's crossings make no single loop: leave those blocks whole
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
    flat = np.ones(len(c.cell), bool)  # plain faces that lie in the plane are the joint's
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


def _part(c: Cells, side, sign: int, some, made: Ints, owner: Ints) -> tuple[Ints, Ints, Ints]:
    """Parts of the faces on one side: their corners, how many each has, and which faces."""
    corner, face = c.corner[some], owner[some]
    kept = np.zeros(len(c.cell), bool)
    kept[face[side[corner] * sign > 0]] = True
    both = np.column_stack([corner, made])
    use = np.column_stack([side[corner] * sign >= 0, made >= 0]) & kept[face][:, None]
    faces, count = np.unique(np.repeat(face, use.sum(axis=1)), return_counts=True)
    return both[use], count, faces


def _caps(c: Cells, side, upper, lower, where: Ints) -> tuple[tuple[Ints, Ints], Ints]:
    """The new face of each upper part, in order of the divided cells; and cells that have none."""
    place = np.full(len(c.block), -1)
    place[where] = np.arange(len(where))

    def edges(part, a: int, b: int) -> tuple[Ints, Ints]:
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
    """The same faces run through the other way."""
    first = np.concatenate([[0], np.cumsum(count)])
    face = np.repeat(np.arange(len(count)), count)
    return corner[first[face] + first[face + 1] - 1 - np.arange(len(corner))]
