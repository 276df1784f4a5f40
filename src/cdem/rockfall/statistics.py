"""Quantiles of a sample with the band in which the true quantile lies, and shares with theirs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
CONFIDENCE = 0.95
"""Probability of the bands: each side is missed by at most half of the rest."""
LEVELS = (0.5, 0.95, 0.99)
"""Quantiles of tables and pictures."""


@dataclass(frozen=True)
class Quantile:
    """A quantile of a sample.

    Attributes:
        level: Fraction below it [1].
        value: Estimate: linear between the values by rank, and not below the band.
        low, high: Band of the true quantile; None where the sample is too small to bound it.
    """

    level: float
    value: float
    low: float | None
    high: float | None

    def text(self, scale: float = 1.0) -> str:
        """``12.3 (10.1 to 18)``; an open end is a question mark."""
        low, high = ("?" if v is None else short(v * scale) for v in (self.low, self.high))
        return f"{short(self.value * scale)} ({low} to {high})"


def short(number: float) -> str:
    """A number with three digits, or its whole part: ``0.123``, ``1,234``."""
    return f"{number:,.0f}" if abs(number) >= 999.5 else f"{number:.3g}"


def quantile_of(values: Floats, level: float) -> Quantile:
    """A quantile with the band of order statistics.

    The number of values below the true quantile has a binomial distribution, whatever the values
    have (David & Nagaraja 2003, Order Statistics, section 7.1). So the r-th value is above it with
    the probability of fewer than r such values.

    Args:
        values: The sample, not empty.
        level: Fraction below the quantile [1].
    """
    ordered = np.sort(np.asarray(values, float))
    below, above = ranks_of(len(ordered), level)
    low = None if below == 0 else float(ordered[below - 1])
    high = None if above > len(ordered) else float(ordered[above - 1])
    value = float(np.quantile(ordered, level))
    return Quantile(level, value if low is None else max(value, low), low, high)


def ranks_of(count: int, level: float) -> tuple[int, int]:
    """Ranks, from 1, of the values that bound a quantile; 0 and count + 1 where none does."""
    miss = (1 - CONFIDENCE) / 2
    log = np.concatenate([[0.0], np.cumsum(np.log(np.arange(1, count + 1)))])
    k = np.arange(count + 1)
    chance = log[count] - log[k] - log[count - k] + k * math.log(level)
    upto = np.cumsum(np.exp(chance + (count - k) * math.log1p(-level)))  # P(at most k below)
    below = int(np.searchsorted(upto, miss, side="right"))  # P(at most below - 1) <= miss
    above = int(np.searchsorted(upto, 1 - miss, side="left")) + 1
    return below, above


def share_of(part: int, whole: int) -> tuple[float, float]:
    """Band of a probability of which `part` of `whole` trials are known (Wilson 1927, JASA 22)."""
    z = NormalDist().inv_cdf(0.5 + CONFIDENCE / 2)
    middle = (part + z * z / 2) / (whole + z * z)
    half = z / (whole + z * z) * math.sqrt(part * (whole - part) / whole + z * z / 4)
    return max(0.0, middle - half), min(1.0, middle + half)
