"""Bolts and cables of a case: what they are made of, where they are, when they come and go."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from cdem.case.bodies_schema import exactly_one
from cdem.case.surface_schema import Surface
from cdem.case.types import Direction3, FileName, Length3, Name, Part, Quantity

Force = Annotated[float, Quantity("N", above=0)]


def _true_is_empty(value: object) -> object:
    """`plate: true` is `plate: {}`, and `plate: false` is none."""
    return ({} if value else None) if isinstance(value, bool) else value


class Grout(Part):
    """What holds a bolt along its hole."""

    stiffness: Annotated[float, Quantity("N/m2", above=0)] = Field(
        description="Force per length of bolt and slip [N/m2]"
    )
    strength: Annotated[float, Quantity("N/m", above=0)] = Field(
        description="Force per length of bolt at which it slips [N/m]"
    )


class Dowel(Part):
    """How a bolt resists the shift of a joint that it crosses."""

    stiffness: Annotated[float, Quantity("N/m", above=0)] | None = Field(
        None,
        description="Force per shift [N/m]; default E I b3, b = (k / (4 E I))^(1/4): two beams on the "
        "ground that bend about the joint, k the Young's modulus of the softer rock",
    )
    strength: Force | None = Field(
        None,
        description="Force at which it shears off plastically [N]; default half the yield force",
    )


class BoltType(Part):
    """What bolts of a type are made of."""

    area: Annotated[float, Quantity("m2", above=0)] = Field(description="Section of the steel [m2]")
    young_modulus: Annotated[float, Quantity("Pa", above=0)] = Field(
        description="Young's modulus of the steel [Pa]"
    )
    yield_force: Force = Field(description="Axial force at which it yields in tension [N]")
    compressive_force: Annotated[float, Quantity("N", at_least=0)] | None = Field(
        None,
        description="The same in compression; 0 for a cable, which cannot be pushed [N]; default the "
        "yield force",
    )
    rupture_strain: Annotated[float, Quantity("1", above=0)] | None = Field(
        None, description="Strain at which it tears, elastic and plastic [1]; default never"
    )
    grout: Grout | None = Field(None, description="Grout; without it only plate and anchor hold")
    dowel: Annotated[Dowel | None, BeforeValidator(_true_is_empty)] = Field(
        None, description="Resistance to shear where it crosses a joint; true for the defaults"
    )

    @model_validator(mode="after")
    def _tears_after_it_yields(self) -> BoltType:
        yields = self.yield_force / (self.area * self.young_modulus)
        if self.rupture_strain is not None and self.rupture_strain <= yields:
            raise ValueError(
                f"rupture_strain {self.rupture_strain:g} is below the strain {yields:.3g} at which "
                "the steel yields; give the strain at which it tears"
            )
        return self


class Fixture(Part):
    """A plate at the head, or an anchor at the toe."""

    stiffness: Annotated[float, Quantity("N/m", above=0)] | None = Field(
        None, description="Force per displacement [N/m]; default that of 0.1 m of the bolt"
    )
    strength: Force | None = Field(
        None, description="Force at which it gives way plastically [N]; default never"
    )


class Pattern(Part):
    """Bolts on a grid on a surface."""

    surface: Surface = Field(description="Surface of the mesh, or {group, normal}")
    spacing: Annotated[
        list[Annotated[float, Quantity("m", above=0)]], Field(min_length=2, max_length=2)
    ] = Field(description="Between rows along the surface, and up or across it [m]")
    length: Annotated[float, Quantity("m", above=0)] = Field(description="Of each bolt [m]")
    direction: Direction3 | None = Field(
        None, description="From head to toe; by default square into the surface [1]"
    )

    @model_validator(mode="after")
    def _direction_is_one(self) -> Pattern:
        if self.direction is not None and not any(self.direction):
            raise ValueError("direction must not be [0, 0, 0]")
        return self


class Rings(Part):
    """Bolts in rings about an axis, such as that of a tunnel."""

    axis: Annotated[list[Length3], Field(min_length=2, max_length=2)] = Field(
        description="Two points on the axis: the first ring is at the first, the last before the second "
        "[m]"
    )
    spacing: Annotated[float, Quantity("m", above=0)] = Field(
        description="Between rings along the axis [m]"
    )
    count: int = Field(ge=1, le=10_000, description="Bolts of a ring")
    angles: Annotated[
        list[Annotated[float, Quantity("deg")]], Field(min_length=2, max_length=2)
    ] = Field(
        [0.0, 360.0],
        description="First and last bolt of a ring, about the axis from the upward direction, "
        "right-handed; a full turn is divided evenly [deg]",
    )
    inside: Name | None = Field(
        None, description="Group that fills the opening until it is dug out; none if it is open"
    )
    length: Annotated[float, Quantity("m", above=0)] = Field(description="Of each bolt [m]")

    @model_validator(mode="after")
    def _has_an_axis(self) -> Rings:
        if np.ptp(self.axis, axis=0).max() == 0:
            raise ValueError(
                "axis: its two points are the same; give the ends of the tunnel's axis"
            )
        if not self.angles[0] <= self.angles[1] <= self.angles[0] + 360:
            raise ValueError("angles must be [first, last] with last within a turn after first")
        return self


class Bolts(Part):
    """A bolt, or bolts in a pattern; the head is at the surface, the toe in the rock."""

    name: FileName = Field(
        description="Name, unique in the case; the bolts of a pattern are name.1, name.2, ..."
    )
    type: Name = Field(description="A name under bolt_types")
    points: Annotated[list[Length3], Field(min_length=2)] | None = Field(
        None, description="One bolt along these points, from head to toe [m]"
    )
    pattern: Pattern | None = Field(None, description="Bolts on a surface")
    rings: Rings | None = Field(None, description="Bolts about a tunnel")
    free_length: Annotated[float, Quantity("m", at_least=0)] = Field(
        0.0, description="Length from the head without grout [m]"
    )
    plate: Annotated[Fixture | None, BeforeValidator(_true_is_empty)] = Field(
        None, description="Plate that presses on the rock at the head; true for the defaults"
    )
    anchor: Annotated[Fixture | None, BeforeValidator(_true_is_empty)] = Field(
        None, description="Anchor at the toe, which holds both ways; true for the defaults"
    )
    pretension: Annotated[float, Quantity("N", at_least=0)] = Field(
        0.0, description="Force to which the head is pulled when it is installed, then locked [N]"
    )
    install: Name | None = Field(
        None, description="Stage at whose beginning they are installed; by default the first"
    )
    remove: Name | None = Field(None, description="Stage at whose beginning they are removed")

    @model_validator(mode="after")
    def _fits_together(self) -> Bolts:
        exactly_one(self, ("points", "pattern", "rings"))
        if self.pretension and self.plate is None:
            raise ValueError("pretension needs a plate that locks it; add plate: true")
        if self.points is not None and not (np.diff(self.points, axis=0) != 0).any(axis=1).all():
            raise ValueError("points: two that follow each other are the same")
        return self
