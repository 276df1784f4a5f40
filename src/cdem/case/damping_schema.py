"""Damping of rock by a ratio that is known at a frequency: Rayleigh's, or Maxwell branches."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag, model_validator

from cdem.case.types import Part, Quantity

Ratio = Annotated[float, Quantity("1", above=0, at_most=0.2)]
Frequency = Annotated[float, Quantity("Hz", above=0)]
WIDEST = 1000.0
"""Largest ratio of the ends of a band: three branches are not flat over a wider one."""


class Rayleigh(Part):
    """Rayleigh damping with a ratio at a frequency, higher away from it."""

    ratio: Ratio = Field(description="Fraction of critical damping at the frequency [1]")
    frequency: Frequency = Field(description="Frequency of the least ratio [Hz]")
    part: Literal["both", "mass"] = Field(
        "both",
        description="Part: both mass and stiffness; or mass only, with the ratio at the frequency "
        "halved but without a shorter step",
    )


class Maxwell(Part):
    """Three Maxwell branches beside the elastic rock: a ratio that is flat over a band."""

    ratio: Ratio = Field(description="Fraction of critical damping in the band [1]")
    band: Annotated[list[Frequency], Field(min_length=2, max_length=2)] = Field(
        description="Lowest and highest frequency of the band [Hz]"
    )
    reference: Annotated[
        Annotated[Literal["static"], Tag("word")] | Annotated[Frequency, Tag("frequency")],
        Discriminator(lambda value: "word" if value == "static" else "frequency"),
    ] = Field(
        "static",
        description="Frequency at which the moduli of the materials hold [Hz]; static: they are the "
        "moduli of slow loading, and rock is stiffer in the band",
    )

    @model_validator(mode="after")
    def _is_a_band(self) -> Maxwell:
        low, high = self.band
        if not low < high:
            raise ValueError(
                f"band: the first frequency must be below the second, got {self.band}; "
                f"write band: [{high:g}, {low:g}]"
                if high < low
                else f"band: has no width; write a lower and a higher frequency, e.g. band: "
                f"[{low / 3:g}, {3 * high:g}]"
            )
        if high > WIDEST * low:
            raise ValueError(
                f"band: spans a factor of {high / low:.4g}; three branches hold a ratio over a factor "
                f"of {WIDEST:g} at most: raise {low:g} Hz or lower {high:g} Hz"
            )
        return self
