"""Meshes: read from files, made of boxes and convex polyhedra, placed and merged."""

from __future__ import annotations

import contextlib
import gzip
import io
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdem.errors import BodyError, MeshError
from cdem.shapes import NODES

Floats = NDArray[np.float64]

_MESHIO_SHAPES = {"tetra": "tet4", "pyramid": "pyramid5", "wedge": "wedge6", "hexahedron": "hex8"}
_KUHN = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
_HEX_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]


@dataclass
class Mesh:
    """Points and cells with named groups.

    Attributes:
        points: [m], shape (points, 3).
        cells: By shape ("tet4", "pyramid5", "wedge6", "hex8"), point ids (cells, nodes).
        cell_group: By shape, index into `group_names`.
        group_names: Names of the groups of cells.
        surfaces: By name, arrays of point ids of triangles (faces, 3) or quadrilaterals (faces, 4).
        notes: Warnings of the reader.
    """

    points: Floats
    cells: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    cell_group: dict[str, NDArray[np.int32]] = field(default_factory=dict)
    group_names: list[str] = field(default_factory=list)
    surfaces: dict[str, list[NDArray[np.int64]]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)


def read_mesh(path: str | Path) -> Mesh:
    """Read a volume mesh in any format that meshio knows.

    A file packed with gzip (``.msh.gz``) is unpacked on the way. Physical groups of volumes (gmsh)
    and cell sets become groups, those of surfaces become named surfaces; cells in no group go to
    the group "default", and a cell in several groups to the first, which `Mesh.notes` reports.

    Raises:
        MeshError: The file is missing, unreadable, or holds no linear volume elements.
    """
    path = Path(path)
    if not path.is_file():
        raise MeshError(f"{path}: no such mesh file; give a path relative to the case file")
    raw = _read_zipped(path) if path.suffix == ".gz" else read_raw(path)
    groups = _cell_groups(raw)
    names: list[str] = []
    mesh = Mesh(np.asarray(raw.points, float).reshape(len(raw.points), -1))
    if mesh.points.shape[1] == 2:
        raise MeshError(f"{path}: a mesh in a plane; cdem needs a volume mesh")
    cells: dict[str, list] = {s: [] for s in NODES}
    group: dict[str, list] = {s: [] for s in NODES}
    unknown = set()
    for index, block in enumerate(raw.cells):
        labels = groups.get(index)
        if block.type in _MESHIO_SHAPES:
            label = labels if labels is not None else np.full(len(block.data), "default", object)
            for name in label:
                if name not in names:
                    names.append(name)
            shape = _MESHIO_SHAPES[block.type]
            cells[shape].append(np.asarray(block.data, np.int64))
            number = {name: i for i, name in enumerate(names)}
            group[shape].append(np.array([number[name] for name in label], np.int32))
        elif block.type in ("triangle", "quad"):
            for name in sorted(set(labels)) if labels is not None else ():
                faces = np.asarray(block.data, np.int64)[labels == name]
                if name != "default":
                    mesh.surfaces.setdefault(name, []).append(faces)
        elif block.type not in ("vertex", "line"):
            unknown.add(block.type)
    if unknown:
        raise MeshError(
            f"{path}: elements of kind {', '.join(sorted(unknown))} are not supported; use linear "
            "tetrahedra, pyramids, wedges and hexahedra (in gmsh: Mesh.ElementOrder = 1)"
        )
    mesh.cells = {s: np.concatenate(c) for s, c in cells.items() if c}
    mesh.cell_group = {s: np.concatenate(g) for s, g in group.items() if g}
    mesh.group_names = names
    if not mesh.cells:
        raise MeshError(
            f"{path}: holds no volume elements; export the volume mesh, not its surface"
        )
    mesh.notes += _several_groups(raw, path)
    return drop_unused(mesh)


def _several_groups(raw, path: Path) -> list[str]:
    """A note if volume elements are in more than one group, for only one of them can count."""
    sets = {n: s for n, s in raw.cell_sets.items() if not n.startswith("gmsh:")}
    cells, names = 0, set()
    for index, block in enumerate(raw.cells):
        if block.type not in _MESHIO_SHAPES:
            continue
        held = np.zeros(len(block.data), int)
        inside = {n: np.asarray(s[index], np.intp) for n, s in sets.items() if s[index] is not None}
        for members in inside.values():
            held[members] += 1
        cells += int((held > 1).sum())
        names |= {n for n, members in inside.items() if (held[members] > 1).any()}
    if cells == 0:
        return []
    return [f"{path}: {cells} elements are in several of the groups {sorted(names)}; one counts"]


def _read_zipped(path: Path):
    """Read ``name.msh.gz`` as ``name.msh``."""
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / path.stem
        try:
            with gzip.open(path) as packed, plain.open("wb") as file:
                shutil.copyfileobj(packed, file)
        except (OSError, EOFError) as error:
            raise MeshError(f"{path}: not a gzip file ({error})") from error
        return read_raw(plain)


