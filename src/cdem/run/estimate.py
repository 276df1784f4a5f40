"""Estimate of a case's run time and memory, measured by steps of the model itself."""

from __future__ import annotations

import resource
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cdem.case.laws import INTERFACE_LAWS
from cdem.model.interfaces import interfaces_of
from cdem.model.stiffness import interface_entries
from cdem.run import stages
from cdem.run.stage_state import StageState
from cdem.run.state import RunState

SECONDS = 0.2
"""Wall time given to each measurement [s]."""
LEAST_STEPS = 40
"""Least number of steps of a measurement, to include a rebuild of the pair lists."""
LISTS = 0.1
"""Of the time: if pair lists and search take less than this, fewer steps are enough."""
PIECE = (5, 0.02)
"""Between two looks at the clock: this many steps, or as many as take this long [s]."""
BALANCED = 1e-3
"""Rock with initial stress is in equilibrium if its unbalanced force is below this."""
WHOLE = 2.0
"""Time of a solve over the time until its first iteration has ended: 1.7 with 6,000 tets, 2.1 with
94,000."""
REPORT = (10_000_000, 21.0, 350_000_000)
"""Measured memory for writing report.html [bytes]: minimum, per node and frame, and maximum."""


@dataclass
class StageEstimate:
    """Cost of one stage.

    Attributes:
        name: Its name.
        mode: "static" or "dynamic".
        step_seconds: Wall time of a step at the beginning of the stage [s].
        wall_time: Wall time of the stage if bonds break only at the initial rate [s]; None for
            a static stage, whose number of steps is unknown in advance.
        wall_time_broken: The same with all bonds broken; None for a model without bonds.
        solve_seconds: Wall time of the solve before the first step [s]; 0 where there is none.
    """

    name: str
    mode: str
    step_seconds: float
    wall_time: float | None
    wall_time_broken: float | None
    solve_seconds: float = 0.0

    @property
    def expected(self) -> float | None:
        """Geometric mean of the two [s]."""
        if self.wall_time is None or self.wall_time_broken is None:
            return self.wall_time
        return float(np.sqrt(self.wall_time * self.wall_time_broken))


@dataclass
class Estimate:
    """Cost of a case.

    Attributes:
        stages: In their order.
        peak_memory: Largest memory of a run, from building the model, from its contacts with all
            bonds broken, or from drawing the report [bytes].
        unbalance: Unbalanced force of the first step over the loads, for rock with initial
            stress.
    """

    stages: list[StageEstimate]
    peak_memory: int
    unbalance: float | None = None

    @property
    def wall_time(self) -> float | None:
        """Expected wall time of the dynamic stages [s]; None when there are none."""
        times = [stage.expected for stage in self.stages if stage.expected is not None]
        return sum(times) if times else None

    def as_dict(self) -> dict[str, Any]:
        """Ready for JSON."""
        return {
            "wall_time_estimate": self.wall_time,
            "peak_memory_bytes": self.peak_memory,
            "start_unbalance": self.unbalance,
            "stage_estimates": [asdict(s) | {"expected": s.expected} for s in self.stages],
        }

    def text(self) -> str:
        """Lines for the report."""
        lines = [f"  peak memory {self.peak_memory / 1e6:,.0f} MB, report.html included"]
        if self.unbalance is not None:
            lines.append(f"  unbalanced force at the start {self.unbalance:.2g} of the loads")
            if self.unbalance > BALANCED:
                lines.append(
                    "    the initial stress is not in equilibrium with gravity and supports: begin with "
                    "a static stage, and check initial_stress (sign, gradient, surface) if it "
                    "moves much"
                )
        for s in self.stages:
            solve = f"a solve of {_clock(s.solve_seconds)}, then " if s.solve_seconds else ""
            step = f"  stage {s.name}: {solve}{1e3 * s.step_seconds:.3g} ms a step"
            if s.wall_time is None:
                lines.append(f"{step}; the number of steps until rest is unknown")
            elif s.wall_time_broken is None:
                lines.append(f"{step}, about {_clock(s.wall_time)}")
            else:
                low, high = sorted((s.wall_time, s.wall_time_broken))
                lines.append(
                    f"{step}, about {_clock(s.expected or 0)} ({_clock(low)} to {_clock(high)}, "
                    "depending on broken bonds)"
                )
        return "\n".join(lines) + "\n"


def estimate(sim: RunState) -> Estimate:
    """Measure every stage by some of its steps; the simulation cannot be used afterwards.

    A stage that ends within these steps is followed by the next, as in a run.

    Args:
        sim: A simulation before its first step.

    Raises:
        CaseError: An error that would end a run within these steps.
    """
    found, unbalance = [], None
    for index, stage in enumerate(sim.case.stages):
        sim.stage_index = index
        begun = stages.begin(sim)
        if index == 0 and sim.build.initial is not None:
            sim.core.run(1)
            unbalance = float(sim.core.unbalance_ratio())
        solve = _solve(sim, begun)
        step, length = _measure(sim, partial(_follow, sim, begun))
        wall = broken = None
        if stage.duration is not None:
            wall = stage.duration / length * step
            if index == len(sim.case.stages) - 1 and _bonded(sim):
                _take_strength(sim)
                sim.core.move_exact_masses()
                step_broken, length = _measure(sim, partial(_go_on, sim))
                broken = stage.duration / length * step_broken
        found.append(StageEstimate(stage.name, stage.mode, step, wall, broken, solve))
    return Estimate(found, peak_memory(sim), unbalance)


