"""Damping of rock: ratio at a frequency, factors of Rayleigh damping, fit of Maxwell branches."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from cdem.case.damping_schema import Maxwell, Rayleigh
from cdem.case.schema import Stage

Floats = NDArray[np.float64]

BRANCHES = 3
FREQUENCIES = 200
"""Frequencies at which the ratio of the branches is fitted, evenly over the logarithm of the band."""
POWERS = (2, 4, 8, 16, 32, 64)
"""Powers of the error whose mean is made small, one after the other: the last is nearly the largest."""
ROUNDS = 60
"""Most Gauss-Newton steps for each power."""
LONGEST = 0.5
"""Longest step of the logarithm of a frequency or a weight."""
DIGITS = 6
"""Digits of the numbers of a branch: others depend on the libraries of a machine."""
NARROWEST = 10.0
"""A band that is narrower is widened: over less the numbers of three branches are not unique."""


@dataclass(frozen=True)
class Factors:
    """Factors of Rayleigh damping.

    Attributes:
        mass: Of the mass [1/s].
        stiffness: Of the stiffness [s].
    """

    mass: float
    stiffness: float

    def ratio(self, frequency: float) -> float:
        """Fraction of critical damping at a frequency [Hz]."""
        w = 2 * np.pi * frequency
        return 0.5 * (self.mass / w + self.stiffness * w)


def rayleigh_factors(rayleigh: Rayleigh | None) -> Factors:
    """Factors with the asked ratio at its frequency, of both parts or of the mass alone."""
    if rayleigh is None:
        return Factors(0.0, 0.0)
    w = 2 * np.pi * rayleigh.frequency
    stiffness = rayleigh.ratio / w if rayleigh.part == "both" else 0.0
    return Factors(rayleigh.ratio * w, stiffness)


@dataclass(frozen=True)
class Branches:
    """Maxwell branches in parallel with elastic rock: springs of `weight` times its moduli, each in
    series with a dashpot.

    Attributes:
        frequency: Frequencies at which they lose most [Hz].
        weight: Moduli over the moduli of the rock [1].
        part: Moduli of the rock over those of its material [1], see `Maxwell.reference`.
    """

    frequency: tuple[float, ...] = ()
    weight: tuple[float, ...] = ()
    part: float = 1.0

    @property
    def rate(self) -> list[float]:
        """Rates at which their stresses relax [1/s]."""
        return [2 * np.pi * f for f in self.frequency]

    @property
    def stiffer(self) -> float:
        """Moduli at the highest frequencies over those of slow loading [1]."""
        return 1 + sum(self.weight)

    def ratio(self, frequency: Floats | float) -> Floats:
        """Fraction of critical damping at frequencies [Hz]."""
        loss, storage = _moduli(
            np.asarray(frequency), np.array(self.frequency), np.array(self.weight)
        )
        return loss / (2 * storage)

    def storage(self, frequency: float) -> float:
        """Storage modulus at a frequency [Hz] over the modulus of slow loading [1]."""
        return float(
            _moduli(np.array(frequency), np.array(self.frequency), np.array(self.weight))[1]
        )


def _moduli(f: Floats, peak: Floats, weight: Floats) -> tuple[Floats, Floats]:
    """Loss and storage modulus of branches at frequencies, over the modulus of slow loading."""
    x = f[..., None] / peak
    part = weight / (1 + x * x)
    return (part * x).sum(axis=-1), 1 + (part * x * x).sum(axis=-1)


def branches_of(maxwell: Maxwell | None) -> Branches:
    """Branches of a stage."""
    if maxwell is None:
        return Branches()
    low, high = maxwell.band
    middle = np.sqrt(low * high)
    peaks, weights = fitted(maxwell.ratio, max(high / low, NARROWEST))
    own = Branches(tuple(_rounded(p * middle) for p in peaks), weights)
    if maxwell.reference == "static":
        return own
    return Branches(own.frequency, own.weight, _rounded(1 / own.storage(maxwell.reference)))


def stiffer_in_waves(maxwell: Maxwell | None) -> float:
    """Moduli of rock in the middle of the band of its branches, over those of its material [1]."""
    if maxwell is None:
        return 1.0
    branches = branches_of(maxwell)
    return branches.part * branches.storage(float(np.sqrt(np.prod(maxwell.band))))


def damping_of(stage: Stage) -> tuple[float, float, float, float]:
    """Local, mass, stiffness and contact damping of a stage."""
    d = stage.damping
    assert d.contact is not None
    return (_local(stage), d.mass + rayleigh_factors(d.rayleigh).mass, d.stiffness, d.contact)


def rock_damping_of(stage: Stage) -> tuple[float, list[float], list[float]]:
    """Rayleigh factor of the stiffness [s]; weights and rates [1/s] of the Maxwell branches."""
    branches = branches_of(stage.damping.maxwell)
    time = rayleigh_factors(stage.damping.rayleigh).stiffness
    return time, list(branches.weight), branches.rate


def is_lumped(stage: Stage) -> bool:
    """Whether a stage moves lumped masses.

    A static stage only looks for rest, which does not depend on inertia, and lumped masses allow a
    longer step (2.2 times for a tet); local damping scales forces node by node, which is stable
    only for lumped masses.
    """
    return stage.mode == "static" or _local(stage) > 0


def _local(stage: Stage) -> float:
    """Local damping of a stage; the case has filled in its default."""
    assert stage.damping.local is not None
    return stage.damping.local


@cache
def fitted(ratio: float, width: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Frequencies, over the middle of the band, and weights of the branches with the flattest ratio.

    The largest relative error over the band is made small, as the mean of ever higher powers.

    Args:
        ratio: Fraction of critical damping [1].
        width: Highest over lowest frequency of the band [1].
    """
    f = np.geomspace(width**-0.5, width**0.5, FREQUENCIES)
    start = np.geomspace(width**-0.5, width**0.5, BRANCHES)
    q = np.log(np.concatenate([start, np.full(BRANCHES, 2 * ratio)]))
    for power in POWERS:
        q = _least_mean(f, ratio, q, power)
    found = tuple(_rounded(number) for number in np.exp(q))
    return found[:BRANCHES], found[BRANCHES:]


