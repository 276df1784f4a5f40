"""Walls of loose boxes for the problems of this folder: limit analysis, tilt, blocks of a case.

The balance of rigid blocks without tension and with Coulomb friction is linear, so the largest tilt at
which forces in balance exist is a linear programme (Livesley 1978, Limit analysis of structures
formed from rigid blocks, IJNME 12, 1853-1871).

Boxes are rows of left, bottom, width, height and depth [m], shape (boxes, 5), in the plane of the
wall; they stand on a floor at z = 0, and tilting turns gravity from -z towards +x.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cdem.case.case import Case

Floats = NDArray[np.float64]

TOUCH = 1e-9
"""Sides as near as this are flush [m]."""


def tilt(case: Case, degrees: float, azimuth: float = 0.0) -> None:
    """Turn gravity instead of the model, towards the azimuth from x to y [deg]."""
    angle, way = np.radians([degrees, azimuth])
    along = 9.81 * np.sin(angle)
    case.set("loads.gravity", [along * np.cos(way), along * np.sin(way), -9.81 * np.cos(angle)])


def course(
    bottom: float, start: float, end: float, length: float, height: float, *, half: bool
) -> list[tuple[float, float, float, float]]:
    """Boxes of one course, laid from its right end; `half` says that the first is a half [m].

    Returns:
        Rows of left, bottom, width and height.
    """
    rows, right, width = [], end, length / 2 if half else length
    while right - start > TOUCH:
        width = min(width, right - start)
        rows.append((right - width, bottom, width, height))
        right, width = right - width, length
    return rows


def block(group: str, box: Iterable[float], y: float = 0.0) -> str:
    """A box of the wall as an entry of ``model.blocks``; y is the place of its front [m]."""
    left, bottom, width, height, depth = (f"{v:.9g}" for v in box)
    return (f"{{group: {group}, box: {{size: [{width}, {depth}, {height}]}}, "
            f"translate: [{left}, {y:.9g}, {bottom}]}}")  # fmt: skip


def turning_limit(boxes: ArrayLike) -> float:
    """Tilt at which a part of the wall overturns about its right face, by hand [deg].

    A box at the face turns about its lower right corner and lifts all that stands on it, and all
    that stands on that: in a running bond a wedge behind a stepped crack. It turns as one, without
    slip, when its weight passes the corner; the head joints of the crack open. The worst box counts.
    """
    rows = np.asarray(boxes, float)
    left, bottom, width, height, depth = rows.T
    mass, right, top = width * height * depth, left + width, bottom + height
    x, z = left + width / 2, bottom + height / 2
    on = np.abs(bottom[:, None] - top) < TOUCH  # box i stands on box j
    on &= np.minimum(right[:, None], right) - np.maximum(left[:, None], left) > TOUCH
    worst = np.inf
    for box in np.flatnonzero(right > right.max() - TOUCH):
        lifted = np.zeros(len(rows), bool)
        lifted[box] = True
        while (more := on[:, lifted].any(axis=1) & ~lifted).any():
            lifted |= more
        arm = mass[lifted] @ (right[box] - x[lifted])
        worst = min(worst, arm / (mass[lifted] @ (z[lifted] - bottom[box])))
    return float(np.degrees(np.arctan(worst)))


def tilt_limit(boxes: ArrayLike, bed_friction: float, head_friction: float) -> float:
    """Largest tilt at which forces in balance exist [deg], by linear programming.

    Forces act in both ends of each touching pair of sides. That the wall fails there, and not
    before, is a theorem for joints that dilate as they slide; for Coulomb's, which do not, it is an
    upper bound, and exact if boxes only turn or if they slide without friction.

    Args:
        boxes: See above.
        bed_friction: Friction angle of horizontal joints [deg].
        head_friction: Of vertical joints [deg].
    """
    rows = np.asarray(boxes, float)
    mass = rows[:, 2:].prod(axis=1)
    weight, size = mass / mass.mean(), rows[:, 2:4].max()
    centre = rows[:, :2] + rows[:, 2:4] / 2
    beds, heads = np.tan(np.radians([bed_friction, head_friction]))
    columns = []  # shares of the forces at the edges of the friction cones in the balances of boxes
    for one, other, point, normal in joints(rows):
        friction = beds if normal[1] else heads
        for way in (-friction, friction):
            force = normal + way * np.array([normal[1], -normal[0]])
            column = np.zeros((len(rows), 3))
            for box, sign in ((one, 1), (other, -1)):
                if box >= 0:
                    x, z = (point - centre[box]) / size
                    column[box] = sign * np.array([*force, z * force[0] - x * force[1]])
            columns.append(column.ravel())
    down, along = np.zeros((2, len(rows), 3))
    down[:, 1], along[:, 0] = weight, weight
    cost = np.zeros(len(columns) + 1)
    cost[-1] = -1
    matrix = np.array([*columns, along.ravel()]).T
    return float(np.degrees(np.arctan(linear_programme(cost, matrix, down.ravel())[-1])))


def joints(boxes: Floats) -> list[tuple[int, int, Floats, Floats]]:
    """Contacts of boxes: (box, other or -1 for the floor, point, normal into the box)."""
    found: list[tuple[int, int, Floats, Floats]] = []
    up, right = np.eye(2)[::-1]
    for i, (x, z, wide, high, _) in enumerate(boxes):
        if abs(z) < TOUCH:
            found += [(i, -1, np.array([end, z]), up) for end in (x, x + wide)]
        for j, (left, low, width, height, _) in enumerate(boxes):
            ends = max(x, left), min(x + wide, left + width)
            if abs(low + height - z) < TOUCH and ends[1] - ends[0] > TOUCH:  # i stands on j
                found += [(i, j, np.array([end, z]), up) for end in ends]
            ends = max(z, low), min(z + high, low + height)
            if abs(left + width - x) < TOUCH and ends[1] - ends[0] > TOUCH:  # i is right of j
                found += [(i, j, np.array([x, end]), right) for end in ends]
    return found


def linear_programme(
    cost: Floats, matrix: Floats, right: Floats, tolerance: float = 1e-5
) -> Floats:
    """Minimise cost . x with matrix x = right, x >= 0, by Mehrotra's predictor and corrector.

    Mehrotra (1992), On the implementation of a primal-dual interior point method, SIAM J. Optim.
    2(4), 575-601.

    Raises:
        ArithmeticError: It does not converge: there is no solution, or no bound.
    """

    def solve(
        dual_gap: Floats, primal_gap: Floats, product: Floats
    ) -> tuple[Floats, Floats, Floats]:
        normal = matrix @ ((x / s)[:, None] * matrix.T)
        normal[np.diag_indices_from(normal)] += 1e-13 * normal.diagonal().max()
        dy: Floats = np.asarray(
            np.linalg.solve(normal, primal_gap + matrix @ ((x * dual_gap - product) / s)),
            np.float64,
        )
        ds = dual_gap - matrix.T @ dy
        return (product - x * ds) / s, dy, ds

    def longest(value: Floats, change: Floats) -> float:
        falls = change < 0
        return min(1.0, (-value[falls] / change[falls]).min(initial=np.inf))

    x, s, y = np.ones_like(cost), np.ones_like(cost), np.zeros_like(right)
    for _ in range(100):
        dual_gap, primal_gap = cost - matrix.T @ y - s, right - matrix @ x
        mean = x @ s / len(x)
        if max(x @ s, abs(dual_gap).max(), abs(primal_gap).max()) < tolerance:
            return x
        if max(x.max(), s.max()) > 1e12:
            break
        dx, dy, ds = solve(dual_gap, primal_gap, -x * s)
        ahead = (x + longest(x, dx) * dx) @ (s + longest(s, ds) * ds) / len(x)
        dx, dy, ds = solve(dual_gap, primal_gap, (ahead / mean) ** 3 * mean - x * s - dx * ds)
        step, dual_step = 0.995 * longest(x, dx), 0.995 * longest(s, ds)
        x, y, s = x + step * dx, y + dual_step * dy, s + dual_step * ds
    raise ArithmeticError("the linear programme does not converge")