def read_raw(path: Path):
    import meshio

    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            return meshio.read(path)
    except SystemExit as error:  # meshio leaves the program when a reader fails
        raise MeshError(
            f"{path}: not a mesh that can be read; see the formats of meshio. Polyhedral cells are "
            "read with model.blocks: [{group: NAME, file: FILE}]"
        ) from error
    except Exception as error:
        raise MeshError(
            f"{path}: not a mesh that can be read ({error or type(error).__name__}); "
            "see the formats of meshio"
        ) from error


def _cell_groups(raw) -> dict[int, NDArray]:
    """Group name of each cell, by meshio cell block; blocks without groups are left out."""
    out: dict[int, NDArray] = {}
    tags = raw.cell_data.get("gmsh:physical")
    if tags is not None:
        by_tag = {(int(dim), int(tag)): name for name, (tag, dim) in raw.field_data.items()}
        for index, block in enumerate(raw.cells):
            names = {t: by_tag.get((block.dim, int(t)), f"group{int(t)}") for t in set(tags[index])}
            names[0] = names.get(0, "default") if (block.dim, 0) in by_tag else "default"
            out[index] = np.array([names[t] for t in tags[index]], object)
        return out
    for name, sets in raw.cell_sets.items():
        if name.startswith("gmsh:"):
            continue
        for index, members in enumerate(sets):
            if members is None or len(members) == 0:
                continue
            label = out.setdefault(index, np.full(len(raw.cells[index].data), "default", object))
            free = np.asarray(members)[label[members] == "default"]
            label[free] = name
    return out


def drop_unused(mesh: Mesh) -> Mesh:
    """Leave out points that no volume element uses."""
    used = np.unique(np.concatenate([c.ravel() for c in mesh.cells.values()]))
    number = np.full(len(mesh.points), -1)
    number[used] = np.arange(len(used))
    mesh.points = mesh.points[used]
    mesh.cells = {s: number[c] for s, c in mesh.cells.items()}
    kept: dict[str, list] = {}
    for name, parts in mesh.surfaces.items():
        moved = [number[p] for p in parts]
        kept[name] = [m[(m >= 0).all(axis=1)] for m in moved]
    mesh.surfaces = kept
    return mesh


def box(
    group: str, size: Sequence[float], divisions: Sequence[int] = (1, 1, 1), *, shape: str = "hex8"
) -> Mesh:
    """A box from the origin to `size`, divided into cells.

    Args:
        group: Name of its group.
        size: Edge lengths [m].
        divisions: Cells along each edge.
        shape: "hex8", or each cell divided: "wedge6" (2), "pyramid5" (6), "tet4" (6, conforming).
    """
    counts = [int(n) for n in divisions]
    axes = [np.linspace(0, s, n + 1) for s, n in zip(size, counts, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    i, j, k = (a.ravel() for a in np.meshgrid(*map(range, counts), indexing="ij"))

    def at(di: int, dj: int, dk: int) -> NDArray[np.int64]:
        return ((i + di) * (counts[1] + 1) + j + dj) * (counts[2] + 1) + k + dk

    hexes = np.column_stack(
        [at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0)]
        + [at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1)]
    )
    cells = hexes
    if shape == "tet4":
        cells = np.concatenate([hexes[:, t] for t in _KUHN])
    elif shape == "wedge6":
        cells = np.concatenate([hexes[:, w] for w in ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7))])
    elif shape == "pyramid5":
        middle = len(points) + np.arange(len(hexes))
        points = np.concatenate([points, points[hexes].mean(axis=1)])
        # a face seen from outside is clockwise from the apex inside: turn it round
        cells = np.concatenate(
            [np.column_stack([hexes[:, list(f)[::-1]], middle]) for f in _HEX_FACES]
        )
    return Mesh(points, {shape: cells}, {shape: np.zeros(len(cells), np.int32)}, [group])


def polyhedron(
    group: str, vertices: ArrayLike, faces: Sequence[Sequence[int]] | None = None
) -> Mesh:
    """A convex polyhedron as a block of tets around its centroid; four vertices are one tet.

    Args:
        group: Name of its group.
        vertices: [m], shape (vertices, 3); every one must be a corner of the hull.
        faces: Vertex ids of each face, in either turn; the convex hull when left out.

    Raises:
        MeshError: Fewer than four vertices, no volume, or not convex.
    """
    points = np.asarray(vertices, float)
    if points.ndim != 2 or points.shape[1] != 3 or len(points) < 4:
        raise MeshError("a polyhedron needs at least four vertices of three coordinates")
    if not np.isfinite(points).all():
        bad = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise MeshError(f"vertex {bad} of a polyhedron is not finite: {points[bad].tolist()}")
    triangles = _fans(outward_faces(points, faces))
    if len(points) == 4:
        a, b, c, d = points
        tet = [0, 1, 2, 3] if np.linalg.det([b - a, c - a, d - a]) > 0 else [0, 2, 1, 3]
        return Mesh(points, {"tet4": np.array([tet])}, {"tet4": np.zeros(1, np.int32)}, [group])
    center = _centroid(points, triangles)
    cells = np.column_stack([triangles[:, ::-1], np.full(len(triangles), len(points))])
    return Mesh(
        np.vstack([points, center]),
        {"tet4": cells},
        {"tet4": np.zeros(len(cells), np.int32)},
        [group],
    )


