"""The parts of a rockfall file: every field with its unit, range, default and meaning."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from cdem.case.interface_schema import Coefficient, Restitution
from cdem.case.map_system import MapSystem
from cdem.case.types import MOST_SEEDS, Line, Listed, Name, Part, Quantity, Size3
from cdem.study.schema import Parameter
from cdem.terrain.schema import OutlineFile, Point2, Size, Span, Terrain
from cdem.units import to_number

MOST_RUNS = 100_000
SIDES = {
    "cube": (1.0, 1.0, 1.0), "slab": (1.0, 0.8, 0.3), "rod": (1.0, 0.45, 0.4),
    "rounded": (1.0, 0.9, 0.8),
}  # fmt: skip
"""Sides of the known shapes, relative to the longest; `rounded` lies on an ellipsoid."""
SLENDER = 0.1
"""Least side of a block over its longest."""


class Drawn(Parameter):
    """A value drawn for each run: one number, a list to choose from, or a distribution."""

    @model_validator(mode="before")
    @classmethod
    def _one_value(cls, data: Any) -> Any:
        return {"values": [data]} if isinstance(data, int | float | str) else data

    @model_validator(mode="after")
    def _is_drawn(self) -> Drawn:
        if self.grid is not None:
            raise ValueError("a grid is not drawn; give values, or a distribution")
        return self


def check_drawn(drawn: Drawn, unit: str) -> None:
    """Refuse units and values that cannot be of this unit.

    Raises:
        ValueError: The unit or a value is wrong.
    """
    if drawn.unit is not None:
        to_number(f"1 {drawn.unit}", unit)
    for value in drawn.values or []:
        if drawn.unit is not None and not isinstance(value, int | float):
            raise ValueError(f"{value!r} has a unit already; leave out unit: {drawn.unit}")
        to_number(value, unit)


class Shape(Part):
    """A kind of block."""

    share: Annotated[float, Quantity("1", above=0)] = Field(
        description="Share of the runs, relative to the sum of all shares [1]"
    )
    sides: Size3 = Field(description="Sides, relative to one another")
    corners: Literal["box", "rounded"] = Field(
        "box", description="Eight corners of a box, or 10 to 14 on an ellipsoid; all displaced"
    )

    @model_validator(mode="after")
    def _not_slender(self) -> Shape:
        if min(self.sides) < SLENDER * max(self.sides):
            raise ValueError(f"the shortest side must be at least {SLENDER:g} of the longest")
        return self


class Blocks(Part):
    """The falling blocks."""

    volume: Drawn = Field(description="Volume [m3]")
    shapes: dict[Name, Shape] = Field(
        {"cube": Shape(share=1, sides=[1, 1, 1], corners="box")},
        min_length=1,
        description="Shapes by name: a share of cube, slab, rod or rounded; others with sides",
    )
    density: Annotated[float, Quantity("kg/m3", above=0)] = Field(2600.0, description="[kg/m3]")
    contact_modulus: Annotated[float, Quantity("Pa", above=0, auto=True)] | str = Field(
        "auto",
        description="Stiffness of contacts times the radius of the block [Pa]; auto: the least "
        "for the highest fall in the terrain",
    )

    @model_validator(mode="before")
    @classmethod
    def _known_shapes(cls, data: Any) -> Any:
        shapes = data.get("shapes") if isinstance(data, dict) else None
        if not isinstance(shapes, dict):
            return data
        return data | {"shapes": {name: _with_sides(name, given) for name, given in shapes.items()}}


def _with_sides(name: str, given: Any) -> Any:
    """A shape with the sides of its name; others must give them."""
    given = {"share": given} if isinstance(given, int | float | str) else given
    if name not in SIDES or not isinstance(given, dict):
        return given
    return {
        "sides": list(SIDES[name]),
        "corners": "rounded" if name == "rounded" else "box",
    } | given


Corners = Annotated[list[Point2], Field(min_length=3), Listed]
Points = Annotated[list[Point2], Field(min_length=2), Listed]


class StartsBy(Part):
    """Where and how blocks start."""

    line: Points | None = Field(
        None, description="Corners of a line [m]; starts are evenly along it"
    )
    area: Corners | None = Field(
        None, description="Corners of an area [m]; starts are evenly in it"
    )
    file: Name | None = Field(
        None,
        description="GIS file of points, lines or areas, of one kind: starts are evenly on them",
    )
    layer: Name | None = Field(None, description="Layer of the file, if there are several")
    where: dict[Name, Any] = Field({}, description="Use only features with these properties")
    crs: MapSystem | None = Field(None, description="Projection of the file; overrides its own")
    height: Drawn = Field(
        default_factory=lambda: Drawn(values=[0.05]),
        description="Height of the block above the ground at its nearest place [m]",
    )
    velocity: Drawn = Field(
        default_factory=lambda: Drawn(values=[0.0]),
        description="Initial speed, horizontal in the direction of the steepest descent [m/s]",
    )

    @model_validator(mode="after")
    def _one_source(self) -> StartsBy:
        given = [key for key in ("line", "area", "file") if getattr(self, key) is not None]
        if len(given) != 1:
            raise ValueError(
                f"needs exactly one of line, area, file; got {' and '.join(given) or 'none'}"
            )
        for key in ("layer", "where", "crs"):
            if self.file is None and getattr(self, key):
                raise ValueError(f"{key} has no effect without file; remove it")
        return self


class Surface(Part):
    """How the ground meets blocks."""

    friction_angle: Annotated[float, Quantity("deg", at_least=0, below=90)] = Field(
        description="Friction angle [deg]"
    )
    restitution: Annotated[
        Annotated[Coefficient, Tag("value")] | Annotated[Restitution, Tag("each")],
        Discriminator(lambda v: "each" if isinstance(v, dict | Restitution) else "value"),
    ] = Field(description="Coefficient of restitution [1]: one, or {normal: 0.4, tangential: 0.8}")
    rolling_resistance: Annotated[float, Quantity("1", at_least=0, below=1)] = Field(
        0.0, description="Rolling resistance [1]"
    )

    def contact(self) -> dict[str, Any]:
        """Keys of an interface of a case."""
        keys = ("friction_angle", "restitution", "rolling_resistance")
        return {key: value for key, value in self.model_dump().items() if key in keys}


def _kind_of_area(value: Any) -> str:
    if isinstance(value, str):
        return "name"
    return "file" if isinstance(value, dict | OutlineFile) else "corners"


class Zone(Surface):
    """Ground of its own in an area."""

    name: Name = Field(description="Name, for reports")
    area: Annotated[
        Annotated[Corners, Tag("corners")]
        | Annotated[Name, Tag("name")]
        | Annotated[OutlineFile, Tag("file")],
        Discriminator(_kind_of_area),
    ] = Field(description="Corners [x, y] in order, or a GIS file [m]")


class GroundBy(Part):
    """Contact of blocks with the ground."""

    default: Surface = Field(description="All ground outside the zones")
    zones: list[Zone] = Field([], description="Zones; the first one counts where they overlap")


class Barrier(Part):
    """A virtual line at which blocks are counted and measured; it stops none."""

    name: Name = Field(description="Name, for reports")
    line: Points = Field(description="Corners [x, y] of the line [m]")
    height: Size | None = Field(
        None, description="Height, to count the blocks that pass above it [m]"
    )
    energy: Annotated[float, Quantity("J", above=0)] | None = Field(
        None, description="Capacity, to count the blocks with more energy [J]"
    )


class MapsBy(Part):
    """Rasters."""

    cell: Size | None = Field(None, description="Side of a cell [m]; default: as the terrain")
    passes: Annotated[int, Field(ge=1)] = Field(
        10, description="Least number of runs through a cell for its 95 % quantiles"
    )


class Extent(Part):
    """The part of the terrain to use."""

    x: Span = Field(description="From west to east [m]")
    y: Span = Field(description="From south to north [m]")

    @model_validator(mode="after")
    def _has_an_area(self) -> Extent:
        for axis, (low, high) in (("x", self.x), ("y", self.y)):
            if low >= high:
                raise ValueError(f"{axis} must rise, got [{low:g}, {high:g}]")
        return self


class RockfallParts(Part):
    """All parts of a rockfall file."""

    rockfall: Literal[1] = Field(1, description="Version of the format")
    title: Line = Field("", description="One line for reports")
    crs: MapSystem | None = Field(
        None, description="Projection of everything here; default: as in the terrain's file"
    )
    terrain: Terrain = Field(description="The ground: a grid of heights")
    extent: Extent | None = Field(None, description="Part of the terrain to use; default: all")
    starts: StartsBy = Field(description="Where and how blocks start")
    count: Annotated[int, Field(ge=1, le=MOST_RUNS)] = Field(100, description="Number of runs")
    seed: Annotated[int, Field(ge=0, le=MOST_SEEDS)] = Field(1, description="Seed of all draws")
    blocks: Blocks = Field(description="The falling blocks")
    ground: GroundBy = Field(description="Contact of blocks with the ground")
    barriers: list[Barrier] = Field([], description="Lines at which blocks are measured")
    maps: MapsBy = Field(MapsBy(), description="Rasters")  # type: ignore[call-arg]
    duration: Annotated[float, Quantity("s", above=0)] = Field(
        120.0, description="Longest time of a run [s]"
    )
