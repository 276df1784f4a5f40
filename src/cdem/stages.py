"""Stages of a run: what each sets, when it records, when it ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from cdem import build as building
from cdem.errors import CaseError

if TYPE_CHECKING:
    from cdem.simulation import Simulation

STATIC_RECORD_STEPS = 200
"""Steps between history rows of a static stage, which has no meaningful time."""
ROWS_PER_FRAME = 10
"""History rows per recorded frame of a dynamic stage."""
STALL_STEPS = 10_000
"""A static stage that comes no nearer to rest in as many steps is said to stall."""
FRAMES = 50
"""Frames of a dynamic stage when output.every is not given."""


@dataclass
class StageState:
    """The running stage.

    Attributes:
        name: Its name.
        mode: "static" or "dynamic".
        start_time: [s].
        start_step: Steps done before it.
        end_time: [s], or None for a static stage.
        row_every: Time between history rows [s].
        rows: Times of history rows that have passed after the first.
        frame_due: Whether a time of a frame passed with the last of them.
        wall_time: Wall time spent in it [s].
        least_unbalance: Smallest unbalance ratio of a static stage so far, or None.
        least_step: Step at which it was reached.
    """

    name: str
    mode: str
    start_time: float
    start_step: int
    end_time: float | None
    row_every: float
    rows: int = 0
    frame_due: bool = False
    wall_time: float = 0.0
    least_unbalance: float | None = None
    least_step: int = 0

    def note(self, step: int, unbalance: float) -> str:
        """What a user should know about a static stage that does not come to rest, or nothing."""
        if self.mode != "static":
            return ""
        if self.least_unbalance is None or unbalance < 0.95 * self.least_unbalance:
            self.least_unbalance, self.least_step = unbalance, step
        waited = step - self.least_step
        if waited < STALL_STEPS:
            return ""
        return (
            f"no nearer to rest for {waited:,} steps (does a block move freely? "
            "else try a larger tolerance or another relax)"
        )

    @property
    def next_row(self) -> float:
        """Time of the next history row [s]."""
        return self.start_time + (self.rows + 1) * self.row_every


def damping_of(stage) -> tuple[float, float, float, float]:
    """Local, mass, stiffness and contact damping of a stage."""
    d = stage.damping
    return (d.local, d.mass, d.stiffness, d.contact)


def is_lumped(stage) -> bool:
    """Whether a stage moves lumped masses.

    A static stage only looks for rest, which does not depend on inertia, and lumped masses allow a
    longer step (2.2 times for a tet); local damping scales forces node by node, which is stable for
    lumped masses alone.
    """
    return stage.mode == "static" or stage.damping.local > 0


def apply_settings(sim: Simulation, index: int) -> None:
    """Apply damping and `set` of a stage to the core (not to motion or displacement)."""
    stage = sim.case.stages[index]
    for path, value in stage.set.items():
        sim.case.set(path, value)
    if stage.set:
        update_core(sim, index)
    sim.core.set_damping(*damping_of(stage))
    sim.core.set_lumped(is_lumped(stage))


def update_core(sim: Simulation, index: int) -> None:
    """Hand the values that the case has now to the core."""
    b = sim.build
    names = b.group_names
    laws, table = building.interfaces_of(sim.case, names)
    was = b.bonded
    now = building.bonded_pairs(laws, table)
    if (now & ~was).any():
        i, j = np.argwhere(now & ~was)[0] % len(names)
        raise CaseError(
            f"{sim.case.where(f'stages.{index}.set')}: stages.{index}.set: the interface of "
            f"{names[i]!r} and {names[j]!r} was not bonded at the start (cohesion and "
            "tensile_strength 0), so it cannot be given strength now; start with a strength"
        )
    sim.core.set_interfaces([building.interface_entry(law) for law in laws])
    sim.core.update_model(building.change(b))
    sim.core.set_curves([c[0] for c in b.curves], [c[1] for c in b.curves])
    sim.core.set_gravity([float(g) for g in sim.case.loads.gravity])


def begin(sim: Simulation) -> StageState:
    """Start the next stage of a simulation."""
    index = sim.stage_index
    stage = sim.case.stages[index]
    sim.core.change_mass(is_lumped(stage))
    apply_settings(sim, index)
    if sim.step_count:
        sim.core.renew_step()
    if stage.reset_displacement:
        sim.reference = sim.fields["position"].copy()
    end = None if stage.duration is None else sim.time + stage.duration
    every = sim.case.output.every or (stage.duration or 1.0) / FRAMES
    return StageState(
        name=stage.name,
        mode=stage.mode,
        start_time=sim.time,
        start_step=sim.step_count,
        end_time=end,
        row_every=every / ROWS_PER_FRAME,
    )


def advance(sim: Simulation, stage: StageState, steps: int, until: float):
    """Run towards the stage's next event or a time, at most `steps` steps; the core's report."""
    rules = sim.case.stages[sim.stage_index]
    done = sim.step_count - stage.start_step
    if rules.max_steps is not None:
        steps = min(steps, rules.max_steps - done)
    if stage.mode == "static":
        steps = min(steps, STATIC_RECORD_STEPS - done % STATIC_RECORD_STEPS)
        return sim.core.run(
            steps,
            end_time=until,
            unbalance_limit=rules.tolerance,
            relaxation="none" if rules.relax == "local" else rules.relax,
        )
    assert stage.end_time is not None
    return sim.core.run(steps, end_time=min(stage.next_row, stage.end_time, until))


def record_is_due(sim: Simulation, stage: StageState, outcome: str) -> bool:
    """Whether a history row belongs to this moment; counts it."""
    if stage.mode == "static":
        due = (sim.step_count - stage.start_step) % STATIC_RECORD_STEPS == 0
        due = due or status(sim, stage, outcome) is not None
    else:
        assert stage.end_time is not None
        due = sim.time >= min(stage.next_row, stage.end_time)
    if due:
        before, stage.rows = stage.rows, stage.rows + 1
        if stage.mode == "dynamic":  # a step may be longer than the time between rows
            passed = int((sim.time - stage.start_time) / stage.row_every)
            stage.rows = max(stage.rows, passed)
        stage.frame_due = stage.rows // ROWS_PER_FRAME > before // ROWS_PER_FRAME
    return due


def frame_is_due(sim: Simulation, stage: StageState, outcome: str) -> bool:
    """Whether the history row just counted comes with a frame of the fields."""
    if status(sim, stage, outcome) is not None:
        return True
    return stage.mode == "dynamic" and stage.frame_due


def status(sim: Simulation, stage: StageState, outcome: str) -> str | None:
    """How the stage ended, or None while it goes on."""
    rules = sim.case.stages[sim.stage_index]
    if outcome == "converged":
        return "converged"
    if stage.end_time is not None and sim.time >= stage.end_time:
        return "finished"
    if rules.max_steps is not None and sim.step_count - stage.start_step >= rules.max_steps:
        return "max_steps"
    return None
