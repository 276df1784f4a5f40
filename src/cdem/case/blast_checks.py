"""Checks of blasts that need no mesh: their stages, and whether these last long enough."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cdem.case.blasts_schema import Blast
from cdem.case.schema import CaseParts, Keys
from cdem.case.surface_schema import surface_groups

Floats = NDArray[np.float64]
Problem = tuple[Keys, str]  # path, problem
CUT = 0.05
"""Part of the impulse that the end of the run may cut off in silence [1]."""


def blast_problems(case: CaseParts) -> Iterator[Problem]:
    """Blasts in static stages, without rock, or after the end of the run."""
    for i, blast in enumerate(case.loads.blasts):
        place: Keys = ("loads", "blasts", i)
        begun = begun_stages(case, blast)
        if begun == 0:
            continue  # no such stage, which is told elsewhere
        stage = case.stages[begun - 1]
        if stage.mode == "static":
            yield (
                (*place, "stage"),
                f"{stage.name} is static, and a blast needs time; write stage: NAME of a dynamic stage",
            )
        for group in set(surface_groups(blast.surface)) & set(case.absent(begun)):
            yield (*place, "surface", "group"), f"{group} is not present in the stage {stage.name}"
        time = remaining_time(case, begun)
        if blast.delay >= time:
            yield (
                (*place, "delay"),
                f"it goes off {blast.delay:g} s after the begin of {stage.name}, and the run ends "
                f"{time:g} s after it; shorten the delay, or let {case.stages[-1].name} last longer",
            )


def cut_pulses(case: CaseParts) -> Iterator[Problem]:
    """Blasts whose pressure goes on at the end of the run."""
    for i, blast in enumerate(case.loads.blasts):
        begun = begun_stages(case, blast)
        time = remaining_time(case, begun)
        part = cut_part(blast, time)
        if part > CUT:
            yield (
                ("loads", "blasts", i),
                f"the run ends {time:g} s after the begin of {case.stages[begun - 1].name} and cuts off "
                f"{100 * part:.0f} % of its impulse; let {case.stages[-1].name} last longer",
            )


def begun_stages(case: CaseParts, blast: Blast) -> int:
    """Number of stages that have begun with the stage of a blast; 0 if there is no such stage."""
    names = [stage.name for stage in case.stages]
    if blast.stage is None:
        return min(1, len(names))
    return names.index(blast.stage) + 1 if blast.stage in names else 0


def remaining_time(case: CaseParts, begun: int) -> float:
    """Time from the begin of a stage to the end of the run [s]; inf where nobody knows it."""
    rest = case.stages[max(begun, 1) - 1 :]
    if begun == 0 or any(stage.duration is None for stage in rest):
        return np.inf
    return sum(stage.duration or 0.0 for stage in rest)


def cut_part(blast: Blast, time: float) -> float:
    """Part of the impulse of a blast after a time since the begin of its stage [1].

    Without the pressure that a table leaves for ever.
    """
    t, p = np.abs(np.array(blast.curves["pressure"])).T
    last = int(np.flatnonzero(np.diff(p))[-1]) + 1
    t, p = t[: last + 1], p[: last + 1]
    before = np.append(t[t < time], min(time, t[-1]))
    return 1 - _impulse(before, np.interp(before, t, p)) / _impulse(t, p)


def _impulse(t: Floats, p: Floats) -> float:
    return float((0.5 * (p[1:] + p[:-1]) * np.diff(t)).sum())
