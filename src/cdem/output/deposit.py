"""The map of a deposit's thickness: ESRI ASCII grid, GeoTIFF and a picture."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.output.element_volumes import Solids

Floats = NDArray[np.float64]

NOTHING = -9999.0
"""What the files hold where no rock lies."""
TRACE = 1e-9
"""Less than this part of the greatest thickness is round-off."""
MOST_CELLS = 4_000_000


@dataclass
class Deposit:
    """Thickness of solid rock, as if its pieces lay without voids, over a grid in plan.

    Attributes:
        x: Western edge [m].
        y: Southern edge [m].
        cell: Side of a cell [m]; edges lie at multiples of it, so that maps of several runs agree.
        thickness: Volume over a cell by its area [m], shape (rows, columns), from south to north.
    """

    x: float
    y: float
    cell: float
    thickness: Floats

    @classmethod
    def of(cls, solids: Solids, cell: float | None = None) -> Deposit:
        """Map elements; the default cell is about as large as a mean element.

        Raises:
            CdemError: The cell is not above zero, or so small that the map would be huge.
        """
        if cell is None:
            cell = _round(float(np.cbrt(solids.volumes().mean())))
        cell = float(cell)
        if not (np.isfinite(cell) and cell > 0):
            raise CdemError(f"the cell of the map must be above 0 m, got {cell:g}")
        _, (rows, columns) = solids.grid(cell)
        if rows * columns > MOST_CELLS:
            raise CdemError(
                f"cells of {cell:g} m make a map of {rows:,} x {columns:,}; choose a larger cell"
            )
        (column, row), thickness = solids.columns(cell)
        return cls(column * cell, row * cell, cell, thickness)

    @property
    def covered(self) -> NDArray[np.bool_]:
        """Cells over which rock lies, shape (rows, columns)."""
        return self.thickness > TRACE * self.thickness.max()

    @property
    def volume(self) -> float:
        """Volume of the map [m3]: that of the elements, to round-off."""
        return float(self.thickness.sum() * self.cell**2)

    @property
    def area(self) -> float:
        """Area of the cells over which rock lies [m2]."""
        return float(self.covered.sum() * self.cell**2)

    def _rows(self) -> Floats:
        """Thickness from north to south, as maps are written."""
        return np.where(self.covered, self.thickness, NOTHING)[::-1]

    def write_asc(self, path: Path) -> None:
        """Write an ESRI ASCII grid that reads back to the same numbers."""
        rows, columns = self.thickness.shape
        head = (
            f"ncols {columns}\nnrows {rows}\nxllcorner {self.x!r}\nyllcorner {self.y!r}\n"
            f"cellsize {self.cell!r}\nNODATA_value {NOTHING:g}\n"
        )
        lines = "\n".join(" ".join(repr(float(v)) for v in row) for row in self._rows())
        path.write_text(f"{head}{lines}\n")

    def write_tiff(self, path: Path) -> None:
        """Write a GeoTIFF of 32-bit numbers: TIFF 6.0 and OGC GeoTIFF 1.1, without a map projection.

        A case does not say in which projection its x and y are, so neither does the file.
        """
        rows, columns = self.thickness.shape
        north = self.y + rows * self.cell
        pixels = self._rows().astype("<f4").tobytes()
        short, long, double, ascii_ = "H", "I", "d", "s"
        tags: list[tuple[int, str, tuple]] = [
            (256, long, (columns,)), (257, long, (rows,)), (258, short, (32,)),
            (259, short, (1,)), (262, short, (1,)), (273, long, (8,)), (277, short, (1,)),
            (278, long, (rows,)), (279, long, (len(pixels),)), (339, short, (3,)),
            (33550, double, (self.cell, self.cell, 0.0)),
            (33922, double, (0.0, 0.0, 0.0, self.x, north, 0.0)),
            (34735, short, (1, 1, 0, 1, 1025, 0, 1, 1)),  # one key: a pixel is an area
            (42113, ascii_, (f"{NOTHING:g}\0".encode(),)),
        ]  # fmt: skip
        kinds = {ascii_: 2, short: 3, long: 4, double: 12}
        entries, more = b"", b""
        first = 8 + len(pixels)  # of the directory; long values follow it
        after = first + 2 + 12 * len(tags) + 4
        for tag, kind, values in tags:
            data = values[0] if kind == ascii_ else struct.pack(f"<{len(values)}{kind}", *values)
            count = len(data) if kind == ascii_ else len(values)
            if len(data) > 4:
                place = struct.pack("<I", after + len(more))
                more += data + b"\0" * (len(data) % 2)
            else:
                place = data.ljust(4, b"\0")
            entries += struct.pack("<HHI", tag, kinds[kind], count) + place
        head = struct.pack("<2sHI", b"II", 42, first)
        path.write_bytes(head + pixels + struct.pack("<H", len(tags)) + entries + b"\0" * 4 + more)


def _round(size: float) -> float:
    """The nearest of 1, 2 or 5 times a power of ten."""
    powers = np.array([1.0, 2.0, 5.0, 10.0]) * 10.0 ** np.floor(np.log10(size))
    return float(f"{powers[np.abs(np.log(powers / size)).argmin()]:.0e}")
