"""Pressure of a blast over time, as rows of time and factor of its peak."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence

Rows = list[tuple[float, float]]
"""Time since the detonation [s], factor of the peak [1]."""
ERROR = 1e-4
"""Largest difference of the rows, joined by straight lines, from their formula [1]."""
JUMP = 1e-6
"""Time of a jump of pressure, as a fraction of the duration of its pulse [1]."""


def two_exponentials(rise: float, fall: float) -> Rows:
    """Rows of (exp(-t / fall) - exp(-t / t2)) / norm, with its peak of 1 at `rise`.

    Args:
        rise: Time of the peak, below `fall` [s].
        fall: Time constant of the fall [s].
    """
    second = second_time(rise, fall)

    def pulse(t: float) -> float:
        return math.exp(-t / fall) - math.exp(-t / second)

    peak = pulse(rise)
    end = fall * math.log(1 / (ERROR * peak))
    return [*sampled(lambda t: pulse(t) / peak, [0.0, rise, end])[:-1], (end, 0.0)]


def second_time(rise: float, fall: float) -> float:
    """Time constant t2 of the rise: rise = ln(fall / t2) / (1 / t2 - 1 / fall), by bisection [s].

    With x = t2 / fall, rise / fall = -x ln x / (1 - x), which grows from 0 to 1.
    """
    low, high = 0.0, 1.0
    for _ in range(60):
        x = 0.5 * (low + high)
        if -x * math.log(x) < (rise / fall) * (1 - x):
            low = x
        else:
            high = x
    return fall * low


def friedlander(duration: float, decay: float, *, suction: bool) -> Rows:
    """Rows of (1 - t / duration) exp(-decay t / duration).

    Args:
        duration: Time with pressure [s].
        decay: Decay [1].
        suction: Whether to keep the negative part.
    """
    ends = [0.0, 1.0]
    if suction:
        end = 2.0
        while (end - 1) * math.exp(-decay * end) > ERROR:
            end *= 1.1
        ends.append(end)
    rows = sampled(lambda x: (1 - x) * math.exp(-decay * x), ends)
    return from_zero([*((duration * x, p) for x, p in rows[:-1]), (duration * ends[-1], 0.0)])


def from_zero(rows: Sequence[tuple[float, float]]) -> Rows:
    """The rows, after a row without pressure: a curve keeps its first value before it begins."""
    if rows[0][1] == 0:
        return list(rows)
    length = rows[-1][0] - rows[0][0]
    jump = JUMP * (length or 1.0)
    if len(rows) > 1:
        jump = min(jump, 0.5 * (rows[1][0] - rows[0][0]))
    return [(rows[0][0], 0.0), (rows[0][0] + jump, rows[0][1]), *rows[1:]]


def sampled(function: Callable[[float], float], ends: Sequence[float]) -> Rows:
    """Rows of a function between its ends and bends, close enough for straight lines."""
    rows = [(ends[0], function(ends[0]))]
    for a, b in itertools.pairwise(ends):
        cuts = [a + (b - a) * k / 4 for k in range(4)] + [b]
        for left, right in itertools.pairwise(cuts):
            rows += _between(function, left, right)
    return rows


def _between(function: Callable[[float], float], a: float, b: float) -> Rows:
    """Rows after `a`, up to `b`."""
    at_a, at_b = function(a), function(b)
    off = max(
        abs(function(a + part * (b - a)) - at_a - part * (at_b - at_a))
        for part in (0.25, 0.5, 0.75)
    )
    if off <= 0.5 * ERROR:
        return [(b, at_b)]
    middle = 0.5 * (a + b)
    return [*_between(function, a, middle), *_between(function, middle, b)]


def highest_frequency(rows: Sequence[tuple[float, float]]) -> float:
    """Highest frequency of a pulse, for its mesh: 1 / (pi rise) [Hz].

    Args:
        rows: Time [s] and factor; a pulse that jumps to its peak counts by its fall to half of it.
    """
    peak = max(range(len(rows)), key=lambda i: abs(rows[i][1]))
    rise = rows[peak][0] - rows[0][0]
    if rise > 2 * JUMP * (rows[-1][0] - rows[0][0]):
        return 1 / (math.pi * rise)
    half = abs(rows[peak][1]) / 2
    later = [t for t, p in rows[peak:] if abs(p) <= half]
    return 1 / (math.pi * ((later or [rows[-1][0] + 1.0])[0] - rows[0][0]))
