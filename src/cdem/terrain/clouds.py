"""Point clouds (LAS, LAZ) as grids of heights: the mean of the ground points of a cell."""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case import reader_process
from cdem.case.input_file import is_file, reading
from cdem.errors import BackendError, CaseError
from cdem.terrain.cloud_sums import MEND, cell_sums
from cdem.terrain.heights import Grid
from cdem.terrain.projection import Projection
from cdem.terrain.rasters import WHAT, Box

Floats = NDArray[np.float64]
KINDS = (".las", ".laz")
MOST_CELLS = 10_000_000


def read_cloud_label(path: Path) -> str | None:
    """Projection named in a point cloud, or None."""
    with _opened(path) as file:
        return _label(file)


def read_cloud(
    path: Path, projection: Projection, told: str | None, box: Box, cell: float | None, classes: str
) -> Grid:
    """Read a point cloud as a grid with lines at multiples of the cell.

    Args:
        path: ``.las`` or ``.laz``; it is read in parts, compressed points by another process.
        projection: Target projection.
        told: Its projection as given by the user, or None.
        box: The required part, in the target [m].
        cell: Cell of the grid [m].
        classes: "ground" for points of class 2, "all" for all.

    Returns:
        The grid: mean heights, in the unit of the file; NaN in cells without points.

    Raises:
        CaseError: No cell is given, the file cannot be read, or has no such points there.
        BackendError: The extra `lidar` is not installed.
    """
    if cell is None:
        raise CaseError(f"{path}: a point cloud needs a cell size for its grid; give cell")
    low = np.floor(box[0] / cell) * cell
    columns, rows = np.round((np.ceil(box[1] / cell) * cell - low) / cell).astype(int).tolist()
    if columns * rows > MOST_CELLS:
        raise CaseError(f"{path}: {columns} x {rows} cells are too many; give a larger cell")
    with _opened(path) as file:
        head = file.header
        own = projection.own(path, _label(file), told, head.mins, head.maxs)
        asked = {
            "low": low.tolist(),
            "cell": cell,
            "columns": columns,
            "rows": rows,
            "classes": classes,
            "own": own and own.to_wkt(),
            "target": projection.target and projection.target.to_wkt(),
        }
        sums = None if head.are_points_compressed else cell_sums(path, file, asked)
    if sums is None:
        sums = reader_process.read(
            "cdem.terrain.cloud_sums", path, MEND, kind=CaseError, asked=asked
        )
    total, count = sums["total"], sums["count"]
    if not sums["taken"] and head.point_count:
        raise CaseError(
            f"{path}: none of its {head.point_count:,} points has class 2 (ground); write classes: "
            "all (--all-points) to use all points, including trees and houses"
        )
    if not count.any():
        raise CaseError(f"{path}: has no points in the required area")
    empty = int((count == 0).sum())
    projection.tell(
        f"{path.name}: {int(count.sum()):,} points to {columns} x {rows} cells of {cell:g} m, {empty} "
        "of them empty"
    )
    with np.errstate(invalid="ignore"):
        mean = np.where(count > 0, total / count, np.nan).reshape(rows, columns)
    return Grid(low[0] + cell / 2, low[1] + cell / 2, (cell, cell), mean)


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    if not is_file(path):
        raise CaseError(f"{path}: cannot read the {WHAT}: No such file or directory")
    try:
        laspy = importlib.import_module("laspy")
        importlib.import_module("lazrs")
    except ImportError as error:
        raise BackendError(
            f"point clouds need laspy: pip install 'cdem[lidar]' ({error})"
        ) from None
    with reading(path, CaseError, MEND), laspy.open(path) as file:
        yield file


def _label(file: Any) -> str | None:
    system = file.header.parse_crs()
    return None if system is None else str(system.to_wkt())
