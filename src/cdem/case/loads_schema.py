"""Actions on the bodies of a case from outside: gravity, surface loads, driven and fixed nodes."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from cdem.case.blasts_schema import Blast
from cdem.case.bodies_schema import exactly_one
from cdem.case.surface_schema import AnySurfaceLoad, Surface
from cdem.case.timed_schema import Factored
from cdem.case.types import Acceleration3, Length3, Name, Part, Stress3, Velocity3

Axis = Literal["x", "y", "z"]
Axes = list[Axis]


class Region(Part):
    """All nodes inside a box along the axes."""

    min: Length3 = Field(description="Lowest corner [m]")
    max: Length3 = Field(description="Highest corner [m]")

    @model_validator(mode="after")
    def _ordered(self) -> Region:
        if any(low > high for low, high in zip(self.min, self.max, strict=True)):
            raise ValueError("min must not be above max")
        return self


class Traction(Factored):
    """A stress on faces, per area of the undeformed face."""

    surface: Surface = Field(description="Surface of the mesh, or {group, normal}")
    traction: Stress3 = Field(description="Force per area [Pa]")


class PrescribedVelocity(Factored):
    """Nodes with a prescribed velocity."""

    group: Name | None = Field(None, description="All nodes of this group")
    surface: Surface | None = Field(None, description="Surface of the mesh, or {group, normal}")
    point: Length3 | None = Field(None, description="The node nearest to this point [m]")
    box: Region | None = Field(None, description="All nodes in this box")
    components: Axes = Field(["x", "y", "z"], description="Driven directions")
    velocity: Velocity3 = Field(
        description="Velocity [m/s]; with a record, the factors of its velocity along x, y, z"
    )
    record: Name | None = Field(
        None,
        description="A name under records, whose velocity the nodes follow from the begin of the stage",
    )

    @property
    def has_curve(self) -> bool:
        """Whether it changes over time."""
        return super().has_curve or self.record is not None

    @model_validator(mode="after")
    def _one_selection(self) -> PrescribedVelocity:
        exactly_one(self, ("group", "surface", "point", "box"))
        if self.record is not None and self.history is not None:
            raise ValueError("give a history or a record, not both")
        if self.record is not None and not any(self.velocity):
            raise ValueError(
                "velocity [0, 0, 0] takes nothing of the record; write the factors of its motion along "
                "x, y, z, e.g. [1, 0, 0]"
            )
        return self


class Support(Part):
    """Nodes that are fixed."""

    surface: Surface | None = Field(None, description="Surface of the mesh, or {group, normal}")
    point: Length3 | None = Field(None, description="The node nearest to this point [m]")
    box: Region | None = Field(None, description="All nodes in this box")
    group: Name | None = Field(None, description="With point or box: only nodes of this group")
    fix: Axes = Field(min_length=1, description="Fixed directions")

    @model_validator(mode="after")
    def _one_selection(self) -> Support:
        exactly_one(self, ("surface", "point", "box"))
        if self.group is not None and self.surface is not None:
            raise ValueError("group goes with point or box; write surface: {group, normal}")
        return self


class Loads(Part):
    """Actions on the bodies from outside."""

    gravity: Acceleration3 = Field([0.0, 0.0, 0.0], description="Acceleration of gravity [m/s2]")
    tractions: list[Traction] = Field(
        [], description="Stresses on faces, in fixed directions, per initial area"
    )
    surfaces: list[AnySurfaceLoad] = Field(
        [], description="Laws on faces, which follow their motion: pressure, and laws of your own"
    )
    blasts: list[Blast] = Field([], description="Pressure of explosives on the walls of holes")
    velocities: list[PrescribedVelocity] = Field([], description="Driven nodes")
    supports: list[Support] = Field([], description="Held nodes")
