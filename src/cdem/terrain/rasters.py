"""Grids over a plan; readers of heights: ESRI ASCII directly; GeoTIFF, VRT and Surfer by GDAL."""

from __future__ import annotations

import importlib.util
import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case import reader_process
from cdem.case.input_file import is_file, read_text, reading, size_of
from cdem.case.map_system import look_up
from cdem.errors import BackendError, CaseError
from cdem.terrain import vrt
from cdem.terrain.heights import Grid, extra, refuse_degrees
from cdem.units import coordinates

Floats = NDArray[np.float64]
Box = tuple[Floats, Floats]  # south-west and north-east corner, in the units of a file
Part = Callable[[str | None, Box], Box | None]  # from the label and all of a file
Window = tuple[int, int, int, int]  # first column and row from the north, how many of each
ASCII = (".asc", ".grd", ".txt")
DRIVERS = {".tif": "GTiff", ".tiff": "GTiff", ".vrt": "VRT"}
SURFER = {b"DSAA": "GSAG", b"DSBB": "GSBG", b"DSRB": "GS7BG"}
KINDS = ".asc (ESRI ASCII), .tif (GeoTIFF), .vrt or .grd"
MEND = f"a grid is one of {KINDS}"
WHAT = "terrain file"
NOTHING = -9999.0
"""Values of files for missing data, unless they name others."""


@dataclass(frozen=True)
class Raster:
    """Numbers over a grid in plan.

    Attributes:
        x: Western edge [m].
        y: Southern edge [m].
        cell: Side of a cell [m].
        values: Values, shape (rows, columns), from south to north; NaN for missing values.
    """

    x: float
    y: float
    cell: float
    values: Floats

    @property
    def north(self) -> float:
        """Northern edge [m]."""
        return self.y + len(self.values) * self.cell

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """West, east, south and north edge [m]."""
        return self.x, self.x + self.values.shape[1] * self.cell, self.y, self.north

    @property
    def rows(self) -> Floats:
        """Values from north to south, as in map files."""
        return np.where(np.isfinite(self.values), self.values, NOTHING)[::-1]

    def middles(self) -> tuple[Floats, Floats]:
        """x of the columns and y of the rows, at the middles of the cells [m]."""
        rows, columns = self.values.shape
        x, y = (self.cell * (np.arange(n, dtype=float) + 0.5) for n in (columns, rows))
        return self.x + x, self.y + y


@dataclass
class LabelledGrid:
    """A grid as in its file, with the labels of the file.

    Attributes:
        grid: Heights, in the units and the projection of the file.
        label: Projection named in the file, for `look_up`, or None.
        unit: Unit of heights named in the file, or empty.
    """

    grid: Grid
    label: str | None = None
    unit: str = ""


def read_grid(path: Path) -> Grid:
    """Read a grid of heights that is in metres.

    Raises:
        CaseError: The file is missing, not such a grid, or not in metres.
    """
    raster = read_raster(path)
    _refuse_other_units(path, raster.label)
    known = np.isfinite(raster.grid.values)
    lowest, highest = raster.grid.values[known].min(), raster.grid.values[known].max()
    corners = [[*raster.grid.low, lowest], [*raster.grid.high, highest]]
    refuse_degrees(path, np.array(corners))
    return raster.grid


def read_label(path: Path) -> str | None:
    """Projection named in a grid, or None."""
    driver = _driver(path)
    if driver is None:
        return _sidecar(path)
    return _by_gdal(path, driver, lambda head: None)[0]["label"]


def read_raster(path: Path, part: Part | None = None) -> LabelledGrid:
    """Read a grid.

    Args:
        path: ``.asc``, ``.grd``, ``.tif``, ``.tiff`` or ``.vrt``.
        part: Function from the label and the box to the required part; by default all is read.

    Raises:
        CaseError: The file is missing, not such a grid, or has no heights in that part.
    """
    driver = _driver(path)
    if driver is None:
        with reading(path, CaseError, MEND):
            head, values = _ascii_grid(path, read_text(path, WHAT))
        head["label"] = _sidecar(path)
        left, top, columns, rows = window = _window(path, head, part)
        values = values[top : top + rows, left : left + columns]
    else:
        windows: list[Window] = []

        def wanted(head: dict[str, Any]) -> Window:
            windows.append(_window(path, head, part))
            return windows[0]

        head, values = _by_gdal(path, driver, wanted)
        window = windows[0]
    if min(values.shape) < 2:
        raise CaseError(f"{path}: a grid needs at least two rows and two columns")
    if not np.isfinite(values).any():
        where = "" if part is None else " in the required area"
        raise CaseError(f"{path}: has no heights{where}; all cells lack data")
    x, _, west, _, y, north = head["place"]
    west, north = west + x * (window[0] + 0.5), north + y * (window[1] + 0.5)
    grid = Grid(west, north + y * (len(values) - 1), (x, -y), values[::-1])
    return LabelledGrid(grid, head["label"], head["unit"])


def _driver(path: Path) -> str | None:
    """Driver of GDAL for a file; None for ESRI ASCII."""
    kind = path.suffix.lower()
    if kind not in (*ASCII, *DRIVERS):
        raise CaseError(f"{path}: grids are read from {KINDS}; gdal_translate makes them")
    if kind == ".grd" and is_file(path):
        with path.open("rb") as file:
            return SURFER.get(file.read(4))
    return DRIVERS.get(kind)


