"""Measures of a motion: peaks, intensity, duration, spectra, slip of a block."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cdem.seismic.processing import GRAVITY, NEGLIGIBLE, Processed, integral, transform_length

Floats = NDArray[np.float64]
PERIODS = np.geomspace(0.02, 10.0, 100)
"""Periods of a response spectrum [s]."""
DAMPING = 0.05
"""Damping of the oscillators of a spectrum, as a fraction of critical [1]."""
LEAST_POINTS = 10
"""Least number of samples in a period: a record of fewer is interpolated linearly."""
ANGLES = np.radians(np.arange(180))
"""Directions of a rotated spectrum [rad]."""
SIGNIFICANT = (0.05, 0.95)
"""Parts of the Arias intensity between which the significant duration lies [1]."""


class Measures(NamedTuple):
    """Measures of a motion along one axis.

    Attributes:
        pga: Largest acceleration [m/s2].
        pgv: Largest velocity [m/s].
        pgd: Largest displacement [m].
        arias: Arias intensity [m/s].
        cav: Cumulative absolute velocity [m/s].
        duration: Significant duration, from 5 to 95 % of the Arias intensity [s].
        last_velocity: Velocity at the end [m/s].
        last_displacement: Displacement at the end [m].
    """

    pga: float
    pgv: float
    pgd: float
    arias: float
    cav: float
    duration: float
    last_velocity: float
    last_displacement: float


def measures(record: Processed) -> Measures:
    """All measures of a record."""
    a, step = record.acceleration, record.step
    return Measures(
        pga=largest(a),
        pgv=largest(record.velocity),
        pgd=largest(record.displacement),
        arias=float(arias(a, step)[-1]),
        cav=float(integral(np.abs(a), step)[-1]),
        duration=significant_duration(a, step),
        last_velocity=float(record.velocity[-1]),
        last_displacement=float(record.displacement[-1]),
    )


def largest(values: Floats) -> float:
    """Largest magnitude."""
    return float(np.abs(values).max())


def arias(acceleration: Floats, step: float) -> Floats:
    """Arias intensity up to each sample [m/s]."""
    return np.pi / (2 * GRAVITY) * integral(acceleration**2, step)


def significant_duration(acceleration: Floats, step: float) -> float:
    """Time between 5 and 95 % of the Arias intensity [s]; 0 without motion."""
    grown = np.cumsum(acceleration**2)
    if not grown[-1] > 0:
        return 0.0
    first, last = (int(np.searchsorted(grown / grown[-1], part)) for part in SIGNIFICANT)
    return (last - first) * step


def highest_frequency(velocity: Floats, step: float, part: float = NEGLIGIBLE) -> float:
    """Frequency below which a part of the energy of the velocity's spectrum lies [Hz]."""
    size = transform_length(len(velocity))
    grown = np.cumsum(np.abs(np.fft.rfft(velocity, size)) ** 2)
    at = int(np.searchsorted(grown, part * grown[-1]))
    return float(np.fft.rfftfreq(size, step)[at])


def fourier_amplitude(values: Floats, step: float) -> tuple[Floats, Floats]:
    """Frequencies [Hz] and Fourier amplitude [unit of the values times s]."""
    size = transform_length(len(values))
    amplitude = np.abs(np.fft.rfft(values, size)) * step
    return np.fft.rfftfreq(size, step).astype(np.float64), amplitude


def oscillate(acceleration: Floats, step: float, periods: Floats, damping: float) -> Floats:
    """Displacement of oscillators on a moving base, relative to it (Nigam & Jennings 1969).

    Exact for an acceleration that is linear between samples.

    Args:
        acceleration: Of the base [m/s2].
        step: Time between samples [s].
        periods: Undamped periods [s].
        damping: Fraction of critical [1], below 1.

    Returns:
        Displacements [m], shape (samples, periods).
    """
    w = 2 * np.pi / periods
    one, none = np.ones_like(w), np.zeros_like(w)
    # the motion over a step is linear in its four causes
    of_u, of_v, of_first, of_last = (
        _over_step(w, damping, step, *causes)
        for causes in (
            (one, none, none, none),
            (none, one, none, none),
            (none, none, one, none),
            (none, none, none, one),
        )
    )
    forced_u = np.outer(acceleration[:-1], of_first[0]) + np.outer(acceleration[1:], of_last[0])
    forced_v = np.outer(acceleration[:-1], of_first[1]) + np.outer(acceleration[1:], of_last[1])
    out = np.zeros((len(acceleration), len(w)))
    u, v = none, none
    for i in range(len(acceleration) - 1):
        u, v = (
            of_u[0] * u + of_v[0] * v + forced_u[i],
            of_u[1] * u + of_v[1] * v + forced_v[i],
        )
        out[i + 1] = u
    return out


