"""Earthquakes on the bodies of a screening: yield accelerations and permanent displacements."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.screening.bodies import batches
from cdem.screening.fos_map import FosMap
from cdem.seismic.displacement import slip_by_jibson, slip_of_record
from cdem.seismic.measures import largest
from cdem.seismic.processing import GRAVITY, Processed

Floats = NDArray[np.float64]

FAR = 10.0
"""Larger displacements are not told: they grow without bound as a yield acceleration goes to 0 [m]."""


@dataclass(frozen=True)
class Earthquake:
    """A motion of the ground: a record, or its largest acceleration.

    Attributes:
        pga: Largest acceleration [g].
        magnitude: Moment magnitude, where there is no record; None for the equation without it.
        record: The record, or None.
        name: File of the record.
    """

    pga: float
    magnitude: float | None = None
    record: Processed | None = None
    name: Path | None = None

    @classmethod
    def of(cls, record: Processed, name: Path) -> Earthquake:
        """The earthquake of a record."""
        return cls(largest(record.acceleration) / GRAVITY, None, record, name)

    def slip(self, yields: Floats) -> Floats:
        """Permanent displacement over yield accelerations [g]; nan where one is not above 0 [m]."""
        if self.record is not None:
            return slip_of_record(self.record, yields)
        return slip_by_jibson(yields, self.pga, self.magnitude)

    def text(self) -> str:
        """The earthquake in words."""
        if self.record is not None:
            return f"record {self.name}, PGA {self.pga:.3g} g"
        of = "" if self.magnitude is None else f" of magnitude {self.magnitude:g}"
        return f"an earthquake{of}, PGA {self.pga:g} g (Jibson 2007)"


@dataclass
class Shaken:
    """Bodies and profiles in an earthquake.

    Attributes:
        quake: The earthquake.
        yields: Smallest yield acceleration of the bodies over a cell [g], shape (rows, columns).
        slip: Largest permanent displacement of the bodies over a cell [m]; nan where a body moves
            without shaking.
        plane_yields, plane_slip: The same of the profiles.
        listed_yields, listed_slips: Those of the listed bodies [g], [m].
        moving: Number of bodies that move without shaking.
    """

    quake: Earthquake
    yields: Floats
    slip: Floats
    plane_yields: Floats
    plane_slip: Floats
    listed_yields: Floats
    listed_slips: Floats
    moving: int

    def lines(self) -> list[str]:
        """The results as lines of text."""
        known = np.isfinite(self.yields)
        both = [_most(slip) for slip in (self.slip, self.plane_slip)]
        lines = [f"{self.quake.text()}: bodies move by {both[0]}, profiles by {both[1]}"]
        if self.moving:
            cells = 100 * (self.yields[known] <= 0).mean()
            lines.append(
                f"note: {self.moving:,} bodies move without shaking (F below 1): they have no "
                f"displacement; they cover {cells:.1f} % of the cells with bodies"
            )
        cells = int((self.plane_yields <= 0).sum())
        if cells:
            lines.append(
                f"note: profiles move without shaking in {cells:,} cells, which have no displacement"
            )
        return lines


def _most(slip: Floats) -> str:
    known = slip[np.isfinite(slip)]
    most = float(known.max(initial=0.0))
    return f"up to {most:.3g} m" if most <= FAR else f"more than {FAR:g} m"


def shake(found: FosMap, quake: Earthquake) -> Shaken:
    """Yield accelerations and displacements of all bodies and profiles.

    Args:
        found: The map, with yield accelerations of profiles.
        quake: The earthquake.
    """
    of_body = np.full(len(found.every), np.nan)
    for numbers, batch in batches(found.every):
        of_body[numbers] = batch.yields(found.loads)
    least = np.full(found.factor.shape, np.inf)
    for body, value in zip(found.every, of_body.tolist(), strict=True):
        part = least[body.window]
        np.minimum(part, value, out=part, where=body.cells)
    yields = np.where(np.isfinite(found.factor), least, np.nan)
    places = {id(body): number for number, body in enumerate(found.every)}
    listed = of_body[[places[id(body)] for body in found.bodies]]
    planes = found.profiles.yields
    assert planes is not None
    every = np.concatenate([yields.ravel(), planes.ravel(), listed])
    slips = np.split(quake.slip(every), [yields.size, yields.size + planes.size])
    return Shaken(
        quake,
        yields,
        slips[0].reshape(yields.shape),
        planes,
        slips[1].reshape(planes.shape),
        listed,
        slips[2],
        int((of_body <= 0).sum()),
    )
