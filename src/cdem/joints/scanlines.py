"""Spacing and area of joints from scanlines and boreholes, with the weights of Terzaghi (1965)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.joints.measured import Measured

Floats = NDArray[np.float64]

LEAST_SINE = 0.2
"""Sine of the smallest angle to a scanline in the weights: 11.5 deg; smaller ones count as this."""


@dataclass(frozen=True)
class Frequency:
    """Density of a set.

    Attributes:
        spacing: Distance of its planes along their normal [m].
        p32: Area of joints per volume [1/m].
        count: Number of joints behind it.
        blind: Whether the mean plane lies within 11.5 deg of all scanlines, which then hardly
            intersect it.
    """

    spacing: float
    p32: float
    count: float
    blind: bool


def terzaghi(measured: Measured) -> Floats | None:
    """Weights 1 / max(sin(angle of scanline and joint), 0.2), shape (joints,); None without lines."""
    if measured.lines is None:
        return None
    sine = np.abs((measured.normals * measured.lines).sum(axis=1))
    return 1 / np.maximum(sine, LEAST_SINE)


def total_length(measured: Measured, length: float | None) -> float | None:
    """Length of all scanlines [m].

    Args:
        measured: The joints.
        length: Total length, if it is known; else a line with n joints over a distance `span`
            counts
            with span n / (n - 1).

    Raises:
        CaseError: A scanline has a single joint, or all at one place.
    """
    if measured.scanline is None or length is not None:
        return length
    if measured.position is None:
        return None
    names, total = np.array(measured.scanline), 0.0
    for name in dict.fromkeys(measured.scanline):
        at = measured.position[names == name]
        if np.ptp(at) == 0:
            raise CaseError(
                f"scanline {name or 'of the table'} has joints at one position only: give the "
                "length of all scanlines"
            )
        total += float(np.ptp(at)) * len(at) / (len(at) - 1)
    return total


def frequencies(
    measured: Measured, means: Floats, membership: Floats, length: float | None
) -> list[Frequency] | None:
    """Spacing and P32 of each set; None without scanlines or their length.

    P32 is the sum of Terzaghi's weights over the length of the scanlines; infinite planes have the
    spacing 1 / P32.

    Args:
        measured: The joints.
        means: Unit normals of the sets, shape (sets, 3).
        membership: Probability of each joint to belong to each set, shape (joints, sets or more).
        length: See `total_length`.
    """
    weights, total = terzaghi(measured), total_length(measured, length)
    if weights is None or measured.lines is None or total is None:
        return None
    out = []
    for j, mean in enumerate(means):
        p32 = float((membership[:, j] * weights).sum() / total)
        blind = bool((np.abs(measured.lines @ mean) < LEAST_SINE).all())
        out.append(Frequency(1 / p32, p32, float(membership[:, j].sum()), blind))
    return out
