"""The ground that is screened: a grid of heights, or the terrain of a landslide file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cdem.case.input_file import is_file
from cdem.errors import CaseError
from cdem.terrain import Landslide
from cdem.terrain.files import read_grid
from cdem.terrain.heights import Grid, Heights, extra
from cdem.units import coordinates

MOST_CELLS = 25_000_000


def read_ground(path: Path, cell: float | None = None) -> tuple[Grid, str | None]:
    """Read the heights to screen.

    Args:
        path: A grid (`.asc`, `.tif`), or a landslide file (`.yaml`) whose terrain and extent count.
        cell: Side of the cells [m]; by default those of the grid, or half of `sizes.body` where
            there is none.

    Returns:
        The heights, and their map projection: EPSG code or WKT, or None.

    Raises:
        CaseError: A file cannot be read, or the cells are too many.
    """
    if path.suffix.lower() not in (".yaml", ".yml"):
        grid = read_grid(path)
        return (grid if cell is None else _sampled(grid, grid.low, grid.high, cell)), _system(path)
    landslide = Landslide.load(path)
    ground, extent = landslide.ground(), landslide.extent
    low, high = np.array([extent.x[0], extent.y[0]]), np.array([extent.x[1], extent.y[1]])
    if (low < ground.low - 1e-6).any() or (high > ground.high + 1e-6).any():
        raise landslide.error(
            "extent",
            f"reaches beyond the terrain, which is known from ({coordinates(ground.low)}) to "
            f"({coordinates(ground.high)})",
        )
    file = landslide.terrain.grid
    system = None if file is None else _system(path.parent / file)
    if cell is None and isinstance(ground, Grid):
        return _cropped(ground, low, high), system
    if cell is None:
        cell = landslide.sizes.body / 2
    return _sampled(ground, low, high, cell), system


def _cropped(grid: Grid, low: Any, high: Any) -> Grid:
    """The cells of a grid whose centres lie in a rectangle."""
    rows, columns = grid.values.shape
    x = grid.west + grid.step[0] * np.arange(columns)
    y = grid.south + grid.step[1] * np.arange(rows)
    i = np.flatnonzero((y >= low[1]) & (y <= high[1]))
    j = np.flatnonzero((x >= low[0]) & (x <= high[0]))
    if min(len(i), len(j)) < 2:
        raise CaseError("the extent holds less than two rows and columns of the grid")
    return Grid(x[j[0]], y[i[0]], grid.step, grid.values[i[0] : i[-1] + 1, j[0] : j[-1] + 1])


def _sampled(heights: Heights, low: Any, high: Any, cell: float) -> Grid:
    """Heights at the centres of cells in a rectangle."""
    if not (np.isfinite(cell) and cell > 0):
        raise CaseError(f"cells must be larger than 0 m, got {cell:g}")
    columns, rows = np.floor((high - low) / cell * (1 + 1e-12)).astype(int)
    if min(rows, columns) < 2 or rows * columns > MOST_CELLS:
        raise CaseError(
            f"cells of {cell:g} m make a map of {rows:,} x {columns:,}; give another cell"
        )
    x = low[0] + cell * (np.arange(columns) + 0.5)
    y = low[1] + cell * (np.arange(rows) + 0.5)
    xy = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return Grid(x[0], y[0], (cell, cell), heights(xy).reshape(rows, columns))


def _system(path: Path) -> str | None:
    """Map projection of a grid as WKT: of a GeoTIFF, or of the `.prj` beside an ASCII grid."""
    rasterio = extra("rasterio")
    if path.suffix.lower() in (".tif", ".tiff"):
        with rasterio.open(path, driver="GTiff") as file:
            return file.crs and file.crs.to_wkt()
    beside = path.with_suffix(".prj")
    if not is_file(beside):
        return None
    try:
        return rasterio.crs.CRS.from_wkt(beside.read_text()).to_wkt()
    except (OSError, ValueError, rasterio.errors.CRSError):
        raise CaseError(f"{beside}: is no map projection (WKT); mend it or take it away") from None
