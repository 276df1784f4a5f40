"""The terms of the energy ledger, in the order in which files, reports and plots list them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cdem._native import core as native


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
    EnergyTerm(term["name"], "energy" if term["kind"] in ("stored", "hidden") else "work")
    for term in native.energy_terms()
]
"""As the core lists them."""
