"""Whether a static stage comes to rest, and what it does where it does not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from cdem.errors import UnstableError
from cdem.run import stages
from cdem.run.simulation import CHECK_INTERVAL, Simulation
from cdem.study.criterion import Criterion
from cdem.units import coordinates

LOOK = 10 * CHECK_INTERVAL
"""Steps between two looks at a stage."""

STEADY = 0.9
"""A body slides, and does not creep, where its unbalance ratio falls by less than a tenth while the
number of steps doubles: a force is left over, which would go on to accelerate it."""

Seen = Literal["at rest", "sliding", "creeping", "undecided", "unstable"]


@dataclass
class Verdict:
    """How a static stage ended.

    Attributes:
        stable: Whether it came to rest.
        saw: What it did: at rest; sliding, far or by a force that stays; creeping, on and on by a force
            that falls too slowly; undecided at the last step allowed; unstable, a computation that
            failed.
        why: The same with figures. Speeds are those of relaxation, which brakes.
    """

    stable: bool
    saw: Seen
    why: str


def rests(
    sim: Simulation,
    prepare: Callable[[], None] | None = None,
    criterion: Criterion | None = None,
    index: int = -1,
) -> Verdict:
    """Run a static stage, by default the last, until it rests or fails by the criterion.

    `prepare` may change the case as the stage begins.
    """
    c = criterion or Criterion()
    sim.stage_index = range(len(sim.case.stages))[index]
    stage = stages.begin(sim)
    if prepare:
        prepare()
        stages.update_core(sim, sim.stage_index)
        sim.core.renew_step()
    watch = _Watch(sim, c)
    most = sim.case.stages[sim.stage_index].max_steps or c.most_steps
    done = 0
    while done < most:
        try:
            outcome = sim.advance(stage, min(LOOK, most - done))
        except UnstableError as error:
            return Verdict(False, "unstable", str(error))
        done = sim.step_count - stage.start_step
        if outcome == "converged":
            left = sim.core.unbalance_ratio()  # 0 below the round-off of the coordinates
            return Verdict(
                True, "at rest", f"unbalance ratio {left:.2g}" if left else "to round-off"
            )
        if verdict := watch.look(done):
            return verdict
    return Verdict(
        False, "undecided", f"no rest in {done:,} steps, ratio {sim.core.unbalance_ratio():.2g}"
    )


@dataclass
class _Look:
    """One look at a stage: steps done, way of the farthest node [faces], lowest unbalance ratio yet."""

    steps: int = 0
    moved: float = 0.0
    least: float = np.inf


@dataclass
class _Watch:
    """What the criterion sees of a stage."""

    sim: Simulation
    criterion: Criterion
    looks: list[_Look] = field(default_factory=lambda: [_Look()])
    half_way: float = 0.0  # kinetic energy when half of the travel was reached [J]

    def __post_init__(self) -> None:
        counts, arrays = self.sim.audit.counts, self.sim.build.arrays
        self.size = float(arrays["face.length"][: counts["faces"]].mean())
        self.start = self.sim.fields["position"].copy()

    def look(self, steps: int) -> Verdict | None:
        """Take in the state after so many steps; a verdict where it has failed."""
        c, last = self.criterion, self.looks[-1]
        ways = np.linalg.norm(self.sim.fields["position"] - self.start, axis=1)
        moved, kinetic = float(ways.max()) / self.size, float(self.sim.energies["kinetic"])
        now = _Look(steps, moved, min(last.least, self.sim.core.unbalance_ratio()))
        self.looks.append(now)
        if last.steps == 0 or moved < 0.5 * c.travel:  # the first look sees loads come, too
            self.half_way = kinetic
        elif moved > c.far or (moved > c.travel and kinetic > self.half_way):
            return Verdict(False, "sliding", self._text(ways))
        if steps >= c.stall_steps:
            return self._goes_on(now, self._text(ways))
        return None

    def _goes_on(self, now: _Look, text: str) -> Verdict | None:
        """Failed where the last half of all steps moved it as far as the quarter before, and the
        unbalance ratio fell by less than half."""
        count = len(self.looks) - 1
        half, quarter = self.looks[count // 2], self.looks[count // 4]
        slower = now.moved - half.moved < half.moved - quarter.moved
        if slower or now.least <= 0.5 * half.least:
            return None
        saw: Seen = "sliding" if now.least > STEADY * half.least else "creeping"
        return Verdict(False, saw, f"{text}, ratio stays at {now.least:.2g}")

    def _text(self, ways: np.ndarray) -> str:
        farthest = int(ways.argmax())
        t = self.sim.build.topology
        group = self.sim.build.group_names[t.block_group[t.node_block[farthest]]]
        place = coordinates(self.sim.fields["position"][farthest])
        speed = np.linalg.norm(self.sim.fields["velocity"], axis=1).max()
        return f"{group} has moved {ways[farthest]:.3g} m at ({place}), {speed:.2g} m/s"
