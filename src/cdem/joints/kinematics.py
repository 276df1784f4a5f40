"""Joints that may slide or topple on a slope, by direction alone: Goodman; Wyllie & Mah."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.joints.directions import dips

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

MOST_FOR_PAIRS = 1500
"""Most joints for pairs; of more, evenly chosen ones are used."""


@dataclass(frozen=True)
class Slope:
    """A slope and the friction of its joints.

    Attributes:
        dip: Dip of the face [deg].
        dip_direction: Dip direction of the face [deg].
        friction: Friction angle of joints [deg].
        lateral: Planes slide and topple if their dip direction differs by less than this [deg].
    """

    dip: float
    dip_direction: float
    friction: float
    lateral: float = 20.0

    def _apparent(self, direction: Floats) -> Floats:
        """Tangent of the dip of the face seen along some directions [deg]."""
        away = np.radians(direction - self.dip_direction)
        return np.tan(np.radians(self.dip)) * np.cos(away)

    def _aside(self, direction: Floats) -> Floats:
        """Angle between some directions and the direction of the face [deg], from 0 to 180."""
        return np.abs((direction - self.dip_direction + 180) % 360 - 180)

    def planar(self, dip: Floats, direction: Floats) -> Bools:
        """Planes that may slide: steeper than friction, daylighting, about along the slope."""
        daylights = np.tan(np.radians(dip)) < self._apparent(direction)
        return (dip > self.friction) & daylights & (self._aside(direction) < self.lateral)

    def toppling(self, dip: Floats, direction: Floats) -> Bools:
        """Layers that may slip on one another and bend over: dip > 90 deg - slope + friction."""
        into = 180 - self._aside(direction) < self.lateral
        return into & (dip > 90 - self.dip + self.friction)

    def wedge(self, plunge: Floats, trend: Floats) -> Bools:
        """Intersections of two planes that may slide: friction < plunge, and daylighting."""
        daylights = np.tan(np.radians(plunge)) < self._apparent(trend)
        return (plunge > self.friction) & daylights


def intersections(normals: Floats) -> tuple[Floats, Floats]:
    """Plunge and trend [deg] of the intersection lines of planes, for all pairs.

    Args:
        normals: Unit normals, shape (planes, 3); pairs of parallel planes are left out.

    Example:
        >>> plunge, trend = intersections(poles(np.array([45.0, 45.0]), np.array([45.0, 135.0])))
        >>> plunge.round(2), trend.round(2)  # tan plunge = tan 45 cos 45
        (array([35.26]), array([90.]))
    """
    if len(normals) > MOST_FOR_PAIRS:
        normals = normals[np.linspace(0, len(normals) - 1, MOST_FOR_PAIRS).astype(int)]
    first, second = np.triu_indices(len(normals), 1)
    lines = np.cross(normals[first], normals[second])
    size = np.linalg.norm(lines, axis=1)
    lines = lines[size > 1e-6] / size[size > 1e-6, None]
    lines *= np.where(lines[:, 2:] > 0, -1.0, 1.0)
    plunge = np.degrees(np.arcsin(np.clip(-lines[:, 2], -1, 1)))
    return plunge, np.degrees(np.arctan2(lines[:, 0], lines[:, 1])) % 360


@dataclass(frozen=True)
class Shares:
    """Fractions of joints that may fail on a slope.

    Attributes:
        planar: Fraction of all joints [1].
        toppling: Fraction of all joints [1].
        wedge: Fraction of the intersections of all pairs [1].
        planar_of: Fraction of each set's joints [1].
        toppling_of: Fraction of each set's joints [1].
        wedges: First and second set, plunge and trend [deg] of their mean planes' intersection, and
            whether it may slide.
    """

    planar: float
    toppling: float
    wedge: float
    planar_of: list[float]
    toppling_of: list[float]
    wedges: list[tuple[int, int, float, float, bool]]


def shares(slope: Slope, normals: Floats, means: Floats, membership: Floats) -> Shares:
    """Count the joints that may fail.

    Args:
        slope: The slope.
        normals: Unit normals of joints, shape (joints, 3).
        means: Unit normals of the sets, shape (sets, 3).
        membership: Probability of each joint to belong to each set, shape (joints, sets or more).
    """
    planar = slope.planar(*dips(normals))
    toppling = slope.toppling(*dips(normals))
    wedge = slope.wedge(*intersections(normals))
    wedges = []
    for i in range(len(means)):
        for j in range(i + 1, len(means)):
            plunge, trend = intersections(means[[i, j]])
            if len(plunge):
                slides = bool(slope.wedge(plunge, trend)[0])
                wedges.append((i, j, float(plunge[0]), float(trend[0]), slides))
    part = membership[:, : len(means)]
    part = part / part.sum(axis=0)
    return Shares(
        float(planar.mean()),
        float(toppling.mean()),
        float(wedge.mean()) if len(wedge) else 0.0,
        (planar @ part).tolist(),
        (toppling @ part).tolist(),
        wedges,
    )
