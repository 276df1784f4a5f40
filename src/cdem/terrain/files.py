"""Readers of terrain: contour lines (GeoJSON, CSV), grids (ESRI ASCII, GeoTIFF), outlines (GeoJSON)."""

from __future__ import annotations

import csv
import json
import math
import re
from collections.abc import Iterator
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import is_file, read_text, reading
from cdem.errors import CaseError
from cdem.terrain.heights import Grid, extra

Floats = NDArray[np.float64]
ELEVATION = re.compile(r"(elev|height|alt|contour|level|z$|h$|hoehe|quota)", re.IGNORECASE)
COLUMNS = {
    "x": re.compile(r"(x|east)", re.IGNORECASE),
    "y": re.compile(r"(y|north)", re.IGNORECASE),
    "z": ELEVATION,
}
GEOJSON = (".geojson", ".json")
CONVERT = "convert others with ogr2ogr -f GeoJSON NEW.geojson OLD"
WHAT = "terrain file"
LINE = re.compile(r"(line|id|contour_?id)", re.IGNORECASE)


def read_lines(path: Path, elevation: str | None = None) -> list[Floats]:
    """Read lines of known height, each an array of points [m], shape (points, 3).

    Args:
        path: GeoJSON (``.geojson``, ``.json``) of lines with a height among their properties or in
            their coordinates, or CSV (``.csv``, ``.txt``) with columns x, y, z and, where lines
            follow one another, one with the number of the line.
        elevation: Name of the property or column that holds the height; found by itself if None.

    Raises:
        CaseError: The file is missing, of another kind, has no heights, or is in degrees.
    """
    kind = path.suffix.lower()
    if kind not in (*GEOJSON, ".csv", ".txt"):
        raise CaseError(
            f"{path}: contours are read from .geojson or .csv ({CONVERT}); a grid goes to 'grid'"
        )
    with reading(path, CaseError, "contours are GeoJSON or CSV"):
        text = read_text(path, WHAT)
        read = _geojson_lines if kind in GEOJSON else _csv_lines
        lines = [line for line in read(path, text, elevation) if len(line)]
    if not lines:
        raise CaseError(f"{path}: holds no lines")
    if len({float(z) for line in lines for z in line[:, 2]}) < 2:
        raise CaseError(
            f"{path}: all points have the same height {lines[0][0, 2]:g}; if the heights stand in "
            "another property or column, name it with 'elevation'"
        )
    _refuse_degrees(path, np.concatenate(lines))
    return lines


def read_outline(path: Path) -> Floats:
    """Read the first polygon or closed line of a GeoJSON file: its corners [m], shape (corners, 2).

    Raises:
        CaseError: The file holds no polygon, or its outline is open.
    """
    if path.suffix.lower() not in GEOJSON:
        raise CaseError(f"{path}: outlines are read from .geojson ({CONVERT})")
    with reading(path, CaseError, "an outline is a polygon or closed line in GeoJSON"):
        return _outline(path)


def _outline(path: Path) -> Floats:
    for geometry, _ in _geometries(path, read_text(path, WHAT)):
        kind, points = geometry.get("type"), geometry.get("coordinates", [])
        if kind == "Polygon":
            points = points[0] if points else []
        elif kind != "LineString":
            continue
        ring = np.array([p[:2] for p in points], float)
        if ring.ndim != 2 or ring.shape[1] != 2 or not np.isfinite(ring).all():
            raise CaseError(f"{path}: its {kind} is not a list of points [x, y]")
        if len(ring) < 4 or (ring[0] != ring[-1]).any():
            raise CaseError(
                f"{path}: the outline is open: it starts at {ring[0].tolist()} and ends at "
                f"{ring[-1].tolist()}; end it where it starts"
            )
        return ring[:-1]
    raise CaseError(f"{path}: holds no polygon")


def read_grid(path: Path) -> Grid:
    """Read a grid of heights: ESRI ASCII (``.asc``) or GeoTIFF (``.tif``).

    Raises:
        CaseError: The file is missing, not such a grid, or in degrees.
    """
    kind = path.suffix.lower()
    if kind in (".asc", ".grd", ".txt"):
        with reading(path, CaseError, "a grid is ESRI ASCII or GeoTIFF"):
            return _ascii_grid(path, read_text(path, WHAT))
    if kind in (".tif", ".tiff"):
        rasterio = extra("rasterio")
        with reading(path, CaseError, "a grid is ESRI ASCII or GeoTIFF"):
            return _geotiff(path, rasterio)
    raise CaseError(
        f"{path}: grids are read from .asc (ESRI ASCII) or .tif (GeoTIFF); gdal_translate makes them"
    )


def _refuse_degrees(path: Path, points: Floats) -> None:
    """Longitudes and latitudes lie within a few units of one another; terrain does not."""
    x, y = points[:, 0], points[:, 1]
    size = max(np.ptp(x), np.ptp(y))
    if np.abs(x).max() <= 180 and np.abs(y).max() <= 90 and np.ptp(points[:, 2]) > 20 * size:
        raise CaseError(
            f"{path}: looks like longitude and latitude in degrees ({size:.3g} wide, "
            f"{np.ptp(points[:, 2]):.3g} high); project it to metres first, e.g. with ogr2ogr -t_srs"
        )


# ------------------------------------------------------------------ GeoJSON and CSV


def _geometries(path: Path, text: str) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    if text.lstrip().startswith("<"):
        raise CaseError(f"{path}: is KML or another XML, not GeoJSON; {CONVERT}")
    try:
        data = json.loads(text)
    except json.JSONDecodeError as error:
        raise CaseError(f"{path}:{error.lineno}:{error.colno}: not JSON: {error.msg}") from None
    features = data.get("features", [data]) if isinstance(data, dict) else None
    if not isinstance(features, list) or not all(isinstance(f, dict) for f in features):
        raise CaseError(f"{path}: not GeoJSON: no features in it")
    for feature in features:
        geometry, properties = feature.get("geometry") or feature, feature.get("properties") or {}
        if not isinstance(geometry, dict) or not isinstance(properties, dict):
            raise CaseError(f"{path}: not GeoJSON: a geometry or properties are no {{...}}")
        yield geometry, properties


