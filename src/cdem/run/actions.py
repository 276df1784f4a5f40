"""Actions of a script at intervals of a run: look, write, change values, end a stage."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from cdem.errors import CdemError
from cdem.run.state import RunState

Act = Callable[[Any], object]
"""Takes the simulation; True ends the running stage, any other value does not."""


@dataclass
class Action:
    """A function called at the first step at or after each multiple of an interval.

    Attributes:
        interval: Simulated time [s].
        act: The function.
        count: Number of the next multiple.
    """

    interval: float
    act: Act
    count: int = 1

    def __post_init__(self) -> None:
        if not self.interval > 0:
            raise CdemError(f"every({self.interval}): the interval must be above 0 [s]")

    @property
    def due(self) -> float:
        """Simulated time of the next call [s]."""
        return self.count * self.interval

    def skip_to(self, time: float) -> None:
        """Make the first multiple after a time [s] the next call."""
        self.count = max(self.count, int(time / self.interval) + 1)

    def call(self, simulation: RunState) -> bool:
        """Call the function if it is due; returns whether it ends the stage."""
        if simulation.time < self.due:
            return False
        self.count += 1
        self.skip_to(simulation.time)
        ends = self.act(simulation)
        return isinstance(ends, (bool, np.bool_)) and bool(ends)
