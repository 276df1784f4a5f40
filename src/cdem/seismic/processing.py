"""From the samples of a record to acceleration, velocity and displacement: see docs/theory/signals.md."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Kind = Literal["acceleration", "velocity", "displacement"]

GRAVITY = 9.81
"""The unit g of accelerations [m/s2]."""
UNITS: dict[str, tuple[Kind, float]] = {
    "g": ("acceleration", GRAVITY), "m/s2": ("acceleration", 1.0), "cm/s2": ("acceleration", 0.01),
    "m/s": ("velocity", 1.0), "cm/s": ("velocity", 0.01),
    "m": ("displacement", 1.0), "cm": ("displacement", 0.01),
}  # fmt: skip
"""Units of a record: quantity, and factor to SI."""
TAPER = 0.01
"""Part of a record at each end that is tapered [1]."""
ORDER = 4
"""Order of the Butterworth filters."""
PADDING = 2
"""Length of a transform over that of the record, at least [1]."""
NEGLIGIBLE = 0.99
"""Part of the energy of the velocity's spectrum below the highest frequency that matters [1]."""


@dataclass(frozen=True, eq=False)
class Processed:
    """A record ready for use: all arrays start at the begin of its stage.

    Attributes:
        step: Time between samples [s].
        acceleration: [m/s2].
        velocity: [m/s].
        displacement: [m], from 0.
    """

    step: float
    acceleration: Floats
    velocity: Floats
    displacement: Floats

    def __post_init__(self) -> None:
        for values in (self.acceleration, self.velocity, self.displacement):
            values.flags.writeable = False

    def __deepcopy__(self, memo: object) -> Processed:
        return self  # nothing in it changes

    @property
    def duration(self) -> float:
        """Time of the last sample [s]."""
        return (len(self.velocity) - 1) * self.step

    @property
    def times(self) -> Floats:
        """Times of the samples [s]."""
        return np.arange(len(self.velocity), dtype=np.float64) * self.step


def integral(values: Floats, step: float) -> Floats:
    """Integral from the first sample, by the trapezoidal rule; shape as `values`."""
    out = np.zeros_like(values)
    out[1:] = np.cumsum((values[1:] + values[:-1]) * (step / 2))
    return out


def derivative(values: Floats, step: float) -> Floats:
    """Derivative by central differences; one-sided at the ends."""
    return np.asarray(np.gradient(values, step))


def of_acceleration(acceleration: Floats, step: float) -> Processed:
    """A record of an acceleration [m/s2], integrated twice."""
    velocity = integral(acceleration, step)
    return Processed(step, acceleration, velocity, integral(velocity, step))


def of_velocity(velocity: Floats, step: float) -> Processed:
    """A record of a velocity [m/s]."""
    return Processed(step, derivative(velocity, step), velocity, integral(velocity, step))


def of_kind(values: Floats, step: float, kind: Kind) -> Processed:
    """A record of some quantity in SI."""
    if kind == "acceleration":
        return of_acceleration(values, step)
    return of_velocity(values if kind == "velocity" else derivative(values, step), step)


def tapered(values: Floats) -> Floats:
    """A signal with a cosine taper at both ends."""
    count = int(TAPER * len(values))
    window = np.ones(len(values))
    rise = 0.5 * (1 - np.cos(np.pi * np.arange(count) / max(count, 1)))
    window[:count] = rise
    window[len(values) - count :] = rise[::-1]
    return values * window


def transform_length(count: int) -> int:
    """Samples of a padded transform: a power of 2."""
    return 1 << math.ceil(math.log2(PADDING * count))


def filtered(values: Floats, step: float, low: float, high: float) -> Floats:
    """A signal in a band of frequencies [Hz], without a shift in phase.

    The factor is that of a high-pass and a low-pass Butterworth filter, each run forwards and
    backwards.
    """
    size = transform_length(len(values))
    f = np.fft.rfftfreq(size, step)
    gain = np.zeros(len(f))
    power = 2 * ORDER
    gain[1:] = 1 / ((1 + (low / f[1:]) ** power) * (1 + (f[1:] / high) ** power))
    return np.fft.irfft(np.fft.rfft(values, size) * gain, size)[: len(values)]


def drift(velocity: Floats, step: float) -> tuple[float, float, float]:
    """Factors b of the cubic b1 t + b2 t^2 + b3 t^3 nearest to a velocity, t in s.

    The sums are exact, so the factors do not depend on the order of summation.
    """
    t = np.arange(len(velocity)) / (len(velocity) - 1)
    powers = [t, t * t, t * t * t]
    matrix = [[math.fsum(a * b) for b in powers] for a in powers]
    b = np.linalg.solve(matrix, [math.fsum(a * velocity) for a in powers])
    length = (len(velocity) - 1) * step
    return float(b[0] / length), float(b[1] / length**2), float(b[2] / length**3)


def on_baseline(record: Processed, kind: Kind) -> Processed:
    """A record without the drift of its velocity."""
    t, (b1, b2, b3) = record.times, drift(record.velocity, record.step)
    if kind == "acceleration":
        drifting = b1 + 2 * b2 * t + 3 * b3 * t * t
        return of_acceleration(record.acceleration - drifting, record.step)
    return of_velocity(record.velocity - (b1 * t + b2 * t * t + b3 * t * t * t), record.step)


def steps_of(
    values: Floats, step: float, kind: Kind, band: tuple[float, float] | None, baseline: str
) -> Iterator[tuple[str, Processed]]:
    """The steps of processing, each with its name and its result; the first is as read.

    Args:
        values: Samples in SI, scaled.
        step: Time between them [s].
        kind: Their quantity.
        band: Low and high frequency [Hz], or None.
        baseline: "none" or "cubic".
    """
    yield "as read, scaled", of_kind(values, step, kind)
    values = tapered(values)
    yield "taper", of_kind(values, step, kind)
    if band is not None:
        values = filtered(values, step, *band)
        yield f"band-pass {band[0]:g} to {band[1]:g} Hz", of_kind(values, step, kind)
    if baseline == "cubic":
        yield "cubic baseline", on_baseline(of_kind(values, step, kind), kind)


@lru_cache(maxsize=16)
def process(
    samples: str,
    factor: float,
    step: float,
    kind: Kind,
    band: tuple[float, float] | None,
    baseline: str,
) -> tuple[tuple[str, Processed], ...]:
    """All steps of processing; the last has the record that is used.

    Args:
        samples: Numbers with blanks between.
        factor: Factor of the samples: scale times unit.
        step, kind, band, baseline: See `steps_of`.
    """
    values = np.array(samples.split(), float) * factor
    return tuple(steps_of(values, step, kind, band, baseline))
