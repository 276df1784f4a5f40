"""Meshes made here: boxes and convex polyhedra."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdem.errors import BodyError, MeshError
from cdem.mesh.element_shapes import FACES
from cdem.mesh.mesh import Floats, Mesh
from cdem.units import coordinates

Steps = int | NDArray[np.int64]

_KUHN = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]


_CORNERS = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
"""Corners of a cell in the order of a hexahedron."""


def box(
    group: str,
    size: Sequence[float],
    divisions: Sequence[int] = (1, 1, 1),
    *,
    shape: str = "hex8",
    mirrored: bool = False,
) -> Mesh:
    """A box from the origin to `size`, divided into cells.

    Args:
        group: Name of its group.
        size: Edge lengths [m].
        divisions: Cells along each edge.
        shape: "hex8", or each cell divided: "wedge6" (2), "pyramid5" (6), "tet4" (6, conforming).
        mirrored: Whether the tets of neighbouring cells are mirror images: the mesh then has no
            preferred direction. Else all cells are divided along the same diagonal.
    """
    counts = [int(n) for n in divisions]
    axes = [np.linspace(0, s, n + 1) for s, n in zip(size, counts, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    i, j, k = (a.ravel() for a in np.meshgrid(*map(range, counts), indexing="ij"))

    def at(di: Steps, dj: Steps, dk: Steps) -> NDArray[np.int64]:
        return ((i + di) * (counts[1] + 1) + j + dj) * (counts[2] + 1) + k + dk

    hexes = np.column_stack([at(*corner) for corner in _CORNERS])
    cells = hexes
    if shape == "tet4":
        if mirrored:
            odd = i % 2, j % 2, k % 2
            hexes = np.column_stack(
                [at(a ^ odd[0], b ^ odd[1], c ^ odd[2]) for a, b, c in _CORNERS]
            )
        cells = np.concatenate([hexes[:, t] for t in _KUHN])
        if mirrored:
            turned = np.tile(sum(odd) % 2 == 1, len(_KUHN))
            cells[turned, :2] = cells[turned, 1::-1]
    elif shape == "wedge6":
        cells = np.concatenate([hexes[:, w] for w in ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))])
    elif shape == "pyramid5":
        middle = len(points) + np.arange(len(hexes))
        points = np.concatenate([points, points[hexes].mean(axis=1)])
        # a face seen from outside is clockwise from the apex inside: reverse it
        cells = np.concatenate(
            [np.column_stack([hexes[:, list(f)[::-1]], middle]) for f in FACES["hex8"]]
        )
    return Mesh(points, {shape: cells}, {shape: np.zeros(len(cells), np.int32)}, [group])


def polyhedron(
    group: str, vertices: ArrayLike, faces: Sequence[Sequence[int]] | None = None
) -> Mesh:
    """A convex polyhedron as a block of tets around its centroid; four vertices are one tet.

    Args:
        group: Name of its group.
        vertices: Positions [m], shape (vertices, 3); every one must be a corner of the hull.
        faces: Vertex ids of each face, in either direction; default the convex hull.

    Raises:
        MeshError: Fewer than four vertices, no volume, or not convex.
    """
    points = np.asarray(vertices, float)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 4:
        raise MeshError("a polyhedron needs at least four vertices of three coordinates")
    if not np.isfinite(points).all():
        bad = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise MeshError(f"vertex {bad} of a polyhedron is not finite: {points[bad].tolist()}")
    loops = outward_faces(points, faces)
    triangles = _fans(loops)
    if len(points) == 4:
        a, b, c, d = points
        tet = [0, 1, 2, 3] if np.linalg.det([b - a, c - a, d - a]) > 0 else [0, 2, 1, 3]
        return Mesh(points, {"tet4": np.array([tet])}, {"tet4": np.zeros(1, np.int32)}, [group])
    center = _centroid(points, triangles)
    cells = np.column_stack([triangles[:, ::-1], np.full(len(triangles), len(points))])
    note = snapped(points, loops)
    return Mesh(
        np.vstack([points, center]),
        {"tet4": cells},
        {"tet4": np.zeros(len(cells), np.int32)},
        [group],
        notes=[f"a polyhedron of group {group!r} is {note}"] if note else [],
    )


def _centroid(points: Floats, triangles: NDArray) -> Floats:
    middle = points.mean(axis=0)
    a, b, c = (points[triangles[:, k]] - middle for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    return middle + (volume[:, None] * (a + b + c) / 4).sum(axis=0) / volume.sum()


SNAPPED = 1e-4
"""A body counts as convex if no corner lies farther outside its faces than this fraction of its size."""


def bulge(points: Floats, loops: Sequence[Sequence[int]]) -> float:
    """Largest distance of corners of a body outside the planes of its outward faces [m]."""
    most = 0.0
    for loop in loops:
        x = points[list(loop)]
        normal = np.cross(x[1:-1] - x[0], x[2:] - x[0]).sum(axis=0)
        most = max(most, float(((points - x[0]) @ normal).max() / np.linalg.norm(normal)))
    return most


def snapped(points: Floats, loops: Sequence[Sequence[int]], near: float = 0.0) -> str:
    """A note on a body that is convex only within `SNAPPED`; empty for others."""
    off, size = bulge(points, loops), float(np.ptp(points, axis=0).max())
    if off <= max(near, 100 * _tolerance(points)):
        return ""
    return (
        f"taken as convex: corners lie up to {off:.2g} m outside its faces, {off / size:.1g} of "
        f"its size (limit {SNAPPED:g})"
    )


def _tolerance(points: Floats) -> float:
    return 1e-9 * float(np.ptp(points, axis=0).max())


def outward_faces(
    points: Floats, faces: Sequence[Sequence[int]] | None, near: float = 0.0
) -> list[list[int]]:
    """Polygons around a convex polyhedron, outward: the given ones, or of its hull.

    Args:
        points: Vertices [m], shape (vertices, 3).
        faces: Vertex ids of each face, in either direction, or None.
        near: How far rounding may have moved vertices off the given faces [m].

    Raises:
        MeshError: No volume, or not convex.
    """
    return _hull(points) if faces is None else _outward(points, faces, near)


def _fans(faces: Sequence[Sequence[int]]) -> NDArray[np.int64]:
    """Triangles of polygons, each cut into a fan from its first vertex."""
    return np.array([(f[0], f[m], f[m + 1]) for f in faces for m in range(1, len(f) - 1)])


def _hull(points: Floats) -> list[list[int]]:
    """Polygons of the convex hull, outward.

    Checks the plane of every three vertices, which is fast enough for the few dozens of a block.
    """
    n = len(points)
    near = _tolerance(points)
    middle = points.mean(axis=0)
    seen: set[tuple[int, ...]] = set()
    faces: list[list[int]] = []
    for i in range(n):
        for j in range(i + 1, n):
            for k in range(j + 1, n):
                normal = np.cross(points[j] - points[i], points[k] - points[i])
                size = np.linalg.norm(normal)
                if (
                    size
                    <= near * np.linalg.norm(points[[j, k, k]] - points[[i, i, j]], axis=1).max()
                ):
                    continue  # three points on a line span no plane
                normal = normal / size
                height = (points - points[i]) @ normal
                if height.max() > near and height.min() < -near:
                    continue
                on = tuple(np.flatnonzero(np.abs(height) <= near).tolist())
                if on in seen:
                    continue
                seen.add(on)
                if (middle - points[i]) @ normal > 0:
                    normal = -normal
                faces.append(_around(points, on, normal))
    used = {v for face in faces for v in face}
    missing = sorted(set(range(n)) - used)
    if len(faces) < 4:
        raise MeshError("a polyhedron has no volume: its vertices lie in a plane")
    if missing:
        raise BodyError(
            f"a polyhedron is not convex: vertex {missing[0]} at "
            f"({coordinates(points[missing[0]])}) is not a corner of the hull; "
            "leave it out if it repeats another or lies on a side, else divide the block into "
            "convex ones",
            points,
            faces,
            [[v] for v in missing],
        )
    return faces


def _around(points: Floats, on: tuple[int, ...], normal: Floats) -> list[int]:
    """Corners of a plane convex polygon in order, counter-clockwise about the normal."""
    center = points[list(on)].mean(axis=0)
    first = points[on[0]] - center
    side = np.cross(normal, first)
    angle = [np.arctan2((points[v] - center) @ side, (points[v] - center) @ first) for v in on]
    loop = [on[i] for i in np.argsort(angle, kind="stable")]
    start = loop.index(on[0])  # away from half a turn, where round-off would decide the order
    loop = loop[start:] + loop[:start]
    corners = []
    for a, b, c in zip(loop[-1:] + loop[:-1], loop, loop[1:] + loop[:1], strict=True):
        turn = np.cross(points[b] - points[a], points[c] - points[b]) @ normal
        if turn > _tolerance(points) ** 2:  # remove points in the middle of a side
            corners.append(b)
    return corners


def _outward(points: Floats, faces: Sequence[Sequence[int]], near: float) -> list[list[int]]:
    """The given faces, turned outward; refused if they do not bound a convex body."""
    near = max(near, SNAPPED * float(np.ptp(points, axis=0).max()))
    middle = points.mean(axis=0)
    loops = []
    for number, face in enumerate(faces):
        if len(face) < 3 or min(face) < 0 or max(face) >= len(points):
            raise MeshError(f"face {number} of a polyhedron needs three or more vertices it has")
        x = points[list(face)]
        normal = np.cross(x[1:-1] - x[0], x[2:] - x[0]).sum(axis=0)
        size = np.linalg.norm(normal)
        if size == 0:
            raise MeshError(f"face {number} of a polyhedron has no area")
        normal, loop = normal / size, list(face)
        if (middle - x[0]) @ normal > 0:
            normal, loop = -normal, loop[::-1]
        out = np.argmax((points - x[0]) @ normal)
        if (points[out] - x[0]) @ normal > near:
            raise BodyError(
                f"a polyhedron is not convex: vertex {out} at ({coordinates(points[out])}) lies "
                f"{(points[out] - x[0]) @ normal:.3g} m outside face {number} "
                f"({'; '.join(map(coordinates, x[:4]))}); divide the block into convex ones",
                points,
                faces,
                [[int(out)], *zip(loop, loop[1:] + loop[:1], strict=True)],
            )
        loops.append(loop)
    sides = [tuple(sorted((t[a], t[a - 1]))) for t in _fans(loops) for a in range(3)]
    open_sides = sorted(s for s in set(sides) if sides.count(s) != 2)
    if open_sides:
        raise BodyError(
            f"the faces of a polyhedron leave its edge {open_sides[0]} open",
            points,
            faces,
            open_sides,
        )
    return loops
