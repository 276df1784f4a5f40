"""The value of a parameter at which a case fails, by bisection; also the factor of safety."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from cdem.case.case import Case
from cdem.case.checks import SETTABLE
from cdem.errors import CaseError
from cdem.output.render import snapshot
from cdem.run import stages
from cdem.run.behaviour import LEAST_STEPS, UNKNOWN, face_size, patience
from cdem.run.kept import bring_back, keep
from cdem.run.moving import Body, lost_cohesion
from cdem.run.simulation import Simulation
from cdem.run.stage_state import StageState
from cdem.study.criterion import Criterion
from cdem.study.strengths import HELD, StrengthReduction, keep_strengths
from cdem.study.verdict import Seen, Verdict, rests, stage_rests

if TYPE_CHECKING:
    from cdem.model.audit import Audit
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
            its own last stage if each trial builds its model [m].
        bodies: Bodies that move where it fails, the largest first.
        chips: Bodies too small to count, which moved and were taken out.
        sure: Whether it was watched as long as the criterion asks, see `Verdict`.
    """

    value: float
    stable: bool
    saw: Seen
    why: str
    steps: int
    moved: float
    bodies: list[Body] = field(default_factory=list)
    chips: list[Body] = field(default_factory=list)
    sure: bool = True

    def as_dict(self) -> dict[str, Any]:
        """All values, ready for JSON."""
        bodies = {name: [b.as_dict() for b in getattr(self, name)] for name in ("bodies", "chips")}
        return vars(self) | bodies


