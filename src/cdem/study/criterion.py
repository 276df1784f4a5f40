"""Criterion of failure for trials of `cdem critical`: displacement, its rate, and kinetic energy."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated

from pydantic import Field, ValidationError

from cdem.case.explain import explain
from cdem.case.source import Source
from cdem.case.types import Part, Quantity
from cdem.errors import CaseError


class Criterion(Part):
    """Limits beyond which a case that has not come to rest has failed."""

    travel: Annotated[float, Quantity("1", above=0)] = Field(
        0.02,
        description="A node has moved this fraction of the mean face size, and the kinetic energy "
        "is "
        "higher than at half of this displacement",
    )
    far: Annotated[float, Quantity("1", above=0)] = Field(
        1.0, description="A node has moved this fraction of the mean face size, at any speed"
    )
    stall_steps: int = Field(
        10_000,
        ge=1,
        description="After this many steps or more, the farthest node moved as far in the last "
        "half of "
        "them as in the quarter before, and the unbalance ratio fell by less than half: it creeps "
        "on",
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
        """Read texts like ``"travel=0.05"``; other limits keep their defaults.

        Raises:
            CaseError: An unknown limit, or a value that is not allowed.
        """
        values: dict[str, str] = {}
        source = Source()
        for text in texts:
            name, equals, value = text.partition("=")
            if not equals:
                raise CaseError(f"--criterion {text}: write NAME=VALUE, e.g. travel=0.02")
            values[name.strip()] = value.strip()
            source.overrides[(name.strip(),)] = f"--criterion {text}"
        try:
            return cls(**values)  # type: ignore[arg-type]
        except ValidationError as error:
            raise explain(error, source, cls) from None

    def text(self) -> str:
        """The whole criterion in one line."""
        bound = f", or rests after more than {self.most_moved:g} m" if self.most_moved else ""
        return (
            f"fails when a node has moved {100 * self.travel:g} % of the mean face size with growing "
            f"kinetic energy, or {100 * self.far:g} % in any case, or creeps on after "
            f"{self.stall_steps:,} steps, or finds no rest in {self.most_steps:,} steps{bound}"
        )
