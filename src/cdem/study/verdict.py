"""Whether a static stage comes to rest, and how it fails otherwise."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cdem.errors import UnstableError
from cdem.run import stages
from cdem.run.kept import bring_back, keep
from cdem.run.simulation import CHECK_INTERVAL, Simulation
from cdem.run.state import StageState
from cdem.study.criterion import Criterion
from cdem.study.moving import Body, moving_bodies
from cdem.units import coordinates

Floats = NDArray[np.float64]

LOOK = 5 * CHECK_INTERVAL
"""Steps between two looks at a stage."""
PERIODS = 2.0
"""Periods of the slowest elastic motion after which the unbalanced force is judged."""
LEAST_STEPS = 4 * LOOK
"""Steps before that at least: the farthest node is compared over halves and quarters of them."""
UNKNOWN = 10_000
"""The same where that motion is not known."""
SHAKE = 0.01
"""Part of gravity by which a model is loaded to find that period."""
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
        bodies: What moves, where it has failed: the largest first.
        chips: Smaller bodies that moved, and were taken out of the model.
        sure: Whether it was watched as long as the criterion asks; else a body slides that may yet
            come to rest on what it meets.
    """

    stable: bool
    saw: Seen
    why: str
    moved: float = np.nan
    bodies: list[Body] = field(default_factory=list)
    chips: list[Body] = field(default_factory=list)
    sure: bool = True


def patience(sim: Simulation) -> int | None:
    """Steps after which a force that has not fallen is not that of an elastic motion.

    The model is loaded by a little more gravity and solved; the displacement gives the period of the
    slowest motion that this excites (Rayleigh's quotient), in steps with the masses of the stage.
    Its state stays as it is.

    Returns:
        Steps, or None where no rest lies near or there is no gravity.
    """
    gravity = np.array(sim.case.loads.gravity, float)
    rules = sim.case.stages[sim.stage_index]
    assert rules.relax is not None and rules.tolerance is not None
    if not gravity.any():
        return None
    state = keep(sim)
    sim.core.set_gravity(list((1 + SHAKE) * gravity))
    sim.core.run(1, relaxation=stages.RELAXATIONS[rules.relax])
    force, step = sim.fields["force"].copy(), float(sim.core.scalars()["dt"])
    mass = np.array(sim.core.array("node.relax_mass")[0]).ravel()
    mass = mass if len(mass) == len(force) else sim.fields["mass"].copy()
    bring_back(sim, state)
    before = sim.fields["position"].copy()
    rounds, _, first, left = sim.core.solve_for_rest(rules.tolerance)
    moved = sim.fields["position"] - before
    sim.core.set_gravity(list(gravity))
    bring_back(sim, state)
    energy, heavy = float((moved * force).sum()), float((mass[:, None] * moved**2).sum())
    if not rounds or left > stages.LEAST_GAIN * first or not energy > 0 or not heavy > 0:
        return None
    return max(LEAST_STEPS, math.ceil(PERIODS * 2 * math.pi * math.sqrt(heavy / energy) / step))


def stage_rests(
    sim: Simulation, criterion: Criterion | None = None, index: int = -1, *, hasty: bool = False
) -> Verdict:
    """Begin a static stage, by default the last, and run it until it rests or fails.

    Args:
        sim: The simulation; stages between are left out.
        criterion: Criterion of failure.
        index: Index of the stage.
        hasty: As in `rests`.
    """
    sim.stage_index = range(len(sim.case.stages))[index]
    stage, criterion = stages.begin(sim), criterion or Criterion()
    wait = criterion.stall_steps or patience(sim) or UNKNOWN
    return rests(sim, stage, criterion, wait, hasty=hasty)


def rests(
    sim: Simulation,
    stage: StageState,
    criterion: Criterion,
    wait: int,
    start: Floats | None = None,
    *,
    hasty: bool = False,
) -> Verdict:
    """Run a static stage that has begun until it rests or fails by the criterion.

    Args:
        sim: The simulation.
        stage: Its stage.
        criterion: Criterion of failure.
        wait: Steps after which the unbalanced force is judged.
        start: Origin of displacements for the check of rest [m], shape (nodes, 3); None:
            present positions.
        hasty: Whether to end where a body slides that has not moved by `travel` yet: such a
            failure is not sure.
    """
    c, chips = criterion, list[Body]()
    watch = _Watch(sim, c, wait, start)
    most = sim.case.stages[sim.stage_index].max_steps or c.most_steps
    begin = sim.step_count
    while (done := sim.step_count - begin) < most:
        try:
            outcome = sim.advance(stage, min(LOOK, most - done))
        except UnstableError as error:
            return Verdict(False, "unstable", str(error), watch.moved(), chips=chips)
        if outcome == "converged":
            return watch.rest(chips)
        verdict = watch.look()
        if verdict is None or not (verdict.sure or hasty):
            continue
        verdict.bodies, verdict.chips = watch.bodies(), chips
        if not verdict.bodies or any(c.counts(sim, body) for body in verdict.bodies):
            return verdict
        if not verdict.sure:  # chips may tighten, too
            continue
        _take_out(sim, verdict.bodies)
        chips += verdict.bodies
        watch = _Watch(sim, c, wait, watch.begin)
    text = f"no rest in {done:,} steps, ratio {sim.core.unbalance_ratio():.2g}"
    return Verdict(False, "undecided", text, watch.moved(), watch.bodies(), chips)


