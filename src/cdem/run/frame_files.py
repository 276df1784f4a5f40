"""Frames of a run: one VTKHDF file each, and one that lists them for ParaView and pyvista.

`frames.vtkhdf` holds no fields itself: virtual datasets of HDF5 point into the files of the folder
`frames`, one for each frame, like time steps that VTK writes into separate files. Every file is
replaced as a whole, so that the series stays readable after a kill at any moment. All data of a
frame have checksums: HDF5 keeps them for chunks of numbers, and for the rest in the format of 1.10.
"""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter as time_now
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from cdem.mesh.element_shapes import NODES
from cdem.mesh.hdf5_links import refuse_links
from cdem.run.datasets import put
from cdem.whole_files import ASIDE, replaced

VTK_TYPES = {"tet4": 10, "pyramid5": 14, "wedge6": 13, "hex8": 12}
VTK_LINE, VTK_TRIANGLE, VTK_QUAD = 3, 5, 9
POLYGONS = np.array([0, 0, VTK_LINE, VTK_TRIANGLE, VTK_QUAD], np.uint8)
"""Type of a cell by its number of corners."""
COUNTS = ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds")
KINDS = ("PointData", "CellData")
ELEMENTS = "elements.h5"
"""The file with the data shared by all frames of the volume."""
CHUNK_BYTES = 1 << 20
FORMAT = ("v110", "v110")
"""HDF5 version: names and sizes have checksums too, and a dataset of one chunk needs no index."""
LIST_PATIENCE = 20
"""The list is rewritten after this multiple of its writing time, and by `sync`."""


def frame_path(folder: Path, number: int) -> Path:
    """The file of a frame."""
    return folder / f"frame-{number:04d}.vtkhdf"


def frame_numbers(folder: Path) -> list[int]:
    """Numbers of the frames in the folder of a series, in order."""
    names = [path.name[len("frame-") : -len(".vtkhdf")] for path in folder.glob("frame-*.vtkhdf")]
    return sorted(int(name) for name in names if name.isdigit())


@dataclass
class _Frame:
    """Data of a frame for the list.

    Attributes:
        number: Its number, from 0.
        time: [s].
        counts: Points, cells and connectivity ids.
        datasets: Shape and type of each of its own datasets.
    """

    number: int
    time: float
    counts: tuple[int, ...]
    datasets: dict[str, tuple[tuple[int, ...], np.dtype]] = field(default_factory=dict)


