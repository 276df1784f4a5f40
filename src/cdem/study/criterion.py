"""Criterion of failure for trials of `cdem critical`: displacement, its rate, unbalanced force."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, ValidationError

from cdem.case.explain import explain
from cdem.case.source import Source
from cdem.case.types import Name, Part, Quantity
from cdem.errors import CaseError
from cdem.run.moving import volume_of

if TYPE_CHECKING:
    from cdem.run.moving import Body
    from cdem.run.simulation import Simulation

CHIP = 1e-4
"""Volume of a chip, over the volume of all groups that are not fixed, unless a user gives it."""


OPTIONS = {"most_moved": "--travel", "ignore_below": "--ignore-below", "group": "--group"}
"""Limits that have an option of their own."""


class Criterion(Part):
    """Limits beyond which a case that has not come to rest has failed."""

    travel: Annotated[float, Quantity("1", above=0)] = Field(
        0.005,
        description="A body that gains speed under a steady force slides once a node has moved this "
        "fraction of the mean face size, or after 10,000 steps: anchors tighten, joints close before",
    )
    far: Annotated[float, Quantity("1", above=0)] = Field(
        1.0, description="A node has moved this fraction of the mean face size, at any speed"
    )
    stall_steps: int | None = Field(
        None,
        ge=1,
        description="After this many steps or more, the farthest node moved no less far in the last "
        "quarter of them than in the quarter before, and the unbalance ratio hardly fell in the last "
        "half: it slides or creeps. Default: two periods of the slowest elastic motion, at least 400",
    )
    ignore_below: Annotated[float, Quantity("m3", at_least=0)] | None = Field(
        None,
        description="Bodies of a smaller volume that move are taken out of the model and reported "
        "(--ignore-below) [m3]. Default: 1e-4 of the volume of groups that are not fixed",
    )
    group: Name | None = Field(
        None,
        description="Only bodies with blocks of this group count; other bodies that move are taken out "
        "(--group)",
    )
    most_moved: Annotated[float, Quantity("m", above=0)] | None = Field(
        None,
        description="A node has moved farther than this [m] since the first trial began, though it "
        "rests (--travel)",
    )
    most_steps: int = Field(
        1_000_000, ge=1, description="No rest within this many steps (or the stage's max_steps)"
    )

    @classmethod
    def read(cls, texts: Iterable[str]) -> Criterion:
        """Read texts like ``"far=0.5"``; other limits keep their defaults.

        Raises:
            CaseError: An unknown limit, or a value that is not allowed.
        """
        values: dict[str, str] = {}
        source = Source()
        for text in texts:
            name, equals, value = text.partition("=")
            if not equals:
                raise CaseError(f"--criterion {text}: write NAME=VALUE, e.g. far=0.5")
            values[name.strip()] = value.strip()
            option = OPTIONS.get(name.strip())
            given = f"{option} {value.strip()}" if option else f"--criterion {text}"
            source.overrides[(name.strip(),)] = given
        try:
            return cls(**values)  # type: ignore[arg-type]
        except ValidationError as error:
            raise explain(error, source, cls) from None

    def check(self, sim: Simulation) -> None:
        """Refuse a group that the model has not.

        Raises:
            CaseError: There is no such group; names those there are.
        """
        if self.group is not None and self.group not in sim.build.group_names:
            names = ", ".join(sim.build.group_names)
            raise CaseError(f"--group {self.group}: no such group in the model; it has: {names}")

    def counts(self, sim: Simulation, body: Body) -> bool:
        """Whether a body that moves is a failure; others are taken out of the model."""
        of_blocks = body.volume if body.whole else volume_of(sim, body.members)
        counts = of_blocks >= self.least_volume(sim)
        if self.group is not None and self.group not in body.groups:
            return counts and not body.whole
        return counts

    def least_volume(self, sim: Simulation) -> float:
        """Volume from which on a body counts [m3]."""
        if self.ignore_below is not None:
            return self.ignore_below
        groups = sim.case.groups
        free = (g["volume"] for name, g in sim.audit.groups.items() if len(groups[name].fix) < 3)
        return CHIP * float(sum(free))

    def text(self) -> str:
        """The whole criterion in one line."""
        bound = f", or rests after more than {self.most_moved:g} m" if self.most_moved else ""
        steps = "two periods" if self.stall_steps is None else f"{self.stall_steps:,} steps"
        chip = (
            "1e-4 of the free volume" if self.ignore_below is None else f"{self.ignore_below:g} m3"
        )
        return (
            f"fails when a body gains speed under a steady force, judged after {steps} and "
            f"{100 * self.travel:g} % of the mean face size, or has moved {100 * self.far:g} % of it, or finds no rest in {self.most_steps:,} "
            f"steps{bound}; bodies below {chip} are taken out"
        )
