"""Boundaries of a case: faces that let waves out, and bases that bring an earthquake in."""

from __future__ import annotations

import math
from typing import Annotated, Literal, cast

from pydantic import Discriminator, Field, Tag, model_validator

from cdem.case.columns_schema import FreeField
from cdem.case.laws import SURFACE_LAWS, models
from cdem.case.surface_schema import QUIET, Surface, SurfaceLoad
from cdem.case.types import Direction3, Name, Part


class BaseInput(Part):
    """A motion that comes in through a base."""

    record: Name = Field(description="A name under records")
    direction: Direction3 = Field(description="Direction of the motion [1]")
    kind: Literal["compliant", "rigid"] = Field(
        "compliant",
        description="compliant: an up-going wave through a quiet base; rigid: velocity of the base, "
        "which sends every wave back",
    )
    motion: Literal["outcrop", "upgoing"] | None = Field(
        None,
        description="Compliant only: the record is the motion of a free rock surface, twice the "
        "up-going wave (outcrop, default), or that wave itself (upgoing)",
    )

    @model_validator(mode="after")
    def _fits(self) -> BaseInput:
        if not any(self.direction):
            raise ValueError("direction must not be [0, 0, 0]")
        if self.kind == "rigid" and self.motion is not None:
            raise ValueError(
                "motion has no effect with kind: rigid: the base moves as the record says; remove it"
            )
        return self

    @property
    def motion_of_record(self) -> list[float]:
        """Velocity of the up-going wave, or of a rigid base, for a record of 1 m/s [m/s]."""
        share = 0.5 if self.kind == "compliant" and self.motion != "upgoing" else 1.0
        return [share * part / math.hypot(*self.direction) for part in self.direction]


Inputs = Annotated[
    Annotated[BaseInput, Tag("one")] | Annotated[list[BaseInput], Tag("some")],
    Discriminator(lambda value: "some" if isinstance(value, list) else "one"),
]


class Boundary(Part):
    """Faces that let waves out of the model, or bring them in."""

    name: Name = Field(description="Unique name")
    surface: Surface = Field(description="Surface of the mesh, or {group, normal}")
    quiet: bool = Field(
        False, description="Whether waves leave through it (Lysmer & Kuhlemeyer 1969)"
    )
    stage: Name | None = Field(
        None,
        description="Dynamic stage from which it acts; supports of the same faces end there, and their "
        "forces stay. By default it acts from the start of the run",
    )
    input: Inputs | None = Field(None, description="Motion of a base, or a list of motions")
    free_field: FreeField | None = Field(
        None, description="For a plane vertical side of ground that is shaken: its surroundings"
    )

    @property
    def inputs(self) -> list[BaseInput]:
        """All motions."""
        if self.input is None:
            return []
        return self.input if isinstance(self.input, list) else [self.input]

    @property
    def absorbs(self) -> bool:
        """Whether waves leave through it."""
        return self.quiet or self.free_field is not None

    @property
    def dashpots(self) -> SurfaceLoad:
        """Its dashpots, as an entry of a surface law."""
        return _QUIET_FACES.model_validate({"surface": self.surface, "stage": self.stage})

    @model_validator(mode="after")
    def _fits(self) -> Boundary:
        if not (self.absorbs or self.inputs):
            raise ValueError("does nothing: give quiet: true, free_field or an input")
        for one in self.inputs:
            if one.kind == "compliant" and not self.quiet:
                raise ValueError("a compliant input needs a quiet base: write quiet: true")
            if one.kind == "rigid" and self.absorbs:
                raise ValueError("is quiet and driven: leave out quiet, or write kind: compliant")
        if self.free_field is not None and self.inputs:
            raise ValueError("a side with free_field takes its motion from the base: remove input")
        rigid = [one.direction for one in self.inputs if one.kind == "rigid"]
        if any(sum(bool(d[axis]) for d in rigid) > 1 for axis in range(3)):
            raise ValueError("two rigid inputs move it along the same axis: add up their records")
        return self


(_QUIET_FACES,) = cast(list[type[SurfaceLoad]], models(SurfaceLoad, {QUIET: SURFACE_LAWS[QUIET]}))
