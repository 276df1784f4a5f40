"""Whether a static stage comes to rest, and how it fails otherwise."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cdem.errors import UnstableError
from cdem.model.held import unheld_blocks
from cdem.run import stages
from cdem.run.behaviour import (
    LONG,
    UNKNOWN,
    Look,
    behaviour,
    face_size,
    patience,
    place_of,
    speed_of,
    ways_from,
)
from cdem.run.moving import Body, moving_bodies
from cdem.run.simulation import CHECK_INTERVAL, Simulation
from cdem.run.stage_state import StageState
from cdem.study.criterion import Criterion

Floats = NDArray[np.float64]

LOOK = 5 * CHECK_INTERVAL
"""Steps between two looks at a stage."""

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

    Bodies that nothing holds at first may fall until they meet something, and settle there for
    `UNKNOWN` steps: meanwhile they only fail if they go on by a face. After `LONG` steps, or once a
    block has fallen past the edge of the model, they count like all others.

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
    notes: list[str] = []
    verdict = _watched(sim, stage, criterion, wait, start, hasty, notes)
    verdict.why = "; ".join([verdict.why, *notes])
    return verdict


def _watched(
    sim: Simulation,
    stage: StageState,
    criterion: Criterion,
    wait: int,
    start: Floats | None,
    hasty: bool,
    notes: list[str],
) -> Verdict:
    """The verdict on a stage; what else is to be told goes to the notes."""
    c, chips = criterion, list[Body]()
    loose = loose_nodes(sim)
    hasty = hasty and not loose.any()
    watch = _Watch(sim, c, wait, loose, start)
    most = sim.case.stages[sim.stage_index].max_steps or c.most_steps
    begin = sim.step_count
    while (done := sim.step_count - begin) < most:
        try:
            outcome = sim.advance(stage, min(LOOK, most - done))
            handed_over = sim.watch_energy(stage)
        except UnstableError as error:
            return Verdict(False, "unstable", str(error), watch.moved(), chips=chips)
        if handed_over:  # the steps of local damping are others
            notes.append(handed_over)
            watch = _Watch(sim, c, max(wait, UNKNOWN), loose, watch.begin)
            continue
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
        loose &= loose_nodes(sim)
        watch = _Watch(sim, c, wait, loose, watch.begin)
    text = f"no rest in {done:,} steps, ratio {sim.core.unbalance_ratio():.2g}"
    return Verdict(False, "undecided", text, watch.moved(), watch.bodies(), chips)


def loose_nodes(sim: Simulation) -> NDArray[np.bool_]:
    """Nodes of blocks that nothing holds, shape (nodes,)."""
    return unheld_blocks(sim.build, sim.out)[sim.build.topology.node_block]


def _take_out(sim: Simulation, bodies: list[Body]) -> None:
    t = sim.build.topology
    leaves = np.zeros(len(t.block_group), np.int8)
    leaves[np.concatenate([body.members for body in bodies])] = 1
    sim.core.take_out(leaves[t.node_block])


@dataclass
class _Watch:
    """A stage as the criterion sees it, from now on."""

    sim: Simulation
    criterion: Criterion
    wait: int
    loose: NDArray[np.bool_]  # nodes that nothing holds at first
    origin: Floats | None = None  # of reported displacements [m]
    looks: list[Look] = field(default_factory=lambda: [Look()])

    def __post_init__(self) -> None:
        self.size = face_size(self.sim)
        self.start = self.sim.fields["position"].copy()
        self.begin = self.start if self.origin is None else self.origin
        self.first_step = self.sim.step_count
        self.falls, self.settles, self.last_fall = self.loose.copy(), bool(self.loose.any()), 0
        self.counts_from = self.start.copy()  # displacements count from here
        self.seen_from = self.counts_from

    def bodies(self) -> list[Body]:
        """The bodies that have moved since the watch began, or since they landed."""
        return moving_bodies(self.sim, self.seen_from)

    def moved(self) -> float:
        """Displacement of the farthest node from the origin [m]."""
        return float(ways_from(self.sim, self.begin).max())

    def rest(self, chips: list[Body]) -> Verdict:
        """The verdict on a model at rest, with its displacement."""
        left = self.sim.core.unbalance_ratio()  # 0 below the round-off of the coordinates
        ways = ways_from(self.sim, self.begin)
        moved, ratio = float(ways.max()), f"unbalance ratio {left:.2g}" if left else "to round-off"
        most = self.criterion.most_moved
        if most is not None and moved > most:
            text = f"{place_of(self.sim, ways)}, more than {most:g} m, and rests, {ratio}"
            return Verdict(
                False, "sliding", text, moved, moving_bodies(self.sim, self.begin), chips
            )
        return Verdict(True, "at rest", f"{ratio}, {place_of(self.sim, ways)}", moved, chips=chips)

    def look(self) -> Verdict | None:
        """Check the present state; returns a verdict if it has failed."""
        done = self.sim.step_count - self.first_step
        self._follow(done)
        ways = ways_from(self.sim, self.counts_from)
        ratio = self.sim.core.unbalance_ratio()
        if ways.max() > self.criterion.far * self.size:
            self.seen_from = self.counts_from
            return Verdict(False, "sliding", self._text(ways), self.moved())
        ways = ways_from(self.sim, self.seen_from)
        moved = float(ways.max()) / self.size
        self.looks.append(Look(moved, min(self.looks[-1].least, ratio)))
        return self._goes_on(done, self._text(ways)) if done >= self.wait else None

    def _follow(self, done: int) -> None:
        """Follow the bodies that nothing held at first, until they have settled."""
        if not self.settles:
            return
        now = self.sim.fields["position"]
        if self.falls.any():
            self.counts_from[self.falls] = now[self.falls]
            self.falls &= loose_nodes(self.sim)
            self.last_fall = done
        past = done > LONG or len(self.sim.fallen) > 0
        self.settles = not past and done - self.last_fall < UNKNOWN
        if not self.settles:
            self.counts_from[self.loose] = now[self.loose]
        self.seen_from = np.where((self.loose & self.settles)[:, None], now, self.counts_from)

    def _goes_on(self, done: int, text: str) -> Verdict | None:
        """Failed if it slides or creeps, see `behaviour`.

        If it creeps, this must be so after four times the wait and `UNKNOWN` steps, or those of a
        fall; if it has not moved by `travel`, it is sure only then.
        """
        saw, now = behaviour(self.looks), self.looks[-1]
        early = done < max(UNKNOWN, 4 * self.wait) or self.settles
        if saw is None or (saw == "creeping" and early):
            return None
        may_tighten = now.moved <= self.criterion.travel  # an anchor, or a joint that closes again
        why = f"{text}, ratio stays at {now.least:.2g}"
        return Verdict(False, saw, why, self.moved(), sure=not (early and may_tighten))

    def _text(self, ways: Floats) -> str:
        past = ", past the edge of the model" if len(self.sim.fallen) else ""
        return f"{place_of(self.sim, ways)}, {speed_of(self.sim):.2g} m/s{past}"
