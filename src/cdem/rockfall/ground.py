"""The ground of a rockfall: heights on a grid, its zones, and windows of it as meshes."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.mesh import Mesh
from cdem.whole_files import replaced

Floats = NDArray[np.float64]
DEEP = 2.0
"""Thickness of the ground in a window, in cells."""
NAME = "ground"


@dataclass(frozen=True)
class Ground:
    """Heights at the points of a grid. Each cell is two triangles; the diagonals alternate.

    Attributes:
        west, south: The first point [m].
        step: Distances of points along x and y [m], shape (2,).
        heights: Heights [m], shape (rows, columns), from south to north; NaN: no ground.
        zone: Number of the zone of each cell between four points, shape (rows - 1, columns - 1).
    """

    west: float
    south: float
    step: Floats
    heights: Floats
    zone: NDArray[np.int16]

    @property
    def low(self) -> Floats:
        """South-west point [m]."""
        return np.array([self.west, self.south])

    @property
    def high(self) -> Floats:
        """North-east point [m]."""
        rows, columns = self.heights.shape
        return self.low + self.step * [columns - 1, rows - 1]

    @property
    def zones(self) -> int:
        """Number of zones."""
        return int(self.zone.max()) + 1

    def _places(self, xy: Floats) -> tuple[NDArray[np.int64], NDArray[np.int64], Floats, Floats]:
        rows, columns = self.heights.shape
        at = (np.asarray(xy, float) - self.low) / self.step
        whole = np.floor(at)
        j = np.clip(whole[..., 0], 0, columns - 2).astype(np.int64)
        i = np.clip(whole[..., 1], 0, rows - 2).astype(np.int64)
        return i, j, at[..., 0] - j, at[..., 1] - i

    def plane(self, xy: Floats) -> tuple[Floats, Floats]:
        """Height and gradient of the triangle at points; NaN outside.

        Args:
            xy: Points [m], shape (..., 2).

        Returns:
            Heights [m], shape (...), and their slopes along x and y [1], shape (..., 2).
        """
        i, j, u, v = self._places(xy)
        z = self.heights
        a, b, c, d = z[i, j], z[i, j + 1], z[i + 1, j + 1], z[i + 1, j]
        rising = (i + j) % 2 == 0  # diagonal from a to c, else from b to d
        first = np.where(rising, u >= v, u + v <= 1)
        along_x = np.where(first, b - a, c - d)
        along_y = np.where(rising, np.where(first, c - b, d - a), np.where(first, d - a, c - b))
        from_a = a + u * along_x + v * along_y
        from_c = c - (1 - u) * along_x - (1 - v) * along_y
        height = np.where(rising | first, from_a, from_c)
        outside = (u < 0) | (u > 1) | (v < 0) | (v > 1)
        return (
            np.where(outside, np.nan, height),
            np.stack([along_x / self.step[0], along_y / self.step[1]], axis=-1),
        )

    def height(self, xy: Floats) -> Floats:
        """Height of the ground [m] at points [m], shape (..., 2); NaN outside."""
        return self.plane(xy)[0]

    def highest(self, xy: Floats, reach: float) -> float:
        """Greatest height of the points within a distance [m] of a place [m]; -inf without any."""
        first = np.floor((xy - reach - self.low) / self.step).astype(int)
        last = np.ceil((xy + reach - self.low) / self.step).astype(int) + 1
        rows, columns = self.heights.shape
        (j, i), (n, m) = np.clip(first, 0, [columns, rows]), np.clip(last, 0, [columns, rows])
        part = self.heights[i:m, j:n]
        known = part[np.isfinite(part)]
        return float(known.max(initial=-np.inf))

    def window(self, low: Floats, high: Floats) -> tuple[Mesh, tuple[Floats, Floats]]:
        """The ground in a rectangle as one layer of wedges, each zone a group.

        Args:
            low, high: South-west and north-east corner [m]; widened to whole cells.

        Returns:
            The mesh, with the groups `ground_NUMBER` of its zones, and the corners of the window.

        Raises:
            CdemError: There is no ground in it.
        """
        rows, columns = self.heights.shape
        first = np.floor((low - self.low) / self.step).astype(int)
        last = np.ceil((high - self.low) / self.step).astype(int)
        (j, i), (n, m) = (np.clip(e, 0, [columns - 1, rows - 1]).tolist() for e in (first, last))
        corners = self.low + self.step * [j, i], self.low + self.step * [n, m]
        row, column = (k.ravel() for k in np.meshgrid(range(i, m), range(j, n), indexing="ij"))
        wide = n - j + 1

        def at(up: int, right: int) -> NDArray[np.int64]:
            return (row - i + up) * wide + column - j + right

        a, b, c, d = at(0, 0), at(0, 1), at(1, 1), at(1, 0)
        rising = ((row + column) % 2 == 0)[:, None]
        one = np.where(rising, np.column_stack([a, b, c]), np.column_stack([a, b, d]))
        two = np.where(rising, np.column_stack([a, c, d]), np.column_stack([b, c, d]))
        x, y = np.meshgrid(
            self.west + self.step[0] * np.arange(j, n + 1),
            self.south + self.step[1] * np.arange(i, m + 1),
        )
        top = np.column_stack([x.ravel(), y.ravel(), self.heights[i : m + 1, j : n + 1].ravel()])
        known = np.isfinite(top[np.column_stack([a, b, c, d])][:, :, 2]).all(axis=1)
        if not known.any():
            raise CdemError("there is no ground in this window")
        triangles = np.concatenate([one[known], two[known]])
        numbers = np.tile(self.zone[row[known], column[known]], 2)
        return _layer(top, triangles, numbers, DEEP * float(self.step.max())), corners

    def write(self, path: Path) -> None:
        """Write the ground into a file of NumPy."""
        with replaced(path) as file:
            np.savez_compressed(file, **{f.name: getattr(self, f.name) for f in fields(self)})


def _layer(top: Floats, triangles: NDArray, numbers: NDArray, depth: float) -> Mesh:
    """Wedges below triangles; groups by their numbers."""
    used = np.unique(triangles)
    number = np.full(len(top), -1)
    number[used] = np.arange(len(used))
    top, triangles = top[used], number[triangles]
    zones, group = np.unique(numbers, return_inverse=True)
    cells = np.column_stack([triangles + len(top), triangles])
    return Mesh(
        np.concatenate([top, top - [0, 0, depth]]),
        {"wedge6": cells},
        {"wedge6": group.astype(np.int32)},
        [f"{NAME}_{zone}" for zone in zones],
    )


def read_ground(path: Path) -> Ground:
    """Read the ground that `Ground.write` wrote; kept in memory for the next run.

    Raises:
        CdemError: The file is damaged or missing.
    """
    try:
        return _read(path, path.stat().st_mtime_ns)
    except (OSError, ValueError, KeyError) as error:
        raise CdemError(f"{path}: cannot read the ground ({error})") from None


@lru_cache(maxsize=2)
def _read(path: Path, changed: int) -> Ground:
    with np.load(path, allow_pickle=False) as data:
        return Ground(
            float(data["west"]), float(data["south"]), data["step"], data["heights"], data["zone"]
        )
