"""Writing results: VTKHDF series, histories, checkpoints, summaries.

Every file is complete after each append, so that a killed run can be read and resumed. On resume a
series is cut back to the checkpoint; it then goes on as if it had never been broken.
"""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.shapes import NODES

VTK_TYPES = {"tet4": 10, "pyramid5": 14, "wedge6": 13, "hex8": 12}
VTK_TRIANGLE, VTK_QUAD = 5, 9


class _Series:
    """A temporal VTKHDF unstructured grid: datasets that grow by one frame at a time."""

    def __init__(self, path: Path, resume_steps: int | None) -> None:
        self.path = path
        new = resume_steps is None or not path.exists()
        # locking off: ParaView may read while the run goes on
        self.file = h5py.File(path, "w" if new else "r+", locking=False)
        if new:
            root = self.file.create_group("VTKHDF")
            root.attrs["Version"] = (2, 1)
            root.attrs.create("Type", b"UnstructuredGrid", dtype="S16")
            steps = root.create_group("Steps")
            steps.attrs["NSteps"] = 0
            self._grow("Steps/Values", (), "f8")
            for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"):
                self._grow(name, (), "i8")
            self._grow("Steps/PartOffsets", (), "i8")
            self._grow("Steps/NumberOfParts", (), "i8")
            self._grow("Steps/PointOffsets", (), "i8")
            self._grow("Steps/CellOffsets", (1,), "i8")
            self._grow("Steps/ConnectivityIdOffsets", (1,), "i8")
            self._grow("Points", (3,), "f8")
            self._grow("Connectivity", (), "i8")
            self._grow("Offsets", (), "i8")
            self._grow("Types", (), "u1")
            for kind in ("PointData", "CellData"):
                root.create_group(kind)
                steps.create_group(f"{kind}Offsets")
        else:
            self._cut(int(resume_steps))

    @property
    def root(self) -> h5py.Group:
        return self.file["VTKHDF"]

    @property
    def frames(self) -> int:
        return int(self.root["Steps"].attrs["NSteps"])

    def _grow(self, name: str, row: tuple[int, ...], kind: str) -> None:
        self.root.create_dataset(name, (0, *row), kind, maxshape=(None, *row), chunks=_chunk(row))

    def _put(self, name: str, values: Any) -> int:
        """Add rows to a dataset (made when new); returns where they begin."""
        values = np.asarray(values)
        if name not in self.root:
            self._grow(name, values.shape[1:], values.dtype.str[1:])
        data = self.root[name]
        start = len(data)
        data.resize(start + len(values), axis=0)
        data[start:] = values
        return start

    def _put_fields(self, kind: str, fields: Mapping[str, NDArray]) -> None:
        for name, values in fields.items():
            start = self._put(f"{kind}/{name}", values)
            self._put(f"Steps/{kind}Offsets/{name}", [start])

    def _finish_frame(self, time: float) -> None:
        self._put("Steps/Values", [time])
        self._put("Steps/NumberOfParts", [1])
        self.root["Steps"].attrs["NSteps"] = self.frames + 1
        self.file.flush()

    def _cut(self, frames: int) -> None:
        """Keep the first frames only."""
        steps = self.root["Steps"]
        if frames >= self.frames:
            return
        for kind in ("PointData", "CellData"):
            for name, offsets in steps[f"{kind}Offsets"].items():
                self.root[f"{kind}/{name}"].resize(int(offsets[frames]), axis=0)
                offsets.resize(frames, axis=0)
        self._cut_geometry(frames)
        for name in ("Values", "PartOffsets", "NumberOfParts", "PointOffsets"):
            steps[name].resize(frames, axis=0)
        for name in ("CellOffsets", "ConnectivityIdOffsets"):
            steps[name].resize(frames, axis=0)
        steps.attrs["NSteps"] = frames
        self.file.flush()

    def _cut_geometry(self, frames: int) -> None:
        raise NotImplementedError


