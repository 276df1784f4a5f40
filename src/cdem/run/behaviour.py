"""How a static stage behaves that finds no rest: it slides, creeps, or its blocks chatter."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cdem.run import stages
from cdem.run.kept import bring_back, keep
from cdem.run.moving import Body, moving_bodies
from cdem.run.stage_state import StageState
from cdem.run.state import RunState
from cdem.units import coordinates

Floats = NDArray[np.float64]

LEAST_STEPS = 400
"""Steps before a behaviour is judged: halves and quarters of them are compared."""
PERIODS = 2.0
"""Periods of the slowest elastic motion after which the unbalanced force is judged."""
UNKNOWN = 10_000
"""The same in steps, where that motion is not known."""
SHAKE = 0.01
"""Part of gravity by which a model is loaded to find that period."""
STEADY = 0.9
"""A body slides, and does not creep, if its unbalance ratio falls by less than a tenth while the
number of steps doubles: a remaining force would keep accelerating it."""
LONG = 4 * UNKNOWN
"""Steps after which a stage of a run ends that slides or creeps; loose stones settle for longer."""
STILL_MOVES = 0.02
"""Part of the mean face size by which the farthest node must then have moved in the last half."""
STAYS = 0.005
"""Part of the mean face size by which blocks that chatter move at most in that half."""
ONWARD = 0.5
"""Part of the way of the farthest node in that half that brings it on, if it moves on."""


@dataclass
class Look:
    """One look at a stage: displacement of the farthest node [faces], lowest unbalance ratio."""

    moved: float = 0.0
    least: float = np.inf


def behaviour(looks: Sequence[Look]) -> Literal["sliding", "creeping"] | None:
    """Whether the farthest node gains speed while the unbalance ratio hardly falls.

    In the last quarter of all steps it moved no less far than in the quarter before. Where the
    ratio has fallen by less than a tenth in the last half, it slides, by less than half, it creeps.

    Args:
        looks: At equal numbers of steps, the first at the start.
    """
    last = len(looks) - 1
    now, later, half = (looks[last - k * (last // 4)] for k in range(3))
    stays = now.moved <= half.moved
    slower = now.moved - later.moved < later.moved - half.moved
    if stays or slower or now.least <= 0.5 * half.least:
        return None
    return "sliding" if now.least > STEADY * half.least else "creeping"


def patience(sim: RunState) -> int | None:
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


def ways_from(sim: RunState, start: Floats) -> Floats:
    """Displacement of each node [m] from a start of shape (nodes, 3); 0 where blocks are out."""
    ways = np.linalg.norm(sim.fields["position"] - start, axis=1)
    return np.where(sim.out[sim.build.topology.node_block], 0.0, ways)


def face_size(sim: RunState) -> float:
    """Mean size of the faces [m]."""
    counts, arrays = sim.audit.counts, sim.build.arrays
    return float(arrays["face.length"][: counts["faces"]].mean())


def place_of(sim: RunState, ways: Floats) -> str:
    """The node that has moved farthest, in words."""
    farthest = int(ways.argmax())
    t = sim.build.topology
    group = sim.build.group_names[t.block_group[t.node_block[farthest]]]
    place = coordinates(np.round(sim.fields["position"][farthest], 3))
    return f"{group} has moved {ways[farthest]:.3g} m at ({place})"


def speed_of(sim: RunState) -> float:
    """Largest speed of a node [m/s]."""
    return float(np.linalg.norm(sim.fields["velocity"], axis=1).max())


@dataclass
class NoRest:
    """The end of a static stage of a run that has found no rest.

    Attributes:
        status: "moving", "creeping", "chattering" or "undecided".
        why: With figures. Speeds are from relaxation, which slows motion.
        bodies: What moves, the largest first; none where blocks chatter.
    """

    status: Literal["moving", "creeping", "chattering", "undecided"]
    why: str
    bodies: list[Body]

    def text(self) -> str:
        """One line for log and screen."""
        first = f": {self.bodies[0].text()}" if self.bodies else ""
        more = f", and {len(self.bodies) - 1} smaller bodies" if len(self.bodies) > 1 else ""
        return f"found no rest, {self.status}: {self.why}{first}{more}"

    def as_dict(self) -> dict[str, Any]:
        """For the summary."""
        return {"no_rest": self.text(), "moving": [body.as_dict() for body in self.bodies]}


def look(sim: RunState, stage: StageState, outcome: str) -> NoRest | None:
    """Look at a stage of a run at a row of its history.

    A body moves if it slides or creeps after `UNKNOWN` steps and by more than the mean face size. It
    moves if it slides, or creeps, after `LONG` steps if it is still moving by `STILL_MOVES`. Where the
    unbalance has not halved in the last half of four times as many, blocks chatter, or the end is
    undecided. Unless a block has fallen past the edge, all of this must be true after the wait of
    `patience` as well, or four times that where nothing has moved by a face.

    Returns:
        How it ends, if it is static and finds no rest; the log tells of it.
    """
    if stage.mode != "static" or stages.status(sim, stage, outcome) is not None:
        return None
    if stages.curves_run(sim, stage):
        stage.watch_anew()
        return None
    ratio = float(sim.core.unbalance_ratio())
    if not stage.ways:
        sim.watched = sim.fields["position"].copy()
        stage.ways, stage.ratios = [0.0], [ratio]
        return None
    ways = ways_from(sim, sim.watched)
    stage.ways.append(float(ways.max()) / face_size(sim))
    stage.ratios.append(min(stage.ratios[-1], ratio))
    done = stages.STATIC_RECORD_STEPS * (len(stage.ways) - 1)
    status = _status(stage, done)
    if status is None:
        return None
    if not len(sim.fallen):
        stage.wait = stage.wait or patience(sim) or UNKNOWN
        if done < (stage.wait if stage.ways[-1] > 1 else 4 * stage.wait):
            return None
    why = (
        f"in {done:,} steps {place_of(sim, ways)}, {speed_of(sim):.2g} m/s, unbalance ratio no lower "
        f"than {stage.ratios[-1]:.2g}"
    )
    bodies = moving_bodies(sim, sim.watched) if status in ("moving", "creeping") else []
    found = NoRest(status, why, bodies)
    sim.tell(f"warning: stage {stage.name} {found.text()}")
    return found


def _status(
    stage: StageState, done: int
) -> Literal["moving", "creeping", "chattering", "undecided"] | None:
    if done < UNKNOWN:
        return None
    looks = [Look(*pair) for pair in zip(stage.ways, stage.ratios, strict=True)]
    half = np.array(stage.ways[len(looks) // 2 :])
    path = np.abs(np.diff(half)).sum()
    goes = half[-1] - half[0] > ONWARD * path
    saw = behaviour(looks) if goes else None
    if saw and half[-1] > 1:
        return "moving"
    if saw and done >= LONG and half[-1] - half[0] > STILL_MOVES:
        return "moving" if saw == "sliding" else "creeping"
    if done < 4 * LONG or looks[-1].least <= 0.5 * looks[len(looks) // 2].least:
        return None
    return "chattering" if not goes and np.ptp(half) < STAYS else "undecided"
