"""Flat regions of a cloud: they grow from the flattest points along the plane fitted to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.outcrop.normals import Normals

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Indices = NDArray[np.intp]

GROWTH_NEIGHBOURS = 12
"""Nearest points, with the point itself, to which a region may grow from a point."""
REFIT = 1.2
"""A plane is fitted anew when its region has grown by this factor."""
TURNED = 0.99996
"""Cosine of 0.5 deg: after a larger turn of its plane a region looks at its whole rim again."""
RIM_PASSES = 3
"""Passes that give points at the rim to the region in whose plane they lie: normals of 24
neighbours are wrong within two to three spacings of an edge."""


@dataclass(frozen=True)
class Rules:
    """What belongs to a region.

    Attributes:
        angle: Largest angle between the normal of a point and that of its region [deg].
        tolerance: Largest distance of a point from the plane of its region [m].
        points: Smallest number of points of a region.
    """

    angle: float
    tolerance: float
    points: int


class Plane:
    """A plane fitted to points that are added in parts.

    Attributes:
        normal: Unit normal, of either sign.
        center: A point of the plane [m].
        count: Number of points.
    """

    def __init__(self, normal: Floats, point: Floats) -> None:
        self.normal, self.center, self.count = normal, point, 0
        self._base, self._sum, self._squares = point, np.zeros(3), np.zeros((3, 3))
        self._next = 10.0

    def deviation_with(self, other: Plane) -> float:
        """Deviation of the points of both from the plane through all [m]."""
        shift, count = other._base - self._base, self.count + other.count
        moved = other._sum + other.count * shift
        cross = np.outer(other._sum, shift)
        squares = other._squares + cross + cross.T + other.count * np.outer(shift, shift)
        mean = (self._sum + moved) / count
        cov = (self._squares + squares) / count - np.outer(mean, mean)
        return float(np.sqrt(max(np.linalg.eigvalsh(cov)[0], 0.0)))

    def add(self, points: Floats) -> None:
        """Add points; a fifth more than at the last fit makes a new one."""
        x = points - self._base
        self.count += len(x)
        self._sum += x.sum(axis=0)
        self._squares += x.T @ x
        if self.count >= self._next:
            self.fit()
            self._next = self.count * REFIT

    def fit(self) -> None:
        """Fit the plane by least squares."""
        mean = self._sum / self.count
        self.normal = np.linalg.eigh(self._squares / self.count - np.outer(mean, mean))[1][:, 0]
        self.center = self._base + mean


class _Growth:
    """The cloud while regions grow; `label` is the number of each point's region, -1 for none."""

    def __init__(self, points: Floats, found: Normals, rules: Rules) -> None:
        self.points, self.normals, self.rules = points, found.normals, rules
        self.near = found.neighbours[:, 1:GROWTH_NEIGHBOURS]
        self.cosine = float(np.cos(np.radians(rules.angle)))
        self.label = np.full(len(points), -1, np.int32)

    def region(self, seed: int, number: int) -> tuple[Plane, Indices]:
        """Grow a region, front by front; labels its points."""
        plane = Plane(self.normals[seed], self.points[seed])
        front, parts, looked = np.array([seed]), list[Indices](), plane.normal
        while len(front):
            self.label[front] = number
            parts.append(front)
            plane.add(self.points[front])
            front = self._joining(front, plane)
            if not len(front) and plane.count > 2:
                plane.fit()
                if abs(looked @ plane.normal) < TURNED:
                    looked = plane.normal
                    front = self._joining(np.concatenate(parts), plane)
        return plane, np.concatenate(parts)

    def _joining(self, front: Indices, plane: Plane) -> Indices:
        """Free neighbours of some points that belong to a plane."""
        beside = np.unique(self.near[front])
        beside = beside[self.label[beside] < 0]
        beside = beside[np.abs(self.normals[beside] @ plane.normal) >= self.cosine]
        away = np.abs((self.points[beside] - plane.center) @ plane.normal)
        return np.asarray(beside[away <= self.rules.tolerance], np.intp)


def grow(points: Floats, found: Normals, rules: Rules) -> tuple[Ints, list[Plane]]:
    """Divide a cloud into flat regions.

    A region begins at the flattest free point, whose neighbours deviate from their plane by half the
    tolerance at most, and takes its neighbours while their normals lie
    within an angle of the normal of the region and they lie near its plane, which is fitted anew
    as it grows (after Rabbani et al. 2006, who compare neighbours with one another).

    Args:
        points: [m], shape (points, 3).
        found: Their normals and neighbours.
        rules: What belongs to a region.

    Returns:
        Number of each point's region, -1 for none, shape (points,); and the planes of the regions.
    """
    growth = _Growth(points, found, rules)
    idle = np.zeros(len(points), bool)  # points of regions that stayed too small start none
    planes: list[Plane] = []
    seeds = np.argsort(found.deviation, kind="stable")
    for seed in seeds[found.deviation[seeds] <= rules.tolerance / 2].tolist():
        if growth.label[seed] >= 0 or idle[seed]:
            continue
        plane, members = growth.region(seed, len(planes))
        if plane.count < rules.points:
            growth.label[members], idle[members] = -1, True
        else:
            planes.append(plane)
    return growth.label, planes


def take_rims(
    points: Floats, found: Normals, label: Ints, planes: list[Plane], tolerance: float
) -> Ints:
    """Give free points beside regions to the region in whose plane they lie, or nearly so.

    Args:
        points: [m], shape (points, 3).
        found: Their neighbours.
        label: Number of each point's region, -1 for none.
        planes: The planes of the regions.
        tolerance: Largest distance from a plane [m].

    Returns:
        The new numbers; a point with a region keeps it.
    """
    label = label.copy()
    if not planes:
        return label
    near = found.neighbours[:, 1:GROWTH_NEIGHBOURS]
    centers = np.array([plane.center for plane in planes])
    normals = np.array([plane.normal for plane in planes])
    for _ in range(RIM_PASSES):
        free = np.flatnonzero(label < 0)
        free = free[(label[near[free]] >= 0).any(axis=1)]
        beside = label[near[free]]
        away = np.einsum("nki,nki->nk", points[free][:, None] - centers[beside], normals[beside])
        away = np.where(beside >= 0, np.abs(away), np.inf)
        best = away.argmin(axis=1)
        at = np.arange(len(free))
        close = away[at, best] <= tolerance
        label[free[close]] = beside[at, best][close]
    return label
