"""Readers of triangulated surfaces, by the ending of the file: OBJ, STL, PLY, GOCAD TSurf, DXF."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np

from cdem.case.input_file import is_file, reading
from cdem.errors import CaseError, CdemError
from cdem.mesh.obj_file import NO_SHAPE, read_obj, within
from cdem.mesh.ply_file import read_ply
from cdem.mesh.stl_file import read_stl
from cdem.terrain.dxf_faces import read_dxf_faces
from cdem.terrain.facets import Facets, fanned
from cdem.terrain.gocad import read_gocad

KINDS = (".obj", ".stl", ".ply", ".ts", ".dxf")
MEND = f"a surface of triangles is read from {', '.join(KINDS[:-1])} or {KINDS[-1]}"
LOOKS = "mtllib"
"""Word of an OBJ file that names a file of materials, which is not opened."""
FARTHEST = 1e9
"""Coordinates from which on numbers are no places [m]."""
VISIBLE = 1e-3
"""Rounding of coordinates from which a note tells of it [m]."""
SHOWN = 4
"""Most kinds in a note."""


def read_facets(path: Path, layer: str | None = None) -> Facets:
    """Read a triangulated surface.

    Args:
        path: ``.obj``, ``.stl``, ``.ply``, ``.ts`` (GOCAD) or ``.dxf`` (ASCII).
        layer: Layer of a DXF file.

    Raises:
        CaseError: The file is missing, of another kind, cannot be read, or has no triangles.
    """
    kind = path.suffix.lower()
    if kind not in KINDS:
        raise CaseError(f"{path}: {MEND}")
    if layer is not None and kind != ".dxf":
        raise CaseError(f"{path}: layer goes with .dxf; leave it out")
    if not is_file(path):
        raise CaseError(f"{path}: cannot read the surface: there is no such file")
    if path.stat().st_size == 0:
        raise CaseError(f"{path}: is empty; {MEND}")
    try:
        with reading(path, CaseError, MEND):
            found = _read(path, kind, layer)
    except CaseError:
        raise
    except CdemError as error:  # readers of meshes have their own class
        raise CaseError(str(error)) from None
    if not len(found.triangles):
        raise CaseError(f"{path}: contains no triangles")
    used = np.unique(found.triangles)
    bad = used[~(np.abs(found.points[used]) < FARTHEST).all(axis=1)]
    if len(bad):
        raise CaseError(
            f"{path}: {len(bad)} of its corners have a coordinate that is not finite, or beyond "
            f"{FARTHEST:.0e}"
        )
    if found.others:
        kinds = ", ".join(f"{n} of '{kind}'" for kind, n in found.others.most_common(SHOWN))
        more = f" and {len(found.others) - SHOWN} kinds more" if len(found.others) > SHOWN else ""
        found.notes.append(f"{path.name}: only its faces are used; {kinds}{more} ignored")
    return found


def _read(path: Path, kind: str, layer: str | None) -> Facets:
    if kind == ".ts":
        return read_gocad(path)
    if kind == ".dxf":
        return read_dxf_faces(path, layer)
    if kind == ".stl":
        return _stl(path)
    return _obj(path) if kind == ".obj" else _ply(path)


def _obj(path: Path) -> Facets:
    found = read_obj(path)
    notes = []
    if LOOKS in found.others:
        notes.append(f"{path.name}: the file of its materials ({LOOKS}) is not opened")
    others = Counter({k: n for k, n in found.others.items() if k not in NO_SHAPE})
    return Facets(found.points, fanned(found.loops), notes, others)


def _stl(path: Path) -> Facets:
    points, rounding = read_stl(path)
    found = Facets(points, np.arange(len(points)).reshape(-1, 3), rounding=rounding)
    if rounding > VISIBLE:
        found.notes.append(
            f"{path.name}: STL keeps seven digits, so coordinates of {np.abs(points).max():.3g} are "
            f"right to {rounding:.2g} only; export another format, or subtract an offset"
        )
    return found


def _ply(path: Path) -> Facets:
    raw = read_ply(path)
    loops: list[list[int]] = []
    others: Counter[str] = Counter()
    for block in raw.cells:
        if block.type in ("triangle", "quad") or block.type.startswith("polygon"):
            loops += np.asarray(block.data).tolist()
        else:
            others[block.type] += len(block.data)
    points = np.asarray(raw.points, float)
    if loops and (points.ndim != 2 or points.shape[1] != 3):
        raise CaseError(f"{path}: its corners have no three coordinates")
    if not all(within(loop, len(points)) for loop in loops):
        raise CaseError(f"{path}: a face refers to a missing corner")
    return Facets(points, fanned(loops), [], others)
