"""The map of a deposit's thickness, and its ESRI ASCII grid."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.element_volumes import Solids
from cdem.run.flow_maps import TRACE, check_size
from cdem.terrain.rasters import NOTHING, Raster

Floats = NDArray[np.float64]


@dataclass
class Deposit:
    """Thickness of solid rock, without voids between pieces, over a grid in plan.

    Attributes:
        x: Western edge [m].
        y: Southern edge [m].
        cell: Side of a cell [m]; edges lie at multiples of it, so that maps of several runs agree.
        thickness: Volume over a cell divided by its area [m], shape (rows, columns), from south to
            north.
    """

    x: float
    y: float
    cell: float
    thickness: Floats

    @classmethod
    def of(cls, solids: Solids, cell: float | None = None) -> Deposit:
        """Map elements; the default cell is about as large as a mean element.

        Raises:
            CdemError: The cell is not above zero, or so small that the map would be too large.
        """
        cell = checked_cell(solids, cell)
        _, (rows, columns) = solids.grid(cell)
        check_size(cell, rows, columns)
        (column, row), thickness = solids.columns(cell)
        return cls(column * cell, row * cell, cell, thickness)

    @property
    def covered(self) -> NDArray[np.bool_]:
        """Cells covered by rock, shape (rows, columns)."""
        return self.thickness > TRACE * self.thickness.max()

    @property
    def volume(self) -> float:
        """Volume of the map [m3]: equals the volume of the elements to round-off."""
        return float(self.thickness.sum() * self.cell**2)

    @property
    def area(self) -> float:
        """Area of the cells covered by rock [m2]."""
        return float(self.covered.sum() * self.cell**2)

    def length(self, direction: float) -> float:
        """Length of the covered cells along an azimuth [m], from the first to the last of them.

        Args:
            direction: Clockwise from y (north) [deg].
        """
        rows, columns = np.nonzero(self.covered)
        azimuth = np.radians(direction)
        along = self.cell * (columns * np.sin(azimuth) + rows * np.cos(azimuth))
        return float(np.ptp(along) + self.cell)

    @property
    def raster(self) -> Raster:
        """Thickness in the covered cells."""
        return Raster(self.x, self.y, self.cell, np.where(self.covered, self.thickness, np.nan))

    def write_asc(self, path: Path) -> None:
        """Write an ESRI ASCII grid that reads back to the same numbers."""
        rows, columns = self.thickness.shape
        head = (
            f"ncols {columns}\nnrows {rows}\nxllcorner {self.x!r}\nyllcorner {self.y!r}\n"
            f"cellsize {self.cell!r}\nNODATA_value {NOTHING:g}\n"
        )
        lines = "\n".join(" ".join(repr(float(v)) for v in row) for row in self.raster.rows)
        path.write_text(f"{head}{lines}\n")


def checked_cell(solids: Solids, cell: float | None) -> float:
    """The given cell of a map [m], or by default about the size of a mean element.

    Raises:
        CdemError: The given cell is not above zero.
    """
    if cell is None:
        return _round(float(np.cbrt(solids.volumes().mean())))
    if not (np.isfinite(cell) and cell > 0):
        raise CdemError(f"the cell of the map must be above 0 m, got {cell:g}")
    return float(cell)


def _round(size: float) -> float:
    """The nearest of 1, 2 or 5 times a power of ten."""
    powers = np.array([1.0, 2.0, 5.0, 10.0]) * 10.0 ** np.floor(np.log10(size))
    return float(f"{powers[np.abs(np.log(powers / size)).argmin()]:.0e}")
