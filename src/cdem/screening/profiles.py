"""Plane failure of profiles down the dip of a set, per metre of width: requires free sides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.screening.bodies import Ground, Limits
from cdem.screening.loads import UNIT_WATER, Loads, force_on
from cdem.screening.planes import JointPlane
from cdem.screening.sliding import LEAST_FALL, Sliding, factors, on_one
from cdem.screening.yields import yield_accelerations

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
        yields: Smallest yield acceleration of the profiles over a cell [g]; None if not asked for.
    """

    factor: Floats
    set_of: NDArray[np.uint8]
    count: int
    yields: Floats | None = None


@dataclass
class _Sections:
    """Sections of profiles above their plane, per metre of width.

    Attributes:
        cells: Number of steps to the end; -1 without an end on known ground.
        plan: Length in plan [m].
        area: Area [m2].
        wet: Area below the water table, for a share of 1 [m2].
        cracked: Whether it ends at a tension crack.
        water: Height of water in the crack, for a share of 1 [m].
    """

    cells: NDArray[np.int64]
    plan: Floats
    area: Floats
    wet: Floats
    cracked: NDArray[np.bool_]
    water: Floats

    @classmethod
    def none(cls, count: int) -> _Sections:
        """Sections of no length."""
        plan, area, wet, water = (np.zeros(count) for _ in range(4))
        return cls(np.zeros(count, np.int64), plan, area, wet, np.zeros(count, bool), water)

    def some(self, which: NDArray[np.bool_]) -> _Sections:
        """Some of the sections."""
        return _Sections(**{name: values[which] for name, values in vars(self).items()})


