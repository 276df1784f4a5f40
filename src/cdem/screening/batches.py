"""Bodies on the same planes, evaluated together under all loads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.screening.loads import UNIT_WATER, Loads, force_on
from cdem.screening.planes import JointPlane
from cdem.screening.sliding import Sliding, factors
from cdem.screening.yields import yield_accelerations

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Batch:
    """Bodies on the same planes.

    Attributes:
        planes: One or two planes.
        sliding: How a body slides on them under its weight.
        weight: Weights [N], shape (bodies,).
        areas: Areas of the planes [m2], shape (bodies, planes).
        heads: Mean height of the water table above each plane, for a share of 1 [m], same shape.
    """

    planes: tuple[JointPlane, ...]
    sliding: Sliding
    weight: Floats
    areas: Floats
    heads: Floats

    @property
    def normals(self) -> Floats:
        """Unit normals of the planes, shape (planes, 3)."""
        return np.array([plane.normal for plane in self.planes])

    @property
    def tangents(self) -> Floats:
        """Tangents of the friction angles [1], shape (planes,)."""
        return np.array([plane.tangent for plane in self.planes])

    @property
    def cohesions(self) -> Floats:
        """Cohesions [Pa], shape (planes,)."""
        return np.array([plane.cohesion for plane in self.planes])

    def force(self, kh: float, kv: float, share: float) -> Floats:
        """Forces on the bodies [N], shape (bodies, 3), under shaking [g] and a share of water."""
        lift = UNIT_WATER * share * self.heads * self.areas
        return force_on(self.weight, self.sliding.heading, kh, kv, 0.0, lift, self.normals)

    def factors(
        self, loads: Loads, tangents: Any = None, cohesions: Any = None
    ) -> tuple[Floats, NDArray[np.int64]]:
        """Factors of safety and modes, as indices of `KINDS`, shape (bodies,).

        Args:
            loads: Water and shaking.
            tangents: Other tangents of the friction angles [1], shape (planes,).
            cohesions: Other cohesions [Pa], shape (planes,).
        """
        tangents = self.tangents if tangents is None else tangents
        cohesive = (self.cohesions if cohesions is None else cohesions) * self.areas
        force = self.force(loads.kh, loads.kv, loads.share)
        return factors(self.normals, tangents, cohesive, force)

    def yields(self, loads: Loads) -> Floats:
        """Yield accelerations [g], shape (bodies,), with water and vertical shaking."""
        still = self.force(0.0, loads.kv, loads.share)
        shaking = self.force(1.0, loads.kv, loads.share) - still
        cohesive = self.cohesions * self.areas
        return yield_accelerations(self.normals, self.tangents, cohesive, still, shaking)
