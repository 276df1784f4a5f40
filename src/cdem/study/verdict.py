"""Whether a static stage comes to rest, and how it fails otherwise."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cdem.errors import UnstableError
from cdem.run import stages
from cdem.run.simulation import CHECK_INTERVAL, Simulation
from cdem.study.criterion import Criterion
from cdem.units import coordinates

Floats = NDArray[np.float64]

LOOK = 10 * CHECK_INTERVAL
"""Steps between two looks at a stage."""

STEADY = 0.9
"""A body slides, and does not creep, if its unbalance ratio falls by less than a tenth while the
number of steps doubles: a remaining force would keep accelerating it."""

Seen = Literal["at rest", "sliding", "creeping", "undecided", "unstable"]


@dataclass
class Verdict:
    """How a static stage ended.

    Attributes:
        stable: Whether it came to rest.
        saw: Its behaviour: at rest; sliding, far or by a constant force; creeping, by a force that
            falls too slowly; undecided at the last allowed step; unstable, a computation that
            failed.
        why: The behaviour with figures. Speeds are from relaxation, which slows motion.
        moved: Displacement of the farthest node since the trial began, or from the given
            positions [m].
    """

    stable: bool
    saw: Seen
    why: str
    moved: float = np.nan


def rests(
    sim: Simulation,
    prepare: Callable[[], None] | None = None,
    criterion: Criterion | None = None,
    index: int = -1,
    start: Floats | None = None,
) -> Verdict:
    """Run a static stage, by default the last, until it rests or fails by the criterion.

    Args:
        sim: The simulation.
        prepare: May change the case at the beginning of the stage.
        criterion: Criterion of failure.
        index: Index of the stage.
        start: Origin of displacements for the check of rest [m], shape (nodes, 3); None:
            positions at the beginning of the stage.
    """
    c = criterion or Criterion()
    sim.stage_index = range(len(sim.case.stages))[index]
    stage = stages.begin(sim)
    if prepare:
        prepare()
        stages.update_core(sim, sim.stage_index)
        sim.core.renew_step()
    watch = _Watch(sim, c, start)
    most = sim.case.stages[sim.stage_index].max_steps or c.most_steps
    done = 0
    while done < most:
        try:
            outcome = sim.advance(stage, min(LOOK, most - done))
        except UnstableError as error:
            return Verdict(False, "unstable", str(error), watch.moved())
        done = sim.step_count - stage.start_step
        if outcome == "converged":
            return watch.rest()
        if verdict := watch.look(done):
            return verdict
    text = f"no rest in {done:,} steps, ratio {sim.core.unbalance_ratio():.2g}"
    return Verdict(False, "undecided", text, watch.moved())


@dataclass
class _Look:
    """One look at a stage: steps, displacement of the farthest node [faces], lowest unbalance ratio."""

    steps: int = 0
    moved: float = 0.0
    least: float = np.inf


@dataclass
class _Watch:
    """A stage as the criterion sees it."""

    sim: Simulation
    criterion: Criterion
    origin: Floats | None = None  # of reported displacements [m]
    looks: list[_Look] = field(default_factory=lambda: [_Look()])
    half_way: float = 0.0  # kinetic energy when half of the travel was reached [J]

    def __post_init__(self) -> None:
        counts, arrays = self.sim.audit.counts, self.sim.build.arrays
        self.size = float(arrays["face.length"][: counts["faces"]].mean())
        self.start = self.sim.fields["position"].copy()
        self.begin = self.start if self.origin is None else self.origin

    def moved(self) -> float:
        """Displacement of the farthest node from the origin [m]."""
        return float(self._ways(self.begin).max())

    def rest(self) -> Verdict:
        """The verdict on a model at rest, with its displacement."""
        left = self.sim.core.unbalance_ratio()  # 0 below the round-off of the coordinates
        ways = self._ways(self.begin)
        moved, ratio = float(ways.max()), f"unbalance ratio {left:.2g}" if left else "to round-off"
        most = self.criterion.most_moved
        if most is not None and moved > most:
            text = f"{self._place(ways)}, more than {most:g} m, and rests, {ratio}"
            return Verdict(False, "sliding", text, moved)
        return Verdict(True, "at rest", f"{ratio}, {self._place(ways)}", moved)

    def _ways(self, start: Floats) -> Floats:
        return np.linalg.norm(self.sim.fields["position"] - start, axis=1)

    def look(self, steps: int) -> Verdict | None:
        """Check the state after a number of steps; returns a verdict if it has failed."""
        c, last = self.criterion, self.looks[-1]
        ways = self._ways(self.start)
        moved, kinetic = float(ways.max()) / self.size, float(self.sim.energies["kinetic"])
        now = _Look(steps, moved, min(last.least, self.sim.core.unbalance_ratio()))
        self.looks.append(now)
        if last.steps == 0 or moved < 0.5 * c.travel:  # the first look includes the onset of loads
            self.half_way = kinetic
        elif moved > c.far or (moved > c.travel and kinetic > self.half_way):
            return Verdict(False, "sliding", self._text(ways), self.moved())
        if steps >= c.stall_steps:
            return self._goes_on(now, self._text(ways))
        return None

    def _goes_on(self, now: _Look, text: str) -> Verdict | None:
        """Failed if the farthest node moved as far in the last half of all steps as in the quarter
        before, and the unbalance ratio fell by less than half."""
        count = len(self.looks) - 1
        half, quarter = self.looks[count // 2], self.looks[count // 4]
        slower = now.moved - half.moved < half.moved - quarter.moved
        if slower or now.least <= 0.5 * half.least:
            return None
        saw: Seen = "sliding" if now.least > STEADY * half.least else "creeping"
        return Verdict(False, saw, f"{text}, ratio stays at {now.least:.2g}", self.moved())

    def _place(self, ways: Floats) -> str:
        farthest = int(ways.argmax())
        t = self.sim.build.topology
        group = self.sim.build.group_names[t.block_group[t.node_block[farthest]]]
        place = coordinates(self.sim.fields["position"][farthest])
        return f"{group} has moved {ways[farthest]:.3g} m at ({place})"

    def _text(self, ways: Floats) -> str:
        speed = np.linalg.norm(self.sim.fields["velocity"], axis=1).max()
        return f"{self._place(ways)}, {speed:.2g} m/s"
