"""Bodies between the ground and one or two planes through a point of the ground, on a grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.screening.batches import Batch
from cdem.screening.loads import Loads
from cdem.screening.planes import JointPlane
from cdem.screening.sliding import KINDS, Kind, Sliding
from cdem.terrain.heights import Grid, extra

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

FIRST_REACH = 16
"""Cells from the point to the edge of the first window; each further window is twice as wide."""
NEAR = 2
"""Largest distance from the point to the body [cells]: on one of two planes it lies beside it."""
LEAST_CELLS = 9
"""Smaller bodies are not resolved by the grid [cells]."""
COUNTED = 75.0
"""Up to this dip the area of a plane is computed from the cells above it; for steeper planes from
the ground, because few cells lie above them [deg]."""
TOUCHES = 1e-6


@dataclass
class Body:
    """A body that may slide.

    Attributes:
        planes: One or two planes that bound it below.
        sliding: Its mode of sliding under its weight alone.
        point: Point where its line of sliding daylights [m].
        volume: Volume [m3].
        weight: Weight [N].
        areas: Areas of its planes [m2].
        heads: Mean height of the water table above each plane, for a share of 1 [m].
        factor: Factor of safety [1].
        kind: Mode of sliding under all loads.
        corner: Row and column of its window in the map.
        cells: Mask of its cells in the window.
    """

    planes: tuple[JointPlane, ...]
    sliding: Sliding
    point: Floats
    volume: float
    weight: float
    areas: tuple[float, ...]
    heads: tuple[float, ...]
    factor: float
    kind: Kind
    corner: tuple[int, int]
    cells: Bools = field(repr=False)

    @property
    def name(self) -> str:
        """Name from its planes; a plane on which it slides alone comes first."""
        names = [plane.name for plane in self.planes]
        return "+".join(reversed(names) if self.kind == "second" else names)

    @property
    def window(self) -> tuple[slice, slice]:
        """Its place in the map."""
        (i, j), (rows, columns) = self.corner, self.cells.shape
        return slice(i, i + rows), slice(j, j + columns)

    def bed(self, x: Any, y: Any) -> Floats:
        """Height of its lower surface [m] at some points, extended beyond its rim."""
        return np.max([height_of(plane, self.point, x, y) for plane in self.planes], axis=0)


@dataclass(frozen=True)
class Limits:
    """Limits of bodies.

    Attributes:
        smallest: Smallest volume [m3].
        largest: Largest volume [m3].
        unit_weight: Unit weight of the rock [N/m3].
    """

    smallest: float
    largest: float
    unit_weight: float


def height_of(plane: JointPlane, point: Floats, x: Any, y: Any) -> Floats:
    """Height of a plane through a point [m]."""
    n = plane.normal
    return point[2] - (n[0] * (x - point[0]) + n[1] * (y - point[1])) / n[2]


class Ground:
    """A grid of heights, ready for many bodies.

    Attributes:
        grid: The heights.
        x, y: Coordinates of its columns and rows [m].
        cell_area: Area of a cell [m2].
        normal: Normal of the ground, not of unit length: (-dz/dx, -dz/dy, 1), shape (rows, columns,
            3).
    """

    def __init__(self, grid: Grid) -> None:
        self.grid = grid
        rows, columns = grid.values.shape
        self.x = grid.west + grid.step[0] * np.arange(columns)
        self.y = grid.south + grid.step[1] * np.arange(rows)
        self.cell_area = grid.step[0] * grid.step[1]
        gy, gx = np.gradient(grid.values, grid.step[1], grid.step[0])
        self.normal = np.stack([-gx, -gy, np.ones_like(gx)], axis=-1)
        self._label: Any = extra("scipy.ndimage").label

    def point(self, i: int, j: int) -> Floats:
        """The point of the ground at a cell [m]."""
        return np.array([self.x[j], self.y[i], self.grid.values[i, j]])

    def body(
        self,
        planes: tuple[JointPlane, ...],
        sliding: Sliding,
        at: tuple[int, int],
        limits: Limits,
        loads: Loads | None = None,
    ) -> Body | None:
        """The body whose line of sliding daylights at a cell.

        It is the connected part of the ground above all planes from the cell on. The window
        grows until the body lies inside or is too large.

        Args:
            planes: One or two planes.
            sliding: How a body slides on them under its weight.
            at: Row and column of the cell.
            limits: Limits of bodies.
            loads: Water and shaking; none by default.

        Returns:
            The body; None if it reaches the edge of the map or unknown ground, is too small or too
            large, or would turn rather than slide on one of two planes.
        """
        point = self.point(*at)
        part = self._whole(planes, point, at, limits.largest)
        if part is None:
            return None
        window, cells, t, beds = part
        volume = float(t[cells].sum()) * self.cell_area
        if volume < limits.smallest or cells.sum() < LEAST_CELLS:
            return None
        if not self._rests(planes, sliding, point, window, np.where(cells, t, 0.0)):
            return None
        shares = self._shares(planes, cells, beds)
        areas = self._areas(planes, shares, cells, window)
        loads, weight = loads or Loads(), limits.unit_weight * volume
        heights = loads.heads(window, beds.max(axis=0), t)[cells]
        heads = tuple(((shares @ heights) / np.maximum(shares.sum(axis=1), TOUCHES)).tolist())
        alone = Batch(planes, sliding, np.array([weight]), np.array([areas]), np.array([heads]))
        factor, kind = (values[0] for values in alone.factors(loads))
        box = _box(cells)
        corner = (window[0].start + box[0].start, window[1].start + box[1].start)
        mask = cells[box].copy()
        name = KINDS[int(kind)]
        return Body(
            planes, sliding, point, volume, weight, areas, heads, float(factor), name, corner, mask
        )

    def _whole(
        self, planes: tuple[JointPlane, ...], point: Floats, at: tuple[int, int], largest: float
    ) -> tuple[tuple[slice, slice], Bools, Floats, Floats] | None:
        """A window around a whole body, with the results of `_part`; None if there is none."""
        shape = self.grid.values.shape
        reach = FIRST_REACH
        while True:
            low = [max(0, k - reach) for k in at]
            high = [min(size, k + reach + 1) for k, size in zip(at, shape, strict=True)]
            window = (slice(low[0], high[0]), slice(low[1], high[1]))
            part = self._part(planes, point, window, (at[0] - low[0], at[1] - low[1]))
            if part is None:
                return None
            cells, t, beds = part
            volume = float(t[cells].sum()) * self.cell_area
            if not volume <= largest:  # NaN too
                return None
            ends = _on_edges(cells)
            if not any(ends):
                return window, cells, t, beds
            of_map = (low[0] == 0, high[0] == shape[0], low[1] == 0, high[1] == shape[1])
            if any(end and last for end, last in zip(ends, of_map, strict=True)):
                return None
            reach *= 2

    def _part(
        self,
        planes: tuple[JointPlane, ...],
        point: Floats,
        window: tuple[slice, slice],
        seed: tuple[int, int],
    ) -> tuple[Bools, Floats, Floats] | None:
        """Cells of the body in a window, thickness above all planes, height of each plane [m]."""
        x, y = self.x[None, window[1]], self.y[window[0], None]
        beds = np.array([height_of(plane, point, x, y) for plane in planes])
        t = self.grid.values[window] - beds.max(axis=0)
        numbers, _ = self._label(
            ~(t <= TOUCHES)
        )  # unknown ground belongs to the parts that it touches
        i, j = seed
        near = numbers[max(0, i - NEAR) : i + NEAR + 1, max(0, j - NEAR) : j + NEAR + 1]
        near = near[near > 0]
        return (numbers == np.bincount(near).argmax(), t, beds) if len(near) else None

    def _rests(
        self,
        planes: tuple[JointPlane, ...],
        sliding: Sliding,
        point: Floats,
        window: tuple[slice, slice],
        thickness: Floats,
    ) -> bool:
        """Whether the centre of mass lies above the plane, of two, on which a body slides.

        Else the body rotates about the edge of that plane, and no closed form applies.
        """
        if sliding.kind not in ("first", "second"):
            return True
        x = float((thickness.sum(axis=0) @ self.x[window[1]]) / thickness.sum())
        y = float((thickness.sum(axis=1) @ self.y[window[0]]) / thickness.sum())
        first, second = (float(height_of(plane, point, x, y)) for plane in planes)
        return first >= second if sliding.kind == "first" else second >= first

    def _shares(self, planes: tuple[JointPlane, ...], cells: Bools, beds: Floats) -> Floats:
        """Share of each plane in the cells of a body, shape (planes, cells of the body)."""
        if len(planes) == 1:
            return np.ones((1, int(cells.sum())))
        # cells on the intersection line of both planes are divided between them
        normals = np.array([plane.normal for plane in planes])
        apart = beds[0][cells] - beds[1][cells]
        slope = np.diff(normals[:, :2] / normals[:, 2:], axis=0)[0]
        across = float(np.abs(slope) @ self.grid.step)
        share = np.clip(0.5 + apart / across, 0, 1)
        return np.stack([share, 1 - share])

    def _areas(
        self,
        planes: tuple[JointPlane, ...],
        shares: Floats,
        cells: Bools,
        window: tuple[slice, slice],
    ) -> tuple[float, ...]:
        """Area of each plane under a body [m2]."""
        normals = np.array([plane.normal for plane in planes])
        plan = shares.sum(axis=1) * self.cell_area
        areas = plan / normals[:, 2]
        steep = np.array([plane.dip > COUNTED for plane in planes])
        if steep.any():
            # vector areas of a closed surface sum to zero
            ground = self.normal[window][cells].sum(axis=0)[:2] * self.cell_area
            rest = ground - areas[~steep] @ normals[~steep, :2]
            found = np.linalg.lstsq(normals[steep, :2].T, rest, rcond=None)[0]
            areas[steep] = np.maximum(found, 0.0)
        return tuple(areas.tolist())


def batches(bodies: Sequence[Body]) -> list[tuple[NDArray[np.int64], Batch]]:
    """Bodies by their planes: indices in the list, and the bodies together."""
    numbers: dict[tuple[str, ...], list[int]] = {}
    for number, body in enumerate(bodies):
        numbers.setdefault(tuple(plane.name for plane in body.planes), []).append(number)
    out = []
    for some in numbers.values():
        group = [bodies[k] for k in some]
        arrays = [np.array([getattr(b, of) for b in group]) for of in ("weight", "areas", "heads")]
        out.append((np.array(some), Batch(group[0].planes, group[0].sliding, *arrays)))
    return out


def _on_edges(cells: Bools) -> tuple[bool, bool, bool, bool]:
    """Whether some cells lie on the first and last row, the first and last column."""
    sides = (cells[0], cells[-1], cells[:, 0], cells[:, -1])
    return tuple(bool(side.any()) for side in sides)  # type: ignore[return-value]


def _box(cells: Bools) -> tuple[slice, slice]:
    """The smallest window that holds some cells."""
    i, j = np.flatnonzero(cells.any(axis=1)), np.flatnonzero(cells.any(axis=0))
    return slice(int(i[0]), int(i[-1]) + 1), slice(int(j[0]), int(j[-1]) + 1)
