"""Writing results: VTKHDF series and histories; checkpoints and summaries come from checkpoint.

Every file is complete after each append, so that a killed run can be read and resumed. On resume a
series is cut back to the checkpoint; it then goes on as if it had never been broken.
"""

from __future__ import annotations

import csv
import math
import os
from collections.abc import Mapping, Sequence
from numbers import Integral
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.element_shapes import NODES
from cdem.run.checkpoint import read_checkpoint, replace_file, write_checkpoint, write_json_atomic

__all__ = [
    "FrameWriter",
    "HistoryWriter",
    "SurfaceWriter",
    "read_checkpoint",
    "write_checkpoint",
    "write_json_atomic",
]

VTK_TYPES = {"tet4": 10, "pyramid5": 14, "wedge6": 13, "hex8": 12}
VTK_TRIANGLE, VTK_QUAD = 5, 9
COUNTS = ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds")
STEP_COLUMNS = (
    "Values", "NumberOfParts", "PartOffsets", "PointOffsets", "CellOffsets",
    "ConnectivityIdOffsets",
)  # fmt: skip
KINDS = ("PointData", "CellData")
CHUNK_VALUES = (128, 65536)
"""Least and most numbers in a chunk: HDF5 stores whole chunks, so small models need small ones."""


class _Series:
    """A temporal VTKHDF unstructured grid: datasets that grow by one frame at a time.

    The format is that of libver "earliest" without filters: a file of "latest" is unreadable after
    its writer was killed.
    """

    def __init__(self, path: Path, resume_steps: int | None) -> None:
        self.path = path
        try:
            # locking off: ParaView may read while the run goes on
            self.file = h5py.File(path, "w" if resume_steps is None else "r+", locking=False)
        except OSError as error:
            raise CdemError(
                f"{path}: cannot be written to ({error}); use --overwrite to start again"
            ) from None
        if resume_steps is None:
            self._create()
        else:
            self._cut(resume_steps)

    @property
    def root(self) -> h5py.Group:
        return self.file["VTKHDF"]

    @property
    def frames(self) -> int:
        """Frames that are whole; a killed run may have left parts of one more."""
        return int(self.root["Steps"].attrs["NSteps"])

    def name_groups(self, names: Sequence[str]) -> None:
        """Say what the numbers of the field "group" stand for, once it has been recorded."""
        self.root["CellData/group"].attrs["names"] = list(names)
        self.file.flush()

    def close(self) -> None:
        """Close the file; nothing can be appended any more."""
        self.file.close()

    def _create(self) -> None:
        root = self.file.create_group("VTKHDF")
        root.attrs["Version"] = (2, 1)
        root.attrs.create("Type", b"UnstructuredGrid", dtype="S16")
        steps = root.create_group("Steps")
        steps.attrs["NSteps"] = 0
        for kind in KINDS:
            root.create_group(kind)
            steps.create_group(f"{kind}Offsets")

    def _put(self, name: str, values: Any) -> int:
        """Add rows to a dataset (made when new); returns where they begin."""
        values = np.asarray(values)
        row = values.shape[1:]
        if name not in self.root:
            width = max(math.prod(row), 1)
            least, most = (max(count // width, 1) for count in CHUNK_VALUES)
            chunk = min(max(len(values), least), most)
            self.root.create_dataset(
                name, (0, *row), values.dtype, maxshape=(None, *row), chunks=(chunk, *row)
            )
        data = self.root[name]
        start = len(data)
        data.resize(start + len(values), axis=0)
        data[start:] = values
        return start

    def _put_fields(
        self, kind: str, fields: Mapping[str, NDArray], static: Mapping[str, NDArray] | None = None
    ) -> None:
        wanted, recorded = {*fields, *(static or {})}, set(self.root[kind])
        if self.frames and wanted != recorded:
            raise CdemError(
                f"{self.path}: records {', '.join(sorted(recorded))}, not "
                f"{', '.join(sorted(wanted))}; resume with the output.fields of the run"
            )
        for name in static or {}:
            self._put(f"Steps/{kind}Offsets/{name}", [0])
        for name, values in fields.items():
            start = self._put(f"{kind}/{name}", values)
            self._put(f"Steps/{kind}Offsets/{name}", [start])

    def _finish_frame(self, time: float, part: int, starts: tuple[int, int, int]) -> None:
        """Write where points, cells and connectivity of the frame begin; only then count it."""
        points, cells, ids = starts
        row = (time, 1, part, points, [cells], [ids])
        for name, value in zip(STEP_COLUMNS, row, strict=True):
            self._put(f"Steps/{name}", [value])
        self.root["Steps"].attrs["NSteps"] = self.frames + 1
        self.file.flush()

    # ------------------------------------------------------------------ resuming

    def _cut(self, frames: int) -> None:
        """Keep the first frames only, and nothing of a frame that was being written."""
        if frames > self.frames:
            raise CdemError(
                f"{self.path}: holds {self.frames} frames, but the checkpoint was written after "
                f"{frames}; the files do not belong together: use --overwrite to start again"
            )
        steps = self.root["Steps"]
        steps.attrs["NSteps"] = frames
        for name in STEP_COLUMNS:
            self._shorten(f"Steps/{name}", frames)
        rows = self._cut_geometry(frames)
        for kind in KINDS:
            for name in self.root[kind]:
                self._shorten(f"Steps/{kind}Offsets/{name}", frames)
                self._shorten(f"{kind}/{name}", self._field_rows(kind, name, rows[kind]))
        self.file.flush()

    def _shorten(self, name: str, rows: int) -> None:
        if name in self.root and len(self.root[name]) > rows:
            self.root[name].resize(rows, axis=0)

    def _field_rows(self, kind: str, name: str, rows: int) -> int:
        return rows

    def _cut_geometry(self, frames: int) -> dict[str, int]:
        """Cut points and cells; returns the rows that point and cell fields have then."""
        raise NotImplementedError


class FrameWriter(_Series):
    """The volume over time; the cells stay the same.

    Args:
        path: The .vtkhdf file.
        cells: By shape, node ids (cells, nodes).
        static_cell_data: Fields that do not change, one value per cell.
        resume_steps: Frames to keep of an existing file; None for a new one.

    Raises:
        CdemError: The file cannot be written to, or holds fewer frames than are to be kept.
    """

    def __init__(
        self,
        path: Path,
        cells: Mapping[str, NDArray],
        static_cell_data: Mapping[str, NDArray],
        resume_steps: int | None = None,
    ) -> None:
        self._static = static_cell_data
        super().__init__(path, resume_steps)
        if resume_steps is not None:
            return
        some = {shape: count for shape, count in NODES.items() if shape in cells}
        sizes = np.concatenate([np.full(len(cells[s]), n) for s, n in some.items()])
        connectivity = np.concatenate([cells[s].ravel() for s in some])
        self._put("Connectivity", connectivity.astype(np.int64))
        self._put("Offsets", np.concatenate([[0], np.cumsum(sizes)]))
        types = [np.full(len(cells[s]), VTK_TYPES[s], np.uint8) for s in some]
        self._put("Types", np.concatenate(types))
        for name, values in static_cell_data.items():
            self._put(f"CellData/{name}", values)
        self.file.flush()

    def append(
        self,
        time: float,
        points: NDArray,
        point_data: Mapping[str, NDArray],
        cell_data: Mapping[str, NDArray],
    ) -> None:
        """Add a frame: time [s], node positions [m] (nodes, 3) and fields."""
        if self.frames == 0:  # the same part serves every step: only the points move on
            sizes = (len(points), len(self.root["Types"]), len(self.root["Connectivity"]))
            for name, size in zip(COUNTS, sizes, strict=True):
                self._put(name, [size])
        start = self._put("Points", points)
        self._put_fields("PointData", point_data)
        self._put_fields("CellData", cell_data, self._static)
        self._finish_frame(time, 0, (start, 0, 0))

    def _cut_geometry(self, frames: int) -> dict[str, int]:
        points = frames * int(self.root["NumberOfPoints"][0]) if frames else 0
        self._shorten("Points", points)
        for name in COUNTS:
            self._shorten(name, min(frames, 1))
        return {"PointData": points, "CellData": frames * len(self.root["Types"])}

    def _field_rows(self, kind: str, name: str, rows: int) -> int:
        return len(self._static[name]) if kind == "CellData" and name in self._static else rows


class SurfaceWriter(_Series):
    """The outer and broken faces over time: triangles and quadrilaterals that come and go.

    Args:
        path: The .vtkhdf file.
        resume_steps: Frames to keep of an existing file; None for a new one.

    Raises:
        CdemError: The file cannot be written to, or holds fewer frames than are to be kept.
    """

    def __init__(self, path: Path, resume_steps: int | None = None) -> None:
        super().__init__(path, resume_steps)
        self.file.flush()

    def append(
        self,
        time: float,
        points: NDArray,
        polygons: NDArray,
        point_data: Mapping[str, NDArray],
        cell_data: Mapping[str, NDArray],
    ) -> None:
        """Add a frame.

        Args:
            time: [s].
            points: [m], shape (points, 3).
            polygons: Point ids, shape (faces, 3) or (faces, 4) with -1 last in a triangle.
            point_data: Fields on points.
            cell_data: Fields on faces.
        """
        corners = (polygons >= 0).sum(axis=1)
        connectivity = polygons[polygons >= 0].astype(np.int64)
        for name, size in zip(COUNTS, (len(points), len(polygons), len(connectivity)), strict=True):
            part = self._put(name, [size])
        types = np.where(corners == 3, VTK_TRIANGLE, VTK_QUAD).astype(np.uint8)
        starts = (
            self._put("Points", points),
            self._put("Types", types),
            self._put("Connectivity", connectivity),
        )
        self._put("Offsets", np.concatenate([[0], np.cumsum(corners)]))
        self._put_fields("PointData", point_data)
        self._put_fields("CellData", cell_data)
        self._finish_frame(time, part, starts)

    def _cut_geometry(self, frames: int) -> dict[str, int]:
        points, cells, ids = (
            int(self.root[n][:frames].sum()) if n in self.root else 0 for n in COUNTS
        )
        for name, rows in (
            ("Points", points), ("Types", cells), ("Offsets", cells + frames),
            ("Connectivity", ids), *((name, frames) for name in COUNTS),
        ):  # fmt: skip
            self._shorten(name, rows)
        return {"PointData": points, "CellData": cells}


class HistoryWriter:
    """Histories as CSV, one row per sample, units in the header.

    Args:
        path: The .csv file.
        columns: Names with units.
        keep_rows: Rows to keep of an existing file; None for a new one.

    Raises:
        CdemError: The existing file has other columns, or fewer rows than are to be kept.
    """

    def __init__(self, path: Path, columns: Sequence[str], keep_rows: int | None = None) -> None:
        self.path = path
        rows = [] if keep_rows is None else self._read(columns, keep_rows)
        temporary = path.with_name(path.name + ".tmp")
        with temporary.open("w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerow(columns)
            file.writelines(rows)
            os.fsync(file.fileno())
        replace_file(temporary, path)

    def append(self, row: Sequence[float]) -> None:
        """Add a row; numbers are written so that they read back to the same bits."""
        with self.path.open("a", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow([int(v) if isinstance(v, Integral) else repr(float(v)) for v in row])

    def _read(self, columns: Sequence[str], keep_rows: int) -> list[str]:
        try:
            with self.path.open(newline="") as file:
                header = next(csv.reader([file.readline()]), [])
                # a row without its line end was being written when the run was killed
                rows = [line for line in file if line.endswith("\n")][:keep_rows]
        except OSError as error:
            raise CdemError(
                f"{self.path}: {error.strerror}, so that the run cannot be resumed; use "
                "--overwrite to start again"
            ) from None
        if header != list(columns):
            raise CdemError(
                f"{self.path}: its columns are not those of this case; resume with the case that "
                "was run, or use --overwrite to start again"
            )
        if len(rows) < keep_rows:
            raise CdemError(
                f"{self.path}: holds {len(rows)} rows, but the checkpoint was written after "
                f"{keep_rows}; the files do not belong together: use --overwrite to start again"
            )
        return rows
