"""Frequencies of the records that act in a stage."""

from __future__ import annotations

from cdem.case.case import Case
from cdem.case.curve_times import record_users
from cdem.seismic.measures import highest_frequency


def record_frequencies(case: Case, index: int) -> tuple[float, float] | None:
    """Middle and highest frequency of the waves of the records in a stage [Hz].

    Half of the energy of the velocity's spectrum lies below the middle one, of the slowest record;
    nearly all of it below the highest one, of the fastest.

    Args:
        case: The case.
        index: Number of the stage.

    Returns:
        The two frequencies; None without a record.
    """
    begun = case.begun_names(index + 1)
    names = sorted({name for _, name, stage in record_users(case) if stage in begun})
    records = [case.processed(name) for name in names]
    if not records:
        return None
    return (
        min(highest_frequency(r.velocity, r.step, 0.5) for r in records),
        max(highest_frequency(r.velocity, r.step) for r in records),
    )
