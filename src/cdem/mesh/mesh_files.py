"""Volume meshes read from files, in any format that meshio knows."""

from __future__ import annotations

import contextlib
import gzip
import io
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import MeshError
from cdem.mesh.element_shapes import NODES
from cdem.mesh.mesh import Mesh, drop_unused

_MESHIO_SHAPES = {"tetra": "tet4", "pyramid": "pyramid5", "wedge": "wedge6", "hexahedron": "hex8"}
_MESHIO_FACES = ("triangle", "quad")


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
    points = np.asarray(raw.points, float).reshape(len(raw.points), -1)
    if points.shape[1] == 2:
        raise MeshError(f"{path}: a mesh in a plane; cdem needs a volume mesh")
    others = {block.type for block in raw.cells} - {
        *_MESHIO_SHAPES,
        *_MESHIO_FACES,
        "vertex",
        "line",
    }
    if others:
        raise MeshError(
            f"{path}: elements of kind {', '.join(sorted(others))} are not supported; use linear "
            "tetrahedra, pyramids, wedges and hexahedra (in gmsh: Mesh.ElementOrder = 1)"
        )
    groups = _cell_groups(raw)
    mesh = Mesh(points, surfaces=_surfaces(raw, groups))
    _take_volumes(mesh, raw, groups)
    if not mesh.cells:
        raise MeshError(
            f"{path}: holds no volume elements; export the volume mesh, not its surface"
        )
    mesh.notes += _several_groups(raw, path)
    return drop_unused(mesh)


def _take_volumes(mesh: Mesh, raw: Any, groups: dict[int, NDArray]) -> None:
    """Cells of the four shapes, and their groups in the order in which they occur."""
    cells: dict[str, list[NDArray]] = {s: [] for s in NODES}
    group: dict[str, list[NDArray]] = {s: [] for s in NODES}
    number: dict[str, int] = {}
    for index, block in enumerate(raw.cells):
        if block.type not in _MESHIO_SHAPES:
            continue
        shape = _MESHIO_SHAPES[block.type]
        names = groups.get(index, np.full(len(block.data), "default", object))
        cells[shape].append(np.asarray(block.data, np.int64))
        group[shape].append(
            np.array([number.setdefault(name, len(number)) for name in names], np.int32)
        )
    mesh.cells = {s: np.concatenate(c) for s, c in cells.items() if c}
    mesh.cell_group = {s: np.concatenate(g) for s, g in group.items() if g}
    mesh.group_names = list(number)


def _surfaces(raw: Any, groups: dict[int, NDArray]) -> dict[str, list[NDArray[np.int64]]]:
    """Triangles and quadrilaterals of the named groups of surfaces."""
    surfaces: dict[str, list[NDArray[np.int64]]] = {}
    for index, block in enumerate(raw.cells):
        if block.type not in _MESHIO_FACES or index not in groups:
            continue
        for name in sorted(set(groups[index]) - {"default"}):
            faces = np.asarray(block.data, np.int64)[groups[index] == name]
            surfaces.setdefault(name, []).append(faces)
    return surfaces


def _several_groups(raw: Any, path: Path) -> list[str]:
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


def _read_zipped(path: Path) -> Any:
    """Read ``name.msh.gz`` as ``name.msh``."""
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / path.stem
        try:
            with gzip.open(path) as packed, plain.open("wb") as file:
                shutil.copyfileobj(packed, file)
        except (OSError, EOFError) as error:
            raise MeshError(f"{path}: not a gzip file ({error})") from error
        return read_raw(plain)


def read_raw(path: Path) -> Any:
    """Read a file with meshio, in silence.

    Raises:
        MeshError: It cannot be read.
    """
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


def _cell_groups(raw: Any) -> dict[int, NDArray]:
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
