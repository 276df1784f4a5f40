"""The ground to screen: a grid of heights, or the terrain of a landslide file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cdem.case.map_system import look_up
from cdem.errors import CaseError
from cdem.terrain import Landslide
from cdem.terrain.heights import Grid, Heights
from cdem.terrain.projection import name_of
from cdem.terrain.rasters import read_grid, read_label
from cdem.units import coordinates

MOST_CELLS = 25_000_000


def read_ground(path: Path, cell: float | None = None) -> tuple[Grid, str | None, list[str]]:
    """Read the heights to screen.

    Args:
        path: A grid (`.asc`, `.tif`), or a landslide file (`.yaml`) with terrain and extent.
        cell: Size of the cells [m]; by default the grid's, or half of `sizes.body` without a
            grid.

    Returns:
        The heights; their map projection, EPSG code or WKT, or None; and messages for the user.

    Raises:
        CaseError: A file cannot be read, or the cells are too many.
    """
    if path.suffix.lower() not in (".yaml", ".yml"):
        grid, label = read_grid(path), read_label(path)
        if cell is not None:
            grid = _sampled(grid, grid.low, grid.high, cell)
        return grid, None if label is None else name_of(look_up(label)), []
    landslide = Landslide.load(path)
    ground, extent = landslide.ground(), landslide.extent
    low, high = np.array([extent.x[0], extent.y[0]]), np.array([extent.x[1], extent.y[1]])
    if (low < ground.low - 1e-6).any() or (high > ground.high + 1e-6).any():
        raise landslide.error(
            "extent",
            f"reaches beyond the terrain, which extends from ({coordinates(ground.low)}) to "
            f"({coordinates(ground.high)})",
        )
    if cell is None and isinstance(ground, Grid):
        grid = _cropped(ground, low, high)
    else:
        grid = _sampled(ground, low, high, cell or landslide.sizes.body / 2)
    return grid, landslide.system, list(landslide.projection.notes)


def _cropped(grid: Grid, low: Any, high: Any) -> Grid:
    """The cells of a grid with centres in a rectangle."""
    rows, columns = grid.values.shape
    x = grid.west + grid.step[0] * np.arange(columns)
    y = grid.south + grid.step[1] * np.arange(rows)
    i = np.flatnonzero((y >= low[1]) & (y <= high[1]))
    j = np.flatnonzero((x >= low[0]) & (x <= high[0]))
    if min(len(i), len(j)) < 2:
        raise CaseError(
            "the extent contains less than two rows and columns of the grid; enlarge it"
        )
    return Grid(x[j[0]], y[i[0]], grid.step, grid.values[i[0] : i[-1] + 1, j[0] : j[-1] + 1])


def _sampled(heights: Heights, low: Any, high: Any, cell: float) -> Grid:
    """Heights at the centres of cells in a rectangle."""
    if not (np.isfinite(cell) and cell > 0):
        raise CaseError(f"cells must be larger than 0 m, got {cell:g}")
    columns, rows = np.floor((high - low) / cell * (1 + 1e-12)).astype(int)
    if min(rows, columns) < 2 or rows * columns > MOST_CELLS:
        raise CaseError(
            f"cells of {cell:g} m give a map of {rows:,} x {columns:,}; give another cell"
        )
    x = low[0] + cell * (np.arange(columns) + 0.5)
    y = low[1] + cell * (np.arange(rows) + 0.5)
    xy = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return Grid(x[0], y[0], (cell, cell), heights(xy).reshape(rows, columns))
