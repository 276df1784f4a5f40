"""Volume meshes from files, in the formats of meshio for volumes."""

from __future__ import annotations

import contextlib
import gzip
import io
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case import reader_process
from cdem.case.input_file import is_file, reading, refuse_entities
from cdem.errors import MeshError
from cdem.mesh.arrays import in_pieces
from cdem.mesh.element_shapes import NODES, volumes
from cdem.mesh.gmsh_nodes import check_node_ids
from cdem.mesh.mesh import Mesh, drop_unused
from cdem.mesh.mesh_arrays import from_arrays
from cdem.mesh.named_parts import check_parts

_MESHIO_SHAPES = {"tetra": "tet4", "pyramid": "pyramid5", "wedge": "wedge6", "hexahedron": "hex8"}
_MESHIO_FACES = ("triangle", "quad")
SURFACES = {".ply", ".off", ".svg", ".wkt", ".obj", ".stl"}
"""Formats of meshio without volume elements."""
HDF5 = {".med", ".h5m", ".cgns", ".hmf", ".xdmf", ".xmf", ".e", ".exo", ".ex2"}
"""Formats that are HDF5, or name HDF5 files."""
BODIES = {".obj", ".stl", ".ply"}
"""Formats for bodies."""
MEND = "is it complete, and of the kind of its ending?"
POLYHEDRA = " Polyhedral cells are read with model.blocks: [{group: NAME, file: FILE}]"
GROUP_DATA = ("material", "gmsh:physical", "region", "group")
"""Cell data used as groups in a file without groups: the first that is present."""
UNPACKED = 100
"""Largest ratio of unpacked to packed size of a mesh."""
TURNED = {
    "tet4": (0, 2, 1, 3),
    "pyramid5": (0, 3, 2, 1, 4),
    "wedge6": (3, 4, 5, 0, 1, 2),
    "hex8": (4, 5, 6, 7, 0, 1, 2, 3),
}
"""Orders of an element's nodes that turn it inside out."""


def read_mesh(path: str | Path) -> Mesh:
    """Read a volume mesh in any format of meshio for volumes.

    A file packed with gzip (``.msh.gz``) is unpacked first. Physical groups of volumes (gmsh) and
    cell sets become groups; groups of surfaces become named surfaces; cells without a group go to
    the group "default", and a cell in several groups to the first, which `Mesh.notes` reports. The
    notes also report elements of a shape that were all numbered inside out and have been corrected.

    Raises:
        MeshError: The file is missing or unreadable, names missing nodes, or contains no
            linear volume elements.
    """
    path = Path(path)
    if not is_file(path):
        raise MeshError(f"{path}: no such mesh file; give a path relative to the case file")
    _refuse_surfaces(path, _kind(path))
    if _kind(path) in HDF5:
        return from_arrays(reader_process.read("cdem.mesh.hdf5_mesh", path, MEND))
    return read_here(path)


def _kind(path: Path) -> str:
    """Ending of a file, or of the file packed in it."""
    packed = path.suffix.lower() == ".gz"
    return (Path(path.stem) if packed else path).suffix.lower()


def read_here(path: Path) -> Mesh:
    """Read a volume mesh in this process, see `read_mesh`."""
    mend = MEND + (POLYHEDRA if _kind(path) in (".vtu", ".vtk") else "")
    with reading(path, MeshError, mend):
        raw = _read_zipped(path) if path.suffix.lower() == ".gz" else read_raw(path)
        return _to_mesh(path, raw)


def _refuse_surfaces(path: Path, kind: str) -> None:
    """Refuse formats for surfaces or lines."""
    if kind in BODIES:
        raise MeshError(
            f"{path}: contains surfaces, but a mesh needs volume elements; closed convex bodies "
            f"are "
            "read with model.blocks: [{group: NAME, file: FILE}]"
        )
    import meshio

    known = {k for k in meshio.extension_to_filetypes if k.count(".") == 1} - SURFACES
    if kind not in known:
        raise MeshError(
            f"{path}: unknown kind of mesh; export the volume elements from the program "
            f"that made it, preferably as .msh (gmsh); known are: {', '.join(sorted(known))}"
        )


def _to_mesh(path: Path, raw: Any) -> Mesh:
    if not len(raw.points):
        raise MeshError(f"{path}: contains no nodes")
    points = np.asarray(raw.points, float).reshape(len(raw.points), -1)
    if points.shape[1] != 3:
        raise MeshError(f"{path}: is a plane mesh; cdem needs a volume mesh")
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
    _check_nodes(path, raw)
    groups = _cell_groups(raw)
    mesh = Mesh(points, surfaces=_surfaces(raw, groups))
    _take_volumes(mesh, raw, groups)
    if not mesh.cells:
        raise MeshError(
            f"{path}: contains no volume elements; export the volume mesh, not its surface"
        )
    mesh.notes += _several_groups(raw, path) + _turn_all_inverted(mesh, path)
    return drop_unused(mesh)


