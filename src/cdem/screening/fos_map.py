"""A map of the smallest factor of safety: all wedges and planes of joint sets through the ground."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.screening.bodies import Body, Ground, Limits
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
MODES = {"both": 1, "first": 2, "second": 2, "plane": 3}
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
        mode: Mode of that body: 1 a wedge on both planes, 2 on one of them, 3 a single plane; 0
            none.
        profiles: Plane failure of profiles, per metre of width.
        tried: Number of starting points.
        count: Number of bodies found.
        at_limit: Number of them within a fifth of the largest volume.
        bodies: Distinct bodies, the worst first.
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

    def _take(self, body: Body) -> None:
        """Write a body into its cells wherever it is the worst so far."""
        window = body.window
        worse = body.cells & ~(self.factor[window] <= body.factor)
        self.factor[window][worse] = body.factor
        self.volume[window][worse] = body.volume
        self.mode[window][worse] = MODES[body.sliding.kind]
        self.count += 1
        self.at_limit += body.volume > 0.8 * self.limits.largest


def screen(
    ground: Ground,
    planes: Sequence[JointPlane],
    limits: Limits,
    stride: int = 4,
    report: Callable[[str, float], None] | None = None,
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

    Raises:
        CaseError: The limits exclude all bodies.
    """
    _check(ground, limits, stride)
    shape = ground.grid.values.shape
    out = FosMap(
        ground,
        limits,
        np.full(shape, np.nan),
        np.full(shape, np.nan),
        np.zeros(shape, np.uint8),
        screen_profiles(ground, planes, limits),
    )
    some = [((plane,), on_one(plane)) for plane in planes]
    some += [(pair, on_two(*pair)) for pair in combinations(planes, 2)]  # type: ignore[misc]
    found: list[Body] = []
    for number, (group, sliding) in enumerate(some):
        if sliding is not None and sliding.drive > LEAST_FALL:
            name = " and ".join(plane.name for plane in group)

            def show(part: float, name: str = name, done: int = number) -> None:
                if report:
                    report(f"bodies of {name}", (done + part) / len(some))

            found += _bodies_of(out, group, sliding, stride, show)
    out.bodies = _different(found, shape)
    return out


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
    ground = out.ground
    leaves = ground.normal @ sliding.direction > LEAST_FALL
    inside = np.zeros(leaves.shape, bool)
    inside[MARGIN:-MARGIN, MARGIN:-MARGIN] = True
    leaves &= inside
    first = np.zeros(leaves.shape, bool)
    first[::stride, ::stride] = leaves[::stride, ::stride]
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
        body = out.ground.body(planes, sliding, (i, j), out.limits)
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
