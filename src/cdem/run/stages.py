"""Stages of a run: settings, times of records, end."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.curve_times import last_change, last_dynamic, over_early, record_users
from cdem.case.laws import INTERFACE_LAWS
from cdem.case.schema import Release, Stage
from cdem.errors import CaseError
from cdem.model.backfill import folded, nodes_of_groups, places
from cdem.model.build import change
from cdem.model.curves import constant, hand_over
from cdem.model.damping import branches_of, damping_of, is_lumped, rock_damping_of
from cdem.model.interfaces import bonded_pairs, interfaces_of
from cdem.model.supports import held_components, supports_of
from cdem.rows import rows_of
from cdem.run.kept import bring_back, keep
from cdem.run.stage_state import StageState
from cdem.run.state import RunState, Setting

STATIC_RECORD_STEPS = 200
"""Steps between history rows of a static stage, which has no meaningful time."""
ROWS_PER_FRAME = 10
"""History rows per recorded frame of a dynamic stage, if nothing asks for more."""
ROUNDING = 1e-12
"""Part by which a time may fall short of that of a frame by rounding [1]."""
RELAXATIONS = {"local": "none", "kinetic": "kinetic", "adaptive": "adaptive", "solve": "adaptive"}
"""What the core does in each step of a static stage, by its `relax`."""
LOCAL_DAMPING = 0.8
"""Local damping by which a stage goes on where adaptive relaxation lost the balance of energy."""
LEAST_GAIN = 0.1
"""Part of the unbalance ratio below which a solve must bring it, or it is taken back."""
FRAMES = 50
"""Frames of a dynamic stage when output.every is not given."""


def apply_settings(sim: RunState, index: int) -> None:
    """Apply damping and `set` of a stage to the core (not to motion or displacement)."""
    stage = sim.case.stages[index]
    for path, value in stage.set.items():
        sim.case.set(path, value)
    moduli = branches_of(stage.damping.maxwell).part
    if stage.set or moduli != sim.build.moduli:
        sim.build.moduli = moduli
        update_core(sim, index)
    sim.core.set_damping(*damping_of(stage))
    sim.core.set_rock_damping(*rock_damping_of(stage))
    sim.core.set_lumped(is_lumped(stage))


def change_value(sim: RunState, setting: Setting) -> None:
    """Change one value of the case and of the core."""
    sim.case.set(setting.path, setting.value)
    update_core(sim, max(setting.begun - 1, 0))


def update_core(sim: RunState, index: int) -> None:
    """Give the core the present values of the case."""
    b = sim.build
    names = b.group_names
    laws, table = interfaces_of(sim.case, names)
    was = b.bonded
    now = bonded_pairs(laws, table)
    if (now & ~was).any():
        i, j = np.argwhere(now & ~was)[0] % len(names)
        raise CaseError(
            f"{sim.case.where(f'stages.{index}.set')}: stages.{index}.set: the interface of "
            f"{names[i]!r} and {names[j]!r} was not bonded at the start (cohesion and "
            "tensile_strength 0), so it cannot get strength now; give it strength from the start"
        )
    arrays = change(b)
    sim.core.set_interfaces(b.assembly.interfaces)
    sim.core.update_model(arrays)
    hand_over(sim.core, b.curves, sim.begins)
    sim.core.set_gravity([float(g) for g in sim.case.loads.gravity])
    sim.keep_case()


def begin(sim: RunState) -> StageState:
    """Start the next stage of a simulation.

    Raises:
        CaseError: A curve ends before it; or an added group does not fit in.
    """
    index = sim.stage_index
    stage = sim.case.stages[index]
    sim.begins.setdefault(stage.name, sim.time)  # a search starts its last stage many times
    if stage.remove:
        excavate(sim, stage.remove)
    change_bolts(sim, stage.name)
    begin_surfaces(sim, stage.name)
    begin_boundaries(sim)
    sim.core.change_mass(is_lumped(stage))
    damp_rock(sim, stage)
    apply_settings(sim, index)
    hand_over(sim.core, sim.build.curves, sim.begins)
    refuse_curves_over(sim)
    keep_peaks(sim, stage)
    if stage.add:
        fill(sim, stage.add)
    if sim.step_count:
        sim.core.renew_step()
    if stage.reset_displacement:
        sim.reference = sim.fields["position"].copy()
    end = None if stage.duration is None else sim.time + stage.duration
    every = sim.case.output.every or (stage.duration or 1.0) / FRAMES
    begun = StageState(
        name=stage.name,
        mode=stage.mode,
        start_time=sim.time,
        start_step=sim.step_count,
        end_time=end,
        row_every=row_every(sim.case, index, every),
        frame_every=every,
        held=float(sim.core.scalars()["relief_to"]),
    )
    release = _release_of(stage)
    if release is not None and stage.mode == "dynamic":
        sim.core.release_forces(1 - release.to, sim.time + (release.over or 0.0))
    elif release is not None:
        release_part(sim, begun)
    return begun


def keep_peaks(sim: RunState, stage: Stage) -> None:
    """Start to keep the largest speeds in a dynamic stage, if the case asks for them, or stop."""
    if "peak_velocity" not in sim.case.output.fields:
        return
    if stage.mode == "dynamic":
        sim.core.begin_peaks()
    sim.core.keep_peaks(stage.mode == "dynamic")


def row_every(case: Case, index: int, frame_every: float) -> float:
    """Time between rows of the histories in a dynamic stage [s].

    Args:
        case: The case.
        index: Number of the stage.
        frame_every: Time between its frames [s].
    """
    asked = [entry.every for entry in case.histories if entry.every is not None]
    if asked:
        return min([frame_every, *asked])
    begun = case.begun_names(index + 1)
    steps = [case.processed(name).step for _, name, stage in record_users(case) if stage in begun]
    return min([frame_every / ROWS_PER_FRAME, *steps])


def refuse_curves_over(sim: RunState) -> None:
    """End a run whose curves end before the last dynamic stage, for which they may be meant.

    Raises:
        CaseError: There is such a curve; says where its times start.
    """
    if sim.begun > last_dynamic(sim.case.stages):
        return
    late = sim.stage_index * float(sim.core.scalars()["dt"])  # each stage may end one step late
    for keys, what in over_early(sim.case, sim.time, late):
        path = ".".join(map(str, keys))
        raise CaseError(f"{sim.case.where(path)}: {path}: {what}")


def _release_of(stage: Stage) -> Release | None:
    """Release settings of a stage: by default, groups removed in it are released at once."""
    return stage.release or (Release() if stage.remove else None)


def excavate(sim: RunState, names: list[str]) -> None:
    """Remove groups; the forces that they carried are kept until they are released."""
    t = sim.build.topology
    leave = np.isin(t.block_group, [sim.build.group_names.index(name) for name in names])
    sim.core.excavate(leave[t.node_block].astype(np.int8))


def fill(sim: RunState, names: list[str]) -> None:
    """Add groups, free of stress in their present positions between the rock."""
    b, t = sim.build, sim.build.topology
    comes, out = nodes_of_groups(t, names), sim.core.fields()["node.out"] != 0
    moved = rows_of(sim.core, "node.motion").position - b.start_position
    held = held_components(supports_of(sim.case, t, b.group_names, constant(), b.boundaries))
    lie = places(t, comes, ~out, held, moved)
    if (node := folded(t, lie, comes)) >= 0:
        group = b.group_names[t.block_group[t.node_block[node]]]
        place = ", ".join(f"{x:.4g}" for x in b.start_position[node])
        raise CaseError(
            f"{sim.case.where(f'stages.{sim.stage_index}.add')}: stages.{sim.stage_index}.add: the rock "
            f"around group {group} has moved so far that an element near ({place}) would be turned "
            "inside out; add the group earlier, or give it larger elements"
        )
    b.born = np.where(comes[:, None], lie, b.born)
    sim.reference = np.where(comes[:, None], lie, sim.reference)
    laws = interfaces_of(sim.case, b.group_names)[0]
    bonded = np.array([INTERFACE_LAWS[law.law].bonds(law) for law in laws], np.int8)
    sim.core.bring_in(comes.astype(np.int8), lie, renewed(sim, names), bonded)


def renewed(sim: RunState, names: Iterable[str]) -> dict[str, NDArray]:
    """Arrays of the core once groups have been added free of stress."""
    b = sim.build
    b.compensate_again(names)
    return change(b, places=True)


def change_bolts(sim: RunState, stage: str) -> None:
    """Remove and install the bolts of a stage; bolts of the first stage are already installed."""
    bolts = sim.build.bolts
    leave, come = bolts.flags(stage, "remove"), bolts.flags(stage, "install")
    if leave.any():
        sim.core.remove_bolts(leave)
    if come.any() and sim.stage_index > 0:
        sim.core.install_bolts(come)


def begin_surfaces(sim: RunState, stage: str) -> None:
    """Start surface laws that wait for this stage; laws of the first stage already act."""
    come = np.array([item.stage == stage for _, item in sim.case.surface_entries], np.int8)
    if come.any() and sim.stage_index > 0:
        sim.core.begin_surfaces(come)


def begin_boundaries(sim: RunState) -> None:
    """Let boundaries of this stage begin: their supports end, and the forces of these stay.

    In a static stage the nodes of earlier boundaries are held where they are.
    """
    b = sim.build
    if not sim.case.boundaries:
        return
    before = held_components(
        supports_of(sim.case, b.topology, b.group_names, constant(), b.boundaries)
    )
    b.boundaries.follow(sim.case, sim.stage_index + 1)
    after = held_components(
        supports_of(sim.case, b.topology, b.group_names, constant(), b.boundaries)
    )
    reaction = sim.fields["reaction"]
    b.boundaries.kept += np.where(before & ~after, reaction, 0.0)
    sim.core.update_model(change(b))


def damp_rock(sim: RunState, stage: Stage) -> None:
    """Start the branches and dashpots of a stage, and give the rock its moduli; stresses stay."""
    sim.core.change_rock_damping(*rock_damping_of(stage))
    given = sim.core.fields()["rock.moduli"]
    moduli = float(given[0]) if len(given) else 1.0
    if moduli != sim.build.moduli:  # a search has brought the state back
        sim.build.moduli = moduli
        update_core(sim, sim.stage_index)
    if moduli != (now := branches_of(stage.damping.maxwell).part):
        sim.core.change_moduli(now)


def release_part(sim: RunState, stage: StageState) -> bool:
    """Release the next part of forces of removed groups in a static stage; returns whether there was one."""
    rules = sim.case.stages[sim.stage_index]
    release = _release_of(rules)
    if stage.mode != "static" or release is None or stage.parts >= release.parts:
        return False
    stage.parts += 1
    share = stage.parts / release.parts
    sim.core.release_forces(stage.held + share * (1 - release.to - stage.held), sim.time)
    stage.solved = ""
    stage.watch_anew()
    return True


def solve_is_due(sim: RunState, stage: StageState) -> bool:
    """Whether a stage is to be solved for before its next step.

    Where loads.velocities move supports, it would rest before these have moved anything.
    """
    case = sim.case
    if case.stages[sim.stage_index].relax != "solve" or case.loads.velocities:
        return False
    return not (stage.solved or stage.handed_over or curves_run(sim, stage))


def curves_run(sim: RunState, stage: StageState) -> bool:
    """Whether curves still change a static stage: it has no rest before they are over."""
    return sim.time < sim.begins[stage.name] + last_change(sim.case, stage.name)


def solve(sim: RunState, stage: StageState) -> None:
    """Solve for the rest of a static stage, and say so; see `_solved`."""
    stage.solved = _solved(sim)
    sim.tell(f"{stage.name}: {stage.solved}")


def _solved(sim: RunState) -> str:
    """Move the rock of a static stage to the equilibrium of elements, bonds and contacts in touch.

    Where it does not lie near, as blocks slide or fall on the way, the rock stays as it is.

    Returns:
        What was reached, for the log.
    """
    limit = sim.case.stages[sim.stage_index].tolerance
    assert limit is not None  # the case has filled it in
    state = keep(sim)
    rounds, iterations, before, after = sim.core.solve_for_rest(limit)
    if rounds > 0 and after < LEAST_GAIN * before:
        return (
            f"solved in {rounds} rounds and {iterations} iterations: unbalance ratio {before:.2g}, "
            f"then {after:.2g}"
        )
    bring_back(sim, state)
    if before <= limit:
        return "begins at rest: nothing to solve"
    return "a solve found no rest nearby: adaptive relaxation from the start"


def may_hand_over(sim: RunState, stage: StageState) -> bool:
    """Whether local damping may go on in place of the adaptive relaxation of a stage."""
    rules = sim.case.stages[sim.stage_index]
    if stage.mode != "static" or stage.handed_over or status(sim, stage, "") is not None:
        return False
    return rules.relax is not None and RELAXATIONS[rules.relax] == "adaptive"


def balance_lost(sim: RunState, stage: StageState) -> str:
    """Why a stage is handed over to local damping."""
    return (
        f"after {sim.step_count - stage.start_step:,} steps of adaptive relaxation the energy balance "
        f"is off by {100 * sim.energies['error']:.3g} %, so the stage goes on from there by relax: "
        "local"
    )


def relax_locally(sim: RunState, stage: StageState) -> tuple[str, int, float]:
    """Let local damping go on, from the present positions without motion; returns the core's report.

    The missing energy is booked as damping, so the balance of all that follows starts anew.
    """
    stage.handed_over = True
    stage.watch_anew()
    sim.core.leave_adaptive()
    report = sim.core.run(1, relaxation="kinetic")  # this stops all motion
    damp_locally(sim)
    sim.core.renew_step()
    return report


def damp_locally(sim: RunState) -> None:
    """Give the core the damping of the present stage, which has been handed over."""
    local, *others = damping_of(sim.case.stages[sim.begun - 1])
    sim.core.set_damping(local or LOCAL_DAMPING, *others)


def change_end(sim: RunState, *, longer: bool) -> None:
    """Let the stage of a resumed run end according to the present case.

    Args:
        sim: The simulation, restored.
        longer: Whether to prolong the last stage begun if it has already ended.
    """
    if longer and sim.stage is None and sim.ended_stage is not None:
        sim.stage, sim.ended_stage = sim.ended_stage, None
        sim.stage_index -= 1
        del sim.finished_stages[-1]
    if sim.stage is not None:
        duration = sim.case.stages[sim.stage_index].duration
        sim.stage.end_time = None if duration is None else sim.stage.start_time + duration


def catch_up(sim: RunState) -> None:
    """Apply to the core of a resumed run all earlier settings and additions of stages and scripts."""
    for done in range(sim.begun + 1):
        if done:
            apply_settings(sim, done - 1)
        for setting in sim.settings:
            if setting.begun == done:
                change_value(sim, setting)
    if (last := sim.stage or sim.ended_stage) and last.handed_over:
        damp_locally(sim)
    if sim.case.boundaries:
        sim.build.boundaries.follow(sim.case, sim.begun)
        sim.core.update_model(change(sim.build))
    hand_over(sim.core, sim.build.curves, sim.begins)
    if len(sim.core.array("node.peak")[0]) and sim.stage is not None:
        sim.core.keep_peaks(sim.stage.mode == "dynamic")
    added = {name for stage in sim.case.stages[: sim.begun] for name in stage.add}
    if added:
        sim.core.update_model(renewed(sim, sorted(added)))


def advance(sim: RunState, stage: StageState, steps: int, until: float) -> tuple[str, int, float]:
    """Run towards the stage's next event or a time, at most `steps` steps; returns the core's report."""
    rules = sim.case.stages[sim.stage_index]
    done = sim.step_count - stage.start_step
    if rules.max_steps is not None:
        steps = min(steps, rules.max_steps - done)
    if stage.mode == "static":
        steps = min(steps, STATIC_RECORD_STEPS - done % STATIC_RECORD_STEPS)
        assert (
            rules.tolerance is not None and rules.relax is not None
        )  # the case has filled them in
        if solve_is_due(sim, stage):
            solve(sim, stage)
        over = sim.begins[stage.name] + last_change(sim.case, stage.name)
        changes = curves_run(sim, stage)
        report = sim.core.run(
            steps,
            end_time=min(until, over) if changes else until,
            unbalance_limit=0.0 if changes else rules.tolerance,
            relaxation="none" if stage.handed_over else RELAXATIONS[rules.relax],
        )
        goes_on = report[0] == "converged" and release_part(sim, stage)
        return ("steps_done", *report[1:]) if goes_on else report
    assert stage.end_time is not None
    return sim.core.run(steps, end_time=min(stage.next_row, stage.end_time, until))


def record_is_due(sim: RunState, stage: StageState, outcome: str) -> bool:
    """Whether a history row is due now; counts it."""
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
        stage.frame_due = frames_until(stage, stage.rows) > frames_until(stage, before)
    return due


def frames_until(stage: StageState, rows: int) -> int:
    """Frames of a stage whose times have passed with this many rows."""
    if stage.frame_every in (0, ROWS_PER_FRAME * stage.row_every):
        return rows // ROWS_PER_FRAME
    return int(rows * stage.row_every / stage.frame_every * (1 + ROUNDING))


def look_for_rest(sim: RunState, stage: StageState) -> None:
    """At a history row: check whether the blocks of a stage with `until: rest` rest."""
    if sim.case.stages[sim.stage_index].until == "rest":
        stage.quiet.look(sim.time, sim.motion_of_rest)


def frame_is_due(sim: RunState, stage: StageState, outcome: str) -> bool:
    """Whether the history row just counted comes with a frame of the fields."""
    if status(sim, stage, outcome) is not None:
        return True
    return stage.mode == "dynamic" and stage.frame_due


def status(sim: RunState, stage: StageState, outcome: str) -> str | None:
    """How the stage ended, or None if it continues."""
    rules = sim.case.stages[sim.stage_index]
    if outcome == "converged":
        return "converged"
    if stage.quiet.rests:
        return "at rest"
    if stage.end_time is not None and sim.time >= stage.end_time:
        return "finished"
    if rules.max_steps is not None and sim.step_count - stage.start_step >= rules.max_steps:
        return "max_steps"
    return None
