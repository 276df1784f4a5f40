"""Second ways to the factors of safety: the kinematic theorem, Hoek & Bray's wedge, strips of a beam."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def root(balance: Callable[[float], float], low: float = 0.2, high: float = 5.0) -> float:
    """The factor at which a balance, which falls with it, is zero; by bisection."""
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if balance(middle) >= 0 else (low, middle)
    return low


def area(profile: Sequence[Sequence[float]]) -> float:
    """Of a polygon of points (x, z)."""
    x, z = np.array(profile, float).T
    return float(0.5 * abs(x @ np.roll(z, -1) - z @ np.roll(x, -1)))


def moving(
    load: Sequence[float], dip: float, friction: float, *, held: float = 0.0, lift: float = 0.0
) -> float:
    """Factor of safety of a body on planes of one dip by the kinematic theorem (Chen 1975, chapter 2).

    At the limit the body moves at the angle of friction to its planes, away from them. The loads then
    do as much work as cohesion takes: load . v + lift sin(phi) = held cos(phi), all strengths
    divided by F.

    Args:
        load: Force on the body without that of its planes, along x, the way the planes dip, and z.
        dip: Of the planes [deg].
        friction: Angle [deg].
        held: Cohesion times area, summed over the planes.
        lift: Force of water on the planes, normal to them.
    """

    def spared(factor: float) -> float:
        phi = np.arctan(np.tan(np.radians(friction)) / factor)
        way = np.radians(dip) - phi
        work = load[0] * np.cos(way) - load[1] * np.sin(way) + lift * np.sin(phi)
        return float(held / factor * np.cos(phi) - work)

    return root(spared)


def pushing(block: float, buttress: float, dip: float, friction: float, beside: float) -> float:
    """Factor of safety of a block that pushes a buttress, by the kinematic theorem.

    The block moves at phi to its plane, the buttress at phi to the floor, and both part at the angle
    of the joint between them: W1 v1 sin(b - phi) = W2 v2 sin(phi).

    Args:
        block: Its weight.
        buttress: Its weight.
        dip: Of the plane below the block [deg].
        friction: Angle of plane and floor [deg].
        beside: Angle of the vertical joint [deg].
    """

    def spared(factor: float) -> float:
        phi, j = (np.arctan(np.tan(np.radians(a)) / factor) for a in (friction, beside))
        way = np.radians(dip) - phi
        faster = (np.cos(way) + np.sin(way) * np.tan(j)) / (np.cos(phi) - np.sin(phi) * np.tan(j))
        return float(buttress * faster * np.sin(phi) - block * np.sin(way))

    return root(spared)


def wedge(
    normals: Sequence[Floats], strengths: Sequence[tuple[float, float]], face: Floats, height: float,
    unit: float, pressures: tuple[float, float] = (0.0, 0.0),
) -> float:  # fmt: skip
    """Factor of safety of a wedge from angles between its lines (Hoek & Bray 1981, chapter 8).

    F = 3 / (gamma H) ((c_a - p_a t_a) X + (c_b - p_b t_b) Y) + A t_a + B t_b

    Args:
        normals: Upward unit normals of both joints.
        strengths: Tangent of friction and cohesion [Pa] of each.
        face: Upward unit normal of the face; the ground above is flat.
        height: Of the line of both joints [m].
        unit: Weight of the rock [N/m3].
        pressures: Mean pressure of water on each joint [Pa].
    """
    top = np.array([0.0, 0.0, 1.0])

    def line(one: Floats, other: Floats) -> Floats:
        way = np.cross(one, other)
        return np.asarray(way / np.linalg.norm(way))

    def sine(one: Floats, other: Floats) -> float:
        return float(np.linalg.norm(np.cross(one, other)))

    a, b = normals
    meeting = line(a, b)
    steep, between = abs(meeting[2]), float(a @ b)
    factor = 0.0
    for own, other, (friction, cohesion), pressure in zip(
        (a, b), (b, a), strengths, pressures, strict=True
    ):
        at_face, at_top = line(other, face), line(other, top)
        share = sine(at_face, at_top) / (sine(at_top, meeting) * abs(float(at_face @ own)))
        factor += 3 / (unit * height) * (cohesion - pressure * friction) * share
        factor += friction * (own[2] - other[2] * between) / (steep * (1 - between**2))
    return float(factor)


def between_two(load: Floats, normals: Sequence[Floats], tangents: Sequence[float]) -> float:
    """Factor of safety of a body on two joints with friction, by projections of the load.

    N_a = -(L . n_a - (L . n_b) c) / (1 - c^2) with c = n_a . n_b (Goodman & Shi 1985, chapter 9).
    """
    a, b = normals
    c, along = float(a @ b), np.cross(a, b)
    drive = abs(float(load @ along)) / float(np.linalg.norm(along))
    pressed = [
        -float(load @ own - (load @ other) * c) / (1 - c**2) for own, other in ((a, b), (b, a))
    ]
    return sum(t * n for t, n in zip(tangents, pressed, strict=True)) / drive


def falling(weight: float, thrust: float, lean: float, friction: float) -> float:
    """Factor of safety of a wedge in a roof by the kinematic theorem.

    It falls at phi to both faces, and parts the abutments: W cos(phi - a) = 2 H sin(phi - a).

    Args:
        weight: Of the wedge less what anchors carry.
        thrust: Force on its sides, across.
        lean: Of its faces from the vertical [deg].
        friction: Angle of its faces [deg].
    """

    def spared(factor: float) -> float:
        way = np.arctan(np.tan(np.radians(friction)) / factor) - np.radians(lean)
        return float(2 * thrust * np.sin(way) - weight * np.cos(way))

    return root(spared)


def tension(weight: float, lean: float, length: float, thick: float, strips: int = 2000) -> float:
    """Largest tension at the foot of a slab that leans, by strips of its foot [Pa] (Navier).

    The foot stays plane: stress = a + s x. Strips carry the weight across the foot, and its moment.

    Args:
        weight: Of the slab, per metre of its width [N/m].
        lean: Of the slab from the vertical [rad].
        length: [m].
        thick: [m].
        strips: Number of them.
    """
    x = (np.arange(strips) + 0.5) / strips * thick - thick / 2
    wide = thick / strips
    sums = np.array([[strips * wide, x.sum() * wide], [x.sum() * wide, (x**2).sum() * wide]])
    forces = [-weight * np.cos(lean), weight * np.sin(lean) * length / 2]
    mean, slope = np.linalg.solve(sums, forces)
    return float(mean + abs(slope) * thick / 2)
