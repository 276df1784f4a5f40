"""Damping that does not fit the waves of a case: warnings of the audit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cdem.case.case import Case
from cdem.case.damping_schema import Maxwell
from cdem.case.laws import SURFACE_LAWS
from cdem.case.schema import Stage
from cdem.model.damping import branches_of
from cdem.model.wave_frequencies import record_frequencies

STRONG = 0.1
"""Mass damping over the circular frequency of the waves, above which it is told [1]."""
COMES_BACK = 0.02
"""Part of a wave that a quiet surface may send back without a word [1]."""


def damping_doubts(case: Case) -> Iterator[str]:
    """Warnings about the damping of stages with waves."""
    for index, stage in enumerate(case.stages):
        path = f"stages.{index}.damping"
        yield from _mass(case, index, stage, f"{path}.mass")
        if stage.damping.maxwell is not None:
            where = f"{case.where(f'{path}.maxwell')}: {path}.maxwell"
            yield from _branches(case, index, stage.damping.maxwell, where)


def _mass(case: Case, index: int, stage: Stage, path: str) -> Iterator[str]:
    """Tell of mass damping that brakes the waves of a record."""
    alpha, waves = stage.damping.mass, record_frequencies(case, index)
    if stage.mode == "static" or waves is None:
        return
    middle, _ = waves
    if alpha > STRONG * 2 * np.pi * middle:
        yield (
            f"{case.where(path)}: {path}: {alpha:g} 1/s damps waves of {middle:.3g} Hz, the middle of "
            f"the record, by {100 * alpha / (4 * np.pi * middle):.3g} % of critical, and slower ones "
            "more; use rayleigh or maxwell"
        )


def _branches(case: Case, index: int, maxwell: Maxwell, where: str) -> Iterator[str]:
    """Tell of moduli of Maxwell's branches that do not fit the band, or a quiet surface."""
    low, high = maxwell.band
    reference = maxwell.reference
    if reference != "static" and not low <= reference <= high:
        yield (
            f"{where}.reference: {reference:g} Hz is outside the band, {low:g} to {high:g} Hz, where "
            "nothing is known of the ratio; use a frequency in it"
        )
    waves = record_frequencies(case, index)
    if waves is not None and not low <= waves[0] <= high:
        yield (
            f"{where}.band: {waves[0]:.3g} Hz, the middle of the record, is outside the band, {low:g} to "
            f"{high:g} Hz, where the ratio falls; use a band around it"
        )
    branches, middle = branches_of(maxwell), float(np.sqrt(low * high))
    speed = np.sqrt(branches.part * branches.storage(middle))
    back = abs(speed - 1) / (speed + 1)
    if back > COMES_BACK and _is_quiet(case, index):
        yield (
            f"{where}: in motion of {middle:.3g} Hz waves in the rock are {speed:.3g} times as fast as "
            f"the moduli of the case say, by which quiet surfaces are made: {100 * back:.2g} % of a "
            f"wave comes back; write reference: {middle:.3g}, the frequency of these moduli"
        )


def _is_quiet(case: Case, index: int) -> bool:
    """Whether a surface lets waves out in a stage."""
    begun = {None, *(stage.name for stage in case.stages[: index + 1])}
    return any(
        SURFACE_LAWS[entry.law].absorbs and entry.stage in begun
        for _, entry in case.surface_entries
    )
