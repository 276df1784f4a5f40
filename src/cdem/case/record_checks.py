"""Checks of records, and of the places of a case that use them."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator

from cdem.case.curve_times import record_users
from cdem.case.schema import CaseParts
from cdem.case.waves_schema import Record
from cdem.seismic.measures import Measures, arias, measures
from cdem.seismic.processing import GRAVITY, Processed

Keys = tuple[str | int, ...]
Problem = tuple[Keys, str]

MOST_PGA, MOST_PGV = 5 * GRAVITY, 10.0
"""Peaks above which a record is refused [m/s2], [m/s]: its unit is taken for wrong."""
HIGH_PGA, HIGH_PGV = 2 * GRAVITY, 3.0
"""Peaks above which a record is unusual [m/s2], [m/s]."""
LEFT_VELOCITY, LEFT_DISPLACEMENT = 0.01, 0.05
"""Parts of the peaks that a record may leave at its end [1]."""
CUT = 0.001
"""Part of the Arias intensity that a stage may cut off in silence [1]."""


def record_contradictions(case: CaseParts) -> Iterator[Problem]:
    """Bands that do not fit their records, and records that do not fit their places."""
    for name, record in case.records.items():
        if why := record.band_fault:
            yield ("records", name, "band"), why
    for keys, name, stage in record_users(case):
        if name not in case.records:
            yield (*keys, "record"), _unknown(name, case.records)
        if keys[0] == "loads" and (why := _static(case, stage)):
            yield (*keys, "record" if stage is None else "stage"), why


def _unknown(name: str, known: Iterable[str]) -> str:
    close = difflib.get_close_matches(name, known, n=1)
    has = f"the case has: {', '.join(known) or 'none'}"
    return f"no record '{name}'; {f'did you mean {close[0]}?' if close else has}"


def _static(case: CaseParts, stage: str | None) -> str:
    """Why a record cannot start in its stage, or nothing; an unknown stage is told elsewhere."""
    first = next((one for one in case.stages if stage in (None, one.name)), None)
    if first is None or first.mode == "dynamic":
        return ""
    shaken = [one.name for one in case.stages if one.mode == "dynamic"]
    return (
        f"would start in the static stage {first.name}, whose time means nothing; write stage: "
        f"{' or '.join(shaken) or 'NAME, of a dynamic stage'}"
    )


def record_doubts(case: CaseParts) -> tuple[list[Problem], list[Problem]]:
    """Impossible and unusual records: path and message."""
    impossible: list[Problem] = []
    used = {name for _, name, _ in record_users(case)}
    unusual: list[Problem] = [
        (("records", name), f"nothing uses it; write record: {name} where it should act")
        for name in case.records
        if name not in used
    ]
    for name, record in case.records.items():
        if record.band_fault:
            continue  # cannot be filtered
        keys: Keys = ("records", name)
        found = measures(case.processed(name))
        if why := _peak(found, MOST_PGA, MOST_PGV):
            impossible.append((keys, f"{why}; look at its unit and scale"))
        elif why := _peak(found, HIGH_PGA, HIGH_PGV):
            unusual.append((keys, f"{why}, which is rare; are its unit and scale right?"))
        unusual += [(keys, why) for why in _left(record, found)]
    for keys, name, stage in record_users(case):
        if name in case.records and not case.records[name].band_fault:
            unusual += [(keys, why) for why in _cut(case, case.processed(name), stage)]
    return impossible, unusual


def _peak(found: Measures, pga: float, pgv: float) -> str:
    if found.pga > pga:
        return f"its acceleration reaches {found.pga / GRAVITY:.3g} g, above {pga / GRAVITY:g} g"
    if found.pgv > pgv:
        return f"its velocity reaches {found.pgv:.3g} m/s, above {pgv:g} m/s"
    return ""


def _left(record: Record, found: Measures) -> Iterator[str]:
    """A motion that a record leaves at its end."""
    velocity = abs(found.last_velocity) / max(found.pgv, 1e-300)
    displacement = abs(found.last_displacement) / max(found.pgd, 1e-300)
    left = []
    if velocity > LEFT_VELOCITY:
        left.append(f"a velocity of {found.last_velocity:.2g} m/s ({100 * velocity:.2g} % of PGV)")
    if displacement > LEFT_DISPLACEMENT:
        left.append(
            f"a displacement of {found.last_displacement:.2g} m ({100 * displacement:.2g} % of PGD)"
        )
    if left:
        mend = "baseline: cubic" if record.baseline == "none" else "a band with a higher low end"
        yield f"leaves {' and '.join(left)} at its end; {mend} reduces it"


def _cut(case: CaseParts, record: Processed, stage: str | None) -> Iterator[str]:
    """The end of a record for which the stages from its own on have no time."""
    rest = case.stages_from(stage)
    if not rest:
        return
    time = sum(one.duration or 0.0 for one in rest)
    if any(one.max_steps or one.until for one in rest) or time >= record.duration:
        return
    grown = arias(record.acceleration, record.step)
    cut = 1 - grown[min(int(time / record.step), len(grown) - 1)] / grown[-1]
    if cut > CUT:
        yield (
            f"its record lasts {record.duration:g} s, the stages from {rest[0].name} on {time:g} s: "
            f"{100 * cut:.2g} % of its Arias intensity is cut off; give them a longer duration"
        )