def _by_gdal(
    path: Path, driver: str, wanted: Callable[[dict[str, Any]], Window | None]
) -> tuple[dict[str, Any], Floats]:
    """Read the required window of a grid, once its head is known, in a process of its own.

    Returns:
        The head, and the heights, rows from the north; no heights without a window.
    """
    if not is_file(path):
        raise CaseError(f"{path}: cannot read the {WHAT}: No such file or directory")
    if importlib.util.find_spec("rasterio") is None:
        extra("rasterio")
    heads: list[dict[str, Any]] = []

    def reply(head: dict[str, Any]) -> Window:
        heads.append(head)
        return wanted(head) or (0, 0, 0, 0)

    size = size_of(path)
    with tempfile.TemporaryDirectory(prefix="cdem-read-") as folder:
        asked = {"driver": driver, "vrt": None}
        with reading(path, CaseError, MEND):
            vrt.refuse_links(path)
            text, files = vrt.plain(path) if driver == "VRT" else ("", [])
        if driver == "VRT":
            copy = Path(folder) / "grid.vrt"
            copy.write_text(text, encoding="utf-8")
            asked["vrt"], size = str(copy), size + sum(file.stat().st_size for file in files)
        read = reader_process.read(
            "cdem.terrain.gdal_grids", path, MEND, CaseError, asked, size=size, reply=reply
        )
    return heads[0], read.get("values", np.zeros((0, 0)))


def _window(path: Path, head: dict[str, Any], part: Part | None) -> Window:
    """The required cells and two more around them: first column and row, and numbers of each."""
    x, bx, west, by, y, north = head["place"]
    columns, rows = head["size"]
    if bx or by or x <= 0 or y >= 0:
        raise CaseError(f"{path}: its rows do not run from west to east, north to south")
    low, high = np.array([west, north + y * rows]), np.array([west + x * columns, north])
    box = part(head["label"], (low, high)) if part else None
    if box is None:
        return 0, 0, columns, rows
    left, right = sorted((v - west) / x for v in (box[0][0], box[1][0]))
    top, bottom = sorted((v - north) / y for v in (box[0][1], box[1][1]))
    first = [max(0, math.floor(v) - 2) for v in (left, top)]
    last = [min(size, math.ceil(v) + 2) for v, size in ((right, columns), (bottom, rows))]
    if last[0] - first[0] < 2 or last[1] - first[1] < 2:
        raise CaseError(
            f"{path}: reaches from ({coordinates(low)}) to ({coordinates(high)}), and does not cover "
            f"the required area, ({coordinates(box[0])}) to ({coordinates(box[1])})"
        )
    return first[0], first[1], last[0] - first[0], last[1] - first[1]


def _refuse_other_units(path: Path, label: str | None) -> None:
    if label is None:
        return
    try:
        system = look_up(label)
    except BackendError:  # the extra is needed to read a .prj beside ESRI ASCII
        return
    name = ":".join(system.to_authority() or [f"'{system.name}'"])
    if system.is_geographic:
        raise CaseError(
            f"{path}: is in degrees ({name}); project it to metres first, e.g. with gdalwarp -t_srs"
        )
    factor = system.axis_info[0].unit_conversion_factor
    if abs(factor - 1) > 1e-9:
        raise CaseError(
            f"{path}: is in {system.axis_info[0].unit_name} ({name}), not in metres; project it first, "
            "e.g. with gdalwarp -t_srs"
        )


def _sidecar(path: Path) -> str | None:
    """The projection in a .prj file of the same name."""
    beside = path.with_suffix(".prj")
    return read_text(beside, "projection of the grid").strip() or None if is_file(beside) else None


def _ascii_grid(path: Path, text: str) -> tuple[dict[str, Any], Floats]:
    """The head of a grid in the form of `gdal_grids`, and its heights, rows from the north."""
    lines = text.splitlines()
    head, count = _grid_head(path, lines)
    corner = "xllcorner" in head
    needed = ["ncols", "nrows", "cellsize"]
    needed += ["xllcorner", "yllcorner"] if corner else ["xllcenter", "yllcenter"]
    missing = [key for key in needed if key not in head]
    if missing:
        raise CaseError(f"{path}: not an ESRI ASCII grid: its head has no {', '.join(missing)}")
    if not all(math.isfinite(head[key]) for key in needed) or head["cellsize"] <= 0:
        raise CaseError(f"{path}: its head has a number that is not finite, or no cellsize above 0")
    columns, rows, step = int(head["ncols"]), int(head["nrows"]), head["cellsize"]
    try:
        values = np.array(" ".join(lines[count:]).split(), float)
    except ValueError as error:
        raise CaseError(f"{path}: {error}") from None
    if len(values) != rows * columns:
        raise CaseError(
            f"{path}: contains {len(values)} heights, but its head says {rows} x {columns}"
        )
    values[values == head.get("nodata_value", NOTHING)] = np.nan
    shift = 0.0 if corner else step / 2
    west = head["xllcorner" if corner else "xllcenter"] - shift
    south = head["yllcorner" if corner else "yllcenter"] - shift
    place = [step, 0.0, west, 0.0, -step, south + rows * step]
    return {"place": place, "size": [columns, rows], "unit": ""}, values.reshape(rows, columns)


def _grid_head(path: Path, lines: list[str]) -> tuple[dict[str, float], int]:
    """Numbers of the head by name, and its number of lines."""
    head: dict[str, float] = {}
    for count, line in enumerate(lines):
        words = line.split()
        if len(words) != 2 or not words[0][0].isalpha():
            return head, count
        try:
            head[words[0].lower()] = float(words[1])
        except ValueError:
            raise CaseError(f"{path}:{count + 1}: '{words[1]}' is not a number") from None
    return head, len(lines)