def _take_out(sim: Simulation, bodies: list[Body]) -> None:
    t = sim.build.topology
    leaves = np.zeros(len(t.block_group), np.int8)
    leaves[np.concatenate([body.members for body in bodies])] = 1
    sim.core.take_out(leaves[t.node_block])


@dataclass
class _Look:
    """One look at a stage: displacement of the farthest node [faces], lowest unbalance ratio."""

    moved: float = 0.0
    least: float = np.inf


@dataclass
class _Watch:
    """A stage as the criterion sees it, from now on."""

    sim: Simulation
    criterion: Criterion
    wait: int
    origin: Floats | None = None  # of reported displacements [m]
    looks: list[_Look] = field(default_factory=lambda: [_Look()])

    def __post_init__(self) -> None:
        counts, arrays = self.sim.audit.counts, self.sim.build.arrays
        self.size = float(arrays["face.length"][: counts["faces"]].mean())
        self.start = self.sim.fields["position"].copy()
        self.begin = self.start if self.origin is None else self.origin
        self.first_step = self.sim.step_count

    def bodies(self) -> list[Body]:
        """The bodies that have moved since the watch began."""
        return moving_bodies(self.sim, self.start)

    def moved(self) -> float:
        """Displacement of the farthest node from the origin [m]."""
        return float(self._ways(self.begin).max())

    def rest(self, chips: list[Body]) -> Verdict:
        """The verdict on a model at rest, with its displacement."""
        left = self.sim.core.unbalance_ratio()  # 0 below the round-off of the coordinates
        ways = self._ways(self.begin)
        moved, ratio = float(ways.max()), f"unbalance ratio {left:.2g}" if left else "to round-off"
        most = self.criterion.most_moved
        if most is not None and moved > most:
            text = f"{self._place(ways)}, more than {most:g} m, and rests, {ratio}"
            return Verdict(
                False, "sliding", text, moved, moving_bodies(self.sim, self.begin), chips
            )
        return Verdict(True, "at rest", f"{ratio}, {self._place(ways)}", moved, chips=chips)

    def _ways(self, start: Floats) -> Floats:
        ways = np.linalg.norm(self.sim.fields["position"] - start, axis=1)
        return np.where(self.sim.out[self.sim.build.topology.node_block], 0.0, ways)

    def look(self) -> Verdict | None:
        """Check the present state; returns a verdict if it has failed."""
        ways = self._ways(self.start)
        moved = float(ways.max()) / self.size
        ratio = self.sim.core.unbalance_ratio()
        self.looks.append(_Look(moved, min(self.looks[-1].least, ratio)))
        if moved > self.criterion.far:
            return Verdict(False, "sliding", self._text(ways), self.moved())
        done = self.sim.step_count - self.first_step
        return self._goes_on(done, self._text(ways)) if done >= self.wait else None

    def _goes_on(self, done: int, text: str) -> Verdict | None:
        """Failed if the farthest node gains speed and the unbalance ratio hardly falls.

        In the last quarter of all steps it moved no less far than in the quarter before. Where the
        ratio has fallen by less than a tenth in the last half, it slides, by less than half, it
        creeps. If it creeps, this must be so after four times the wait and `UNKNOWN` steps; if it
        has not moved by `travel`, it is sure only then.
        """
        last = len(self.looks) - 1
        quarter = last // 4
        now, later, half = (self.looks[last - k * quarter] for k in range(3))
        slower = now.moved - later.moved < later.moved - half.moved
        if slower or now.least <= 0.5 * half.least:
            return None
        saw: Seen = "sliding" if now.least > STEADY * half.least else "creeping"
        early = done < max(UNKNOWN, 4 * self.wait)
        if saw == "creeping" and early:
            return None
        may_tighten = now.moved <= self.criterion.travel  # an anchor, or a joint that closes again
        why = f"{text}, ratio stays at {now.least:.2g}"
        return Verdict(False, saw, why, self.moved(), sure=not (early and may_tighten))

    def _place(self, ways: Floats) -> str:
        farthest = int(ways.argmax())
        t = self.sim.build.topology
        group = self.sim.build.group_names[t.block_group[t.node_block[farthest]]]
        place = coordinates(np.round(self.sim.fields["position"][farthest], 3))
        return f"{group} has moved {ways[farthest]:.3g} m at ({place})"

    def _text(self, ways: Floats) -> str:
        speed = np.linalg.norm(self.sim.fields["velocity"], axis=1).max()
        return f"{self._place(ways)}, {speed:.2g} m/s"
