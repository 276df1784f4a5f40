"""What a script does at intervals of a run: look, write, change values, end a stage."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cdem.errors import CdemError

if TYPE_CHECKING:
    from cdem.run.simulation import Simulation

Act = Callable[["Simulation"], object]
"""Takes the simulation; True ends the running stage, anything else does not."""


@dataclass
class Action:
    """A function that is called at the first step at or after each multiple of an interval.

    Attributes:
        interval: [s] of simulated time.
        act: The function.
        count: Of the multiple that comes next.
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
        """Let the next call be the first after a time [s]."""
        self.count = max(self.count, int(time / self.interval) + 1)

    def call(self, simulation: Simulation) -> bool:
        """Call the function if its time has come; whether it ends the stage."""
        if simulation.time < self.due:
            return False
        self.count += 1
        self.skip_to(simulation.time)
        ends = self.act(simulation)
        return isinstance(ends, (bool, np.bool_)) and bool(ends)
