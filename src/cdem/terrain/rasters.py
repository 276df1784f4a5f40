"""Readers of grids of heights: ESRI ASCII by itself; GeoTIFF, VRT and Surfer by rasterio."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import is_file, read_text, reading
from cdem.case.map_system import look_up
from cdem.errors import BackendError, CaseError
from cdem.terrain.heights import Grid, extra, refuse_degrees
from cdem.units import coordinates

Floats = NDArray[np.float64]
Box = tuple[Floats, Floats]  # south-west and north-east corner, in the units of a file
Part = Callable[[str | None, Box], Box | None]  # from the label and all of a file
ASCII = (".asc", ".grd", ".txt")
DRIVERS = {".tif": "GTiff", ".tiff": "GTiff", ".vrt": "VRT"}
SURFER = {b"DSAA": "GSAG", b"DSBB": "GSBG", b"DSRB": "GS7BG"}
KINDS = ".asc (ESRI ASCII), .tif (GeoTIFF), .vrt or .grd"
MEND = f"a grid is one of {KINDS}"
WHAT = "terrain file"
# a VRT may name other files; none from the net, and no code
CLOSED = {
    "CPL_VSIL_CURL_ALLOWED_EXTENSIONS": ".none",
    "GDAL_VRT_ENABLE_PYTHON": "NO",
    "GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR",
}


@dataclass
class Raster:
    """A grid as its file has it.

    Attributes:
        grid: Heights, in the units and the projection of the file.
        label: What it says of its projection, for `look_up`; None if it says nothing.
        unit: Unit of its heights as it says; empty if it says nothing.
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
    """What a grid says of its projection; None if it says nothing, or its kind cannot."""
    driver = _driver(path)
    if driver is None:
        return _sidecar(path)
    with reading(path, CaseError, MEND):
        return _opened(path, driver, lambda file: file.crs and file.crs.to_wkt())


def read_raster(path: Path, part: Part | None = None) -> Raster:
    """Read a grid.

    Args:
        path: ``.asc``, ``.grd``, ``.tif``, ``.tiff`` or ``.vrt``.
        part: The part that is needed, from the label and the box of all; by default all is read.

    Raises:
        CaseError: The file is missing, not such a grid, or has no heights there.
    """
    driver = _driver(path)
    with reading(path, CaseError, MEND):
        if driver is None:
            raster = Raster(_ascii_grid(path, read_text(path, WHAT)), _sidecar(path))
        else:
            raster = _opened(path, driver, lambda file: _read(path, file, part))
    if min(raster.grid.values.shape) < 2:
        raise CaseError(f"{path}: a grid needs at least two rows and two columns")
    if not np.isfinite(raster.grid.values).any():
        raise CaseError(f"{path}: holds no heights, all cells are without data")
    return raster


def _driver(path: Path) -> str | None:
    """Driver of GDAL that reads a file; None for ESRI ASCII."""
    kind = path.suffix.lower()
    if kind not in (*ASCII, *DRIVERS):
        raise CaseError(f"{path}: grids are read from {KINDS}; gdal_translate makes them")
    if kind == ".grd" and is_file(path):
        with path.open("rb") as file:
            return SURFER.get(file.read(4))
    return DRIVERS.get(kind)


def _opened(path: Path, driver: str, use: Callable[[Any], Any]) -> Any:
    if not is_file(path):
        raise CaseError(f"{path}: cannot read the {WHAT}: No such file or directory")
    rasterio = extra("rasterio")
    try:
        # other drivers of GDAL would follow links to other files, and into the net
        with rasterio.Env(**CLOSED), rasterio.open(path, driver=driver) as file:
            return use(file)
    except rasterio.errors.RasterioError as error:
        name = {"GTiff": "GeoTIFF", "VRT": "VRT"}.get(driver, "Surfer grid")
        raise CaseError(f"{path}: not a {name}: {error}") from None


def _read(path: Path, file: Any, part: Part | None) -> Raster:
    place, label = file.transform, file.crs and file.crs.to_wkt()
    if place.b or place.d or place.a <= 0 or place.e >= 0:
        raise CaseError(f"{path}: its rows do not run from west to east, north to south")
    b = file.bounds
    box = part(label, (np.array([b.left, b.bottom]), np.array([b.right, b.top]))) if part else None
    window = None if box is None else _window(path, file, box)
    values = file.read(1, masked=True, window=window).astype(float).filled(np.nan)
    values = values * file.scales[0] + file.offsets[0]
    if window is not None:
        place = file.window_transform(window)
    west, north = place.c + place.a / 2, place.f + place.e / 2
    south = north + place.e * (len(values) - 1)
    grid = Grid(west, south, (place.a, -place.e), values[::-1])
    return Raster(grid, label, (file.units[0] or "").strip())


def _window(path: Path, file: Any, box: Box) -> Any:
    """The cells that a box covers, two more around it."""
    windows = extra("rasterio.windows")
    place = file.transform
    left, right = sorted((x - place.c) / place.a for x in (box[0][0], box[1][0]))
    top, bottom = sorted((y - place.f) / place.e for y in (box[0][1], box[1][1]))
    first = [max(0, math.floor(v) - 2) for v in (left, top)]
    last = [min(size, math.ceil(v) + 2) for v, size in ((right, file.width), (bottom, file.height))]
    if last[0] - first[0] < 2 or last[1] - first[1] < 2:
        b = file.bounds
        raise CaseError(
            f"{path}: reaches from ({coordinates((b.left, b.bottom))}) to "
            f"({coordinates((b.right, b.top))}), and does not cover what is needed, "
            f"({coordinates(box[0])}) to ({coordinates(box[1])})"
        )
    return windows.Window(*first, last[0] - first[0], last[1] - first[1])


def _refuse_other_units(path: Path, label: str | None) -> None:
    if label is None:
        return
    try:
        system = look_up(label)
    except BackendError:  # without the extra a .prj beside ESRI ASCII is not understood
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
    """The projection in a file of the same name that ends in .prj."""
    beside = path.with_suffix(".prj")
    return read_text(beside, "projection of the grid").strip() or None if is_file(beside) else None


def _ascii_grid(path: Path, text: str) -> Grid:
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
            f"{path}: holds {len(values)} heights, but its head says {rows} x {columns}"
        )
    values[values == head.get("nodata_value", -9999.0)] = np.nan
    shift = step / 2 if corner else 0.0
    west = head["xllcorner" if corner else "xllcenter"] + shift
    south = head["yllcorner" if corner else "yllcenter"] + shift
    return Grid(west, south, (step, step), values.reshape(rows, columns)[::-1])


def _grid_head(path: Path, lines: list[str]) -> tuple[dict[str, float], int]:
    """Numbers of the head by their names, and the number of its lines."""
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
