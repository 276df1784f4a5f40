"""Lengths along the path of the centre of mass, and its energy line."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STEP = 0.01
"""Points of a path within this fraction of its length are too close to give its direction."""


def lengths(places: Floats) -> Floats:
    """Length in plan along a path, at each of its points [m].

    Args:
        places: x, y (and more) of its points [m], shape (points, 2 or more).
    """
    steps = np.linalg.norm(np.diff(places[:, :2], axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


class Path:
    """The path of the centre of mass in plan, extended straight at both ends.

    Args:
        places: Its points [m], shape (points, 2 or more).
    """

    def __init__(self, places: Floats) -> None:
        length = lengths(places)
        numbers = np.unique(np.searchsorted(length, np.arange(0, 1 + STEP / 2, STEP) * length[-1]))
        self.points = places[np.append(numbers[:-1], len(places) - 1), :2]
        self.moves = len(self.points) > 1 and length[-1] > 0

    def length_at(self, place: Floats) -> float:
        """Length along the path at its point nearest to a place in plan [m]; nan without motion.

        Before its start lengths are negative.
        """
        if not self.moves:
            return np.nan
        way = np.diff(self.points, axis=0)
        size = np.linalg.norm(way, axis=1)
        t = np.einsum("ij,ij->i", place[:2] - self.points[:-1], way) / size**2
        low, high = np.zeros(len(t)), np.ones(len(t))
        low[0], high[-1] = -np.inf, np.inf
        t = np.clip(t, low, high)
        gap = np.linalg.norm(self.points[:-1] + t[:, None] * way - place[:2], axis=1)
        near = int(gap.argmin())
        return float(lengths(self.points)[near] + t[near] * size[near])


def energy_line(height: Floats, kinetic: Floats, weight: Floats) -> Floats:
    """Height of the centre of mass and, above it, kinetic energy over weight [m].

    Over the length of the path, its slope is the fraction of the weight that resists the motion:
    for a rigid block sliding on a plane, the tangent of the friction angle.

    Args:
        height: Height of the centre of mass [m].
        kinetic: Kinetic energy [J].
        weight: Weight [N]; 0 gives no such line.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        line = height + kinetic / weight
    return np.where(np.isfinite(line), line, np.nan)
