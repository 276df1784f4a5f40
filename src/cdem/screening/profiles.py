"""Plane failure of profiles down the dip of a set, per metre of width: requires free sides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.screening.bodies import Ground, Limits
from cdem.screening.planes import JointPlane
from cdem.screening.sliding import LEAST_FALL, on_one

Floats = NDArray[np.float64]

AT_ONCE = 2_000_000
"""Points of profiles computed together."""
LEAST_POINTS = 3
"""Shorter profiles are not resolved by the grid [cells]."""


@dataclass
class Profiles:
    """Plane failure over a map.

    Attributes:
        factor: Smallest factor of safety of the profiles over a cell, nan elsewhere, shape
            (rows, columns).
        set_of: Set of that profile, from 1; 0 for none.
        count: Number of profiles found.
    """

    factor: Floats
    set_of: NDArray[np.uint8]
    count: int


def screen_profiles(ground: Ground, planes: Sequence[JointPlane], limits: Limits) -> Profiles:
    """Search plane failure at every cell.

    The profile goes against the dip direction from the point where the plane daylights to the point
    where it meets the ground again. F = (c L + W cos(dip) tan(phi)) / (W sin(dip)) per metre of
    width. Its sides are assumed free. For the limits of volume its width equals its length in plan.
    """
    shape = ground.grid.values.shape
    out = Profiles(np.full(shape, np.nan), np.zeros(shape, np.uint8), 0)
    for number, plane in enumerate(planes, 1):
        sliding = on_one(plane)
        if sliding is None:
            continue
        leaves = ground.normal @ sliding.direction > LEAST_FALL
        places = np.argwhere(leaves)
        count = _longest(ground)
        for part in np.array_split(places, max(1, len(places) * count // AT_ONCE)):
            if len(part):
                _look(out, ground, number, plane, part, limits)
    return out


def _longest(ground: Ground) -> int:
    """Most points of a profile."""
    size = np.array(ground.grid.values.shape[::-1]) * ground.grid.step
    return int(np.hypot(*size) / _step(ground)) + 2


def _step(ground: Ground) -> float:
    return min(ground.grid.step)


def _look(
    out: Profiles,
    ground: Ground,
    number: int,
    plane: JointPlane,
    places: NDArray[np.int64],
    limits: Limits,
) -> None:
    """Profiles from some cells, whose row and column are given, shape (places, 2)."""
    grid, step = ground.grid, _step(ground)
    azimuth, rise = np.radians(plane.dip_direction), np.tan(np.radians(plane.dip))
    along = -step * np.array([np.sin(azimuth), np.cos(azimuth)])
    start = np.column_stack([ground.x[places[:, 1]], ground.y[places[:, 0]]])
    base = grid.values[places[:, 0], places[:, 1]]
    going = np.arange(len(places))
    area, length = np.zeros(len(places)), np.zeros(len(places), int)
    for k in range(1, _longest(ground)):
        at = start[going] + k * along
        t = grid(at) - base[going] - k * step * rise
        inside = ((at >= grid.low) & (at <= grid.high)).all(axis=1) & np.isfinite(t)
        above = inside & (t > 0)
        length[going[~inside]] = -1  # it continues beyond the known ground
        area[going[above]] += t[above] * step
        length[going[above]] = k
        going = going[above]
        if not len(going):
            break
    plan = length * step
    volume = area * plan
    good = (length >= LEAST_POINTS) & (volume >= limits.smallest) & (volume <= limits.largest)
    sine, cosine = np.sin(np.radians(plane.dip)), np.cos(np.radians(plane.dip))
    weight = limits.unit_weight * area[good]
    held = plane.cohesion * plan[good] / cosine + weight * cosine * plane.tangent
    _draw(out, ground, number, places[good], length[good], held / (weight * sine), along)
    out.count += int(good.sum())


def _draw(
    out: Profiles,
    ground: Ground,
    number: int,
    places: NDArray[np.int64],
    length: NDArray[np.int64],
    factor: Floats,
    along: Floats,
) -> None:
    """Give the cells below profiles their factor, if it is the smallest."""
    order = np.argsort(-factor, kind="stable")  # the smallest comes last and remains
    places, length, factor = places[order], length[order], factor[order]
    rows, columns = out.factor.shape
    least = np.full(out.factor.shape, np.inf)
    for k in range(int(length.max(initial=-1)) + 1):
        here = length >= k
        j = np.rint(places[here, 1] + k * along[0] / ground.grid.step[0]).astype(int)
        i = np.rint(places[here, 0] + k * along[1] / ground.grid.step[1]).astype(int)
        inside = (i >= 0) & (i < rows) & (j >= 0) & (j < columns)
        np.minimum.at(least, (i[inside], j[inside]), factor[here][inside])
    worse = np.isfinite(least) & ~(out.factor <= least)
    out.factor[worse] = least[worse]
    out.set_of[worse] = number
