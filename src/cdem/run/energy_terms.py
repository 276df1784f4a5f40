"""The terms of the energy ledger, in the order in which files, reports and plots list them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class EnergyTerm:
    """One term of the ledger.

    Attributes:
        name: As the core reports it.
        kind: Whether it is stored in the model, or the work that something has done.
    """

    name: str
    kind: Literal["energy", "work"]

    @property
    def column(self) -> str:
        """Its column of histories.csv."""
        return f"{self.name} {self.kind} [J]"


ENERGY_TERMS = [
    EnergyTerm("kinetic", "energy"),
    EnergyTerm("strain", "energy"),
    EnergyTerm("contact", "energy"),
    EnergyTerm("friction", "work"),
    EnergyTerm("damping", "work"),
    EnergyTerm("fracture", "work"),
    EnergyTerm("external", "work"),
]