class _Series:
    """Frames in a folder, and the file that lists them.

    Args:
        path: The list, a .vtkhdf file; the folder has its name.
        group_names: Names by number of the field "group".
        keep: Frames to keep of an existing series; None for a new one.

    Attributes:
        lost: Numbers of frames to keep that are damaged or missing.
    """

    shared: Sequence[str] = ()  # datasets of ELEMENTS
    moves_cells = True  # whether every frame has cells of its own

    def __init__(self, path: Path, group_names: Sequence[str], keep: int | None = None) -> None:
        self.path, self.folder = path, path.with_suffix("")
        self.group_names = list(group_names)
        self.lost: list[int] = []
        self._frames: list[_Frame] = []
        self._listed = 0
        self._list_due = 0.0
        self.folder.mkdir(exist_ok=True)
        if keep is not None:
            self._keep(keep)

    def sync(self) -> None:
        """Bring the list up to date; frames themselves are on the disk once written."""
        if self._listed != len(self._frames):
            self._write_list()

    def drop_last(self) -> None:
        """Remove the last frame, and list the others."""
        last = self._frames.pop()
        self._write_list()
        frame_path(self.folder, last.number).unlink(missing_ok=True)

    @property
    def last_time(self) -> float | None:
        """Time of the last frame [s], or None."""
        return self._frames[-1].time if self._frames else None

    def _add(self, number: int, time: float, counts: tuple[int, ...], own: dict[str, Any]) -> None:
        """Write a frame and, if due, the list."""
        frame = _Frame(number, time, counts)
        with _replaced_hdf5(frame_path(self.folder, number)) as hdf5:
            root = self._root(hdf5)
            for name, count in zip(COUNTS, counts, strict=True):
                _put(root, name, np.array([count]))
            for name in self.shared:
                root[name] = h5py.ExternalLink(ELEMENTS, name)
            for name, values in sorted(own.items()):
                _put(root, name, np.asarray(values))
                frame.datasets[name] = (np.shape(values), np.asarray(values).dtype)
            _put(root, "FieldData/TimeValue", np.array([time], float))
            self._name_groups(root)
        if self._frames and self._frames[-1].datasets == frame.datasets:
            frame.datasets = self._frames[-1].datasets  # kept once
        self._frames.append(frame)
        if time_now() >= self._list_due:
            self._write_list()

    @staticmethod
    def _root(hdf5: h5py.File) -> h5py.Group:
        root = hdf5.create_group("VTKHDF")
        root.attrs["Version"] = (2, 1)
        root.attrs.create("Type", b"UnstructuredGrid", dtype="S16")
        for kind in KINDS:
            root.create_group(kind)
        return root

    def _name_groups(self, root: h5py.Group) -> None:
        """Give the names for the numbers of the field "group"."""
        if "CellData/group" not in self.shared and "CellData/group" in root:
            _put_names(root["CellData/group"], self.group_names)

    # ------------------------------------------------------------------ the list

    def _write_list(self) -> None:
        """Write the file that presents the datasets of all frames as one."""
        frames, began = self._frames, time_now()
        with _replaced_hdf5(self.path) as hdf5:
            root = self._root(hdf5)
            for k, name in enumerate(COUNTS):
                some = frames if self.moves_cells else frames[:1]
                put(root, name, np.array([f.counts[k] for f in some], int))
            for name in self.shared:
                root[name] = h5py.ExternalLink(f"{self.folder.name}/{ELEMENTS}", name)
            names = sorted(set.intersection(*(set(f.datasets) for f in frames))) if frames else []
            folder = Path(self.folder.name)
            paths = [frame_path(folder, f.number).as_posix().encode() for f in frames]
            for name in names:
                _put_virtual(root, name, paths, [f.datasets[name] for f in frames])
            self._name_groups(root)
            self._put_steps(root, names)
        self._listed = len(frames)
        self._list_due = time_now() + LIST_PATIENCE * (time_now() - began)

    def _put_steps(self, root: h5py.Group, names: Sequence[str]) -> None:
        """Write times, and the first row of each frame."""
        frames, count = self._frames, len(self._frames)
        none = np.zeros(count, int)
        points, cells, ids = (_starts([f.counts[k] for f in frames]) for k in range(3))
        moves = self.moves_cells
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = count
        put(steps, "Values", np.array([frame.time for frame in frames], float))
        put(steps, "NumberOfParts", np.ones(count, int))
        put(steps, "PartOffsets", np.arange(count) if moves else none)
        put(steps, "PointOffsets", points)
        put(steps, "CellOffsets", (cells if moves else none).reshape(-1, 1))
        put(steps, "ConnectivityIdOffsets", (ids if moves else none).reshape(-1, 1))
        rows = {name: _starts([f.datasets[name][0][0] for f in frames]) for name in names}
        for name, starts in [*rows.items(), *((name, none) for name in self.shared)]:
            kind, _, field_name = name.partition("/")
            if field_name:
                put(steps, f"{kind}Offsets/{field_name}", starts)

    # ------------------------------------------------------------------ resuming

    def _keep(self, count: int) -> None:
        """Keep the first frames only, and remove a half-written one."""
        for number in range(count):
            try:
                self._frames.append(self._look(number))
            except Exception:  # h5py raises many kinds for a damaged file
                self.lost.append(number)
        self._write_list()  # before files that it no longer lists are removed
        for number in frame_numbers(self.folder):
            if number >= count:
                frame_path(self.folder, number).unlink()
        for path in self.folder.glob(f"*{ASIDE}"):
            path.unlink()

    def _look(self, number: int) -> _Frame:
        path = frame_path(self.folder, number)
        with h5py.File(path, "r", locking=False) as hdf5:
            refuse_links(hdf5, path, ELEMENTS)
            root = hdf5["VTKHDF"]
            frame = _Frame(
                number,
                float(root["FieldData/TimeValue"][0]),
                tuple(int(root[name][0]) for name in COUNTS),
            )
            cells = () if not self.moves_cells else ("Points", "Types", "Connectivity", "Offsets")
            fields = (f"{kind}/{name}" for kind in KINDS for name in root[kind])
            for name in [*(cells or ("Points",)), *fields]:
                if name not in self.shared:
                    values = root[name][()]  # this verifies its checksums
                    frame.datasets[name] = (values.shape, values.dtype)
            names_of_groups(root)
        return frame


