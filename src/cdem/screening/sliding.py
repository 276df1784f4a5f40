"""Modes of sliding of bodies on one or two planes under any force, and their factors of safety."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cdem.screening.planes import JointPlane

Floats = NDArray[np.float64]
Kind = Literal["both", "first", "second", "plane", "lifts"]

KINDS: tuple[Kind, ...] = ("both", "first", "second", "plane", "lifts")
"""On both planes of a pair, on the first or second alone, on a single plane, on none."""
BOTH, FIRST, SECOND, PLANE, LIFTS = range(5)
DOWN = np.array([0.0, 0.0, -1.0])
LEAST_FALL = 1e-6
"""A line of sliding with a smaller downward component does not slide."""
LEAVES = 1e-9
"""A direction leaves a plane if its component along the normal is larger [1]."""


@dataclass(frozen=True)
class Sliding:
    """The mode of sliding of a body under its own weight.

    Attributes:
        kind: On both planes of a pair, on the first or second alone, or on a single plane.
        direction: Unit vector of sliding.
    """

    kind: Kind
    direction: Floats

    @property
    def drive(self) -> float:
        """Force along the direction over the weight [1]."""
        return float(-self.direction[2])

    @property
    def heading(self) -> Floats:
        """Horizontal unit vector of sliding, shape (2,)."""
        return self.direction[:2] / np.hypot(*self.direction[:2])


@dataclass(frozen=True)
class Rest:
    """What planes do with forces on bodies.

    Attributes:
        kind: Index of `KINDS`, shape (...).
        normal: Normal force of each plane, 0 where the body leaves it [N], shape (..., planes).
        along: The part of the force that no plane takes [N], shape (..., 3).
    """

    kind: NDArray[np.int64]
    normal: Floats
    along: Floats


def rest_on(normals: Floats, force: Floats) -> Rest:
    """Planes that hold bodies against a force, which may press in any direction.

    After Warburton (1981): a body lifts off if the force leaves all planes; it slides on one plane
    if the part of the force along that plane leaves the other plane; else on both, along their
    intersection. Friction does not matter for the mode.

    Args:
        normals: Unit normals that point into the body, shape (planes, 3); one plane, or two that
            are not parallel.
        force: Sum of all forces but those of the rock below [N], shape (..., 3).
    """
    press = -force @ normals.T
    alone = np.maximum(press, 0.0)
    if len(normals) == 1:
        kind = np.where(press[..., 0] > 0, PLANE, LIFTS)
        return Rest(kind, alone, force + alone * normals[0])
    cosine = float(normals[0] @ normals[1])
    # what remains along one plane presses on the other one by this much
    inward = press - cosine * press[..., ::-1]
    slides = force[..., None, :] + press[..., None] * normals  # along each plane, (..., 2, 3)
    bar = -LEAVES * np.linalg.norm(slides, axis=-1)[..., ::-1]
    on_both = (inward >= bar).all(axis=-1)
    first = (press[..., 0] > 0) & (inward[..., 1] < bar[..., 1])
    second = (press[..., 1] > 0) & (inward[..., 0] < bar[..., 0])
    kind = np.select([first, second, on_both], [FIRST, SECOND, BOTH], LIFTS)
    each = kind[..., None]
    normal = np.where(each == BOTH, np.maximum(inward, 0.0) / (1 - cosine**2), 0.0)
    normal = np.where(each == np.array([FIRST, SECOND]), alone, normal)
    return Rest(kind, normal, force + normal @ normals)


def factors(
    normals: Floats, tangents: Floats, cohesive: Floats, force: Floats
) -> tuple[Floats, NDArray[np.int64]]:
    """Factors of safety of bodies, and their modes as indices of `KINDS`.

    F = (sum of N tan(phi) + sum of c A of the planes in contact) / force along the sliding; 0 for a
    body that lifts off.

    Args:
        normals: Unit normals that point into the bodies, shape (planes, 3).
        tangents: Tangents of the friction angles [1], shape (..., planes).
        cohesive: Cohesion times area [N], shape (..., planes).
        force: As in `rest_on`, shape (..., 3).
    """
    rest = rest_on(normals, force)
    held = np.where(rest.normal > 0, rest.normal * tangents + cohesive, 0.0).sum(axis=-1)
    drive = np.linalg.norm(rest.along, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(rest.kind == LIFTS, 0.0, held / drive)
    return factor, rest.kind


def on_one(plane: JointPlane) -> Sliding | None:
    """Sliding down a plane; None if it is flat."""
    return _sliding(plane.normal[None])


def on_two(first: JointPlane, second: JointPlane) -> Sliding | None:
    """Sliding of a wedge; None if it does not slide, or the planes are parallel."""
    normals = np.array([first.normal, second.normal])
    if np.linalg.norm(np.cross(*normals)) < LEAST_FALL:
        # of two parallel planes the one that is left holds nothing
        return None
    return _sliding(normals)


def _sliding(normals: Floats) -> Sliding | None:
    rest = rest_on(normals, DOWN)
    size = float(np.linalg.norm(rest.along))
    if size < LEAST_FALL:
        return None
    return Sliding(KINDS[int(rest.kind)], rest.along / size)
