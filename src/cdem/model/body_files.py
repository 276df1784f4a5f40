"""Bodies from files: closed surfaces (OBJ, STL, PLY), convex or filled with tets; cells (VTK)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import is_file, reading
from cdem.errors import BodyError, MeshError
from cdem.joints.cell_mesh import to_mesh
from cdem.joints.convex_cells import from_polyhedron, join
from cdem.mesh.arrays import components
from cdem.mesh.mesh import Mesh, merge
from cdem.mesh.mesh_files import MEND
from cdem.mesh.obj_file import NO_SHAPE, read_obj, within
from cdem.mesh.ply_file import read_ply
from cdem.mesh.primitives import outward_faces, snapped
from cdem.mesh.stl_file import read_stl
from cdem.model import vtk_cells
from cdem.units import coordinates

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Loops = list[list[int]]
Body = tuple[str, Floats, Loops, str]  # its name, corners, faces and material

SHELLS = (".obj", ".stl", ".ply")
"""Endings of formats with closed surfaces."""
CELLS = (".vtu", ".vtk")
"""Endings of formats with polyhedral cells."""
GROWTH = 0.3  # growth of the edge length of tets with the distance from the surface
CROSSES = (
    "its surface cannot be filled with tets: it crosses itself, or has needles or a double wall"
)
SHOWN = 4
"""Most open edges in an error."""
ROUNDED = 1e-6
"""Coordinates in files are rounded to about this fraction of the largest: STL keeps seven digits."""


def read_bodies(path: Path, group: str, scale: float = 1.0) -> Mesh:
    """Read convex bodies; each becomes a block of tets around its centre.

    Args:
        path: ``.obj``, ``.stl`` or ``.ply``: every closed surface is a body; ``.vtu`` or ``.vtk``:
            every volume cell is one, polyhedra too (needs the extra ``viz``).
        group: Group of the bodies; if cell data distinguish materials, prefix of their groups.
        scale: Metres per unit of the file.

    Raises:
        MeshError: The file cannot be read.
        BodyError: A body is open or not convex; names the place.
    """
    parts, notes, groups, unused = [], list[str](), list[str](), list[str]()
    for name, points, faces, kind in _bodies(path, scale, unused):
        own = f"{group}_{kind}" if kind else group
        if own not in groups:
            groups.append(own)
        try:
            _refuse_open(points, faces)
            near = ROUNDED * float(np.abs(points).max())
            loops = outward_faces(points, faces, near)
            if note := snapped(points, loops, near):
                notes.append(f"{path.name}: {name} is {note}")
            parts.append(from_polyhedron(points, loops, groups.index(own)))
        except MeshError as error:
            hint = (
                "; with 'size' beside the file it is filled with tets"
                if path.suffix.lower() in SHELLS
                else ""
            )
            closed = "not closed" not in str(error)
            error.args = (f"{path}: {name}: {error}{hint if closed else ''}",)
            raise
    # meshed like blocks cut by joints: bodies with a common face divide it alike
    mesh = to_mesh(join(parts), groups, [], [])
    mesh.notes += [
        *unused,
        *notes[:SHOWN],
        *([f"{len(notes) - SHOWN} more"] if len(notes) > SHOWN else []),
    ]
    if groups != [group]:
        mesh.notes.append(f"{path.name}: groups by its cell data: {', '.join(groups)}")
    return mesh


def fill_bodies(path: Path, group: str, size: float, scale: float = 1.0) -> Mesh:
    """Read closed surfaces, convex or not, and fill each with tets.

    Args:
        path: ``.obj``, ``.stl`` or ``.ply``: every closed surface is a body.
        group: Group of the bodies.
        size: Largest edge of the tets inside [m]; the triangles of the surface are kept.
        scale: Metres per unit of the file.

    Raises:
        MeshError: The file cannot be read, or a surface crosses itself.
        BodyError: A surface is open.
        BackendError: The extra `terrain` is not installed.
    """
    from cdem.terrain.solid import fill

    if path.suffix.lower() not in SHELLS:
        raise MeshError(f"{path}: size goes with surfaces, {', '.join(SHELLS)}")
    meshes, unused = [], list[str]()
    for name, points, faces, _ in _bodies(path, scale, unused):
        try:
            _refuse_open(points, faces)
            shell = _outward([(f[0], a, b) for f in faces for a, b in pairwise(f[1:])], points)
            inside = _volume(points[shell]) if len(shell) else 0.0
            xyz, tets = fill(points, shell, size, GROWTH)
        except BodyError as error:
            error.args = (f"{path}: {name}: {error}",)
            raise
        except MeshError:
            raise MeshError(f"{path}: {name}: {CROSSES}") from None
        corners = xyz[tets]
        filled = np.linalg.det(corners[:, 1:] - corners[:, :1]).sum() / 6
        if not abs(filled - inside) <= 1e-6 * inside:
            raise MeshError(f"{path}: {name}: {CROSSES}")
        of_group = np.zeros(len(tets), np.int32)
        meshes.append(Mesh(xyz, {"tet4": tets}, {"tet4": of_group}, [group]))
    made = merge(meshes)
    made.notes += unused
    return made


def _volume(shell: Floats) -> float:
    """Volume inside outward triangles, shape (triangles, 3, 3)."""
    return float(np.linalg.det(shell - shell.mean(axis=(0, 1))).sum() / 6)


def _outward(triangles: list[tuple[int, int, int]], points: Floats) -> Ints:
    """The triangles of a closed surface, oriented outwards."""
    faces = np.array(triangles, np.int64)
    of_edge: dict[tuple[int, int], list[int]] = {}
    for number, (a, b, c) in enumerate(triangles):
        for p, q in ((a, b), (b, c), (c, a)):
            of_edge.setdefault((min(p, q), max(p, q)), []).append(number)
    seen, waiting = {0}, [0]
    while waiting:
        number = waiting.pop()
        a, b, c = faces[number].tolist()
        for p, q in ((a, b), (b, c), (c, a)):
            for other in of_edge[min(p, q), max(p, q)]:
                if other in seen:
                    continue
                ring = faces[other].tolist()
                if (p, q) in zip(ring, ring[1:] + ring[:1], strict=True):  # same direction
                    faces[other] = ring[::-1]
                seen.add(other)
                waiting.append(other)
    return faces if _volume(points[faces]) > 0 else faces[:, ::-1]


def _bodies(path: Path, scale: float, unused: list[str]) -> list[Body]:
    """All bodies of a file, in metres; ignored parts are added to a list."""
    if not is_file(path):
        raise MeshError(f"{path}: no such file; give a path relative to the case file")
    kind = path.suffix.lower()
    if kind in CELLS:
        bodies = list(_vtk(path))
    elif kind in SHELLS:
        with reading(path, MeshError, MEND):
            bodies = list(READERS[kind](path, unused))
    else:
        raise MeshError(f"{path}: bodies are read from {', '.join((*SHELLS, *CELLS))} files")
    if not bodies:
        raise MeshError(f"{path}: contains no bodies")
    for name, points, *_ in bodies:
        if not np.isfinite(points).all():
            raise MeshError(f"{path}: {name}: a corner has a coordinate that is not finite")
    return [(name, points * scale, faces, kind) for name, points, faces, kind in bodies]


def _refuse_open(points: Floats, faces: Loops) -> None:
    """Refuse edges that do not have exactly two faces."""
    count: dict[tuple[int, int], int] = {}
    for loop in faces:
        for a, b in zip(loop, loop[1:] + loop[:1], strict=True):
            edge = (min(a, b), max(a, b))
            count[edge] = count.get(edge, 0) + 1
    wrong = [edge for edge, faces_there in count.items() if faces_there != 2]
    if not wrong:
        return
    named = []
    for edge in wrong[:SHOWN]:
        ends = (coordinates(points[v]) for v in edge)
        named.append(" - ".join(f"({end})" for end in ends) + f" has {count[edge]}")
    more = f" and {len(wrong) - SHOWN} more" if len(wrong) > SHOWN else ""
    raise BodyError(
        f"the surface is not closed: every edge needs two faces, but {'; '.join(named)}{more}",
        points,
        faces,
        wrong,
    )


def _surfaces(points: Floats, loops: Loops, parts: list[str] | None = None) -> Iterator[Body]:
    """Bodies of a surface: within each connected part, each run of faces that closes.

    Args:
        points: Corners [m]; corners at the same place count as one.
        loops: Faces, in the order of the file: objects, groups and solids follow one another, so
            bodies with a common face, edge or corner close one after the other.
        parts: Name of the object or solid of each face, if the file has any.
    """
    points, same = np.unique(points, axis=0, return_inverse=True)
    same = same.reshape(-1)
    loops = [[int(same[v]) for v in loop] for loop in loops]
    first = np.concatenate([np.full(len(loop), loop[0]) for loop in loops])
    label = components(len(points), first, np.concatenate(loops))
    of_loop = label[[loop[0] for loop in loops]]
    order = np.argsort(of_loop, kind="stable")
    starts = np.flatnonzero(np.r_[True, np.diff(of_loop[order]) != 0])
    number = 0
    for some in np.split(order, starts[1:]):
        for run in _runs(loops, some.tolist()):
            named = {parts[i] for i in run} - {""} if parts else set()
            name = f"body {number}" + (f" ({named.pop()})" if len(named) == 1 else "")
            yield _own(name, points, [loops[i] for i in run])
            number += 1


def _runs(loops: Loops, some: list[int]) -> Iterator[list[int]]:
    """Parts of connected faces that close one after the other; an open rest makes them one part."""
    runs: list[list[int]] = [[]]
    odd: set[tuple[int, int]] = set()
    for i in some:
        runs[-1].append(i)
        for a, b in zip(loops[i], loops[i][1:] + loops[i][:1], strict=True):
            odd ^= {(min(a, b), max(a, b))}
        if not odd:
            runs.append([])
    if odd:
        yield some
    else:
        yield from runs[:-1]


def _own(name: str, points: Floats, loops: Loops, kind: str = "") -> Body:
    """A body with its own corners, numbered from 0."""
    used = np.unique(np.concatenate(loops))
    faces = [np.searchsorted(used, loop).tolist() for loop in loops]
    return name, points[used], faces, kind


def _obj(path: Path, unused: list[str]) -> Iterator[Body]:
    found = read_obj(path)
    shapes = {kind: count for kind, count in found.others.items() if kind not in NO_SHAPE}
    _tell_unused(path, Counter(shapes), unused)
    yield from _surfaces(found.points, found.loops, found.parts)


def _tell_unused(path: Path, others: Counter[str], unused: list[str]) -> None:
    if others:
        kinds = ", ".join(f"{count} of '{kind}'" for kind, count in others.most_common(SHOWN))
        more = f" and {len(others) - SHOWN} kinds more" if len(others) > SHOWN else ""
        unused.append(f"{path.name}: only faces are used; {kinds}{more} ignored")


def _stl(path: Path, unused: list[str]) -> Iterator[Body]:
    points, _ = read_stl(path)
    if not len(points):
        raise MeshError(f"{path}: contains no readable faces; is the file complete?")
    yield from _surfaces(points, np.arange(len(points)).reshape(-1, 3).tolist())


def _ply(path: Path, unused: list[str]) -> Iterator[Body]:
    raw = read_ply(path)
    loops: Loops = []
    others: Counter[str] = Counter()
    for block in raw.cells:
        if block.type in ("triangle", "quad") or block.type.startswith("polygon"):
            loops += np.asarray(block.data).tolist()
        else:
            others[block.type] += len(block.data)
    if not loops:
        raise MeshError(f"{path}: contains no readable faces; is the file complete?")
    if not all(within(loop, len(raw.points)) for loop in loops):
        raise MeshError(f"{path}: a face refers to a missing vertex")
    _tell_unused(path, others, unused)
    yield from _surfaces(np.asarray(raw.points, float), loops)


READERS = {".obj": _obj, ".stl": _stl, ".ply": _ply}


def _vtk(path: Path) -> Iterator[Body]:
    for name, points, faces, kind in vtk_cells.cells(path):
        yield _own(name, points, faces, kind)
