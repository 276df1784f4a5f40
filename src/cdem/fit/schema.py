"""The parts of a fit: the study whose runs are compared, and the observations."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from cdem.case.types import MOST_SEEDS, Name, Part, Quantity
from cdem.terrain.schema import OutlineFile

Length = Annotated[float, Quantity("m")]
Size = Annotated[float, Quantity("m", above=0)]
Number = Annotated[float, Quantity("1")]
Positive = Annotated[float, Quantity("1", above=0)]

KINDS = ("result", "runout", "outline", "thickness", "front")
"""The key that names an observation."""


class OfResult(Part):
    """A number of the table of the study."""

    result: Name = Field(description="Column of the table: a name under results of the study")
    value: Number = Field(description="Observed value, in the unit of the column")
    deviation: Positive = Field(
        description="Standard deviation of observation and model together, same unit"
    )


class OfOutline(Part):
    """The outline of the area that rock met."""

    outline: Annotated[
        Annotated[Name, Tag("name")] | Annotated[OutlineFile, Tag("file")],
        Discriminator(lambda value: "name" if isinstance(value, str) else "file"),
    ] = Field(description="GIS file with polygons, relative to this file")
    deviation: Size = Field(
        description="Standard deviation of the edge, of observation and model together [m]"
    )
    length: Size | None = Field(
        None,
        description="Distance over which errors of the edge are alike [m]; default: a fifth of the "
        "diagonal of the outline's box",
    )


class OfThickness(Part):
    """A map of the thickness of the deposit: solid rock, without voids."""

    thickness: Name = Field(description="Grid of thicknesses [m], relative to this file")
    deviation: Size = Field(
        description="Standard deviation of a cell, of observation and model together [m]"
    )
    length: Size | None = Field(
        None,
        description="Distance over which errors are alike [m]; default: a fifth of the diagonal of "
        "the grid",
    )


class OfRunout(Part):
    """A number that `cdem runout` measures in the result folder of a run."""

    runout: Name = Field(description="Path in runout.json, e.g. reach or deposit.thickness_mean")
    value: Number = Field(description="Observed value, in SI")
    deviation: Positive = Field(
        description="Standard deviation of observation and model together, in SI"
    )


class OfFront(Part):
    """The distance of the front from the crown at some times."""

    front: Name = Field(description="CSV file with columns time [s] and distance [m]")
    deviation: Size = Field(
        description="Standard deviation of a distance, of observation and model together [m]"
    )


def _kind(value: Any) -> str | None:
    """The kind of an observation by its key."""
    keys = value if isinstance(value, dict) else getattr(value, "model_fields_set", ())
    return next((kind for kind in KINDS if kind in keys), None)


Observation = Annotated[
    Annotated[OfResult, Tag("result")]
    | Annotated[OfOutline, Tag("outline")]
    | Annotated[OfThickness, Tag("thickness")]
    | Annotated[OfRunout, Tag("runout")]
    | Annotated[OfFront, Tag("front")],
    Discriminator(
        _kind,
        custom_error_type="observation",
        custom_error_message=f"needs one of {', '.join(KINDS)}",
    ),
]


class FitParts(Part):
    """All parts of a fit."""

    fit: Literal[1] = Field(1, description="Version of the format")
    title: str = Field("", description="One line for reports")
    study: Name = Field(description="Study file of `cdem sweep`, relative to this file")
    sweep: Name | None = Field(
        None, description="Folder of its results; default: STUDY.sweep beside the study"
    )
    observed: list[Observation] = Field(min_length=1, description="The observations")
    seed: int = Field(1, ge=0, le=MOST_SEEDS, description="Seed of the random values")
