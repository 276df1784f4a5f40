"""Blasts: pressure of an explosive on the walls of its hole, and the mesh that waves need."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, create_model, model_validator

from cdem.case import blast_pulses
from cdem.case.surface_schema import Surface
from cdem.case.timed_schema import Timed
from cdem.case.types import Length3, Name, Part, Quantity

HIGHEST = 10e9
"""Largest pressure of a blast: detonation pressures of explosives reach 4 to 40 GPa, on the wall
of a hole half of that [Pa]."""
EXPONENT = 2.4
"""Power of charge over hole diameter of the pressure of a decoupled charge; others take up to 2.6."""
RINGS = 64
"""Rings of faces that a detonation reaches one after the other."""

Pressure = Annotated[float, Quantity("Pa", above=0)]
Duration = Annotated[float, Quantity("s", above=0)]
Rows = Annotated[
    list[tuple[Annotated[float, Quantity("s", at_least=0)], Annotated[float, Quantity("Pa")]]],
    Field(min_length=2),
]


class Friedlander(Part):
    """P (1 - t / duration) exp(-decay t / duration): a jump, then a decay."""

    peak: Pressure | None = Field(None, description="Peak, unless explosive gives it [Pa]")
    duration: Duration = Field(description="Time until the pressure is 0 [s]")
    decay: Annotated[float, Quantity("1", at_least=0)] = Field(description="Decay b [1]")
    suction: bool = Field(False, description="Whether to keep the negative pressure that follows")

    @model_validator(mode="after")
    def _suction_ends(self) -> Friedlander:
        if self.suction and self.decay < 1:
            raise ValueError(
                f"with decay {self.decay:g} the suction is stronger than any real one; give a decay of "
                "at least 1, or leave out suction"
            )
        return self


class FriedlanderPulse(Part):
    """A jump, then a decay."""

    friedlander: Friedlander = Field(description="The formula of Friedlander")

    @property
    def peak(self) -> float | None:
        """Peak [Pa], or None."""
        return self.friedlander.peak

    @property
    def rows(self) -> blast_pulses.Rows:
        """Time [s] and factor of the peak [1]."""
        f = self.friedlander
        return blast_pulses.friedlander(f.duration, f.decay, suction=f.suction)


class TablePulse(Part):
    """Any pressure over time."""

    table: Rows = Field(
        description="Pressure over time, linear between: [[time [s], pressure [Pa]], ...]; the last "
        "one stays"
    )

    @model_validator(mode="after")
    def _increases(self) -> TablePulse:
        times = [t for t, _ in self.table]
        if any(later <= earlier for earlier, later in itertools.pairwise(times)):
            raise ValueError("table: times must increase")
        if not any(p for _, p in self.table):
            raise ValueError("table: has no pressure")
        return self

    @property
    def peak(self) -> float:
        """Largest pressure [Pa]."""
        return max(abs(p) for _, p in self.table)

    @property
    def rows(self) -> blast_pulses.Rows:
        """Time [s] and factor of the peak [1]."""
        return blast_pulses.from_zero([(t, p / self.peak) for t, p in self.table])


class Pulse(Part):
    """Two exponentials: a rise, then a decay."""

    peak: Pressure | None = Field(None, description="Peak, unless explosive gives it [Pa]")
    rise: Duration = Field(description="Time of the peak [s]")
    fall: Duration = Field(description="Time in which the pressure then falls by a factor e [s]")

    @model_validator(mode="after")
    def _rises_first(self) -> Pulse:
        if self.rise >= self.fall:
            raise ValueError(
                f"rise {self.rise:g} s must be shorter than fall {self.fall:g} s; with both alike "
                "write a table"
            )
        return self

    @property
    def rows(self) -> blast_pulses.Rows:
        """Time [s] and factor of the peak [1]."""
        return blast_pulses.two_exponentials(self.rise, self.fall)


def _pulse_kind(value: object) -> str:
    for kind in ("friedlander", "table"):
        if (isinstance(value, dict) and kind in value) or hasattr(value, kind):
            return kind
    return "pulse"


AnyPulse = Annotated[
    Annotated[Pulse, Tag("pulse")]
    | Annotated[FriedlanderPulse, Tag("friedlander")]
    | Annotated[TablePulse, Tag("table")],
    Discriminator(_pulse_kind),
]


class Explosive(Part):
    """The peak pressure by the explosive: density speed² / 8 (diameter / hole)^2.4."""

    density: Annotated[float, Quantity("kg/m3", above=0)] = Field(description="Density [kg/m3]")
    speed: Annotated[float, Quantity("m/s", above=0)] = Field(
        description="Speed of its detonation [m/s]"
    )
    diameter: Annotated[float, Quantity("m", above=0)] = Field(description="Its diameter [m]")
    hole: Annotated[float, Quantity("m", above=0)] = Field(description="Diameter of the hole [m]")

    @model_validator(mode="after")
    def _fits_in(self) -> Explosive:
        if self.diameter > self.hole:
            raise ValueError(
                f"diameter {self.diameter:g} m does not fit into a hole of {self.hole:g} m; give both "
                "diameters, not radii"
            )
        return self

    @property
    def peak(self) -> float:
        """Peak pressure on the wall [Pa]."""
        return self.density * self.speed**2 / 8 * (self.diameter / self.hole) ** EXPONENT

    def mass(self, length: float) -> float:
        """Mass of a charge of a length [m] along the whole hole [kg]."""
        return self.density * math.pi / 4 * self.diameter**2 * length


class DetonationBase(Part):
    """A detonation that runs along the hole."""

    speed: Annotated[float, Quantity("m/s", above=0)] = Field(
        description="Speed of the detonation [m/s]"
    )


if TYPE_CHECKING:
    Detonation = DetonationBase
else:  # `from` is no name of a field in a class
    Detonation = create_model(
        "Detonation",
        __base__=DetonationBase,
        __doc__=DetonationBase.__doc__,
        **{"from": (Length3, Field(description="Point where it begins [m]"))},
    )


@dataclass(frozen=True)
class Ring:
    """One of the rings of faces of a hole: its distances from the begin of the detonation.

    Attributes:
        number: From 0 to `RINGS` - 1: the share of the distances of all faces of the hole.
        begin: Point where the detonation begins [m].
        speed: Of the detonation [m/s].
    """

    number: int
    begin: tuple[float, ...]
    speed: float


@dataclass(frozen=True)
class BlastEntry:
    """Pressure on the faces of a blast, or on one ring of them, as an entry of surface laws.

    Attributes:
        surface: The faces.
        stage: Stage where its times begin, or None.
        pressure: Peak [Pa].
        history: Time [s] and factor; without the time that the detonation takes to the ring.
        ring: The ring, or None for all faces.
    """

    surface: Surface
    stage: str | None
    pressure: float
    history: blast_pulses.Rows
    ring: Ring | None = None
    law: ClassVar[Literal["pressure"]] = "pressure"


class Blast(Timed):
    """Pressure of an explosive on the wall of its hole, against the normals as they turn."""

    acts_from_stage: ClassVar[bool] = True
    surface: Surface = Field(
        description="Wall of the hole: surface of the mesh, or {group, normal}"
    )
    stage: Name | None = Field(
        None, description="Dynamic stage in which it goes off; by default the first"
    )
    delay: Annotated[float, Quantity("s", at_least=0)] = Field(
        0.0, description="Time from the begin of the stage [s]"
    )
    pressure: AnyPulse = Field(
        description="Pressure over time: {peak, rise, fall}, {friedlander} or {table}"
    )
    explosive: Explosive | None = Field(
        None, description="Gives the peak in place of pressure.peak"
    )
    detonation: Detonation | None = Field(
        None, description="It runs along the hole; by default the whole wall is loaded at once"
    )

    @model_validator(mode="after")
    def _one_peak(self) -> Blast:
        if (self.pressure.peak is None) == (self.explosive is None):
            raise ValueError(
                "give the peak of the pressure, or the explosive that determines it"
                + ("" if self.explosive is None else ", not both")
            )
        if self.peak > HIGHEST:
            raise ValueError(
                f"a peak of {self.peak / 1e9:.3g} GPa is more than explosives reach on rock, "
                f"{HIGHEST / 1e9:g} GPa; check the unit of the pressure"
            )
        return self

    @property
    def peak(self) -> float:
        """Peak pressure [Pa]."""
        peak = self.pressure.peak if self.explosive is None else self.explosive.peak
        assert peak is not None  # one of them gives it
        return peak

    @property
    def curves(self) -> dict[str, list[tuple[float, float]]]:
        """Time since the begin of its stage [s] and factor of its peak."""
        return {"pressure": [(t + self.delay, p) for t, p in self.pressure.rows]}

    @property
    def highest_frequency(self) -> float:
        """Highest frequency of its waves [Hz]."""
        return blast_pulses.highest_frequency(self.pressure.rows)

    @property
    def entries(self) -> list[BlastEntry]:
        """Its entries of surface laws: one, or one for each ring."""
        whole = BlastEntry(self.surface, self.stage, self.peak, self.curves["pressure"])
        if self.detonation is None:
            return [whole]
        begin = tuple(getattr(self.detonation, "from"))
        rings = [Ring(number, begin, self.detonation.speed) for number in range(RINGS)]
        return [replace(whole, ring=ring) for ring in rings]


class Waves(Part):
    """Waves in the mesh."""

    allow_coarse: bool = Field(
        False,
        description="Whether the mesh may have fewer than 5 elements in the shortest wave length of "
        "blasts and records",
    )
