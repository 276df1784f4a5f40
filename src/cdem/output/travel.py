"""Lengths along the path of the centre of mass, and its energy line."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STEP = 0.01
"""Points of a path nearer to one another than this part of its length say nothing of its course."""


def lengths(places: Floats) -> Floats:
    """Length in plan of a path up to each of its points [m].

    Args:
        places: x, y (and more) of its points [m], shape (points, 2 or more).
    """
    steps = np.linalg.norm(np.diff(places[:, :2], axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])


class Path:
    """The way of the centre of mass in plan, going on straight at both ends.

    Args:
        places: Its points [m], shape (points, 2 or more).
    """

    def __init__(self, places: Floats) -> None:
        length = lengths(places)
        numbers = np.unique(np.searchsorted(length, np.arange(0, 1 + STEP / 2, STEP) * length[-1]))
        self.points = places[np.append(numbers[:-1], len(places) - 1), :2]
        self.moves = len(self.points) > 1 and length[-1] > 0

    def length_at(self, place: Floats) -> float:
        """Length along the path of its point nearest to a place in plan [m]; nan if it does not move.

        Before its begin lengths are negative.
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

    Over the length of the path its slope is that part of the weight which resists the motion: for a
    rigid block that slides on a plane, the tangent of the angle of friction.

    Args:
        height: Of the centre of mass [m].
        kinetic: Energy [J].
        weight: [N]; where it is 0 there is no such line.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        line = height + kinetic / weight
    return np.where(np.isfinite(line), line, np.nan)
