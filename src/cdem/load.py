"""Reading a result folder: summary, histories, and the frames of its VTKHDF files."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError

SHAPE_OF_TYPE = {10: "tet4", 14: "pyramid5", 13: "wedge6", 12: "hex8", 5: "triangle", 9: "quad"}


def load_summary(folder: Path | str) -> dict[str, Any]:
    """Content of summary.json.

    Raises:
        CdemError: The folder holds no run that came to an end.
    """
    path = Path(folder) / "summary.json"
    try:
        return json.loads(path.read_text())
    except FileNotFoundError:
        raise CdemError(
            f"{folder}: no summary.json; the run has not come to an end yet, or this is no result "
            "folder"
        ) from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise CdemError(f"{path}: not readable ({error})") from None


def load_histories(folder: Path | str) -> dict[str, NDArray[np.float64]]:
    """Columns of histories.csv by their name with unit, e.g. "time [s]".

    Raises:
        CdemError: There is no such file, it has no rows, or a number cannot be read.
    """
    path = Path(folder) / "histories.csv"
    if not path.is_file():
        raise CdemError(f"{folder}: no histories.csv; is this a result folder?")
    try:
        with path.open(newline="") as file:
            reader = csv.reader(file)
            names = next(reader, [])
            # a row that a killed run left unfinished is shorter
            rows = [[float(v) for v in row] for row in reader if len(row) == len(names)]
    except ValueError as error:
        raise CdemError(f"{path}: not readable ({error})") from None
    if not rows:
        raise CdemError(f"{path}: holds no rows yet")
    return dict(zip(names, np.array(rows).T, strict=True))


@dataclass
class Frame:
    """One moment of a run.

    Attributes:
        time: [s].
        points: [m], shape (points, 3).
        types: VTK cell types, shape (cells,).
        offsets: Where each cell begins in `connectivity`, and its end; shape (cells + 1,).
        connectivity: Point ids of all cells, one after the other.
        point_data: Fields on points, by name.
        cell_data: Fields on cells, by name.
    """

    time: float
    points: NDArray[np.float64]
    types: NDArray[np.uint8]
    offsets: NDArray[np.int64]
    connectivity: NDArray[np.int64]
    point_data: dict[str, NDArray]
    cell_data: dict[str, NDArray]

    @property
    def cells(self) -> dict[str, NDArray[np.int64]]:
        """Point ids by shape ("tet4", ..., "triangle", "quad"), each (cells, nodes)."""
        sizes = np.diff(self.offsets)
        found = {}
        for kind, shape in SHAPE_OF_TYPE.items():
            some = np.flatnonzero(self.types == kind)
            if len(some):
                nodes = np.arange(int(sizes[some[0]]))
                found[shape] = self.connectivity[self.offsets[some][:, None] + nodes]
        return found


class Frames:
    """The frames of a VTKHDF file, read when they are asked for; `frames[-1]` is the last one.

    A file that a run is still writing to can be read: only whole frames count.

    Args:
        path: The .vtkhdf file.

    Raises:
        CdemError: The file is missing, is not readable, or holds no frames yet.
    """

    def __init__(self, path: Path | str) -> None:
        import h5py

        self.path = Path(path)
        if not self.path.is_file():
            raise CdemError(f"{self.path}: no such file; was output.frames switched off?")
        try:
            self._file = h5py.File(self.path, "r", locking=False)
            self._root = self._file["VTKHDF"]
            count = int(self._root["Steps"].attrs["NSteps"])
        except (OSError, KeyError) as error:
            raise CdemError(f"{self.path}: not readable ({error})") from None
        if count == 0:
            raise CdemError(f"{self.path}: holds no frames yet")
        self.times: NDArray[np.float64] = self._root["Steps/Values"][:count]

    def __len__(self) -> int:
        return len(self.times)

    def __iter__(self) -> Iterator[Frame]:
        return (self[index] for index in range(len(self)))

    def __getitem__(self, index: int) -> Frame:
        if not -len(self) <= index < len(self):
            raise IndexError(f"frame {index} of {len(self)}")
        index %= len(self)
        root, steps = self._root, self._root["Steps"]
        part = int(steps["PartOffsets"][index])
        points, cells, ids = (
            int(root[name][part])
            for name in ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds")
        )
        first_point = int(steps["PointOffsets"][index])
        first_cell = int(steps["CellOffsets"][index, 0])
        first_id = int(steps["ConnectivityIdOffsets"][index, 0])
        first_offset = first_cell + part  # each part before has one offset more than cells
        return Frame(
            time=float(self.times[index]),
            points=root["Points"][first_point : first_point + points],
            types=root["Types"][first_cell : first_cell + cells],
            offsets=root["Offsets"][first_offset : first_offset + cells + 1],
            connectivity=root["Connectivity"][first_id : first_id + ids],
            point_data=self._fields("PointData", index, points),
            cell_data=self._fields("CellData", index, cells),
        )

    def _fields(self, kind: str, index: int, rows: int) -> dict[str, NDArray]:
        fields = {}
        for name, values in self._root[kind].items():
            first = int(self._root[f"Steps/{kind}Offsets/{name}"][index])
            fields[name] = values[first : first + rows]
        return fields


def load_frames(folder: Path | str) -> Frames:
    """The elements over time, from frames.vtkhdf.

    Example:
        >>> frames = load_frames("incline.results")       # doctest: +SKIP
        >>> frames[-1].point_data["displacement"].shape   # doctest: +SKIP
        (2700, 3)
    """
    return Frames(Path(folder) / "frames.vtkhdf")


def load_surface(folder: Path | str) -> Frames:
    """The outer faces and those of broken interfaces over time, from surface.vtkhdf."""
    return Frames(Path(folder) / "surface.vtkhdf")
