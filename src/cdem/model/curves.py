"""Histories of loads and velocities as curves of the core."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cdem.seismic.processing import Processed

if TYPE_CHECKING:
    from cdem._core import Core


class Curve(NamedTuple):
    """Values over time.

    Attributes:
        times: Times from the start of the run, or of a stage [s].
        values: Values at these times, linear between; constant before the first and after the last.
        stage: Name of that stage, or None.
    """

    times: list[float]
    values: list[float]
    stage: str | None

    @property
    def at_start(self) -> float:
        """The value at the start of the run."""
        return float(np.interp(0.0, self.times, self.values))

    def in_run(self, begins: Mapping[str, float]) -> tuple[list[float], list[float]]:
        """Times from the start of the run [s], and values; the first value until its stage begins.

        Args:
            begins: Start times of the stages begun, by name [s].
        """
        if self.stage is None:
            return self.times, self.values
        if self.stage not in begins:
            return [0.0], self.values[:1]
        return [begins[self.stage] + time for time in self.times], self.values


Curves = list[Curve]


def constant() -> Curves:
    """The initial curves: the first is 1 at all times."""
    return [Curve([0.0], [1.0], None)]


def add_curve(
    history: Sequence[tuple[float, float]] | None, stage: str | None, curves: Curves
) -> int:
    """Index of a history's curve; of the constant curve without a history."""
    if history is None:
        return 0
    curves.append(Curve([float(t) for t, _ in history], [float(f) for _, f in history], stage))
    return len(curves) - 1


def add_record(record: Processed, stage: str | None, curves: Curves) -> int:
    """Index of the curve of a record, its velocity [m/s]: linear between samples, 0 before and after."""
    times = (np.arange(len(record.velocity) + 1) * record.step).tolist()
    curves.append(Curve(times, [0.0, *record.velocity[1:].tolist(), 0.0], stage))
    return len(curves) - 1


def hand_over(core: Core, curves: Curves, begins: Mapping[str, float]) -> None:
    """Give the core the curves, valid until another stage begins.

    Args:
        core: The core.
        curves: Curves of the model.
        begins: Start times of the stages begun, by name [s].
    """
    in_run = [curve.in_run(begins) for curve in curves]
    core.set_curves([times for times, _ in in_run], [values for _, values in in_run])
