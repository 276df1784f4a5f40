"""Records of earthquakes and blasts."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from cdem.case.types import Line, Part, Quantity
from cdem.errors import CaseError
from cdem.seismic.files import Series, checked
from cdem.seismic.processing import UNITS, Kind, Processed, process
from cdem.units import to_number

Unit = Literal["g", "m/s2", "cm/s2", "m/s", "cm/s", "m", "cm"]
Frequency = Annotated[float, Quantity("Hz", above=0)]


def _as_text(value: object) -> object:
    """Samples as text: a list of numbers becomes one, and a text is looked at."""
    if isinstance(value, list | tuple):
        value = " ".join(repr(to_number(number, "1")) for number in value)
    if isinstance(value, str):
        try:
            checked(Series(np.array(value.split(), float), None, None), "samples")
        except CaseError as error:
            raise ValueError(str(error).partition(": ")[2]) from None
        return " ".join(value.split())
    return value


Samples = Annotated[str, BeforeValidator(_as_text)]
"""Numbers with blanks between: a text is stored and compared faster than a list of 20,000 numbers."""


class Record(Part):
    """A motion of the ground, from a file."""

    file: Line | None = Field(
        None,
        description="File: .at2 (PEER), .csv or .txt of one column, or two with the times first, or .npy",
    )
    samples: Samples | None = Field(
        None,
        description="Samples in `unit`: those of the file, which is read only where they are missing",
    )
    kind: Literal["acceleration", "velocity", "displacement"] | None = Field(
        None, description="Quantity of the samples; by default that of the unit"
    )
    unit: Unit | None = Field(
        None,
        description="Unit of the samples, where the file has none in its header; g is 9.81 m/s2",
    )
    scale: Annotated[float, Quantity("1")] = Field(1.0, description="Factor of all samples [1]")
    step: Annotated[float, Quantity("s", above=0)] | None = Field(
        None, description="Time between samples of a file that has no times [s]"
    )
    band: tuple[Frequency, Frequency] | None = Field(
        None, description="Low and high frequency of a band-pass filter without shift in phase [Hz]"
    )
    baseline: Literal["none", "cubic"] = Field(
        "none", description="Correction of the velocity: none, or less the nearest cubic of time"
    )

    @model_validator(mode="after")
    def _complete(self) -> Record:
        if self.samples is None:
            raise ValueError("give a file, e.g. file: kobe.at2, or samples")
        if self.unit is None:
            raise ValueError(f"the unit is missing, in file and case: {', '.join(UNITS)}")
        quantity = UNITS[self.unit][0]
        if self.kind not in (None, quantity):
            raise ValueError(f"the unit {self.unit} is that of {quantity}, not of {self.kind}")
        if self.step is None:
            raise ValueError(
                "the file has no times: write the time between samples, e.g. step: 5 ms"
            )
        if self.scale == 0:
            raise ValueError("scale must not be 0")
        return self

    @property
    def quantity(self) -> Kind:
        """Quantity of the samples."""
        assert self.unit is not None
        return UNITS[self.unit][0]

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        assert self.samples is not None and self.step is not None
        return self.samples.count(" ") * self.step

    @property
    def band_fault(self) -> str:
        """Why the band does not fit the samples, or nothing."""
        if self.band is None:
            return ""
        assert self.step is not None
        (low, high), nyquist = self.band, 0.5 / self.step
        if low >= high:
            return f"the low frequency must be below the high one, got {low:g} and {high:g} Hz"
        if high > nyquist:
            return (
                f"{high:g} Hz is above {nyquist:g} Hz, the highest frequency in samples every "
                f"{self.step:g} s; write at most that"
            )
        if low < 1 / self.duration:
            return (
                f"{low:g} Hz is below {1 / self.duration:.3g} Hz, one period in the "
                f"{self.duration:g} s of the record; write at least that"
            )
        return ""

    def steps(self) -> tuple[tuple[str, Processed], ...]:
        """The steps of its processing, each with its name and its result; the last is used."""
        assert self.samples is not None and self.unit is not None and self.step is not None
        factor = self.scale * UNITS[self.unit][1]
        return process(self.samples, factor, self.step, self.quantity, self.band, self.baseline)
