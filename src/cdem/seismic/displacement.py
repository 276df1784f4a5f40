"""Permanent displacement of rigid blocks (Newmark 1965) over their yield acceleration."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.seismic.measures import newmark_slip
from cdem.seismic.processing import GRAVITY, Processed

Floats = NDArray[np.float64]

RATIOS = np.concatenate([np.geomspace(0.01, 0.5, 30), np.linspace(0.5, 1.0, 41)[1:]])
"""Yield accelerations over the largest acceleration, for which a record is integrated [1]."""
POWER = 2.4
"""Root of the slip that is nearly linear close to the largest acceleration [1]."""
MAGNITUDES = (5.3, 7.6)
"""Magnitudes of the earthquakes to which Jibson fitted his equation."""


def slip_of_record(record: Processed, yields: Floats) -> Floats:
    """Slip of rigid blocks on level ground in a record [m], shape as `yields`.

    The larger of both polarities. Interpolated in a table of 70 yield accelerations.

    Args:
        record: The motion of the ground.
        yields: Yield accelerations [g]; the slip is nan where one is not above 0.
    """
    a, step = record.acceleration, record.step
    largest = float(np.abs(a).max())
    slips = np.array(
        [max(newmark_slip(sign * a, step, r * largest) for sign in (1, -1)) for r in RATIOS]
    )
    at = np.asarray(yields, float) * GRAVITY / largest
    with np.errstate(invalid="ignore", divide="ignore"):
        # slip times ratio is bounded at small ratios, its root nearly linear at large ones
        found = np.interp(at, RATIOS, (slips * RATIOS) ** (1 / POWER)) ** POWER / at
    return np.where(at > 0, np.where(at < 1, found, 0.0), np.nan)


def slip_by_jibson(yields: Floats, pga: float, magnitude: float | None = None) -> Floats:
    """Median displacement of rigid blocks after Jibson (2007) [m], shape as `yields`.

    With r the yield acceleration over the PGA, in cm: log D = 0.215 + log((1 - r)^2.341 r^-1.438),
    Eq. 6, with a standard deviation of 0.510; or with the moment magnitude M: log D = -2.710 +
    log((1 - r)^2.335 r^-1.478) + 0.424 M, Eq. 7, with 0.454.

    Jibson, R.W. (2007): Regression models for estimating coseismic landslide displacement.
    Engineering Geology 91, 209-218. doi:10.1016/j.enggeo.2007.01.013

    Args:
        yields: Yield accelerations [g]; the displacement is nan where one is not above 0.
        pga: Largest acceleration of the ground [g].
        magnitude: Moment magnitude; None for Eq. 6.
    """
    r = np.asarray(yields, float) / pga
    level, fall, rise = (0.215, 2.341, 1.438)
    if magnitude is not None:
        level, fall, rise = (-2.710 + 0.424 * magnitude, 2.335, 1.478)
    with np.errstate(invalid="ignore", divide="ignore"):
        found = 0.01 * 10**level * np.maximum(1 - r, 0.0) ** fall * r**-rise
    return np.where(r > 0, np.where(r < 1, found, 0.0), np.nan)