def _least_mean(f: Floats, ratio: float, q: Floats, power: int) -> Floats:
    """Logarithms of frequencies and weights with the least mean of a power of the error."""
    damping = 1e-3
    error, slope = _error(f, ratio, q)
    for _ in range(ROUNDS):
        most = np.abs(error).max()
        size = (np.abs(error) / most) ** (power / 2)
        # the derivative of |e|^(p/2) is p/2 |e|^(p/2 - 1) sign(e) de
        rows = (
            power / 2 * (size / np.maximum(np.abs(error), 1e-12) * np.sign(error))[:, None] * slope
        )
        normal = rows.T @ rows
        lift = damping * np.diag(np.diag(normal))
        way = np.clip(-np.linalg.solve(normal + lift, rows.T @ size), -LONGEST, LONGEST)
        new_error, new_slope = _error(f, ratio, q + way)
        if ((np.abs(new_error) / most) ** power).sum() < (size**2).sum():
            q, error, slope, damping = q + way, new_error, new_slope, 0.3 * damping
            if np.abs(way).max() < 1e-13:
                break
        else:
            damping = max(5 * damping, 1e-12)
    return q


def _error(f: Floats, ratio: float, q: Floats) -> tuple[Floats, Floats]:
    """Relative error of the ratio at frequencies, and its derivatives, (frequencies, unknowns)."""
    peak, weight = np.exp(q[:BRANCHES]), np.exp(q[BRANCHES:])
    loss, storage = _moduli(f, peak, weight)
    x = f[:, None] / peak
    below = 1 / (1 + x * x)
    own_loss, own_storage = weight * x * below, weight * x * x * below
    # of the logarithm of a frequency, which moves x by -x, then of the logarithm of a weight
    d_loss = np.hstack([-own_loss * (1 - x * x) * below, own_loss])
    d_storage = np.hstack([-2 * own_storage * below, own_storage])
    slope = (d_loss - (loss / storage)[:, None] * d_storage) / (2 * storage)[:, None]
    return loss / (2 * storage) / ratio - 1, slope / ratio


def _rounded(number: float) -> float:
    return float(f"{number:.{DIGITS - 1}e}")
