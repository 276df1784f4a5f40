"""From when the times of curves count, and which curves are over too early."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cdem.case.schema import CaseParts, Stage
from cdem.case.timed_schema import Timed

Keys = tuple[str | int, ...]
Problem = tuple[Keys, str]  # path, what is wrong


def timed(case: CaseParts) -> Iterator[tuple[Keys, Timed]]:
    """Every place of a case that may have a curve over time."""
    for kind in ("tractions", "surfaces", "velocities"):
        for i, load in enumerate(getattr(case.loads, kind)):
            yield ("loads", kind, i), load
    if case.water is not None:
        for i, field in enumerate(case.water.fields):
            yield ("water", "fields", i), field
        if case.water.reservoir is not None:
            yield ("water", "reservoir"), case.water.reservoir


def last_dynamic(stages: Sequence[Stage]) -> int:
    """Number of the last dynamic stage; -1 where there is none."""
    return max((i for i, stage in enumerate(stages) if stage.mode == "dynamic"), default=-1)


def least_time(stages: Sequence[Stage]) -> float:
    """The shortest that stages can take [s]: nobody knows beforehand when one comes to rest."""
    return sum(s.duration or 0.0 for s in stages if s.until is None and s.max_steps is None)


def over_early(case: CaseParts, time: float, late: float = 0.0) -> Iterator[Problem]:
    """Curves that count from the start of the run, and are over before the last dynamic stage begins.

    Args:
        case: With a dynamic stage; as it is at that time.
        time: Before that begin, or that begin [s].
        late: By how much stages before may have ended later than they should [s].
    """
    name = case.stages[last_dynamic(case.stages)].name
    for keys, key, end in _varying(case, None):
        if end + late < time:
            yield (
                (*keys, key),
                f"is over at {end:g} s, before the stage {name} begins: its times count from the "
                f"start of the run; write stage: {name} beside it, or the stage that it is meant for",
            )


def last_change(case: CaseParts, stage: str) -> float:
    """When the last of the curves that count from a stage has come to its last value [s]."""
    return max((end for _, _, end in _varying(case, stage)), default=0.0)


def in_static_stages(case: CaseParts) -> Iterator[Problem]:
    """Curves that go on while a stage that they do not name comes to rest, in a time of its own."""
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
                    f"{rest[static].name} comes to rest, in a time that its tolerance decides; "
                    "stage: NAME beside it says from which stage its times count",
                )


def _varying(case: CaseParts, stage: str | None) -> Iterator[tuple[Keys, str, float]]:
    """Curves with this stage that are not constant: place, key and time of the last change [s]."""
    for keys, entry in timed(case):
        for key, rows in entry.curves.items():
            last = max((i for i, row in enumerate(rows) if row[1] != rows[-1][1]), default=-1)
            if entry.stage == stage and last >= 0:
                yield keys, key, rows[last + 1][0]