@dataclass
class Critical:
    """The result of a search.

    Attributes:
        stable: The last value at which the case rests.
        failed: The nearest value at which it fails.
        criterion: Criterion of failure.
        trials: All values tried, in order.
        body: The model at the end of the trial at `failed`.
        broken: Broken part of the bonded area of each interface at rest at `stable` [1], by name.
        audit: The report on the model.
        slip: Movement of the farthest node after which the case rests at `stable`, where it is more
            than half of the criterion's `travel`; else 0 [m].
    """

    stable: float
    failed: float
    criterion: Criterion
    trials: list[Trial] = field(default_factory=list)
    body: Surface | None = field(default=None, compare=False)
    broken: dict[str, float] = field(default_factory=dict)
    audit: Audit | None = field(default=None, compare=False)
    slip: float = 0.0

    @property
    def trial_that_failed(self) -> Trial:
        """The trial at `failed`."""
        return next(t for t in reversed(self.trials) if t.value == self.failed)

    @property
    def value(self) -> float:
        """The middle of the bracket."""
        return 0.5 * (self.stable + self.failed)

    def caution(self) -> str:
        """A sentence where the case rests only after a slip; else empty."""
        if not self.slip:
            return ""
        return (
            f"at {self.stable:.6g} it rests only after a slip of {self.slip:.2g} m: supports have "
            "stretched, joints have closed, or blocks have caught on edges that they slid past, which "
            "makes the factor too high; --travel LENGTH counts more slip than that as failure"
        )

    def nearest_failure(self) -> float:
        """The value next to `stable` whose last trial failed, or nan."""
        last = {t.value: t.stable for t in self.trials}
        failed = [value for value, stable in last.items() if not stable]
        return min(failed, key=lambda value: abs(value - self.stable), default=np.nan)

    def as_dict(self) -> dict[str, Any]:
        """All results, ready for JSON."""
        return {
            "value": self.value,
            "stable": self.stable,
            "failed": self.failed,
            "criterion": self.criterion.model_dump(),
            "broken": self.broken,
            "slip": self.slip,
            "trials": [t.as_dict() for t in self.trials],
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


def strength_reduction(keep: bool = False) -> StrengthReduction:
    """Divide all strengths by the varied factor, see `StrengthReduction`."""
    return StrengthReduction(keep)


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
    first: tuple[float, float] = (1.0, WIDER),
) -> Critical:
    """Bisect between a value at which a case rests and one at which it fails.

    All stages except the last prepare the case with its own values. Each trial sets the value and
    runs the last stage, which must be static, from the state of the last stable trial. It is stable
    when the unbalance ratio falls below the stage's tolerance, and has failed according to
    `criterion`. Without bolts and water a trial ends as soon as a body slides; only the failure next
    to the critical value is watched until it has moved by `travel`, and where it comes to rest after
    all, the search goes on.

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
        first: Without `between`: the first value, and the one that follows it if it rests.

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
    hasty = not (case.bolts or case.water)  # bolts tighten, and joints that water opens close again
    if between:
        _try_ends(between, partial(step, hasty=False))
    else:
        _widen(partial(step, hasty=hasty), *first)
    search.begin_bisection()
    _narrow(found, step, tolerance, hasty)
    found.broken, found.audit = search.broken_at_rest(), search.sim.audit
    moved = next(t.moved for t in reversed(found.trials) if t.value == found.stable)
    found.slip = moved if moved > 0.5 * criterion.travel * face_size(search.sim) else 0.0
    return found


def _attempt(
    search: _Warm | _Cold, found: Critical, report: Report | None, value: float, *, hasty: bool
) -> Trial:
    """Try a value and put it into the bracket."""
    trial = search.attempt(value, hasty=hasty)
    found.trials.append(trial)
    if trial.stable:
        found.stable = value
        found.failed = found.nearest_failure()
    else:
        found.failed, found.body = value, snapshot(search.sim)
    if report:
        report(found)
    return trial


def _narrow(found: Critical, step: Callable[..., Trial], tolerance: float, hasty: bool) -> None:
    """Bisect until the bracket is narrow and its failure is sure."""
    while True:
        while abs(found.stable - found.failed) > tolerance:
            step(found.value, hasty=hasty)
        if found.trial_that_failed.sure:
            return
        hasty = not step(found.failed, hasty=False).stable  # if it rests, so may others
        if np.isnan(found.failed):
            _widen(partial(step, hasty=False), found.stable * WIDER, found.stable * WIDER**2)


def _try_ends(between: tuple[float, float], step: Callable[[float], Trial]) -> None:
    first, last = (step(float(value)) for value in between)
    if first.stable == last.stable:
        both = "come to rest" if first.stable else "fail"
        raise CaseError(
            f"both {between[0]:g} and {between[1]:g} {both} ({last.why}); give a wider range"
        )


def _widen(step: Callable[[float], Trial], first: float, above: float) -> None:
    """Try a value, then others in one direction, until one rests and one fails."""
    value, stable = first, step(first).stable
    following = above if stable else first / WIDER
    while step(following).stable == stable:
        value, following = following, following * WIDER if stable else following / WIDER
        if not 1 / WIDEST < value < WIDEST:
            all_of = "come to rest" if stable else "fail"
            raise CaseError(
                f"all factors from {first:.3g} to {value:.3g} {all_of}: check that the model can slide"
            )


@dataclass
class FactorOfSafety:
    """Factors of safety of a case.

    Attributes:
        kept: With shear strengths kept as joints slip, as in limit equilibrium.
        written: With the laws as written, where some lose strength; else None.
        may_lose: Interfaces and materials that may lose strength as written.
    """

    kept: Critical
    written: Critical | None
    may_lose: list[str]

    def as_dict(self) -> dict[str, Any]:
        """All results, ready for JSON; those with strengths kept at the top."""
        written = None if self.written is None else self.written.as_dict()
        more = {"strengths": "kept", "may_lose": self.may_lose, "as_written": written}
        return {"parameter": "factor"} | self.kept.as_dict() | more


def find_factor(
    case: Case,
    between: tuple[float, float] | None = None,
    *,
    tolerance: float = 0.01,
    criterion: Criterion | None = None,
    threads: int | None = None,
    report: Callable[[str, Critical], None] | None = None,
    tell: Tell | None = None,
) -> FactorOfSafety:
    """Factor of safety with strengths kept, and with the laws as written if these lose strength.

    Args:
        case: The case; its last stage must be static.
        between, tolerance, criterion, threads, tell: As in `find_critical`; `between` is for the
            strengths kept.
        report: Called after every trial with "strengths kept" or "as written", and the search.
    """

    def told(kind: str) -> Report | None:
        return None if report is None else partial(report, kind)

    same = partial(find_critical, tolerance=tolerance, criterion=criterion, threads=threads)
    kept_case, may_lose = keep_strengths(case)
    kept = same(
        kept_case, strength_reduction(keep=True), between, report=told("strengths kept"), tell=tell
    )
    if not may_lose:
        return FactorOfSafety(kept, None, may_lose)
    written = same(
        case.model_copy(deep=True), strength_reduction(), None, report=told("as written"),
        first=(kept.stable, kept.failed),
    )  # fmt: skip
    return FactorOfSafety(kept, written, may_lose)


class _Warm:
    """Trials of one model, each from the state of the last stable trial.

    All stages but the last prepare the model. Where strengths vary, the last stage then begins once,
    with strengths a hundred times as high (`HELD`), and rests: trials only lower strengths.
    """

    def __init__(
        self,
        case: Case,
        apply: Apply,
        criterion: Criterion,
        threads: int | None,
        tell: Tell,
    ) -> None:
        self.apply, self.criterion, self.tell = apply, criterion, tell
        self.sim = Simulation(case, threads=threads)
        criterion.check(self.sim)
        tell(self.sim.audit.warnings)
        while self.sim.stage_index < len(case.stages) - 1:
            self.sim.run_stage(case.stages[self.sim.stage_index].name)
        self.wait: int | None = criterion.stall_steps
        self.held: StageState | None = None
        if isinstance(apply, StrengthReduction):
            self.held = self._hold()
        self.start = self.at_rest = keep(self.sim)
        self.from_where = self.sim.fields["position"].copy()
        self.bisecting, self.wait_at_rest = False, self.wait

    def _hold(self) -> StageState:
        """Begin the last stage with strengths that hold everything, and find its rest.

        The period of trials is that of the rest: what is loose has fallen by then.

        Raises:
            CaseError: It does not rest: something falls or topples whatever the strengths.
        """
        sim = self.sim
        stage = self._begin(1.0)  # takes the strengths as given
        self._give(HELD)
        before = sim.step_count
        stages.solve(sim, stage)
        held = self.criterion.model_copy(update={"most_moved": None})  # it counts from now on
        verdict = rests(sim, stage, held, self.wait or UNKNOWN)
        if not verdict.stable:
            bodies = "".join(f"; {body.text()}" for body in verdict.bodies[:1])
            raise CaseError(
                f"the model does not rest even with strengths {1 / HELD:g} times as high "
                f"({verdict.saw}: {verdict.why}{bodies}): no factor of strengths holds it"
            )
        steps = sim.step_count - before
        self.wait = self.wait or patience(sim) or max(LEAST_STEPS, steps)
        self.tell(self._before_the_search(stage, verdict, steps))
        sim.reference = sim.fields["position"].copy()  # displacements count from here
        return stage

    def _before_the_search(self, stage: StageState, verdict: Verdict, steps: int) -> list[str]:
        """Warnings of what has moved far before the trials, or was handed over."""
        when = f"before the search, with strengths {1 / HELD:g} times as high"
        told = []
        if chips := verdict.chips:
            more = f", and {len(chips) - 1} smaller ones" if len(chips) > 1 else ""
            told.append(f"{when}, a chip was taken out: {chips[0].text()}{more}")
        slip = 0.5 * self.criterion.travel * face_size(self.sim)
        if verdict.moved > slip or stage.handed_over:
            told.append(f"{when}: at rest after {steps:,} steps, {verdict.why}")
        return told

    def _begin(self, value: float) -> StageState:
        """Begin the last stage with a value of the search."""
        sim = self.sim
        sim.stage_index = len(sim.case.stages) - 1
        stage = stages.begin(sim)
        self._give(value)
        return stage

    def _give(self, value: float) -> None:
        self.apply(self.sim.case, value)
        stages.update_core(self.sim, self.sim.stage_index)
        self.sim.core.renew_step()

    def begin_bisection(self) -> None:
        """Let further trials start from rest instead of the prepared state."""
        self.bisecting = True
        self.wait = self.wait_at_rest

    def broken_at_rest(self) -> dict[str, float]:
        """Broken part of the bonded area of each interface, after the last trial that came to rest."""
        bring_back(self.sim, self.at_rest)
        return lost_cohesion(self.sim)

    def attempt(self, value: float, *, hasty: bool) -> Trial:
        sim = self.sim
        bring_back(sim, self.at_rest if self.bisecting else self.start)
        before = sim.step_count
        if self.held:
            self._give(value)
            sim.core.set_damping(*stages.damping_of(sim.case.stages[-1]))  # not that of a hand-over
            stage = replace(self.held, start_step=before, solved="", handed_over=False)
        else:
            stage = self._begin(value)
            self.wait = self.wait or patience(sim)
        wait = self.wait or UNKNOWN
        verdict = rests(sim, stage, self.criterion, wait, self.from_where, hasty=hasty)
        if verdict.stable:
            self.at_rest = keep(sim)
            self.wait_at_rest = self.wait or patience(sim)  # what was loose has fallen
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

    def broken_at_rest(self) -> dict[str, float]:
        """Nothing: the model of the last stable trial is gone."""
        return {}

    def attempt(self, value: float, *, hasty: bool) -> Trial:
        case = self.case.model_copy(deep=True)
        self.apply(case, value)
        sim = self.sim = Simulation(case, threads=self.threads)
        self.criterion.check(sim)
        if self.tell:  # warnings of the first trial only; others differ by one value
            self.tell(sim.audit.warnings)
            self.tell = None
        verdict = Verdict(True, "at rest", "")
        for index, rules in enumerate(case.stages):
            if rules.mode == "static":
                verdict = stage_rests(sim, self.criterion, index, hasty=hasty)
                sim.stage_index, sim.stage = index + 1, None
            else:
                sim.run_stage(rules.name)
            if not verdict.stable:
                if index < len(case.stages) - 1:
                    verdict.why = f"stage {rules.name}: {verdict.why}"
                break
        return _trial(value, verdict, sim.step_count)


def _trial(value: float, verdict: Verdict, steps: int) -> Trial:
    v = verdict
    return Trial(value, v.stable, v.saw, v.why, steps, v.moved, v.bodies, v.chips, v.sure)