def _check_nodes(path: Path, raw: Any) -> None:
    """Refuse elements that name missing nodes: -1 would mean the last one."""
    for block in raw.cells:
        cells = np.asarray(block.data)
        if cells.size == 0:
            continue
        if not np.issubdtype(cells.dtype, np.integer) or cells.ndim != 2:
            raise MeshError(
                f"{path}: the nodes of its elements of kind {block.type} are not numbers"
            )
        wrong = np.argwhere((cells < 0) | (cells >= len(raw.points)))
        if len(wrong):
            row, column = wrong[0]
            raise MeshError(
                f"{path}: element {row} of kind {block.type} names node {cells[row, column]}, which "
                f"the file does not have: it has {len(raw.points)} nodes (elements and nodes count "
                f"from 0); "
                "write the mesh again, completely"
            )


def _turn_all_inverted(mesh: Mesh, path: Path) -> list[str]:
    """Correct the elements of a shape if all are numbered inside out, as tets of netgen are."""
    notes = []
    for shape, order in TURNED.items():
        cells = mesh.cells.get(shape)
        if cells is None or not len(cells):
            continue

        def highest(some: NDArray, shape: str = shape) -> NDArray[np.float64]:
            return volumes(shape, mesh.points[some]).max(axis=1)

        if highest(cells[:1])[0] < 0 and (in_pieces(highest, cells) < 0).all():
            mesh.cells[shape] = cells[:, order]
            notes.append(
                f"{path}: all {len(cells):,} {shape} elements were numbered inside out, as in a "
                "mirror image, and have been corrected; a mesh mirrored on purpose is fine"
            )
    return notes


def _take_volumes(mesh: Mesh, raw: Any, groups: dict[int, NDArray]) -> None:
    """Cells of the four shapes, and their groups in the order in which they occur."""
    cells: dict[str, list[NDArray]] = {s: [] for s in NODES}
    group: dict[str, list[NDArray]] = {s: [] for s in NODES}
    number: dict[str, int] = {}
    for index, block in enumerate(raw.cells):
        if block.type not in _MESHIO_SHAPES or not len(block.data):
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
    """A note if volume elements are in more than one group, since only one of them counts."""
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
    allowed = UNPACKED * (path.stat().st_size + 1000)
    with tempfile.TemporaryDirectory() as folder:
        plain = Path(folder) / path.stem
        with gzip.open(path) as packed, plain.open("wb") as file:
            while piece := packed.read(1 << 20):
                allowed -= len(piece)
                if allowed < 0:
                    raise MeshError(
                        f"{path}: unpacks to more than {UNPACKED} times its size, more than any "
                        f"mesh"
                    )
                file.write(piece)
        return read_raw(plain)


def read_raw(path: Path) -> Any:
    """Read a file with meshio, silently; call it inside `reading`."""
    import meshio

    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        if path.suffix.lower() != ".msh":
            refuse_entities(path)
            if path.suffix.lower() in (*HDF5, ".inp"):
                check_parts(path)
            return meshio.read(path)
        with path.open("rb") as file:
            ansys = file.read(1) == b"("
        if not ansys:
            check_node_ids(path)
        return meshio.read(path, file_format="ansys" if ansys else "gmsh")


def cell_groups(data: Mapping[str, NDArray]) -> NDArray | None:
    """Groups of cells by their data: the first of `GROUP_DATA` with whole numbers or names.

    Args:
        data: Values of all cells, by name.

    Returns:
        A name for each cell, e.g. `material2`, or `group2` of `gmsh:physical`; None without such
        data.
    """
    for name in GROUP_DATA:
        values = data.get(name)
        if values is None or values.ndim != 1:
            continue
        if values.dtype.kind in "US":
            return values.astype(object)
        if np.isfinite(values).all() and (values == np.round(values)).all():
            stem = "group" if name == "gmsh:physical" else name
            return np.array([f"{stem}{int(value)}" for value in values], object)
    return None


def _data_groups(raw: Any) -> dict[int, NDArray]:
    """Groups by cell data, block by block; none if all cells have the same."""
    sizes = [len(block.data) for block in raw.cells]
    data = {
        name: np.concatenate([np.asarray(part) for part in parts])
        for name, parts in raw.cell_data.items()
        if name in GROUP_DATA and all(np.ndim(part) == 1 for part in parts)
    }
    names = cell_groups(data)
    if names is None or len(set(names.tolist())) < 2:
        return {}
    return dict(enumerate(np.split(names, np.cumsum(sizes)[:-1])))


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
    return out or _data_groups(raw)
