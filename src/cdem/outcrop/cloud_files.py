"""Point clouds of outcrops from files: LAS, LAZ, PLY and text."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case import reader_process
from cdem.case.input_file import is_file, reading
from cdem.errors import BackendError, CaseError, MeshError
from cdem.mesh.ply_file import read_ply
from cdem.outcrop.text_points import read_text_points
from cdem.terrain.cloud_sums import MEND

Floats = NDArray[np.float64]

LIDAR = (".las", ".laz")
TEXT = (".xyz", ".pts", ".txt", ".csv", ".asc")
KINDS = (*LIDAR, ".ply", *TEXT)
CLOUDS_ONLY = (*LIDAR, ".ply", ".xyz", ".pts")
"""Endings of files that are no tables of joints."""
MOST_READ = 20_000_000
"""Most points that are read of LAS and LAZ; of more, every second, third ... one."""
WIDEST = 10_000.0
"""Largest extent of an outcrop [m]; more is a wrong unit, or a point far away."""
FLATTEST = 1e-3
"""Smallest extent in plan over that in height; less is degrees."""


@dataclass(frozen=True)
class Cloud:
    """A point cloud.

    Attributes:
        points: About the origin [m], shape (points, 3); x east, y north, z up.
        origin: [m].
        notes: Messages for the user.
    """

    points: Floats
    origin: Floats
    notes: list[str]


def read_outcrop(path: Path) -> Cloud:
    """Read a point cloud, whatever the class of its points.

    Args:
        path: ``.las``, ``.laz``; ``.ply``; or text with x, y, z: ``.xyz``, ``.pts``, ``.txt``,
            ``.csv``, ``.asc``.

    Raises:
        CaseError: It cannot be read, or is no cloud in metres.
        BackendError: The extra `lidar` is not installed.
    """
    kind, notes = path.suffix.lower(), list[str]()
    if not is_file(path):
        what = "is a folder" if path.is_dir() else "no such file"
        raise CaseError(f"{path}: cannot read the point cloud: {what}")
    if kind not in KINDS:
        raise CaseError(f"{path}: a point cloud is one of {', '.join(KINDS)}")
    if kind in LIDAR:
        points = _lidar(path, notes)
    elif kind == ".ply":
        points = _ply(path, notes)
    else:
        with reading(path, CaseError, "a cloud has a line of x y z for each point"):
            points = read_text_points(path, notes)
    return _local(path, points, notes)


def _lidar(path: Path, notes: list[str]) -> Floats:
    try:
        importlib.import_module("laspy")
        importlib.import_module("lazrs")
    except ImportError as error:
        raise BackendError(
            f"point clouds need laspy: pip install 'cdem[lidar]' ({error})"
        ) from None
    read = reader_process.read(
        "cdem.outcrop.las_points", path, MEND, kind=CaseError, asked={"most": MOST_READ}
    )
    if read["every"] > 1:
        notes.append(f"one of {read['every']} points is read, for at most {MOST_READ:,}")
    if (read["factor"] != 1).any():
        factor = f"{read['factor'][0]:.6g}"
        notes.append(f"its projection has another unit: coordinates are times {factor}, in metres")
    return read["points"]


def _ply(path: Path, notes: list[str]) -> Floats:
    with reading(path, CaseError, "a cloud is ASCII or binary PLY, with x, y, z of its vertices"):
        try:
            raw = read_ply(path)
        except MeshError as error:
            raise CaseError(str(error)) from None
        points = np.asarray(raw.points)
        if points.ndim != 2 or points.shape[1] != 3:
            raise CaseError(f"{path}: its vertices have no x, y, z")
    idle = [*raw.point_data, *sorted({block.type + "s" for block in raw.cells})]
    if idle:
        notes.append(f"not used: {', '.join(idle)}")
    step = float(np.spacing(np.abs(points).max(initial=0)))
    if points.dtype == np.float32 and step > 0.001:
        notes.append(
            f"its coordinates have single precision: steps of {1000 * step:.2g} mm, which look like "
            "noise; export it with a shift to the origin"
        )
    with np.errstate(invalid="ignore"):  # of bits that are no number
        return points.astype(float)


def _local(path: Path, points: Floats, notes: list[str]) -> Cloud:
    """A cloud about its centre in whole metres."""
    finite = np.isfinite(points).all(axis=1)
    if lost := int((~finite).sum()):
        notes.append(f"{lost:,} points without coordinates are left out")
        points = points[finite]
    if not len(points):
        raise CaseError(f"{path}: has no points")
    low, high = points.min(axis=0), points.max(axis=0)
    size = high - low
    if size.max() > WIDEST:
        raise CaseError(
            f"{path}: extends over {size[0]:.6g} x {size[1]:.6g} x {size[2]:.6g}; an outcrop in metres "
            f"is smaller than {WIDEST:g}: convert its unit, or cut off points far away"
        )
    if not size.max() > 0:
        raise CaseError(f"{path}: all points lie at one place")
    if size[:2].max() < FLATTEST * size[2]:
        raise CaseError(
            f"{path}: x and y span {size[0]:.2g} and {size[1]:.2g}, z {size[2]:.4g}: if x and y are "
            "degrees, project it to metres first"
        )
    origin = np.round((low + high) / 2)
    return Cloud(points - origin, origin, notes)
