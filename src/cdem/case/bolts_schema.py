"""Bolts and cables of a case: section, places, and stages of installation and removal."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from cdem.case.bodies_schema import exactly_one
from cdem.case.loads_schema import Region
from cdem.case.surface_schema import Surface
from cdem.case.types import Direction3, FileName, Length3, Name, Part, Quantity

Force = Annotated[float, Quantity("N", above=0)]


def _true_is_empty(value: object) -> object:
    """`plate: true` means `plate: {}`, and `plate: false` means no plate."""
    return ({} if value else None) if isinstance(value, bool) else value


class Grout(Part):
    """The grout of a bolt."""

    stiffness: Annotated[float, Quantity("N/m2", above=0)] = Field(
        description="Force per length of bolt and slip [N/m2]"
    )
    strength: Annotated[float, Quantity("N/m", above=0)] = Field(
        description="Force per length of bolt at which it slips [N/m]"
    )


class Dowel(Part):
    """Resistance of a bolt to the shift of a joint that it crosses."""

    stiffness: Annotated[float, Quantity("N/m", above=0)] | None = Field(
        None,
        description="Force per shift [N/m]; default E I b3, b = (k / (4 E I))^(1/4): two beams on the "
        "ground that bend about the joint, k the Young's modulus of the softer rock",
    )
    strength: Force | None = Field(
        None,
        description="Force at which it yields in shear [N]; default half the yield force",
    )


class BoltType(Part):
    """Section and strength of a type of bolt."""

    area: Annotated[float, Quantity("m2", above=0)] = Field(description="Section of the steel [m2]")
    young_modulus: Annotated[float, Quantity("Pa", above=0)] = Field(
        description="Young's modulus of the steel [Pa]"
    )
    yield_force: Force = Field(description="Axial force at which it yields in tension [N]")
    compressive_force: Annotated[float, Quantity("N", at_least=0)] | None = Field(
        None,
        description="Force at which it yields in compression [N]; 0 for a cable; default the "
        "yield force",
    )
    rupture_strain: Annotated[float, Quantity("1", above=0)] | None = Field(
        None, description="Total strain at rupture (elastic and plastic) [1]; default never"
    )
    grout: Grout | None = Field(
        None, description="Grout; without it only plate and anchor hold the bolt"
    )
    dowel: Annotated[Dowel | None, BeforeValidator(_true_is_empty)] = Field(
        None, description="Resistance to shear at joints; true for the defaults"
    )

    @model_validator(mode="after")
    def _tears_after_it_yields(self) -> BoltType:
        yields = self.yield_force / (self.area * self.young_modulus)
        if self.rupture_strain is not None and self.rupture_strain <= yields:
            raise ValueError(
                f"rupture_strain {self.rupture_strain:g} is below the strain {yields:.3g} at which "
                "the steel yields; give the total strain at rupture"
            )
        return self


class Fixture(Part):
    """A plate at the head, or an anchor at the toe."""

    stiffness: Annotated[float, Quantity("N/m", above=0)] | None = Field(
        None, description="Force per displacement [N/m]; default: as 0.1 m of the bolt"
    )
    strength: Force | None = Field(None, description="Force at which it yields [N]; default never")


class Pattern(Part):
    """Bolts in rows on a surface."""

    surface: Surface = Field(description="Surface of the mesh, or {group, normal}")
    box: Region | None = Field(
        None, description="Only heads in this box, where the rows are centred; default the surface"
    )
    spacing: Annotated[
        list[Annotated[float, Quantity("m", above=0)]], Field(min_length=2, max_length=2)
    ] = Field(description="Spacing along a row, and of the rows up or across the surface [m]")
    length: Annotated[float, Quantity("m", above=0)] = Field(description="Length of each bolt [m]")
    direction: Direction3 | None = Field(
        None, description="From head to toe; default normal to the surface [1]"
    )

    @model_validator(mode="after")
    def _direction_is_one(self) -> Pattern:
        if self.direction is not None and not any(self.direction):
            raise ValueError("direction must not be [0, 0, 0]")
        return self


class Rings(Part):
    """Bolts in rings about an axis, e.g. of a tunnel."""

    axis: Annotated[list[Length3], Field(min_length=2, max_length=2)] = Field(
        description="Two points on the axis: the first ring is at the first, the last before the second "
        "[m]"
    )
    spacing: Annotated[float, Quantity("m", above=0)] = Field(
        description="Spacing of rings along the axis [m]"
    )
    count: int = Field(ge=1, le=10_000, description="Bolts per ring")
    angles: Annotated[
        list[Annotated[float, Quantity("deg")]], Field(min_length=2, max_length=2)
    ] = Field(
        [0.0, 360.0],
        description="First and last bolt of a ring, about the axis from the upward direction, "
        "right-handed; a full turn is divided evenly [deg]",
    )
    inside: Name | None = Field(
        None, description="Group in the opening that is excavated later; none for an open tunnel"
    )
    length: Annotated[float, Quantity("m", above=0)] = Field(description="Length of each bolt [m]")

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
        0.0, description="Free length at the head, without grout [m]"
    )
    plate: Annotated[Fixture | None, BeforeValidator(_true_is_empty)] = Field(
        None, description="Plate at the head, which only presses; true for the defaults"
    )
    anchor: Annotated[Fixture | None, BeforeValidator(_true_is_empty)] = Field(
        None, description="Anchor at the toe, which pulls and presses; true for the defaults"
    )
    pretension: Annotated[float, Quantity("N", at_least=0)] = Field(
        0.0, description="Pretension at installation, then locked at the head [N]"
    )
    install: Name | None = Field(
        None, description="Stage that installs the bolts at its beginning; default the first"
    )
    remove: Name | None = Field(None, description="Stage that removes the bolts at its beginning")

    @model_validator(mode="after")
    def _fits_together(self) -> Bolts:
        exactly_one(self, ("points", "pattern", "rings"))
        if self.pretension and self.plate is None:
            raise ValueError("pretension needs a plate to lock it; add plate: true")
        if self.points is not None and not (np.diff(self.points, axis=0) != 0).any(axis=1).all():
            raise ValueError("points: two successive points are equal; remove one")
        return self
