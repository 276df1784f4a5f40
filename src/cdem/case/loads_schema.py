"""What acts on the bodies of a case from outside: gravity, surfaces, driven and held nodes."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, WithJsonSchema, model_validator

from cdem.case.bodies_schema import exactly_one
from cdem.case.laws import SURFACE_LAWS, choice, models, surface_contradiction
from cdem.case.types import (
    Acceleration3,
    Direction3,
    Length3,
    Name,
    Part,
    Quantity,
    Stress3,
    Velocity3,
)

Axis = Literal["x", "y", "z"]
Axes = list[Axis]
Rows = list[tuple[Annotated[float, Quantity("s")], Annotated[float, Quantity("1")]]]
_CELL = {"anyOf": [{"type": "number"}, {"type": "string"}]}
_NAMED = {
    "type": "object",
    "properties": {"file": {"type": "string", "description": "Text with two columns"}},
    "required": ["file"],
    "additionalProperties": False,
}
History = Annotated[
    Rows,
    WithJsonSchema(
        {
            "anyOf": [
                {"type": "array", "minItems": 1, "items": {"type": "array", "items": _CELL}},
                _NAMED,
            ]
        }
    ),
]
"""Rows of time and factor; a case may name a file of them, see `history_file`."""


class FacesOfGroup(Part):
    """The outer faces of a group that look in one direction."""

    group: Name = Field(description="Group")
    normal: Direction3 = Field(description="Outward normal of the faces [1]")

    @model_validator(mode="after")
    def _normal_has_a_direction(self) -> FacesOfGroup:
        if not any(self.normal):
            raise ValueError("normal must not be [0, 0, 0]")
        return self


def _surface_kind(value: object) -> str:
    return "faces" if isinstance(value, dict | FacesOfGroup) else "name"


Surface = Annotated[
    Annotated[Name, Tag("name")] | Annotated[FacesOfGroup, Tag("faces")],
    Discriminator(_surface_kind),
]


class Region(Part):
    """All nodes inside a box along the axes."""

    min: Length3 = Field(description="Lowest corner [m]")
    max: Length3 = Field(description="Highest corner [m]")

    @model_validator(mode="after")
    def _ordered(self) -> Region:
        if any(low > high for low, high in zip(self.min, self.max, strict=True)):
            raise ValueError("min must not be above max")
        return self


class Timed(Part):
    """Something with curves over time: under `history`, of a factor, or `level`, of heights."""

    acts_from_stage: ClassVar[bool] = False
    """Whether it begins to act in its stage, so that this stands for itself."""
    stage: Name | None = Field(
        None,
        description="Stage from whose begin the times of history or of a level count; before it the "
        "first value holds. By default they count from the start of the run",
    )

    @property
    def curves(self) -> dict[str, list[tuple[float, float]]]:
        """Rows of time [s] and value of its curves, by key."""
        values = {key: getattr(self, key, None) for key in ("history", "level")}
        return {key: rows for key, rows in values.items() if isinstance(rows, list)}

    @model_validator(mode="after")
    def _times_increase(self) -> Timed:
        for key, rows in self.curves.items():
            if any(later <= earlier for (earlier, _), (later, _) in pairwise(rows)):
                raise ValueError(f"{key}: times must increase")
            if self.stage is not None and rows[0][0] < 0:
                raise ValueError(
                    f"{key}: times must be at least 0, the begin of stage {self.stage}"
                )
        if self.stage is not None and not self.curves and not self.acts_from_stage:
            raise ValueError("stage says from when a curve counts: give it with a history or level")
        return self


class _Factored(Timed):
    history: History | None = Field(
        None,
        min_length=1,
        description="Factor over time, linear between: [[time [s], factor [1]], ...], or "
        "{file: NAME} of two columns",
    )


class Traction(_Factored):
    """A stress on faces, per area of the undeformed face."""

    surface: Surface = Field(description="Surface of the mesh, or {group, normal}")
    traction: Stress3 = Field(description="Force per area [Pa]")


class SurfaceLoad(_Factored):
    """A law that acts on faces as they lie now; its parameters come with the model of the law."""

    acts_from_stage: ClassVar[bool] = True
    if TYPE_CHECKING:
        law: str
    surface: Surface = Field(description="Surface of the mesh, or {group, normal}")
    stage: Name | None = Field(
        None,
        description="Stage at whose begin it starts to act, and from which the times of its history "
        "and the displacements of its faces count; by default all from the start of the run",
    )

    @model_validator(mode="after")
    def _parameters_fit(self) -> SurfaceLoad:
        if why := surface_contradiction(self):
            raise ValueError(why)
        return self


if TYPE_CHECKING:
    AnySurfaceLoad = SurfaceLoad
else:
    AnySurfaceLoad = choice(models(SurfaceLoad, SURFACE_LAWS), SURFACE_LAWS)


class PrescribedVelocity(_Factored):
    """Nodes that are driven."""

    group: Name | None = Field(None, description="All nodes of this group")
    surface: Surface | None = Field(None, description="Surface of the mesh, or {group, normal}")
    point: Length3 | None = Field(None, description="The node nearest to this point [m]")
    box: Region | None = Field(None, description="All nodes in this box")
    components: Axes = Field(["x", "y", "z"], description="Directions that are driven")
    velocity: Velocity3 = Field(description="Velocity [m/s]")

    @model_validator(mode="after")
    def _one_selection(self) -> PrescribedVelocity:
        exactly_one(self, ("group", "surface", "point", "box"))
        return self


class Support(Part):
    """Nodes that are held."""

    surface: Surface | None = Field(None, description="Surface of the mesh, or {group, normal}")
    point: Length3 | None = Field(None, description="The node nearest to this point [m]")
    box: Region | None = Field(None, description="All nodes in this box")
    group: Name | None = Field(None, description="With point or box: only nodes of this group")
    fix: Axes = Field(min_length=1, description="Directions in which the nodes never move")

    @model_validator(mode="after")
    def _one_selection(self) -> Support:
        exactly_one(self, ("surface", "point", "box"))
        if self.group is not None and self.surface is not None:
            raise ValueError("group goes with point or box; write surface: {group, normal}")
        return self


class Loads(Part):
    """What acts on the bodies from outside."""

    gravity: Acceleration3 = Field([0.0, 0.0, 0.0], description="Acceleration of gravity [m/s2]")
    tractions: list[Traction] = Field(
        [], description="Stresses on faces, in directions that stay, per area of the start"
    )
    surfaces: list[AnySurfaceLoad] = Field(
        [], description="Laws on faces, which follow them: pressure, and laws of your own"
    )
    velocities: list[PrescribedVelocity] = Field([], description="Driven nodes")
    supports: list[Support] = Field([], description="Held nodes")
