"""The value of a parameter at which a case fails, by bisection; also the factor of safety."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from cdem.case.case import Case
from cdem.case.checks import SETTABLE
from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS, Law
from cdem.case.softening import reduced_tables
from cdem.case.types import Part
from cdem.errors import CaseError
from cdem.output.render import snapshot
from cdem.run.simulation import Simulation
from cdem.study.criterion import Criterion
from cdem.study.verdict import Seen, Verdict, rests

if TYPE_CHECKING:
    from cdem.output.reader import Surface

Apply = Callable[[Case, float], None]


@dataclass
class Trial:
    """One trial.

    Attributes:
        value: Value of the parameter.
        stable: Whether the case came to rest.
        saw: Its behaviour, see `Verdict`.
        why: The behaviour with figures.
        steps: Number of steps.
        moved: Displacement of its farthest node since the first trial began, or since the start of
            its
            own last stage if each trial builds its model [m].
    """

    value: float
    stable: bool
    saw: Seen
    why: str
    steps: int
    moved: float


@dataclass
class Critical:
    """The result of a search.

    Attributes:
        stable: The last value at which the case rests.
        failed: The nearest value at which it fails.
        criterion: Criterion of failure.
        trials: All values tried, in order.
        body: The model at the end of the trial at `failed`.
    """

    stable: float
    failed: float
    criterion: Criterion
    trials: list[Trial] = field(default_factory=list)
    body: Surface | None = field(default=None, compare=False)

    @property
    def value(self) -> float:
        """The middle of the bracket."""
        return 0.5 * (self.stable + self.failed)

    def as_dict(self) -> dict[str, Any]:
        """All results, ready for JSON."""
        return {
            "value": self.value,
            "stable": self.stable,
            "failed": self.failed,
            "criterion": self.criterion.model_dump(),
            "trials": [vars(t) for t in self.trials],
        }


WIDER = 1.5
"""Ratio of successive factors before there is a bracket."""
WIDEST = 100.0
"""A factor beyond this, or below its inverse, ends the search for a bracket."""

Report = Callable[["Critical"], None]
"""Receives the search so far: its last trial is the newest, its bracket is nan at first."""
Tell = Callable[[list[str]], None]
"""Receives the warnings of a model."""


@dataclass(frozen=True)
class _OneValue:
    """Put one value into a case."""

    path: str

    @property
    def makes_a_model(self) -> bool:
        """Whether another value makes another model, which cannot use states of earlier trials."""
        return not self.path.startswith(SETTABLE)

    def __call__(self, case: Case, value: float) -> None:
        case.set(self.path, value)


def parameter(path: str) -> Apply:
    """Vary one value of the case, e.g. ``interfaces.bed.friction_angle`` (plain units)."""
    return _OneValue(path)


def strength_reduction() -> Apply:
    """Divide all strengths of interfaces and materials by the varied factor (tangents of angles).

    Each law declares its strengths. Their values are taken from the last stage, including its own
    settings.
    """
    whole: dict[str, tuple[Law, Part]] = {}

    def apply(case: Case, factor: float) -> None:
        if factor <= 0:
            raise CaseError(f"a factor of safety must be above 0, got {factor:g}")
        if not whole:  # the first trial: full strengths
            whole.update(_parts_with_strengths(case))
        for path, (law, part) in whole.items():
            reduced = law.reduced(part, factor) | reduced_tables(part, factor)
            for name, strength in reduced.items():
                case.set(f"{path}.{name}", strength)

    return apply


def _parts_with_strengths(case: Case) -> Iterator[tuple[str, tuple[Law, Part]]]:
    """Path in the case, law and a copy of every interface and material."""
    interfaces = {"default": case.interfaces.default} | {
        f"pairs.{i}": pair for i, pair in enumerate(case.interfaces.pairs)
    }
    for place, interface in interfaces.items():
        if interface is not None:
            yield f"interfaces.{place}", (INTERFACE_LAWS[interface.law], interface.model_copy())
    for name, material in case.materials.items():
        yield f"materials.{name}", (BLOCK_LAWS[material.law], material.model_copy())


def check_last_stage(case: Case) -> None:
    """Refuse a case whose last stage is not static: this stage decides on rest."""
    if case.stages[-1].mode != "static":
        where = case.where(f"stages.{len(case.stages) - 1}.mode")
        raise CaseError(
            f"{where}: the last stage must be static: it decides whether the case comes to rest"
        )


def find_critical(
    case: Case,
    apply: Apply,
    between: tuple[float, float] | None,
    *,
    tolerance: float,
    criterion: Criterion | None = None,
    threads: int | None = None,
    report: Report | None = None,
    tell: Tell | None = None,
) -> Critical:
    """Bisect between a value at which a case rests and one at which it fails.

    All stages except the last prepare the case with its own values. Each trial sets the value and
    runs
    the last stage, which must be static, from the state of the last stable trial. It is stable when
    the unbalance ratio falls below the stage's tolerance, and has failed according to `criterion`.

    If each value of a `parameter` makes another model (its geometry, its rock), each trial builds
    the model and runs all stages; every static stage must then come to rest.

    Args:
        case: Is changed: it ends with the last trial's value.
        apply: Puts a value into the case; see `parameter` and `strength_reduction`.
        between: Two values, one stable and one not, in either order. None, for a factor: 1 and its
            multiples by 1.5, up or down, until both are found.
        tolerance: Width of the bracket at which the search ends.
        criterion: Criterion of failure; default `Criterion()`.
        threads: Threads of the core; None for all.
        report: Called after every trial.
        tell: Called once with the warnings of the model.

    Raises:
        CaseError: The last stage is not static, or both ends rest or fail.
    """
    check_last_stage(case)
    if not tolerance > 0:
        raise CaseError(f"tolerance {tolerance}: must be above zero")
    criterion = criterion or Criterion()
    cold = isinstance(apply, _OneValue) and apply.makes_a_model
    search = (_Cold if cold else _Warm)(case, apply, criterion, threads, tell or (lambda _: None))
    found = Critical(np.nan, np.nan, criterion)
    step = partial(_attempt, search, found, report)
    if between:
        _try_ends(between, step)
    else:
        _widen(step)
    search.begin_bisection()
    while abs(found.stable - found.failed) > tolerance:
        step(found.value)
    return found


def _attempt(search: _Warm | _Cold, found: Critical, report: Report | None, value: float) -> Trial:
    """Try a value and put it into the bracket."""
    trial = search.attempt(value)
    found.trials.append(trial)
    if trial.stable:
        found.stable = value
    else:
        found.failed, found.body = value, snapshot(search.sim)
    if report:
        report(found)
    return trial


def _try_ends(between: tuple[float, float], step: Callable[[float], Trial]) -> None:
    first, last = (step(float(value)) for value in between)
    if first.stable == last.stable:
        both = "come to rest" if first.stable else "fail"
        raise CaseError(
            f"both {between[0]:g} and {between[1]:g} {both} ({last.why}); give a wider range"
        )


def _widen(step: Callable[[float], Trial]) -> None:
    """Try 1, then its multiples by 1.5 in one direction, until one rests and one fails."""
    value, stable = 1.0, step(1.0).stable
    while step(value := value * WIDER if stable else value / WIDER).stable == stable:
        if not 1 / WIDEST < value < WIDEST:
            all_of = "come to rest" if stable else "fail"
            raise CaseError(
                f"all factors from 1 to {value:.3g} {all_of}: check that the model can slide"
            )


class _Warm:
    """Trials of one model, each from the state of the last stable trial."""

    def __init__(
        self,
        case: Case,
        apply: Apply,
        criterion: Criterion,
        threads: int | None,
        tell: Tell,
    ) -> None:
        self.apply, self.criterion = apply, criterion
        self.sim = Simulation(case, threads=threads)
        tell(self.sim.audit.warnings)
        while self.sim.stage_index < len(case.stages) - 1:
            self.sim.run_stage(case.stages[self.sim.stage_index].name)
        self.start = self.at_rest = _keep(self.sim)
        self.from_where = self.sim.fields["position"].copy()
        self.bisecting = False

    def begin_bisection(self) -> None:
        """Let further trials start from rest instead of the prepared state."""
        self.bisecting = True

    def attempt(self, value: float) -> Trial:
        sim = self.sim
        _bring_back(sim, self.at_rest if self.bisecting else self.start)
        before = sim.step_count
        prepare = partial(self.apply, sim.case, value)
        verdict = rests(sim, prepare, self.criterion, start=self.from_where)
        if verdict.stable:
            self.at_rest = _keep(sim)
        return _trial(value, verdict, sim.step_count - before)


class _Cold:
    """Trials that each build their own model."""

    def __init__(
        self,
        case: Case,
        apply: Apply,
        criterion: Criterion,
        threads: int | None,
        tell: Tell,
    ) -> None:
        self.case, self.apply, self.criterion, self.threads = case, apply, criterion, threads
        self.tell: Tell | None = tell

    def begin_bisection(self) -> None:
        """No state is carried over."""

    def attempt(self, value: float) -> Trial:
        case = self.case.model_copy(deep=True)
        self.apply(case, value)
        sim = self.sim = Simulation(case, threads=self.threads)
        if self.tell:  # warnings of the first trial only; others differ by one value
            self.tell(sim.audit.warnings)
            self.tell = None
        verdict = Verdict(True, "at rest", "")
        for index, stage in enumerate(case.stages):
            if stage.mode == "static":
                verdict = rests(sim, None, self.criterion, index)
                sim.stage_index, sim.stage = index + 1, None
            else:
                sim.run_stage(stage.name)
            if not verdict.stable:
                if index < len(case.stages) - 1:
                    verdict.why = f"stage {stage.name}: {verdict.why}"
                break
        return _trial(value, verdict, sim.step_count)


def _trial(value: float, verdict: Verdict, steps: int) -> Trial:
    return Trial(value, verdict.stable, verdict.saw, verdict.why, steps, verdict.moved)


@dataclass
class _State:
    arrays: dict[str, np.ndarray]
    scalars: dict[str, Any]


def _keep(sim: Simulation) -> _State:
    return _State({k: v.copy() for k, v in sim.core.fields().items()}, sim.core.scalars())


def _bring_back(sim: Simulation, state: _State) -> None:
    sim.core.restore(state.arrays, state.scalars)
    sim.core.prepare()