def _chunk(row: tuple[int, ...]) -> tuple[int, ...]:
    return (65536 // max(int(np.prod(row)), 1), *row)


class FrameWriter(_Series):
    """The volume over time; the cells stay the same.

    Args:
        path: The .vtkhdf file.
        cells: By shape, node ids (cells, nodes).
        static_cell_data: Fields that do not change, one value per cell.
        resume_steps: Frames to keep of an existing file; None for a new one.
    """

    def __init__(
        self,
        path: Path,
        cells: Mapping[str, NDArray],
        static_cell_data: Mapping[str, NDArray],
        resume_steps: int | None = None,
    ) -> None:
        super().__init__(path, resume_steps)
        self._static = static_cell_data
        if len(self.root["Types"]):
            return
        sizes = np.concatenate([np.full(len(cells[s]), n) for s, n in NODES.items()])
        self._put("Connectivity", np.concatenate([cells[s].ravel() for s in NODES]))
        self._put("Offsets", np.concatenate([[0], np.cumsum(sizes)]))
        types = [np.full(len(cells[s]), VTK_TYPES[s], np.uint8) for s in NODES]
        self._put("Types", np.concatenate(types))
        for name, values in static_cell_data.items():
            self._put(f"CellData/{name}", values)

    def append(
        self,
        time: float,
        points: NDArray,
        point_data: Mapping[str, NDArray],
        cell_data: Mapping[str, NDArray],
    ) -> None:
        """Add a frame: time [s], node positions (nodes, 3) and fields."""
        cells, ids = len(self.root["Types"]), len(self.root["Connectivity"])
        if self.frames == 0:  # the same part serves every step: only the points move on
            self._put("NumberOfPoints", [len(points)])
            self._put("NumberOfCells", [cells])
            self._put("NumberOfConnectivityIds", [ids])
        start = self._put("Points", points)
        self._put("Steps/PartOffsets", [0])
        self._put("Steps/PointOffsets", [start])
        self._put("Steps/CellOffsets", [[0]])
        self._put("Steps/ConnectivityIdOffsets", [[0]])
        self._put_fields("PointData", point_data)
        self._put_fields("CellData", cell_data)
        for name in self._static:
            self._put(f"Steps/CellDataOffsets/{name}", [0])
        self._finish_frame(time)

    def _cut_geometry(self, frames: int) -> None:
        for name in self._static_names():
            self.root[f"CellData/{name}"].resize(len(self.root["Types"]), axis=0)
        self.root["Points"].resize(int(self.root["Steps/PointOffsets"][frames]), axis=0)
        if frames == 0:
            for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"):
                self.root[name].resize(0, axis=0)

    def _static_names(self) -> list[str]:
        return [n for n in ("group", "block") if n in self.root["CellData"]]


class SurfaceWriter(_Series):
    """The outer and broken faces over time: triangles and quadrilaterals that come and go.

    Args:
        path: The .vtkhdf file.
        resume_steps: Frames to keep of an existing file; None for a new one.
    """

    def append(
        self,
        time: float,
        points: NDArray,
        polygons: NDArray,
        point_data: Mapping[str, NDArray],
        cell_data: Mapping[str, NDArray],
    ) -> None:
        """Add a frame: time [s], points, polygons (faces, 4) with -1 last in a triangle, fields."""
        sizes = (polygons >= 0).sum(axis=1)
        connectivity = polygons[polygons >= 0]
        self._put("NumberOfPoints", [len(points)])
        self._put("NumberOfCells", [len(polygons)])
        self._put("NumberOfConnectivityIds", [len(connectivity)])
        parts = len(self.root["NumberOfPoints"]) - 1
        self._put("Steps/PartOffsets", [parts])
        self._put("Steps/PointOffsets", [self._put("Points", points)])
        cell = self._put("Types", np.where(sizes == 3, VTK_TRIANGLE, VTK_QUAD).astype(np.uint8))
        self._put("Steps/CellOffsets", [[cell]])
        self._put("Offsets", np.concatenate([[0], np.cumsum(sizes)]))
        self._put("Steps/ConnectivityIdOffsets", [[self._put("Connectivity", connectivity)]])
        self._put_fields("PointData", point_data)
        self._put_fields("CellData", cell_data)
        self._finish_frame(time)

    def _cut_geometry(self, frames: int) -> None:
        steps = self.root["Steps"]
        cells = int(steps["CellOffsets"][frames, 0])
        self.root["Points"].resize(int(steps["PointOffsets"][frames]), axis=0)
        self.root["Types"].resize(cells, axis=0)
        self.root["Offsets"].resize(cells + frames, axis=0)
        self.root["Connectivity"].resize(int(steps["ConnectivityIdOffsets"][frames, 0]), axis=0)
        for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"):
            self.root[name].resize(frames, axis=0)


class HistoryWriter:
    """Histories as CSV, one row per sample, units in the header.

    Args:
        path: The .csv file.
        columns: Names with units.
        keep_rows: Rows to keep of an existing file; None for a new one.
    """

    def __init__(self, path: Path, columns: Sequence[str], keep_rows: int | None = None) -> None:
        self.path = path
        kept = [",".join(columns)]
        if keep_rows is not None and path.exists():
            kept += path.read_text().splitlines()[1 : keep_rows + 1]
        path.write_text("\n".join(kept) + "\n")

    def append(self, row: Sequence[float]) -> None:
        """Add a row; numbers are written so that they read back to the same bits."""
        with self.path.open("a", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow([v if isinstance(v, int) else repr(float(v)) for v in row])


def _replace(path: Path, temporary: Path) -> None:
    os.replace(temporary, path)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def write_checkpoint(path: Path, arrays: Mapping[str, NDArray], attributes: dict[str, Any]) -> None:
    """Write a checkpoint so that either the old or the new one is there, whole, at any moment."""
    temporary = path.with_suffix(".tmp")
    with h5py.File(temporary, "w") as file:
        for name, values in arrays.items():
            file.create_dataset(name.replace(".", "/"), data=values)
        file.attrs["attributes"] = json.dumps(attributes)
    with temporary.open("rb") as raw:
        os.fsync(raw.fileno())
    _replace(path, temporary)


def read_checkpoint(path: Path) -> tuple[dict[str, NDArray], dict[str, Any]]:
    """Read what `write_checkpoint` wrote.

    Raises:
        CdemError: The file is not a checkpoint.
    """
    arrays: dict[str, NDArray] = {}
    try:
        with h5py.File(path, "r") as file:
            file.visititems(
                lambda name, item: (
                    arrays.__setitem__(name.replace("/", "."), item[()])
                    if isinstance(item, h5py.Dataset)
                    else None
                )
            )
            attributes = json.loads(file.attrs["attributes"])
    except (OSError, KeyError, ValueError) as error:
        raise CdemError(f"{path}: not a checkpoint that can be read ({error})") from error
    return arrays, attributes


def write_json_atomic(path: Path, content: dict[str, Any]) -> None:
    """Write JSON so that a reader never sees half a file."""
    temporary = path.with_suffix(".tmp")
    temporary.write_text(json.dumps(content, indent=2, default=_plain) + "\n")
    _replace(path, temporary)


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"cannot write {type(value).__name__} as JSON")
