"""Heights over a plan: planes, lines of known height (contours, polylines), grids; all exact on planes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from cdem.errors import BackendError, CaseError

Floats = NDArray[np.float64]
MOST_POINTS, LONGEST = 2_000_000, 20_000
"""Number of parts of all lines together, and of the path between two points."""
FIT = 24  # triangles whose corners define the plane beyond the outermost lines


class Heights(Protocol):
    """A height [m] for every point of a plan; extrapolated beyond its data."""

    low: Floats
    high: Floats

    def __call__(self, xy: Floats) -> Floats:
        """Heights [m], shape (points,), at xy [m], shape (points, 2)."""


def extra(module: str, what: str = "meshing terrain") -> Any:
    """Import a library of the extra `terrain`, needed for a given purpose.

    Raises:
        BackendError: It is not installed.
    """
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise BackendError(
            f"{what} needs {module.split('.')[0]}: pip install 'cdem[terrain]' ({error})"
        ) from None


def refuse_degrees(path: Path, points: Floats) -> None:
    """Refuse longitudes and latitudes: they lie within a few units of one another, unlike terrain.

    Args:
        path: File of the points.
        points: Points, supposedly in metres, shape (points, 3).

    Raises:
        CaseError: They are degrees.
    """
    x, y = points[:, 0], points[:, 1]
    size = max(np.ptp(x), np.ptp(y))
    if np.abs(x).max() <= 180 and np.abs(y).max() <= 90 and np.ptp(points[:, 2]) > 20 * size:
        raise CaseError(
            f"{path}: looks like longitude and latitude in degrees ({size:.3g} wide, "
            f"{np.ptp(points[:, 2]):.3g} high); write the projection in metres as crs at the top, or "
            "project it first, e.g. with ogr2ogr -t_srs"
        )


@dataclass
class Plane:
    """A plane through a point, falling by `dip` towards `dip_direction` (from north over east).

    Attributes:
        dip: Angle to the horizontal [deg].
        dip_direction: Azimuth of its dip [deg]; y is north, x is east.
        through: A point on it [m].
    """

    dip: float
    dip_direction: float
    through: tuple[float, float, float]

    def __post_init__(self) -> None:
        self.low = np.full(2, -np.inf)
        self.high = np.full(2, np.inf)

    def __call__(self, xy: Floats) -> Floats:
        azimuth = math.radians(self.dip_direction)
        fall = math.tan(math.radians(self.dip))
        along = (xy - self.through[:2]) @ [math.sin(azimuth), math.cos(azimuth)]
        return self.through[2] - fall * along


class Lines:
    """Triangles between lines of known height; beyond the outermost, the best-fitting plane.

    Args:
        lines: Points [m] of each line, shape (points, 3).
        spacing: Largest distance of points along a line [m]; the lines are divided to it, so
            no triangle crosses a line with a neighbour at that distance.

    Raises:
        CaseError: All points lie on one line, or the lines are millions of spacings long.
    """

    def __init__(self, lines: list[Floats], spacing: float) -> None:
        sides = np.concatenate([np.hypot(*np.diff(line[:, :2], axis=0).T) for line in lines])
        if not sides.max(initial=0.0) < LONGEST * spacing or sides.sum() > MOST_POINTS * spacing:
            raise CaseError(
                f"the lines are {sides.sum():.3g} m long, with up to {sides.max():.3g} m between "
                f"two points: "
                f"too much for a spacing of {spacing:.3g} m; are the units the same?"
            )
        points = np.concatenate([_divided(line, spacing) for line in lines])
        points = points[np.lexsort(points.T[::-1])]
        fresh = np.ones(len(points), bool)
        fresh[1:] = np.abs(np.diff(points[:, :2], axis=0)).max(axis=1) > 1e-6 * spacing
        self.points = points[fresh]
        self.low, self.high = self.points[:, :2].min(axis=0), self.points[:, :2].max(axis=0)
        self._middle = self.points[:, :2].mean(axis=0)
        spatial = extra("scipy.spatial")
        try:
            self._net = spatial.Delaunay(self.points[:, :2] - self._middle)
        except (spatial.QhullError, ValueError):
            raise CaseError(
                "the points lie on one straight line; give lines that span an area"
            ) from None
        # made once, here; with several threads SciPy is 200 times slower for its 3 x 3 systems
        with extra("threadpoolctl").threadpool_limits(1):
            self._to_local = self._net.transform
        z = self.points[self._net.simplices, 2]
        sloping = np.flatnonzero(np.ptp(z, axis=1) > 0)
        self._corners = self._net.simplices[sloping if len(sloping) else slice(None)]
        centers = self._net.points[self._corners].mean(axis=1)
        self._near = spatial.cKDTree(centers)

    def __call__(self, xy: Floats) -> Floats:
        at = np.asarray(xy, float) - self._middle
        triangle = self._net.find_simplex(at, tol=1e-9)
        to_local = self._to_local[triangle]
        first = np.einsum("ijk,ik->ij", to_local[:, :2], at - to_local[:, 2])
        weights = np.column_stack([first, 1 - first.sum(axis=1)])
        z = (self.points[self._net.simplices[triangle], 2] * weights).sum(axis=1)
        # triangles of three collinear points have no local coordinates
        for i in np.flatnonzero((triangle < 0) | ~np.isfinite(z)):
            z[i] = self._beyond(at[i])
        return z

    def _beyond(self, at: Floats) -> float:
        count = min(FIT, len(self._corners))
        nearest = np.atleast_1d(self._near.query(at, count)[1])
        some = np.unique(self._corners[nearest])
        xy = self._net.points[some] - at
        columns = np.column_stack([np.ones(len(some)), xy])
        return float(np.linalg.lstsq(columns, self.points[some, 2], rcond=None)[0][0])


def _divided(line: Floats, spacing: float) -> Floats:
    """A line with points added so that no two are further apart than `spacing` in plan."""
    steps = np.hypot(*np.diff(line[:, :2], axis=0).T)
    pieces = [line[-1:]]
    for a, b, length in zip(line[:-1], line[1:], steps, strict=True):
        count = max(1, math.ceil(length / spacing))
        pieces.append(a + (b - a) * (np.arange(count) / count)[:, None])
    return np.concatenate(pieces)


@dataclass
class Grid:
    """Heights on a regular grid, bilinear in between.

    Attributes:
        west: x of the first column of points [m].
        south: y of the first row of points [m].
        step: Distances of columns and of rows [m].
        values: Heights [m], shape (rows, columns), rows from south to north; NaN where unknown.
    """

    west: float
    south: float
    step: tuple[float, float]
    values: Floats

    def __post_init__(self) -> None:
        # a value represents its cell, so the data reach half a cell beyond the outermost points
        rows, columns = self.values.shape
        half = np.array(self.step) / 2
        self.low = np.array([self.west, self.south]) - half
        self.high = self.low + np.array(self.step) * [columns, rows]

    def __call__(self, xy: Floats) -> Floats:
        rows, columns = self.values.shape
        x = (xy[:, 0] - self.west) / self.step[0]
        y = (xy[:, 1] - self.south) / self.step[1]
        i = np.clip(np.floor(x).astype(int), 0, columns - 2)
        j = np.clip(np.floor(y).astype(int), 0, rows - 2)
        u, v = x - i, y - j
        z = self.values
        south = (1 - u) * z[j, i] + u * z[j, i + 1]
        north = (1 - u) * z[j + 1, i] + u * z[j + 1, i + 1]
        return (1 - v) * south + v * north


class Smooth:
    """Heights averaged with a normal distribution in plan; a plane is unchanged.

    Args:
        heights: Heights to smooth.
        width: Standard deviation [m].
    """

    def __init__(self, heights: Heights, width: float) -> None:
        self._heights = heights
        self.low, self.high = heights.low, heights.high
        # five points of Gauss and Hermite along each axis
        at, weight = np.polynomial.hermite_e.hermegauss(5)
        weight = weight / weight.sum()
        self._shifts = width * np.array([(x, y) for x in at for y in at])
        self._weights = np.outer(weight, weight).ravel()

    def __call__(self, xy: Floats) -> Floats:
        around = (np.asarray(xy, float)[:, None] + self._shifts).reshape(-1, 2)
        return self._heights(around).reshape(len(xy), -1) @ self._weights
