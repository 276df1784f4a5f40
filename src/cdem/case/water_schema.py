"""Water: its level or pressure in joints, in pores, and in open water."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from cdem.case.bodies_schema import exactly_one
from cdem.case.formula import Formula
from cdem.case.loads_schema import Region
from cdem.case.timed_schema import History, Timed
from cdem.case.types import Angle, Length3, Line, Name, Part, Quantity

Height = Annotated[float, Quantity("m")]
Heights = Annotated[list[tuple[Annotated[float, Quantity("s")], Height]], Field(min_length=1)]
Level = Annotated[
    Annotated[Height, Tag("height")] | Annotated[Heights, Tag("heights")],
    Discriminator(lambda v: "heights" if isinstance(v, list) else "height"),
]


class WaterPlane(Part):
    """A water table that is a plane."""

    point: Length3 = Field(description="A point on it [m]")
    dip: Annotated[float, Quantity("deg", at_least=0, below=90)] = Field(
        description="Angle to the horizontal [deg]"
    )
    dip_direction: Angle = Field(description="Azimuth of its dip, clockwise from north (y) [deg]")


class WaterField(Timed):
    """Water in some joints, or in the joints and pores of some groups; a later entry replaces an
    earlier one.

    One of `level`, `plane`, `surface`, `formula`, `table` and `ru` gives its pressure.
    """

    name: Name | None = Field(None, description="A name for use in paths")
    groups: list[Name] | None = Field(
        None, min_length=1, description="Groups; without interface, all by default"
    )
    interface: Name | None = Field(
        None, description="A named pair under interfaces: only joints with it, e.g. a crack"
    )
    level: Level | None = Field(
        None,
        description="Height z of the water table, or heights over time, linear between: "
        "[[time [s], height [m]], ...]",
    )
    plane: WaterPlane | None = Field(None, description="An inclined water table")
    surface: Line | None = Field(
        None, description="File of the water table's heights: .asc or .tif (extra terrain)"
    )
    formula: Line | None = Field(
        None,
        description="Pressure [Pa] as a formula of x, y, z [m], e.g. '9810 * max(0, 50 - z)'; a "
        "negative value means no water",
    )
    table: Line | None = Field(
        None,
        description="CSV file of points with pressure: columns x, y, z [m], pressure [Pa]; linear "
        "between points, outside of them the pressure of the nearest (extra terrain)",
    )
    ru: Annotated[float, Quantity("1", at_least=0, at_most=1)] | None = Field(
        None, description="Pressure over the weight of the rock above [1]"
    )
    lift: Height = Field(
        0.0, description="Rise of level, plane or surface, e.g. by a later stage [m]"
    )
    seepage: Literal["hydrostatic", "parallel"] = Field(
        "hydrostatic",
        description="With plane: hydrostatic pressure below it, or pressure of flow parallel to it "
        "(cos² of the dip)",
    )
    history: History | None = Field(
        None, min_length=1, description="Factor of the pressure over time, linear between"
    )
    wet: Literal["auto", "always", "broken", "never"] = Field(
        "auto",
        description="Pressure in joints: always, once their bonds are broken, or never; auto: "
        "always in sets of joints, in interfaces with a name, without strength or beside rock with "
        "pores (biot), else broken",
    )
    aperture: Annotated[float, Quantity("m", at_least=0)] | None = Field(
        None,
        description="Largest opening of joints that keep their water [m]; default 0.05 of "
        "the length of the face",
    )

    @model_validator(mode="after")
    def _complete(self) -> WaterField:
        exactly_one(self, ("level", "plane", "surface", "formula", "table", "ru"))
        if self.interface is not None and self.groups is not None:
            raise ValueError("give groups or interface, not both")
        if self.seepage == "parallel" and self.plane is None:
            raise ValueError("seepage: parallel goes with plane")
        if self.lift and self.level is None and self.plane is None and self.surface is None:
            raise ValueError("lift goes with level, plane or surface")
        return self

    @model_validator(mode="after")
    def _factors_fit(self) -> WaterField:
        if any(factor < 0 for _, factor in self.history or []):
            raise ValueError("history: factors must be at least 0")
        return self

    @field_validator("formula")
    @classmethod
    def _formula_of_places(cls, formula: str | None) -> str | None:
        unknown = Formula(formula).names - {"x", "y", "z"} if formula is not None else set()
        if unknown:
            raise ValueError(
                f"must be a formula of x, y and z only; remove {', '.join(sorted(unknown))}"
            )
        return formula


class Reservoir(Timed):
    """Open water at rest: presses on faces that touch nothing."""

    box: Region | None = Field(
        None, description="Only faces whose middle lies in this box at the start; default all"
    )

    level: Level = Field(
        description="Height z of its surface, or heights over time, linear between: "
        "[[time [s], height [m]], ...]"
    )


class Water(Part):
    """Water in joints and pores, and open water."""

    density: Annotated[float, Quantity("kg/m3", above=0)] = Field(
        1000.0, description="Density of the water [kg/m3]"
    )
    fields: list[WaterField] = Field([], description="Water in the ground")
    reservoir: Reservoir | None = Field(
        None,
        description="Open water; also fills joints and pores without an entry in fields",
    )

    @model_validator(mode="after")
    def _says_something(self) -> Water:
        if not self.fields and self.reservoir is None:
            raise ValueError("give fields, a reservoir, or both")
        return self
