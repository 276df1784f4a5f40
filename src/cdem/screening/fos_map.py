"""A map of the smallest factor of safety: all wedges and planes of joint sets through the ground."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.screening.bodies import Body, Ground, Limits
from cdem.screening.loads import Loads
from cdem.screening.planes import JointPlane
from cdem.screening.profiles import Profiles, screen_profiles
from cdem.screening.sliding import LEAST_FALL, Sliding, on_one, on_two

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

REFINED = 1.5
"""Around bodies with a lower factor, every cell of the map is a start."""
REFINED_SHARE = 0.1
"""The same around this fraction of the bodies, those with the lowest factors."""
MARGIN = 2
"""Least distance of a body's start from the edge [cells]."""
ALIKE = 0.5
"""A body is not listed if worse ones cover more than this fraction of it [1]."""
MOST_LISTED = 200
MODES = {"both": 1, "first": 2, "second": 2, "plane": 3, "lifts": 4}
"""Numbers of the map of modes."""


@dataclass
class FosMap:
    """Results of a screening.

    Attributes:
        ground: The ground.
        limits: Limits of bodies.
        factor: Smallest factor of safety of the bodies that cover a cell, nan elsewhere, shape
            (rows, columns).
        volume: Volume of that body [m3].
        mode: Mode of that body: 1 a wedge on both planes, 2 on one of them, 3 a single plane, 4 it
            lifts off; 0 none.
        profiles: Plane failure of profiles, per metre of width.
        tried: Number of starting points.
        count: Number of bodies found.
        at_limit: Number of them within a fifth of the largest volume.
        bodies: Distinct bodies, the worst first.
        every: All bodies.
        loads: Water and shaking.
    """

    ground: Ground
    limits: Limits
    factor: Floats
    volume: Floats
    mode: NDArray[np.uint8]
    profiles: Profiles
    tried: int = 0
    count: int = 0
    at_limit: int = 0
    bodies: list[Body] = field(default_factory=list)
    every: list[Body] = field(default_factory=list, repr=False)
    loads: Loads = field(default_factory=Loads)

    def _take(self, body: Body) -> None:
        """Write a body into its cells wherever it is the worst so far."""
        window = body.window
        worse = body.cells & ~(self.factor[window] <= body.factor)
        self.factor[window][worse] = body.factor
        self.volume[window][worse] = body.volume
        self.mode[window][worse] = MODES[body.kind]
        self.count += 1
        self.at_limit += body.volume > 0.8 * self.limits.largest


def screen(
    ground: Ground,
    planes: Sequence[JointPlane],
    limits: Limits,
    stride: int = 4,
    report: Callable[[str, float], None] | None = None,
    *,
    loads: Loads | None = None,
    yields: bool = False,
) -> FosMap:
    """Search the bodies of all sets and pairs of sets.

    Bodies start at every `stride`-th cell at which their direction of sliding daylights, and at
    every cell around bodies with a low factor.

    Args:
        ground: The ground.
        planes: The sets.
        limits: Limits of bodies.
        stride: Cells between the points of the first search.
        report: Called with a text and the fraction done.
        loads: Water and shaking; none by default.
        yields: Whether to map yield accelerations of profiles too.

    Raises:
        CaseError: The limits exclude all bodies.
    """
    _check(ground, limits, stride)
    loads = loads or Loads()
    out = _empty(
        ground, limits, loads, screen_profiles(ground, planes, limits, loads, yields=yields)
    )
    some = _groups(planes)
    for number, (group, sliding) in enumerate(some):
        name = " and ".join(plane.name for plane in group)

        def show(part: float, name: str = name, done: int = number) -> None:
            if report:
                report(f"bodies of {name}", (done + part) / len(some))

        out.every += _bodies_of(out, group, sliding, stride, show)
    out.bodies = _different(out.every, out.factor.shape)
    return out


def screen_coarsely(
    ground: Ground, planes: Sequence[JointPlane], limits: Limits, stride: int, loads: Loads
) -> FosMap:
    """The first search of `screen` alone: a map of bodies that start at every `stride`-th cell."""
    shape = ground.grid.values.shape
    none = Profiles(np.full(shape, np.nan), np.zeros(shape, np.uint8), 0)
    out = _empty(ground, limits, loads, none)
    for group, sliding in _groups(planes):
        points = _leaving(ground, sliding) & _every(stride, shape)
        _bodies_at(out, group, sliding, points, lambda part: None)
    return out


