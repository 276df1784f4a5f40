"""The terms of the energy ledger, in the order in which files, reports and plots list them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from cdem._native import core as native
from cdem.case.case import Case


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


OF_SURFACES = ("surface", "radiated")
"""Terms of surface laws: only a case that has some tells them."""

ENERGY_TERMS = [
    EnergyTerm(term["name"], "energy" if term["kind"] in ("stored", "hidden") else "work")
    for term in native.energy_terms()
]
"""As the core lists them."""


def terms_of(case: Case) -> list[EnergyTerm]:
    """Those that the files of a case tell."""
    return [term for term in ENERGY_TERMS if case.loads.surfaces or term.name not in OF_SURFACES]
