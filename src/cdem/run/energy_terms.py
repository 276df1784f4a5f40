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
        name: Its name in the core.
        kind: "stored" energy of the model, or "work" done.
    """

    name: str
    kind: Literal["energy", "work"]

    @property
    def column(self) -> str:
        """Its column of histories.csv."""
        return f"{self.name} {self.kind} [J]"


OF_SURFACES = ("surface", "radiated")
"""Terms of surface laws: present only in a case with such laws."""

ENERGY_TERMS = [
    EnergyTerm(term["name"], "energy" if term["kind"] in ("stored", "hidden") else "work")
    for term in native.energy_terms()
]
"""All terms, in the order of the core."""


def terms_of(case: Case) -> list[EnergyTerm]:
    """The terms in the files of a case."""
    absent = set() if case.acts_on_faces else set(OF_SURFACES)
    if not any(boundary.free_field for boundary in case.boundaries):
        absent.add("columns")
    return [term for term in ENERGY_TERMS if term.name not in absent]
