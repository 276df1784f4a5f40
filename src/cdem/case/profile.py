"""Layered ground in a file: `layers: [{thickness: 10 m, density: 1900, speed: 250 m/s}, ...]`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator

from cdem.case.document import Document
from cdem.case.types import Part, Quantity
from cdem.seismic.site_response import Layer


class ProfileLayer(Part):
    """A layer of the ground, or the half space below the last one."""

    thickness: Annotated[float, Quantity("m", above=0)] | None = Field(
        None, description="Thickness; none for the half space [m]"
    )
    density: Annotated[float, Quantity("kg/m3", above=0)] = Field(description="Density [kg/m3]")
    speed: Annotated[float, Quantity("m/s", above=0)] = Field(
        description="Wave speed, of S or P waves [m/s]"
    )
    damping: Annotated[float, Quantity("1", at_least=0, at_most=0.2)] = Field(
        0.0, description="Fraction of critical, the same at all frequencies [1]"
    )


class Profile(Document):
    """Layered ground, from the surface down."""

    kind = "profile"

    layers: list[ProfileLayer] = Field(
        min_length=2, description="Layers, then the half space below them"
    )

    @model_validator(mode="after")
    def _ends_with_a_half_space(self) -> Profile:
        for number, layer in enumerate(self.layers[:-1]):
            if layer.thickness is None:
                raise ValueError(f"layer {number} needs a thickness; only the last one has none")
        if self.layers[-1].thickness is not None:
            raise ValueError("the last layer is the half space: leave out its thickness")
        return self

    @property
    def ground(self) -> list[Layer]:
        """The layers for `cdem.seismic.site_response`."""
        return [Layer(x.thickness or 0.0, x.density, x.speed, x.damping) for x in self.layers]
