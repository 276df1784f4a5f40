"""The value of a parameter at which a case fails, by bisection; also the factor of safety."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cdem import stages
from cdem.case import Case
from cdem.case_checks import SETTABLE
from cdem.errors import CaseError, UnstableError
from cdem.simulation import CHECK_INTERVAL, Simulation

TRAVEL = 0.02
"""A trial has failed when a node has moved this part of the mean face size, ever faster."""
FAR = 1.0
"""A trial has failed when a node has moved this part of the mean face size, in any way."""
STALL_STEPS = 10_000
"""A trial has failed when its unbalance ratio came no lower in as many steps, in which nodes moved
farther than in all steps before."""
MOST_STEPS = 1_000_000
"""A trial that has not come to rest in so many steps counts as failed."""

Apply = Callable[[Case, float], None]


@dataclass
class Trial:
    """One value tried.

    Attributes:
        value: Of the parameter.
        stable: Whether the case came to rest.
        why: The verdict in words.
        steps: Steps that it took.
    """

    value: float
    stable: bool
    why: str
    steps: int


@dataclass
class Critical:
    """What a search found.

    Attributes:
        stable: The last value at which the case rests.
        failed: The nearest value at which it fails.
        trials: All values tried, in order.
    """

    stable: float
    failed: float
    trials: list[Trial] = field(default_factory=list)

    @property
    def value(self) -> float:
        """The middle of the bracket."""
        return 0.5 * (self.stable + self.failed)

    def as_dict(self) -> dict[str, Any]:
        """Everything, ready for JSON."""
        return {
            "value": self.value,
            "stable": self.stable,
            "failed": self.failed,
            "trials": [vars(t) for t in self.trials],
        }


def parameter(path: str) -> Apply:
    """Vary one value of the case, e.g. ``interfaces.bed.friction_angle`` (plain units).

    Raises:
        CaseError: A stage cannot change that value.
    """
    if not path.startswith(SETTABLE):
        allowed = ", ".join(f"{start}*" for start in SETTABLE)
        raise CaseError(
            f"{path}: only {allowed} can be varied; another mesh or rock is another case"
        )
    return lambda case, value: case.set(path, value)


def strength_reduction(case: Case) -> Apply:
    """Divide cohesion, tensile strength and tan(phi) of all interfaces by the varied factor."""
    laws = [law for law in (case.interfaces.default, *case.interfaces.pairs) if law is not None]
    strength = [(law.cohesion, law.tensile_strength, law.friction_angle) for law in laws]
    places = ["default"] * (case.interfaces.default is not None)
    places += [f"pairs.{i}" for i in range(len(case.interfaces.pairs))]

    def apply(case: Case, factor: float) -> None:
        for place, (cohesion, tension, angle) in zip(places, strength, strict=True):
            path = f"interfaces.{place}"
            case.set(f"{path}.cohesion", cohesion / factor)
            case.set(f"{path}.tensile_strength", tension / factor)
            less = np.degrees(np.arctan(np.tan(np.radians(angle)) / factor))
            case.set(f"{path}.friction_angle", float(less))

    return apply


def find_critical(
    case: Case,
    apply: Apply,
    between: tuple[float, float],
    *,
    tolerance: float,
    threads: int | None = None,
    report: Callable[[Trial, float, float], None] | None = None,
) -> Critical:
    """Bisect between a value at which a case rests and one at which it fails.

    All stages but the last prepare the case with its own values. Each trial sets the value and runs
    the last stage, which must be static, from the state of the last stable trial. It is stable when
    the unbalance ratio falls below the stage's tolerance. It has failed when a node has moved by
    `TRAVEL` of the mean face size while the kinetic energy grew, or by `FAR` in any way, or goes on
    moving while the unbalance ratio stalls (`STALL_STEPS`), or when there is no rest in `MOST_STEPS`
    steps (or the stage's ``max_steps``).

    Args:
        case: Is changed: it ends with the last value tried.
        apply: Puts a value into the case; see `parameter` and `strength_reduction`.
        between: Two values, one stable and one not, in either order.
        tolerance: Width of the bracket at which the search ends.
        threads: Threads of the core; None for all.
        report: Called after every trial with the trial and the bracket (stable, failed) so far.

    Raises:
        CaseError: The last stage is not static, or both ends rest or fail.
    """
    last = case.stages[-1]
    if last.mode != "static":
        where = case.where(f"stages.{len(case.stages) - 1}.mode")
        raise CaseError(f"{where}: the last stage must be static: it decides what comes to rest")
    if not tolerance > 0:
        raise CaseError(f"tolerance {tolerance}: must be above zero")
    sim = Simulation(case, threads=threads)
    while sim.stage_index < len(case.stages) - 1:
        sim.run_stage(case.stages[sim.stage_index].name)
    state = _keep(sim)
    trials: list[Trial] = []

    def attempt(value: float) -> Trial:
        _bring_back(sim, state)
        trial = _try(sim, apply, value)
        trials.append(trial)
        return trial

    ends = []
    for value in between:
        ends.append(attempt(value))
        if ends[-1].stable:
            at_rest = _keep(sim)
        if report:
            report(ends[-1], *between)
    if ends[0].stable == ends[1].stable:
        what = "come to rest" if ends[0].stable else "fail"
        raise CaseError(
            f"both {between[0]:g} and {between[1]:g} {what} ({ends[1].why}); give a wider range"
        )
    stable, failed = between if ends[0].stable else between[::-1]
    state = at_rest
    while abs(stable - failed) > tolerance:
        trial = attempt(0.5 * (stable + failed))
        if trial.stable:
            stable, state = trial.value, _keep(sim)
        else:
            failed = trial.value
        if report:
            report(trial, stable, failed)
    return Critical(stable, failed, trials)


def _try(sim: Simulation, apply: Apply, value: float) -> Trial:
    """Run the last stage at one value from the state that the simulation is in."""
    start = sim.step_count
    stable, why = rests(sim, lambda: apply(sim.case, value))
    return Trial(value, stable, why, sim.step_count - start)


def rests(sim: Simulation, prepare: Callable[[], None] | None = None) -> tuple[bool, str]:
    """Run the last, static stage; return whether it comes to rest, and why or why not.

    The rules are those of `find_critical`. `prepare` may change the case as the stage begins.
    """
    sim.stage_index = len(sim.case.stages) - 1
    stage = stages.begin(sim)
    if prepare:
        prepare()
        stages.update_core(sim, sim.stage_index)
        sim.core.renew_step()
    size = float(sim.build.assembly.arrays["face.length"][: sim.audit.counts["faces"]].mean())
    start = sim.fields["position"].copy()
    most = sim.case.stages[-1].max_steps or MOST_STEPS
    half_way = 0.0  # kinetic energy when half of TRAVEL was reached
    least, least_step, least_moved = np.inf, 0, 0.0  # unbalance ratio
    while True:
        try:
            outcome = sim.advance(stage, 10 * CHECK_INTERVAL)
        except UnstableError as error:
            return False, str(error)
        done, unbalance = sim.step_count - stage.start_step, sim.core.unbalance_ratio()
        if outcome == "converged":
            return True, f"rests, unbalance ratio {unbalance:.2g}"
        moved = float(np.linalg.norm(sim.fields["position"] - start, axis=1).max()) / size
        kinetic = float(sim.energies["kinetic"])
        if moved < 0.5 * TRAVEL:
            half_way = kinetic
        elif moved > FAR or (moved > TRAVEL and kinetic > half_way):
            return False, f"has moved {moved * size:.3g} m, kinetic energy {kinetic:.3g} J"
        if unbalance < 0.95 * least:
            least, least_step, least_moved = unbalance, done, moved
        elif done - least_step >= STALL_STEPS and moved > 2 * least_moved:
            return False, f"goes on moving, {moved * size:.3g} m, ratio stays at {unbalance:.2g}"
        if done >= most:
            return False, f"no rest in {done:,} steps, ratio {unbalance:.2g}"


@dataclass
class _State:
    arrays: dict[str, np.ndarray]
    scalars: dict[str, Any]


def _keep(sim: Simulation) -> _State:
    return _State({k: v.copy() for k, v in sim.core.fields().items()}, sim.core.scalars())


def _bring_back(sim: Simulation, state: _State) -> None:
    sim.core.restore(state.arrays, state.scalars)
    sim.core.prepare()
