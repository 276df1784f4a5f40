"""Where blocks start: along lines, evenly by length, or in areas, evenly by area."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Starts:
    """Places of starts in plan.

    Attributes:
        lines: Points of each line [m], shape (points, 2).
        triangles: Corners of triangles that fill the areas [m], shape (triangles, 3, 2).
        points: Single places, each as likely as the others [m], shape (points, 2).
    """

    lines: list[Floats]
    triangles: Floats
    points: Floats

    def place(self, random: np.random.Generator) -> Floats:
        """A place [m], shape (2,)."""
        u, v, w = random.random(3)
        if len(self.points):
            return self.points[min(int(u * len(self.points)), len(self.points) - 1)]
        if self.lines:
            begins = np.concatenate([line[:-1] for line in self.lines])
            ways = np.concatenate([np.diff(line, axis=0) for line in self.lines])
            at, rest = _pick(np.hypot(*ways.T), u)
            return begins[at] + rest * ways[at]
        a, b, c = np.moveaxis(self.triangles, 1, 0)
        one, two = b - a, c - a
        areas = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
        at, _ = _pick(areas, u)
        if v + w > 1:
            v, w = 1 - v, 1 - w
        return a[at] + v * one[at] + w * two[at]

    @property
    def corners(self) -> Floats:
        """All points that bound the starts [m], shape (points, 2)."""
        return np.concatenate([self.points, *self.lines, self.triangles.reshape(-1, 2)])


def _pick(sizes: Floats, u: float) -> tuple[int, float]:
    """Number of the part at this fraction of the sum of all sizes, and the fraction of that part."""
    ends = np.cumsum(sizes)
    at = min(int(np.searchsorted(ends, u * ends[-1], side="right")), len(sizes) - 1)
    return at, float((u * ends[-1] - ends[at] + sizes[at]) / sizes[at])


def triangles_of(ring: Floats) -> Floats:
    """Triangles that fill a simple polygon, by cutting ears, shape (triangles, 3, 2).

    Args:
        ring: Its corners [m], shape (corners, 2), the first not repeated.

    Raises:
        ValueError: The polygon crosses itself or has no area.
    """
    points = ring if _area(ring) > 0 else ring[::-1]
    left, found = list(range(len(points))), []
    while len(left) > 3:
        for k, b in enumerate(left):
            a, c = left[k - 1], left[(k + 1) % len(left)]
            ear = points[[a, b, c]]
            others = points[[i for i in left if i not in (a, b, c)]]
            if _area(ear) > 0 and not _inside(ear, others).any():
                found.append(ear)
                left.remove(b)
                break
        else:
            raise ValueError("an area must not cross itself")
    found.append(points[left])
    triangles = np.array(found)
    whole = sum(_area(triangle) for triangle in triangles)
    if not whole > 0 or abs(whole - _area(points)) > 1e-9 * whole:
        raise ValueError("an area must have a size and must not cross itself")
    return triangles


def _area(ring: Floats) -> float:
    x, y = (ring - ring[0]).T
    return float(0.5 * (x * np.roll(y, -1) - y * np.roll(x, -1)).sum())


def _inside(triangle: Floats, points: Floats) -> NDArray[np.bool_]:
    sides = np.roll(triangle, -1, axis=0) - triangle
    to = points[:, None] - triangle
    left = sides[:, 0] * to[..., 1] - sides[:, 1] * to[..., 0] >= 0
    return np.all(left, axis=1)