class FrameFiles(_Series):
    """The volume over time; the cells stay the same.

    Args:
        path: The .vtkhdf file.
        cells: By shape, node ids (cells, nodes).
        cell_data: Fields that do not change, one value per cell.
        group_names: Names by number of the field "group".
        keep: Frames to keep of an existing series; None for a new one.

    Raises:
        DiskError: They cannot be written.
    """

    moves_cells = False

    def __init__(
        self,
        path: Path,
        cells: Mapping[str, NDArray],
        cell_data: Mapping[str, NDArray],
        group_names: Sequence[str],
        keep: int | None = None,
    ) -> None:
        some = {shape: count for shape, count in NODES.items() if shape in cells}
        sizes = np.concatenate([np.full(len(cells[s]), n) for s, n in some.items()])
        connectivity = np.concatenate([cells[s].ravel() for s in some])
        types = [np.full(len(cells[s]), VTK_TYPES[s], np.uint8) for s in some]
        content = {
            "Connectivity": connectivity.astype(np.int64),
            "Offsets": np.concatenate([[0], np.cumsum(sizes)]),
            "Types": np.concatenate(types),
        } | {f"CellData/{name}": values for name, values in cell_data.items()}
        self.shared = list(content)
        self._cells, self._ids = len(sizes), len(connectivity)
        path.with_suffix("").mkdir(exist_ok=True)
        with _replaced_hdf5(path.with_suffix("") / ELEMENTS) as hdf5:
            for name, values in content.items():
                _put(hdf5, name, np.asarray(values))
            if "CellData/group" in content:
                _put_names(hdf5["CellData/group"], group_names)
        super().__init__(path, group_names, keep)

    def append(
        self,
        number: int,
        time: float,
        points: NDArray,
        point_data: Mapping[str, NDArray],
        cell_data: Mapping[str, NDArray],
    ) -> None:
        """Add a frame: its number, time [s], node positions [m] (nodes, 3) and fields."""
        own = {"Points": points} | _fields(point_data, cell_data)
        self._add(number, time, (len(points), self._cells, self._ids), own)


class SurfaceFiles(_Series):
    """The outer and broken faces over time: triangles and quadrilaterals that come and go; or lines.

    Args:
        path: The .vtkhdf file.
        group_names: Names by number of the field "group".
        keep: Frames to keep of an existing series; None for a new one.

    Raises:
        DiskError: They cannot be written.
    """

    def append(
        self,
        number: int,
        time: float,
        points: NDArray,
        polygons: NDArray,
        point_data: Mapping[str, NDArray],
        cell_data: Mapping[str, NDArray],
    ) -> None:
        """Add a frame.

        Args:
            number: From 0.
            time: [s].
            points: Positions [m], shape (points, 3).
            polygons: Point ids, shape (faces, 3) or (faces, 4) with -1 last in a triangle; for
                lines
                (lines, 2).
            point_data: Fields on points.
            cell_data: Fields on faces.
        """
        corners = (polygons >= 0).sum(axis=1)
        connectivity = polygons[polygons >= 0].astype(np.int64)
        own = {
            "Points": points,
            "Types": POLYGONS[corners],
            "Connectivity": connectivity,
            "Offsets": np.concatenate([[0], np.cumsum(corners)]),
        } | _fields(point_data, cell_data)
        self._add(number, time, (len(points), len(polygons), len(connectivity)), own)


