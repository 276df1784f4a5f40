"""Grids in metres and one projection, without gaps: resampled once, cubic."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cdem.case.map_system import look_up
from cdem.errors import CaseError
from cdem.terrain.clouds import KINDS, read_cloud, read_cloud_label
from cdem.terrain.heights import Grid, extra
from cdem.terrain.projection import Projection, horizontal, moved, vertical_name
from cdem.terrain.rasters import Box, read_label, read_raster
from cdem.units import coordinates

Floats = NDArray[np.float64]
UNITS = {"m": 1.0, "ft": 0.3048, "us-ft": 1200 / 3937, "cm": 0.01, "dm": 0.1}
"""Units of heights, in metres."""
OTHER_NAMES = {
    "metre": "m", "meter": "m", "metres": "m", "meters": "m", "foot": "ft", "feet": "ft",
    "us survey foot": "us-ft", "us survey feet": "us-ft", "foot_us": "us-ft", "ftus": "us-ft",
}  # fmt: skip


@dataclass
class Wanted:
    """Requirements for a grid.

    Attributes:
        box: South-west and north-east corner of the required part, in the target [m].
        told: Its projection as given by the user, or None.
        cell: Distance of points, or None to keep the file's [m].
        unit: Unit of its heights as given by the user, or None.
        nodata: Further values for missing data.
        classes: Points of a cloud to use: "ground" (class 2), or "all".
    """

    box: Box
    told: str | None = None
    cell: float | None = None
    unit: str | None = None
    nodata: list[float] | None = None
    classes: str = "ground"


def label_of(path: Path) -> str | None:
    """Projection named in a grid or point cloud, for `look_up`, or None."""
    return read_cloud_label(path) if path.suffix.lower() in KINDS else read_label(path)


def read_heights(path: Path, projection: Projection, wanted: Wanted) -> Grid:
    """Read a grid of heights, or a point cloud, and transform it to metres in the landslide's
    projection.

    Raises:
        CaseError: The file cannot be read, or its projection or unit cannot be true.
    """
    if path.suffix.lower() in KINDS:
        return _of_cloud(path, projection, wanted)
    raster = read_raster(path, lambda label, whole: _part(path, label, whole, projection, wanted))
    projection.same_heights(path, wanted.told or raster.label)
    own = projection.own(path, raster.label, wanted.told, raster.grid.low, raster.grid.high)
    values = raster.grid.values * metres_of_heights(
        path, wanted.told or raster.label, raster.unit, wanted.unit, projection
    )
    for value in wanted.nodata or []:
        values[raster.grid.values == value] = np.nan
    grid = Grid(raster.grid.west, raster.grid.south, raster.grid.step, values)
    if own is not None or wanted.cell is not None:
        source = own if own is not None else projection.target
        grid = _warped(path, grid, source, projection, wanted)
    if not np.isfinite(grid.values).any():
        raise CaseError(f"{path}: has no heights in the required area")
    return grid


def _of_cloud(path: Path, projection: Projection, wanted: Wanted) -> Grid:
    label = label_of(path)
    projection.same_heights(path, wanted.told or label)
    grid = read_cloud(path, projection, wanted.told, wanted.box, wanted.cell, wanted.classes)
    values = grid.values * metres_of_heights(
        path, wanted.told or label, "", wanted.unit, projection
    )
    return trimmed(Grid(grid.west, grid.south, grid.step, values))


def _part(
    path: Path, label: str | None, whole: Box, projection: Projection, wanted: Wanted
) -> Box | None:
    """The required part of a file, in its own units; None for all of it."""
    own = projection.own(path, label, wanted.told, *whole)
    if not np.isfinite(wanted.box).all():
        return None
    if own is None:
        return wanted.box
    ring = moved(_edge(*wanted.box), projection.target, own)
    return ring.min(axis=0), ring.max(axis=0)


def _edge(low: Floats, high: Floats) -> Floats:
    """Points along the edge of a rectangle, which may be curved in another projection."""
    t = np.linspace(0, 1, 21)[:, None]
    corners = np.array([low, [high[0], low[1]], high, [low[0], high[1]], low])
    return np.concatenate([a + (b - a) * t for a, b in pairwise(corners)])


def metres_of_heights(
    path: Path,
    label: str | None,
    unit: str,
    told: str | None,
    projection: Projection,
) -> float:
    """Metres per unit of the heights: as given, as in the band, or as in the vertical datum.

    Args:
        path: The file.
        label: Its projection, given by the user or named in the file, or None.
        unit: Unit of heights named in the file, or empty.
        told: Unit given by the user, or None.
        projection: Receives notes on assumptions.

    Raises:
        CaseError: The unit is unknown, or missing while the projection is in feet.
    """
    if told is not None:
        return UNITS[told]
    named = OTHER_NAMES.get(unit.lower(), unit.lower())
    if named and named not in UNITS:
        raise CaseError(
            f"{path}: its heights are in '{unit}'; write 'unit' beside it, one of {', '.join(UNITS)}"
        )
    factor = UNITS[named] if named else _axis_factor(path, label)
    if factor != 1.0:
        projection.tell(f"{path.name}: its heights are multiplied by {factor:.10g}")
    return factor


def _axis_factor(path: Path, label: str | None) -> float:
    system = look_up(label) if label is not None else None
    if system is None:
        return 1.0
    if vertical_name(system) is not None:
        return float(system.axis_info[-1].unit_conversion_factor)
    plan = horizontal(system)
    if plan.is_projected and abs(plan.axis_info[0].unit_conversion_factor - 1) > 1e-9:
        raise CaseError(
            f"{path}: its projection is in {plan.axis_info[0].unit_name}, but it does not name the "
            f"unit "
            "of its heights; write 'unit' beside it (--unit), us-ft, ft or m"
        )
    return 1.0


def _warped(path: Path, grid: Grid, source: Any, projection: Projection, wanted: Wanted) -> Grid:
    """A grid with lines at multiples of the cell, resampled by cubic interpolation."""
    warp = extra("rasterio.warp")
    transform = extra("rasterio.transform")
    crs = extra("rasterio.crs").CRS
    system = projection.target
    if source is None:  # all in the same metres: any projection works
        source = system = extra("pyproj").CRS.from_epsg(32631)
    cell = wanted.cell or _native(grid, source, system)
    low = np.floor(np.array(wanted.box[0]) / cell - 1) * cell
    high = np.ceil(np.array(wanted.box[1]) / cell + 1) * cell
    columns, rows = (np.round((high - low) / cell)).astype(int).tolist()
    out = np.full((rows, columns), np.nan)
    # GDAL averages over larger cells; for slightly larger ones this is uneven, by 0.1 m at 30 deg
    sharp = {"XSCALE": 1.0, "YSCALE": 1.0} if cell < 2 * _native(grid, source, system) else {}
    warp.reproject(
        np.ascontiguousarray(grid.values[::-1]),
        out,
        src_transform=transform.from_origin(grid.low[0], grid.high[1], *grid.step),
        src_crs=crs.from_wkt(horizontal(source).to_wkt()),
        src_nodata=np.nan,
        dst_transform=transform.from_origin(low[0], high[1], cell, cell),
        dst_crs=crs.from_wkt(horizontal(system).to_wkt()),
        dst_nodata=np.nan,
        resampling=warp.Resampling.cubic,
        tolerance=0.0,
        **sharp,
    )
    if not np.isfinite(out).any():
        raise CaseError(f"{path}: does not cover the required area")
    projection.tell(f"{path.name}: resampled once, cubic, to cells of {cell:.6g} m")
    return trimmed(Grid(low[0] + cell / 2, low[1] + cell / 2, (cell, cell), out[::-1].copy()))


def _native(grid: Grid, source: Any, target: Any) -> float:
    """Distance of points that keeps the detail of a grid, with two digits [m]."""
    middle = (grid.low + grid.high) / 2
    steps = middle + np.array([[0, 0], [grid.step[0], 0], [0, grid.step[1]]])
    there = moved(steps, source, target)
    size = float(np.hypot(*(there[1:] - there[0]).T).min())
    digits = 1 - math.floor(math.log10(size))
    return round(size, digits)


def trimmed(grid: Grid) -> Grid:
    """A grid without gaps at its edges: the side with most gaps is removed first."""
    known = np.isfinite(grid.values)
    rows, columns = np.flatnonzero(known.any(axis=1)), np.flatnonzero(known.any(axis=0))
    south, north, west, east = rows[0], rows[-1] + 1, columns[0], columns[-1] + 1
    while min(north - south, east - west) > 2:
        sides = {
            "south": known[south, west:east],
            "north": known[north - 1, west:east],
            "west": known[south:north, west],
            "east": known[south:north, east - 1],
        }
        side = max(sides, key=lambda name: 1 - sides[name].mean())
        if sides[side].all():
            break
        south, west = south + (side == "south"), west + (side == "west")
        north, east = north - (side == "north"), east - (side == "east")
    x = grid.west + grid.step[0] * west
    y = grid.south + grid.step[1] * south
    return Grid(float(x), float(y), grid.step, grid.values[south:north, west:east])


def filled(
    path: Path, grid: Grid, fill: float | Literal["all"], outlines: list[Floats]
) -> tuple[Grid, list[str]]:
    """A grid with gaps filled from their edges.

    Args:
        path: Its file.
        grid: The grid.
        fill: Longest distance over which a gap is filled [m]; "all": any, also in outlines.
        outlines: Corners of the bodies [m].

    Returns:
        The grid, and a note on filled cells.

    Raises:
        CaseError: A gap touches an outline.
    """
    gaps = ~np.isfinite(grid.values)
    if not gaps.any():
        return grid, []
    shapely = extra("shapely")
    reach = max(grid.values.shape) if fill == "all" else fill / min(grid.step)
    source = np.where(gaps, 0.0, grid.values).astype(np.float32)
    values = extra("rasterio.fill").fillnodata(
        source, (~gaps).astype(np.uint8), max_search_distance=float(reach)
    )
    near = extra("scipy.ndimage").distance_transform_edt(gaps, sampling=grid.step[::-1])
    done = gaps & (near <= (np.inf if fill == "all" else fill))
    rows, columns = np.nonzero(done)
    at = np.column_stack([grid.west + grid.step[0] * columns, grid.south + grid.step[1] * rows])
    inside = np.zeros(len(at), bool)
    for outline in outlines:
        reach_of_cell = shapely.Polygon(outline).buffer(max(grid.step))
        inside |= shapely.contains_xy(reach_of_cell, at)
    if inside.any() and fill != "all":
        raise CaseError(
            f"{path}: has a gap in an outline, at ({coordinates(at[inside][0])}); "
            "its ground would be guessed: write fill: all to accept that"
        )
    out = np.where(done, values.astype(float), grid.values)
    note = f"{path.name}: {int(done.sum())} cells without data filled"
    if inside.any():
        note += f", {int(inside.sum())} of them in outlines"
    return Grid(grid.west, grid.south, grid.step, out), [note]