def _groups(planes: Sequence[JointPlane]) -> list[tuple[tuple[JointPlane, ...], Sliding]]:
    """Sets and pairs of sets on which bodies slide."""
    some = [((plane,), on_one(plane)) for plane in planes]
    some += [(pair, on_two(*pair)) for pair in combinations(planes, 2)]  # type: ignore[misc]
    return [(group, s) for group, s in some if s is not None and s.drive > LEAST_FALL]


def _leaving(ground: Ground, sliding: Sliding) -> Bools:
    """Cells at which a direction of sliding daylights, off the edge of the map."""
    leaves = ground.normal @ sliding.direction > LEAST_FALL
    inside = np.zeros(leaves.shape, bool)
    inside[MARGIN:-MARGIN, MARGIN:-MARGIN] = True
    return leaves & inside


def _every(stride: int, shape: tuple[int, ...]) -> Bools:
    """Every `stride`-th cell of rows and columns."""
    out = np.zeros(shape, bool)
    out[::stride, ::stride] = True
    return out


def _empty(ground: Ground, limits: Limits, loads: Loads, profiles: Profiles) -> FosMap:
    shape = ground.grid.values.shape
    factor, volume = np.full(shape, np.nan), np.full(shape, np.nan)
    return FosMap(ground, limits, factor, volume, np.zeros(shape, np.uint8), profiles, loads=loads)


def _check(ground: Ground, limits: Limits, stride: int) -> None:
    if not 0 <= limits.smallest < limits.largest:
        raise CaseError(
            f"volumes from {limits.smallest:g} to {limits.largest:g} m3: the first must be below the "
            "second"
        )
    if stride < 1:
        raise CaseError(f"stride {stride}: must be at least 1")
    if min(ground.grid.values.shape) < 2 * MARGIN + 3:
        rows, columns = ground.grid.values.shape
        raise CaseError(f"a map of {rows} x {columns} cells is too small for bodies")


def _bodies_of(
    out: FosMap,
    planes: tuple[JointPlane, ...],
    sliding: Sliding,
    stride: int,
    show: Callable[[float], None],
) -> list[Body]:
    """The bodies of one set or pair."""
    leaves = _leaving(out.ground, sliding)
    first = leaves & _every(stride, leaves.shape)
    found = _bodies_at(out, planes, sliding, first, lambda part: show(0.5 * part))
    if stride == 1 or not found:
        return [body for _, body in found]
    limit = max(REFINED, float(np.quantile([b.factor for _, b in found], REFINED_SHARE)))
    around = np.zeros(leaves.shape, bool)
    for (i, j), body in found:
        if body.factor <= limit:
            around[max(0, i - stride + 1) : i + stride, max(0, j - stride + 1) : j + stride] = True
    more = _bodies_at(
        out, planes, sliding, around & leaves & ~first, lambda part: show(0.5 + 0.5 * part)
    )
    return [body for _, body in found + more]


def _bodies_at(
    out: FosMap,
    planes: tuple[JointPlane, ...],
    sliding: Sliding,
    points: Bools,
    show: Callable[[float], None],
) -> list[tuple[tuple[int, int], Body]]:
    places = np.argwhere(points).tolist()
    found = []
    for number, (i, j) in enumerate(places):
        body = out.ground.body(planes, sliding, (i, j), out.limits, out.loads)
        if body is not None:
            out._take(body)
            found.append(((i, j), body))
        if number % 200 == 0:
            show(number / len(places))
    out.tried += len(places)
    return found


def _different(bodies: list[Body], shape: tuple[int, ...]) -> list[Body]:
    """The worst bodies at different places; of equal ones the larger."""
    covered = np.zeros(shape, bool)
    out: list[Body] = []
    for body in sorted(bodies, key=lambda b: (b.factor, -b.volume)):
        there = covered[body.window]
        if there[body.cells].mean() <= ALIKE:
            there[body.cells] = True
            out.append(body)
            if len(out) == MOST_LISTED:
                break
    return out
