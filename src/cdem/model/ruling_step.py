"""Limit of the time step: elements, bonds or contacts, group and place; and remedies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cdem.case.types import AUTO
from cdem.model.build import Build
from cdem.rows import rows_of

PLURAL = {"element": "elements", "bond": "bonds", "contact": "contacts"}
GAIN = 1.1
"""A step longer by this factor is worth a suggestion."""


@dataclass
class RulingStep:
    """The present limit of the step.

    Attributes:
        limit: Stable step, damping included [s].
        group: Group of the limiting node.
        place: Position of that node [m].
        shares: Shares of the squared frequency there: of elements, bonds and contacts; in sum 1.
    """

    limit: float
    node: int
    group: str
    place: tuple[float, float, float]
    shares: dict[str, float]

    @property
    def rules(self) -> str:
        """The largest share: element, bond or contact."""
        return max(self.shares, key=lambda what: self.shares[what])

    def words(self) -> str:
        """``bonds of rock at 1.2, 0, 3.5 (63 %)``."""
        at = ", ".join(f"{x:.4g}" for x in self.place)
        return (
            f"{PLURAL[self.rules]} of {self.group} at {at} ({100 * self.shares[self.rules]:.0f} %)"
        )


def ruling_step(build: Build) -> RulingStep:
    """The limit of the step of a model in its present state."""
    limit, node, elements, springs, bonds = build.core.step_limit()
    t = build.topology
    x, y, z = rows_of(build.core, "node.motion").position[node].tolist()
    of = np.array([elements, springs * bonds, springs * (1 - bonds)])
    shares = dict(zip(PLURAL, (of / of.sum()).tolist(), strict=True))
    return RulingStep(
        limit, node, build.group_names[t.block_group[t.node_block[node]]], (x, y, z), shares
    )


def remedy(build: Build, ruling: RulingStep, dt: float) -> str:
    """The most accurate way to a longer step [s], or nothing."""
    case, (now, with_mass) = build.case, build.assembly.limits
    if case.time.step != "auto":
        return ""
    longer = with_mass / now if np.isfinite(now) else 1.0
    if case.time.mass_scaling is None and longer > GAIN:
        return f"0.1 % more mass would make it {dt * longer:.3g} s: time: {{mass_scaling: {{most: 0.001}}}}"
    others = 1 / np.sqrt(max(1 - ruling.shares[ruling.rules], 1e-12))
    if ruling.rules == "contact":
        return (
            f"softer contacts would make it up to {others:.2g} times as long: contact_stiffness: "
            "{overlap: 1e-3}"
        )
    given = [*case.interfaces.pairs, case.interfaces.default]
    if ruling.rules == "bond" and any(law and law.stiffness_n != AUTO for law in given):
        return (
            f"softer bonds would make it up to {others:.2g} times as long: stiffness_n, stiffness_s"
        )
    return ""