@contextmanager
def _replaced_hdf5(path: Path) -> Iterator[h5py.File]:
    """Make an HDF5 file in memory, then replace the file on the disk with one write."""
    content = io.BytesIO()
    with h5py.File(content, "w", libver=FORMAT) as hdf5:
        yield hdf5
    with replaced(path) as file:
        file.write(content.getbuffer())


def _fields(
    point_data: Mapping[str, NDArray], cell_data: Mapping[str, NDArray]
) -> dict[str, NDArray]:
    """Fields under their names in a VTKHDF file."""
    return {
        f"{kind}/{name}": values
        for kind, data in zip(KINDS, (point_data, cell_data), strict=True)
        for name, values in data.items()
    }


def _starts(counts: Sequence[int]) -> NDArray[np.int64]:
    """First row of each of several ranges of rows."""
    return np.cumsum([0, *counts])[:-1].astype(np.int64)


def _put(root: h5py.Group, name: str, values: NDArray) -> None:
    """Write a dataset with checksums, which HDF5 has for chunks only."""
    rows = max(1, CHUNK_BYTES // values[0].nbytes) if values.size else 0
    put(root, name, values, (min(rows, len(values)), *values.shape[1:]) if rows else None)


def _put_names(dataset: h5py.Dataset, names: Sequence[str]) -> None:
    """Write group names at equal length: HDF5 has no checksum for others."""
    texts = [name.encode() for name in names]
    length = max(map(len, texts), default=1)
    dataset.attrs["names"] = np.array(texts, h5py.string_dtype("utf-8", length))


def names_of_groups(root: h5py.Group) -> list[str]:
    """Names by number of the field "group" of a frame; empty if the file lacks them."""
    if "CellData/group" not in root:
        return []
    names = root["CellData/group"].attrs.get("names", [])
    return [name.decode() if isinstance(name, bytes) else str(name) for name in names]


def _put_virtual(
    root: h5py.Group,
    name: str,
    paths: Sequence[bytes],
    datasets: Sequence[tuple[tuple[int, ...], np.dtype]],
) -> None:
    """Combine the datasets of all frames into one; rows of a missing file are NaN.

    Args:
        root: The file or group that gets it.
        name: Name of the new dataset and of the old ones.
        paths: Files of the frames, relative to the folder of the list.
        datasets: Shape and type of the frames' datasets.
    """
    shapes = [shape for shape, _ in datasets]
    rows = [shape[0] for shape in shapes]
    dtype = datasets[0][1]
    space = h5py.h5s.create_simple((sum(rows), *shapes[0][1:]))
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_obj_track_times(False)  # equal frames give equal bytes
    if dtype.kind == "f":
        properties.set_fill_value(np.array(np.nan, dtype))
    source_name = f"VTKHDF/{name}".encode()
    sources: dict[tuple[int, ...], h5py.h5s.SpaceID] = {}
    for path, start, shape in zip(paths, _starts(rows).tolist(), shapes, strict=True):
        if shape[0]:
            if shape not in sources:
                sources[shape] = h5py.h5s.create_simple(shape)
            space.select_hyperslab((start, *(0 for _ in shape[1:])), shape)
            properties.set_virtual(space, path, source_name, sources[shape])
    space.select_all()
    kind, _, last = name.rpartition("/")
    parent = root[kind] if kind else root
    h5py.h5d.create(parent.id, last.encode(), h5py.h5t.py_create(dtype), space, properties)
