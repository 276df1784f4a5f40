"""Initial stress of the rock."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from cdem.case.bodies_schema import exactly_one
from cdem.case.loads_schema import Region
from cdem.case.types import (
    Angle,
    Length3,
    Listed,
    Name,
    Part,
    Quantity,
    Stress3,
    Stress6,
    StressGradient6,
    Three,
)

RIGHT = 1.0
"""Largest deviation from a right angle between two given principal directions [deg]."""


class StressGradient(Part):
    """Change of a stress with the place."""

    x: StressGradient6 = Field([0.0] * 6, description="Per metre along x [Pa/m]")
    y: StressGradient6 = Field([0.0] * 6, description="Per metre along y [Pa/m]")
    z: StressGradient6 = Field([0.0] * 6, description="Per metre along z [Pa/m]")


class PrincipalStress(Part):
    """A stress by its principal values."""

    values: Stress3 = Field(description="Principal stresses, tension positive [Pa]")
    trends: Annotated[list[Angle], Three, Listed] = Field(
        description="Trends of their directions, clockwise from north (y) [deg]"
    )
    plunges: Annotated[list[Angle], Three, Listed] = Field(
        description="Plunges of their directions, below the horizontal [deg]"
    )

    @model_validator(mode="after")
    def _at_right_angles(self) -> PrincipalStress:
        d = self.directions()
        angles = np.degrees(np.arcsin(np.abs(np.einsum("ix,jx->ij", d, d) - np.eye(3)).clip(0, 1)))
        if angles.max() > RIGHT:
            raise ValueError(
                f"the directions of trends and plunges must be at right angles; two of them are "
                f"{angles.max():.3g} deg off"
            )
        return self

    def directions(self) -> np.ndarray:
        """Unit vectors of the directions, shape (3, 3)."""
        trend, plunge = np.radians(self.trends), np.radians(self.plunges)
        flat = np.cos(plunge)
        return np.stack([flat * np.sin(trend), flat * np.cos(trend), -np.sin(plunge)], axis=1)


class InitialStress(Part):
    """Initial stress of a part of the rock; a later entry replaces an earlier one.

    Tension is positive. One of `stress`, `principal` and `vertical` gives the stress.
    """

    groups: list[Name] | None = Field(None, min_length=1, description="Groups; all by default")
    box: Region | None = Field(None, description="Only elements in this box")
    stress: Stress6 | None = Field(
        None, description="xx, yy, zz, xy, yz, zx at the origin, tension positive [Pa]"
    )
    principal: PrincipalStress | None = Field(None, description="The same by principal values")
    origin: Length3 = Field([0.0, 0.0, 0.0], description="Point with this stress or principal [m]")
    gradient: StressGradient = Field(
        StressGradient(), description="Change of stress or principal with the place"
    )
    vertical: Literal["overburden"] | None = Field(
        None, description="overburden: the vertical stress is the weight of the rock above"
    )
    surface: Annotated[float, Quantity("m")] | Literal["top"] = Field(
        "top",
        description="With overburden: the top of the model, or the height z of the ground where the "
        "model ends below it [m]",
    )
    k0: Annotated[
        list[Annotated[float, Quantity("1", at_least=0)]],
        Field(min_length=1, max_length=2),
        BeforeValidator(lambda k0: [k0] if isinstance(k0, int | float | str) else k0),
        Listed,
    ] = Field([1.0], description="Horizontal over vertical stress: one value, or two directions")
    azimuth: Angle = Field(
        90.0, description="Azimuth of the first horizontal stress, clockwise from north (y) [deg]"
    )

    @model_validator(mode="after")
    def _one_kind(self) -> InitialStress:
        exactly_one(self, ("stress", "principal", "vertical"))
        others = ("origin", "gradient") if self.vertical else ("surface", "k0", "azimuth")
        for key in others:
            if key in self.model_fields_set:
                kind = "vertical: overburden" if self.vertical else "stress or principal"
                raise ValueError(f"{key} does not go with {kind}")
        return self