def _bonded(sim: RunState) -> bool:
    counts = sim.build.assembly.counts
    return any(counts[f"{kind}.count"] for kind in ("triangles", "quads", "overlaps"))


def _take_strength(sim: RunState) -> None:
    """Remove the bonds from all interfaces; the case stays unchanged."""
    names, position = sim.build.group_names, sim.build.start_position
    entries = interface_entries(sim.case, interfaces_of(sim.case, names)[0], names, position)
    for entry in entries:
        bonds = [p.name for p in INTERFACE_LAWS[entry["law"]].parameters if p.bonds]
        entry["parameters"] |= dict.fromkeys(bonds, 0.0)
    sim.core.set_interfaces(entries)


def _solve(sim: RunState, stage: StageState) -> float:
    """Wall time of the solve for the rest of a stage, if a run has one [s], or 0.

    Later stages begin where it ends; of that of the last stage the first iteration is enough.
    """
    if not stages.solve_is_due(sim, stage):
        return 0.0
    begin = time.perf_counter()
    if sim.stage_index < len(sim.case.stages) - 1:
        stages.solve(sim, stage)
        return time.perf_counter() - begin
    limit = sim.case.stages[-1].tolerance
    assert limit is not None  # the case has filled it in
    stage.solved = "measured"
    sim.core.solve_for_rest(limit, 1)
    return WHOLE * (time.perf_counter() - begin)


def _follow(sim: RunState, stage: StageState, steps: int) -> bool:
    """Run a stage as a run does, for at most this many steps; returns whether it continues."""
    outcome = stages.advance(sim, stage, steps, np.inf)[0]
    stages.record_is_due(sim, stage, outcome)  # a run steps without a break up to these rows
    ended = stages.status(sim, stage, outcome) is not None
    return outcome in ("steps_done", "time_reached") and not ended


def _go_on(sim: RunState, steps: int) -> bool:
    """Step on, and ignore the end of a stage."""
    return bool(sim.core.run(steps)[0] == "steps_done")


def _measure(sim: RunState, run: Callable[[int], bool]) -> tuple[float, float]:
    """Wall time and simulated time of a step [s]: measured in the second half of `SECONDS`.

    Args:
        sim: The simulation.
        run: Does at most the given number of steps; returns whether more are left.
    """
    begin = (time.perf_counter(), sim.step_count, sim.time)
    marks, steps = [begin], PIECE[0]
    phases = np.array(sim.core.seconds())

    def is_enough() -> bool:
        wall, done, _ = np.subtract(marks[-1], begin)
        spent = sim.core.seconds() - phases
        return wall >= SECONDS and (done >= LEAST_STEPS or spent[:2].sum() < LISTS * spent.sum())

    while not is_enough():
        try:
            goes_on = run(steps)
        except RuntimeError:  # the core has no room left for contacts
            break
        marks.append((time.perf_counter(), sim.step_count, sim.time))
        if not goes_on:
            break
        wall, done, _ = np.subtract(marks[-1], marks[-2])
        steps = max(PIECE[0], int(PIECE[1] * done / max(wall, 1e-9)))
    wall, done, passed = np.subtract(marks[-1], marks[(len(marks) - 1) // 2])
    if done == 0:
        return 0.0, float(sim.core.scalars()["dt"])
    return wall / done, passed / done


def peak_memory(sim: RunState) -> int:
    """Largest memory of a run [bytes].

    The larger of this process's peak so far, and its present memory plus the report's.
    """
    try:  # getrusage would include memory of the parent process
        lines = [line.split() for line in Path("/proc/self/status").read_text().splitlines()]
        kilobytes = {words[0]: int(words[1]) for words in lines if words[-1] == "kB"}
        most, now = 1024 * kilobytes["VmHWM:"], 1024 * kilobytes["VmRSS:"]
    except OSError:  # not Linux
        most = now = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # bytes on macOS
    return max(most, now + _report_memory(sim))


def _report_memory(sim: RunState) -> int:
    """Memory for writing report.html [bytes], if every node is visible in every frame."""
    least, each, at_most = REPORT
    output = sim.case.output
    if not output.frames:
        return int(least)
    lengths = [stage.duration or 0.0 for stage in sim.case.stages]
    frames = sum(
        2 + (length / output.every if output.every else stages.FRAMES) for length in lengths
    )
    return int(least + min(each * len(sim.reference) * frames, at_most))


def _clock(seconds: float) -> str:
    if seconds < 90:
        return f"{seconds:.2g} s"
    return f"{seconds / 60:.2g} min" if seconds < 5400 else f"{seconds / 3600:.2g} h"
