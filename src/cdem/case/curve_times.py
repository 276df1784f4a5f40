"""Start times of curves over time, and checks for curves that end too early."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cdem.case.schema import CaseParts, Stage
from cdem.case.timed_schema import Timed

Keys = tuple[str | int, ...]
Problem = tuple[Keys, str]  # path, problem


def timed(case: CaseParts) -> Iterator[tuple[Keys, Timed]]:
    """Every place of a case that may have a curve over time."""
    for kind in ("tractions", "surfaces", "blasts", "velocities"):
        for i, load in enumerate(getattr(case.loads, kind)):
            yield ("loads", kind, i), load
    if case.water is not None:
        for i, field in enumerate(case.water.fields):
            yield ("water", "fields", i), field
        if case.water.reservoir is not None:
            yield ("water", "reservoir"), case.water.reservoir


def record_users(case: CaseParts) -> Iterator[tuple[Keys, str, str | None]]:
    """Every place of a case that uses a record: the entry, the record, and the stage named."""
    for i, driven in enumerate(case.loads.velocities):
        if driven.record is not None:
            yield ("loads", "velocities", i), driven.record, driven.stage
    for i, boundary in enumerate(case.boundaries):
        for k, given in enumerate(boundary.inputs):
            at = (k,) if isinstance(boundary.input, list) else ()
            yield ("boundaries", i, "input", *at), given.record, boundary.stage


def last_dynamic(stages: Sequence[Stage]) -> int:
    """Number of the last dynamic stage; -1 where there is none."""
    return max((i for i, stage in enumerate(stages) if stage.mode == "dynamic"), default=-1)


def least_time(stages: Sequence[Stage]) -> float:
    """Shortest total duration of stages [s]; a static stage counts as 0: its end is unknown."""
    return sum(s.duration or 0.0 for s in stages if s.until is None and s.max_steps is None)


def over_early(case: CaseParts, time: float, late: float = 0.0) -> Iterator[Problem]:
    """Curves that start with the run and end before the last dynamic stage begins.

    Args:
        case: Has a dynamic stage; in its state at that time.
        time: Begin of that stage, or an earlier time [s].
        late: How much later than planned earlier stages may have ended [s].
    """
    name = case.stages[last_dynamic(case.stages)].name
    for keys, key, end in _varying(case, None):
        if end + late < time:
            yield (
                (*keys, key),
                f"is over at {end:g} s, before the stage {name} begins: its times count from the "
                f"start of the run; write stage: {name} beside it, or the stage where it should "
                f"start",
            )


def last_change(case: CaseParts, stage: str) -> float:
    """Time when the last curve of a stage reaches its last value [s]."""
    return max((end for _, _, end in _varying(case, stage)), default=0.0)


def in_static_stages(case: CaseParts) -> Iterator[Problem]:
    """Curves still running while a static stage, which they do not name, comes to rest."""
    names = [stage.name for stage in case.stages]
    for stage in (None, *names):
        first = 0 if stage is None else names.index(stage)
        if stage is not None and case.stages[first].mode == "static":
            continue
        rest = case.stages[first:]
        static = next((i for i, s in enumerate(rest) if s.mode == "static"), None)
        if static is None:
            continue
        begin = sum(s.duration or 0.0 for s in rest[:static])
        since = "the start of the run" if stage is None else f"the begin of {stage}"
        for keys, key, end in _varying(case, stage):
            if end > begin:
                yield (
                    (*keys, key),
                    f"goes on until {end:g} s from {since}, also while the static stage "
                    f"{rest[static].name} comes to rest, for a time that depends on the tolerance; "
                    "write stage: NAME beside it for the stage where its times start",
                )


def _varying(case: CaseParts, stage: str | None) -> Iterator[tuple[Keys, str, float]]:
    """Curves of this stage that are not constant: place, key and time of the last change [s]."""
    for keys, entry in timed(case):
        for key, rows in entry.curves.items():
            last = max((i for i, row in enumerate(rows) if row[1] != rows[-1][1]), default=-1)
            if entry.stage == stage and last >= 0:
                yield keys, key, rows[last + 1][0]
    for keys, name, begin in record_users(case):
        if name in case.records and begin == stage:
            yield keys, "record", case.records[name].duration