def _centroid(points: Floats, triangles: NDArray) -> Floats:
    middle = points.mean(axis=0)
    a, b, c = (points[triangles[:, k]] - middle for k in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    return middle + (volume[:, None] * (a + b + c) / 4).sum(axis=0) / volume.sum()


def _text(point: Floats) -> str:
    return ", ".join(f"{c:g}" for c in point)


def _tolerance(points: Floats) -> float:
    return 1e-9 * float(np.ptp(points, axis=0).max())


def outward_faces(
    points: Floats, faces: Sequence[Sequence[int]] | None, near: float = 0.0
) -> list[list[int]]:
    """Polygons around a convex polyhedron, outward: those given, or of its hull.

    Args:
        points: Vertices [m], shape (vertices, 3).
        faces: Vertex ids of each face, in either turn, or None.
        near: How far rounding may have moved vertices off the faces that were given [m].

    Raises:
        MeshError: No volume, or not convex.
    """
    return _hull(points) if faces is None else _outward(points, faces, near)


def _fans(faces: Sequence[Sequence[int]]) -> NDArray[np.int64]:
    """Triangles of polygons, each cut into a fan from its first vertex."""
    return np.array([(f[0], f[m], f[m + 1]) for f in faces for m in range(1, len(f) - 1)])


def _hull(points: Floats) -> list[list[int]]:
    """Polygons of the convex hull, outward.

    Looks at the plane of every three vertices, which is plenty fast for a block's few dozens.
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
                    continue  # three in a line span no plane
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
            f"a polyhedron is not convex: vertex {missing[0]} at ({_text(points[missing[0]])}) is no corner of the hull; "
            "leave it out if it repeats another or lies on a side, else cut the block into convex ones",
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
    corners = []
    for a, b, c in zip(loop[-1:] + loop[:-1], loop, loop[1:] + loop[:1], strict=True):
        turn = np.cross(points[b] - points[a], points[c] - points[b]) @ normal
        if turn > _tolerance(points) ** 2:  # leave out points in the middle of a side
            corners.append(b)
    return corners


def _outward(points: Floats, faces: Sequence[Sequence[int]], near: float) -> list[list[int]]:
    """The faces that a user gave, turned outward; refused if they do not bound a convex body."""
    near = max(near, 100 * _tolerance(points))
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
                f"a polyhedron is not convex: vertex {out} at ({_text(points[out])}) lies "
                f"{(points[out] - x[0]) @ normal:.3g} m outside face {number} "
                f"({'; '.join(map(_text, x[:4]))}); cut the block into convex ones",
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


def place(mesh: Mesh, rotate=None, translate: Sequence[float] | None = None) -> Mesh:
    """Rotate about an axis (right-hand, degrees) through its origin, then translate [m]."""
    if rotate is not None:
        axis = np.asarray(rotate.axis, float)
        x, y, z = axis / np.linalg.norm(axis)
        angle = np.radians(rotate.angle)
        k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        turn = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
        origin = np.zeros(3) if rotate.origin is None else np.asarray(rotate.origin, float)
        mesh.points = (mesh.points - origin) @ turn.T + origin
    if translate is not None:
        mesh.points = mesh.points + np.asarray(translate, float)
    return mesh


def merge(pieces: Sequence[Mesh]) -> Mesh:
    """All pieces in one mesh; points are not merged, groups of the same name are."""
    names: list[str] = []
    for piece in pieces:
        names += [n for n in piece.group_names if n not in names]
    out = Mesh(np.concatenate([p.points for p in pieces]), group_names=names)
    start = np.cumsum([0] + [len(p.points) for p in pieces])
    for shape in NODES:
        some = [(p, s) for p, s in zip(pieces, start, strict=False) if shape in p.cells]
        if not some:
            continue
        out.cells[shape] = np.concatenate([p.cells[shape] + s for p, s in some])
        out.cell_group[shape] = np.concatenate(
            [
                np.array([names.index(n) for n in p.group_names], np.int32)[p.cell_group[shape]]
                for p, _ in some
            ]
        )
    for piece, s in zip(pieces, start, strict=False):
        for name, parts in piece.surfaces.items():
            out.surfaces.setdefault(name, []).extend(part + s for part in parts)
        out.notes += piece.notes
    return out