def screen_profiles(
    ground: Ground,
    planes: Sequence[JointPlane],
    limits: Limits,
    loads: Loads | None = None,
    *,
    yields: bool = False,
) -> Profiles:
    """Search plane failure at every cell.

    The profile goes against the dip direction from the point where the plane daylights to the point
    where it meets the ground again, or to a vertical tension crack: where its thickness has grown
    beyond the depth of the crack and falls to it. Its sides are assumed free. For the limits of
    volume its width equals its length in plan. After Hoek & Bray (1981), with psi the dip, per
    metre of width:

    F = (c L + N tan(phi)) / (W ((1 - kv) sin(psi) + kh cos(psi)) + V cos(psi)),
    N = W ((1 - kv) cos(psi) - kh sin(psi)) - U - V sin(psi).

    With water of a height z_w in the crack V = gamma z_w^2 / 2. For a share U = gamma z_w L / 2 with
    a crack; without one, and for a water table, U is the sum of the pressure below that table.

    Args:
        ground: The ground.
        planes: The sets.
        limits: Limits of volume, and unit weight.
        loads: Water and shaking; none by default.
        yields: Whether to map yield accelerations too.
    """
    shape, loads = ground.grid.values.shape, loads or Loads()
    out = Profiles(np.full(shape, np.nan), np.zeros(shape, np.uint8), 0)
    if yields:
        out.yields = np.full(shape, np.nan)
    for number, plane in enumerate(planes, 1):
        sliding = on_one(plane)
        if sliding is None:
            continue
        leaves = ground.normal @ sliding.direction > LEAST_FALL
        places = np.argwhere(leaves)
        count = _longest(ground)
        for part in np.array_split(places, max(1, len(places) * count // AT_ONCE)):
            if len(part):
                _look(out, ground, number, plane, sliding, part, limits, loads)
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
    sliding: Sliding,
    places: NDArray[np.int64],
    limits: Limits,
    loads: Loads,
) -> None:
    """Profiles from some cells, whose row and column are given, shape (places, 2)."""
    azimuth = np.radians(plane.dip_direction)
    along = -_step(ground) * np.array([np.sin(azimuth), np.cos(azimuth)])
    found = _trace(ground, plane, places, along, loads)
    volume = found.area * found.plan
    good = (found.cells >= LEAST_POINTS) & (volume >= limits.smallest) & (volume <= limits.largest)
    some = found.some(good)
    length = some.plan / np.cos(np.radians(plane.dip))
    lift = UNIT_WATER * loads.share * some.wet / np.cos(np.radians(plane.dip))
    if loads.level is None:
        in_crack = 0.5 * UNIT_WATER * loads.share * some.water * length
        lift = np.where(some.cracked, in_crack, lift)
    push = 0.5 * UNIT_WATER * (loads.share * some.water) ** 2
    weight, normals = limits.unit_weight * some.area, plane.normal[None]
    tangents, cohesive = np.array([plane.tangent]), (plane.cohesion * length)[:, None]

    def force(kh: float) -> Floats:
        return force_on(weight, sliding.heading, kh, loads.kv, push, lift[:, None], normals)

    factor, _ = factors(normals, tangents, cohesive, force(loads.kh))
    ways = (places[good], some.cells, along)
    worse = _draw(out.factor, ground, factor, *ways)
    out.set_of[worse] = number
    if out.yields is not None:
        still = force(0.0)
        least = yield_accelerations(normals, tangents, cohesive, still, force(1.0) - still)
        _draw(out.yields, ground, least, *ways)
    out.count += int(good.sum())


def _trace(
    ground: Ground, plane: JointPlane, places: NDArray[np.int64], along: Floats, loads: Loads
) -> _Sections:
    """Sections from some cells, in steps `along` the plan [m]."""
    grid, step, rise = ground.grid, _step(ground), np.tan(np.radians(plane.dip))
    start = np.column_stack([ground.x[places[:, 1]], ground.y[places[:, 0]]])
    base = grid.values[places[:, 0], places[:, 1]]
    out, going = _Sections.none(len(places)), np.arange(len(places))
    before, wet = np.zeros(len(places)), np.zeros(len(places))  # thickness, head one step ago

    for k in range(1, _longest(ground)):
        at = start[going] + k * along
        bed = base[going] + k * step * rise
        t = grid(at) - base[going] - k * step * rise
        h = loads.heads_at(grid, at, bed, t)
        inside = ((at >= grid.low) & (at <= grid.high)).all(axis=1) & np.isfinite(t)
        cracks = inside & (before[going] > loads.crack) & (t <= loads.crack) & (loads.crack > 0)
        above = inside & (t > 0) & ~cracks
        out.cells[going[~inside]] = -1  # it continues beyond the known ground
        if cracks.any():
            end, last = going[cracks], before[going[cracks]]
            part = (last - loads.crack) / (last - t[cracks])
            plan = (k - 1 + part) * step
            deep = np.full(len(end), loads.crack)
            place = start[end] + plan[:, None] / step * along
            water = loads.heads_at(grid, place, base[end] + plan * rise, deep)
            # the trapezoid to the crack, in place of half a step
            out.area[end] += step * (part * (last + deep) - last) / 2
            out.wet[end] += step * (part * (wet[end] + water) - wet[end]) / 2
            out.plan[end], out.water[end], out.cracked[end] = plan, water, True
        some = going[above]
        out.area[some] += t[above] * step
        out.wet[some] += h[above] * step
        out.cells[some], out.plan[some] = k, k * step
        before[some], wet[some] = t[above], h[above]
        going = some
        if not len(going):
            break
    return out


def _draw(
    values: Floats,
    ground: Ground,
    value: Floats,
    places: NDArray[np.int64],
    length: NDArray[np.int64],
    along: Floats,
) -> NDArray[np.bool_]:
    """Give the cells below profiles their value, where it is the smallest; returns these cells."""
    order = np.argsort(-value, kind="stable")  # the smallest comes last and remains
    places, length, value = places[order], length[order], value[order]
    rows, columns = values.shape
    least = np.full(values.shape, np.inf)
    for k in range(int(length.max(initial=-1)) + 1):
        here = length >= k
        j = np.rint(places[here, 1] + k * along[0] / ground.grid.step[0]).astype(int)
        i = np.rint(places[here, 0] + k * along[1] / ground.grid.step[1]).astype(int)
        inside = (i >= 0) & (i < rows) & (j >= 0) & (j < columns)
        np.minimum.at(least, (i[inside], j[inside]), value[here][inside])
    worse = np.isfinite(least) & ~(values <= least)
    values[worse] = least[worse]
    return worse
