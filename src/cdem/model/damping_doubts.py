"""Damping that does not fit the waves of a case: warnings of the audit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cdem.case.case import Case
from cdem.case.damping_schema import Maxwell
from cdem.case.laws import SURFACE_LAWS
from cdem.case.schema import Stage
from cdem.model.boundaries import maxwell_at
from cdem.model.damping import stiffer_in_waves
from cdem.model.wave_frequencies import record_frequencies

STRONG = 0.1
"""Mass damping over the circular frequency of the waves, above which it is told [1]."""
COMES_BACK = 0.02
"""Part of a wave that a quiet surface may send back without a word [1]."""


def damping_doubts(case: Case) -> Iterator[str]:
    """Warnings about the damping of stages with waves."""
    for index, stage in enumerate(case.stages):
        path = f"stages.{index}.damping"
        if stage.mode == "static":
            continue
        yield from _mass(case, index, stage, f"{path}.mass")
        if stage.damping.maxwell is not None:
            where = f"{case.where(f'{path}.maxwell')}: {path}.maxwell"
            yield from _branches(case, index, stage.damping.maxwell, where)
        yield from _quiet(case, index, stage, f"{case.where(path)}: {path}")


def _mass(case: Case, index: int, stage: Stage, path: str) -> Iterator[str]:
    """Tell of mass damping that brakes the waves of a record."""
    alpha, waves = stage.damping.mass, record_frequencies(case, index)
    if waves is None:
        return
    middle, _ = waves
    if alpha > STRONG * 2 * np.pi * middle:
        yield (
            f"{case.where(path)}: {path}: {alpha:g} 1/s damps waves of {middle:.3g} Hz, the middle of "
            f"the record, by {100 * alpha / (4 * np.pi * middle):.3g} % of critical, and slower ones "
            "more; use rayleigh or maxwell"
        )


def _branches(case: Case, index: int, maxwell: Maxwell, where: str) -> Iterator[str]:
    """Tell of a band that misses the waves, and of moduli of another frequency."""
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


def _quiet(case: Case, index: int, stage: Stage, where: str) -> Iterator[str]:
    """Tell of quiet surfaces that were made for rock with other branches."""
    begun = case.begun_names(index + 1)
    own = stiffer_in_waves(stage.damping.maxwell)
    for _, entry in case.surface_entries:
        if not SURFACE_LAWS[entry.law].absorbs or entry.stage not in begun:
            continue
        speed = np.sqrt(own / stiffer_in_waves(maxwell_at(case, entry.stage)))
        back = abs(speed - 1) / (speed + 1)
        if back > COMES_BACK:
            yield (
                f"{where}: waves in the rock are {speed:.3g} times as fast as in the stage in which quiet "
                f"surfaces begin: {100 * back:.2g} % of a wave comes back from them; give both stages the "
                "same maxwell damping"
            )
            return
