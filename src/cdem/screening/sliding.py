"""Mode of sliding of a body on one or two planes, and its factor of safety in closed form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cdem.screening.planes import JointPlane

Floats = NDArray[np.float64]
Kind = Literal["both", "first", "second", "plane"]

DOWN = np.array([0.0, 0.0, -1.0])
LEAST_FALL = 1e-6
"""A line of sliding with a smaller downward component does not slide."""


@dataclass(frozen=True)
class Sliding:
    """The mode of sliding of a body, and its resistance; all per weight.

    Attributes:
        kind: On both planes of a pair, on the first or second alone, or on a single plane.
        direction: Unit vector of sliding.
        normal: Normal force on each plane over the weight [1].
        grip: Sum of normal forces times tan(friction) over the weight [1].
    """

    kind: Kind
    direction: Floats
    normal: tuple[float, float]
    grip: float

    @property
    def drive(self) -> float:
        """Force along the direction over the weight [1]."""
        return float(-self.direction[2])

    def factor(self, weight: float, resistance: float) -> float:
        """Factor of safety, for a weight [N] and a resistance from cohesion [N]."""
        return (self.grip * weight + resistance) / (weight * self.drive)


def on_one(plane: JointPlane) -> Sliding | None:
    """Sliding down a plane; None if it is flat."""
    found = _down_plane(plane.normal)
    if found is None:
        return None
    direction, normal = found
    return Sliding("plane", direction, (normal, 0.0), normal * plane.tangent)


def on_two(first: JointPlane, second: JointPlane) -> Sliding | None:
    """Sliding of a wedge; None if it does not slide, or the planes are parallel.

    After Warburton (1981): it slides down one plane if that direction leaves the other plane, else
    along the intersection of both. Friction does not matter for the mode.
    """
    pairs: list[tuple[Kind, JointPlane, JointPlane]] = [
        ("first", first, second),
        ("second", second, first),
    ]
    for kind, own, other in pairs:
        found = _down_plane(own.normal)
        if found is not None and other.normal @ found[0] > 1e-9:
            direction, normal = found
            both = (normal, 0.0) if kind == "first" else (0.0, normal)
            return Sliding(kind, direction, both, normal * own.tangent)
    line = np.cross(first.normal, second.normal)
    size = float(np.linalg.norm(line))
    if size < 1e-6:
        return None
    line *= -np.sign(line[2]) / size
    if -line[2] < LEAST_FALL:
        return None
    cosine = float(first.normal @ second.normal)
    n = np.linalg.solve(
        [[1, cosine], [cosine, 1]], [-first.normal @ DOWN, -second.normal @ DOWN]
    ).tolist()
    return Sliding("both", line, (n[0], n[1]), n[0] * first.tangent + n[1] * second.tangent)


def _down_plane(normal: Floats) -> tuple[Floats, float] | None:
    """Direction of steepest descent of a plane, and its normal force per weight."""
    force = float(-normal @ DOWN)
    along = DOWN + force * normal
    size = float(np.linalg.norm(along))
    return None if size < LEAST_FALL else (along / size, force)