def _over_step(
    w: Floats, damping: float, step: float, u: Floats, v: Floats, first: Floats, last: Floats
) -> tuple[Floats, Floats]:
    """Displacement and velocity after a step with a linear acceleration of the base."""
    slope = (last - first) / step
    level, rate = -first / w**2 + 2 * damping * slope / w**3, -slope / w**2
    own = w * math.sqrt(1 - damping**2)
    c = u - level
    s = (v - rate + damping * w * c) / own
    fall, cosine, sine = np.exp(-damping * w * step), np.cos(own * step), np.sin(own * step)
    after = fall * (c * cosine + s * sine) + level + rate * step
    speed = fall * ((s * own - damping * w * c) * cosine - (c * own + damping * w * s) * sine)
    return after, speed + rate


def refined(acceleration: Floats, step: float, period: float) -> tuple[Floats, float]:
    """An acceleration with enough samples in a period, linear between the given ones, and its step."""
    parts = math.ceil(LEAST_POINTS * step / period - 1e-9)
    if parts <= 1:
        return acceleration, step
    at = np.arange((len(acceleration) - 1) * parts + 1) / parts
    return np.interp(at, np.arange(len(acceleration)), acceleration), step / parts


def spectrum(
    acceleration: Floats, step: float, periods: Floats = PERIODS, damping: float = DAMPING
) -> Floats:
    """Pseudo-spectral acceleration at each period [m/s2]."""
    out = np.empty(len(periods))
    for k, period in _by_refinement(step, periods):
        base, fine = refined(acceleration, step, period)
        out[k] = np.abs(oscillate(base, fine, periods[k], damping)).max(axis=0)
    return out * (2 * np.pi / periods) ** 2


def rotated_spectrum(
    x: Floats, y: Floats, step: float, periods: Floats = PERIODS, damping: float = DAMPING
) -> tuple[Floats, Floats]:
    """Median and largest pseudo-spectral acceleration over all horizontal directions [m/s2].

    Args:
        x, y: Accelerations along two axes at right angles [m/s2].
        step: Time between samples [s].
        periods: Periods [s].
        damping: Fraction of critical [1].

    Returns:
        RotD50 and RotD100 (Boore 2010) at each period.
    """
    middle, most = np.empty(len(periods)), np.empty(len(periods))
    for k, period in _by_refinement(step, periods):
        (base_x, fine), (base_y, _) = (refined(a, step, period) for a in (x, y))
        along_x, along_y = (oscillate(a, fine, periods[k], damping) for a in (base_x, base_y))
        peaks = np.array(
            [np.abs(np.cos(a) * along_x + np.sin(a) * along_y).max(axis=0) for a in ANGLES]
        )
        middle[k], most[k] = np.median(peaks, axis=0), peaks.max(axis=0)
    factor = (2 * np.pi / periods) ** 2
    return middle * factor, most * factor


def _by_refinement(step: float, periods: Floats) -> list[tuple[NDArray[np.intp], float]]:
    """Periods that need the same refinement: their indices, and the shortest of them [s]."""
    parts = np.ceil(LEAST_POINTS * step / periods - 1e-9).clip(1)
    return [(k := np.flatnonzero(parts == n), float(periods[k].min())) for n in np.unique(parts)]


def newmark_slip(acceleration: Floats, step: float, least: float) -> float:
    """Slip of a rigid block whose base moves (Newmark 1965) [m].

    It slides while its base is faster; exact for an acceleration that is linear between samples.
    On a plane that dips by beta, with a friction angle phi and a horizontal motion, the yield
    acceleration is g tan(phi - beta), and the slip is cos(phi - beta) / cos(phi) times this one.

    Args:
        acceleration: Of the base, positive where it drives the slip [m/s2].
        step: Time between samples [s].
        least: Yield acceleration [m/s2].
    """
    slip, speed = 0.0, 0.0
    excess = (acceleration - least).tolist()
    for now, then in pairwise(excess):
        if speed > 0 or now > 0 or then > 0:
            more, speed = _slide(speed, now, then, step)
            slip += more
    if speed > 0:  # the base moves on at a constant velocity
        slip += speed**2 / (2 * least) if least > 0 else math.inf
    return slip


def _slide(speed: float, now: float, then: float, time: float) -> tuple[float, float]:
    """Slip over a time in which the rate of the speed goes from `now` to `then`, and speed after it."""
    slope = (then - now) / time
    if speed == 0 and now < 0:
        if then <= 0:
            return 0.0, 0.0
        now, time = 0.0, time * then / (then - now)
    stop = _first_stop(speed, now, slope, time)
    end = min(stop, time)
    slip = speed * end + now * end**2 / 2 + slope * end**3 / 6
    if stop >= time:
        return slip, max(speed + now * time + slope * time**2 / 2, 0.0)
    more, speed = _slide(0.0, min(now + slope * stop, -0.0), then, time - stop)
    return slip + more, speed


def _first_stop(speed: float, rate: float, slope: float, time: float) -> float:
    """Time until a speed that changes at `rate`, which grows by `slope`, is 0; else infinite."""
    if speed == 0:
        return 0.0 if rate < 0 or (rate == 0 and slope < 0) else math.inf
    inside = rate**2 - 2 * slope * speed
    if inside < 0:
        return math.inf
    way = -rate - math.copysign(math.sqrt(inside), rate)  # no difference of near numbers
    roots = [way / slope if slope else 0.0, 2 * speed / way if way else 0.0]
    return min((root for root in roots if root > 0), default=math.inf)