def _geojson_lines(path: Path, text: str, elevation: str | None) -> Iterator[Floats]:
    for number, (geometry, properties) in enumerate(_geometries(path, text)):
        kind, points = geometry.get("type"), geometry.get("coordinates", [])
        if kind not in ("LineString", "MultiLineString"):
            continue
        for part in [points] if kind == "LineString" else points:
            try:
                line = np.array(part, float)
            except (TypeError, ValueError):
                line = np.zeros(0)
            if line.ndim != 2 or line.shape[1] not in (2, 3) or not np.isfinite(line).all():
                raise CaseError(f"{path}: feature {number} is not a list of points [x, y]")
            if line.shape[1] == 2 or elevation is not None:
                z = _property(path, number, properties, elevation)
                line = np.column_stack([line[:, :2], np.full(len(line), z)])
            yield line


def _property(path: Path, number: int, properties: dict, elevation: str | None) -> float:
    names = [elevation] if elevation else [n for n in properties if ELEVATION.match(n)]
    try:
        return float(properties[names[0]])
    except (KeyError, IndexError, TypeError, ValueError):
        has = ", ".join(properties) or "none"
        raise CaseError(
            f"{path}: feature {number} has no height; name its property with 'elevation' "
            f"(it has: {has})"
        ) from None


def _csv_lines(path: Path, text: str, elevation: str | None) -> Iterator[Floats]:
    rows = [r for r in csv.reader(text.splitlines(), skipinitialspace=True) if r and any(r)]
    if not rows:
        raise CaseError(f"{path}: is empty")
    head = [name.strip().lstrip("#").strip() for name in rows[0]]
    at = _columns(path, head, elevation)
    line_at = next((i for i, n in enumerate(head) if LINE.match(n) and i not in at.values()), None)
    labelled = []
    for number, row in enumerate(rows[1:], start=2):
        point = _point(path, number, row, at)
        if line_at is not None and line_at >= len(row):
            raise CaseError(f"{path}: row {number} has no {head[line_at]}: {','.join(row)}")
        # without a column of lines each point stands for itself
        labelled.append((number if line_at is None else row[line_at], point))
    for _, line in groupby(labelled, key=itemgetter(0)):
        yield np.array([point for _, point in line])


def _columns(path: Path, head: list[str], elevation: str | None) -> dict[str, int]:
    """Where the columns x, y and z stand; z is that of the elevation, if one is named."""
    found = {}
    for key, pattern in COLUMNS.items():
        named = key == "z" and elevation
        for i, name in enumerate(head):
            if name == elevation if named else pattern.match(name):
                found[key] = i
                break
        else:
            raise CaseError(
                f"{path}: the first line must name the columns x, y and z (or elevation), e.g. "
                f"'line,x,y,z'; it says: {', '.join(head)}"
            )
    return found


def _point(path: Path, number: int, row: list[str], at: dict[str, int]) -> list[float]:
    try:
        point = [float(row[at[key]]) for key in "xyz"]
    except (ValueError, IndexError):
        point = [math.nan]
    if not all(map(math.isfinite, point)):
        raise CaseError(f"{path}: row {number} has no numbers x, y, z: {','.join(row)}")
    return point


# ------------------------------------------------------------------ grids


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
    return _checked(path, Grid(west, south, (step, step), values.reshape(rows, columns)[::-1]))


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


def _geotiff(path: Path, rasterio: Any) -> Grid:
    if not is_file(path):
        raise CaseError(f"{path}: cannot read the {WHAT}: No such file or directory")
    try:
        # other drivers of GDAL would follow links to other files, and into the net
        with rasterio.open(path, driver="GTiff") as file:
            values = file.read(1, masked=True).astype(float).filled(np.nan)
            place, system = file.transform, file.crs
    except rasterio.errors.RasterioError as error:
        raise CaseError(f"{path}: not a GeoTIFF: {error}") from None
    if system is not None and system.is_geographic:
        raise CaseError(
            f"{path}: is in degrees ({system.to_string()}); project it to metres first, e.g. with "
            "gdalwarp -t_srs"
        )
    if system is not None and abs(system.linear_units_factor[1] - 1) > 1e-9:
        raise CaseError(
            f"{path}: is in {system.linear_units_factor[0]} ({system.to_string()}), not in metres; "
            "project it first, e.g. with gdalwarp -t_srs"
        )
    if place.b or place.d or place.a <= 0 or place.e >= 0:
        raise CaseError(f"{path}: its rows do not run from west to east, north to south")
    west, north = place.c + place.a / 2, place.f + place.e / 2
    south = north + place.e * (len(values) - 1)
    return _checked(path, Grid(west, south, (place.a, -place.e), values[::-1]))


def _checked(path: Path, grid: Grid) -> Grid:
    if min(grid.values.shape) < 2:
        raise CaseError(f"{path}: a grid needs at least two rows and two columns")
    known = np.isfinite(grid.values)
    if not known.any():
        raise CaseError(f"{path}: holds no heights, all cells are without data")
    rows, columns = grid.values.shape
    x = grid.west + grid.step[0] * np.arange(columns)
    y = grid.south + grid.step[1] * np.arange(rows)
    corners = np.array(
        [[x[0], y[0], grid.values[known].min()], [x[-1], y[-1], grid.values[known].max()]]
    )
    _refuse_degrees(path, corners)
    return grid
