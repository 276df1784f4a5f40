"""Sets of joints among measured directions: Fisher distributions on axes, and a uniform background."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.joints.directions import NamedPlane

Floats = NDArray[np.float64]

MOST_SETS = 6
"""Largest number of sets in the search."""
LEAST_MEMBERS = 5.0
"""Smallest number of joints of a fitted set."""
MOST_KAPPA = 2000.0
"""Largest concentration, the precision of measurement: 63 % within 1.8 deg."""
STARTS, FIRST_PASSES, MOST_PASSES = 30, 15, 500
SAMPLE = 1000
"""Most joints used to compare initial sets."""


@dataclass(frozen=True)
class JointSet(NamedPlane):
    """One set, by its mean plane.

    Attributes:
        kappa: Concentration of Fisher's distribution [1].
        a95: Half angle of the cone that contains the true mean with 95 % confidence [deg].
        share: Fraction of all joints in the set [1].
    """

    kappa: float
    a95: float
    share: float


@dataclass(frozen=True)
class Fit:
    """Sets found among joints.

    Attributes:
        sets: The largest first.
        membership: Probability of each joint to belong to each set and, last, to the background;
            shape
            (joints, sets + 1).
        bic: Bayesian information criterion by number of sets; empty if the sets were given.
    """

    sets: list[JointSet]
    membership: Floats
    bic: dict[int, float]

    @property
    def background(self) -> float:
        """Fraction of the joints in no set [1]."""
        return 1 - sum(s.share for s in self.sets)


def mean_axis(normals: Floats, weights: Floats | None = None) -> tuple[Floats, float, float]:
    """Mean, concentration and cone of confidence of axes near one another (Fisher 1953).

    kappa = (N - 1) / (N - R), cos a95 = 1 - (N - R) / R (20^(1 / (N - 1)) - 1), with the number N
    of axes and the length R of their sum.

    Args:
        normals: Unit vectors, up or down, shape (axes, 3).
        weights: Weights of the axes, shape (axes,); 1 each if None.

    Returns:
        Upward unit vector, kappa [1] (at most 2000), a95 [deg].

    Example:
        >>> from cdem.joints.directions import dips
        >>> axes = poles(np.array([28.0, 32.0]), np.array([90.0, 90.0]))
        >>> axis, kappa, _ = mean_axis(axes)
        >>> float(dips(axis)[0].round(9)), round(kappa, 2)  # 1 / (2 - 2 cos 2 deg)
        (30.0, 820.8)
    """
    w = np.ones(len(normals)) if weights is None else weights
    axis = np.linalg.eigh((normals * w[:, None]).T @ normals)[1][:, -1]
    total = (normals * (w * np.where(normals @ axis < 0, -1.0, 1.0))[:, None]).sum(axis=0)
    count, length = float(w.sum()), float(np.linalg.norm(total))
    mean = total / length * (1.0 if total[2] >= 0 else -1.0)
    apart = max(count - length, 1e-12)
    kappa = min(max(count - 1, 1e-3) / apart, MOST_KAPPA)
    cosine = -1.0
    if count > 1.05:  # below, 20^(1 / (N - 1)) overflows; the cone is then the half sphere
        cosine = 1 - apart / length * (20 ** (1 / (count - 1)) - 1)
    return mean, kappa, float(np.degrees(np.arccos(np.clip(cosine, 0, 1))))


def axis_density(cosine: Floats, kappa: Floats) -> Floats:
    """Density of Fisher's distribution on axes over the half sphere [1/sr].

    Args:
        cosine: Cosine of the angle to the mean, from 0 to 1.
        kappa: Concentration.
    """
    scale = kappa / (2 * np.pi * -np.expm1(-2 * kappa))
    return scale * (np.exp(kappa * (cosine - 1)) + np.exp(-kappa * (cosine + 1)))


@dataclass
class _State:
    """Sets during the fit; `share` has the background last."""

    means: Floats
    kappa: Floats
    share: Floats
    a95: Floats
    likelihood: float = -np.inf

    def membership(self, normals: Floats) -> tuple[Floats, Floats]:
        """Probability of each joint to belong to each set, and the total density."""
        cosine = np.abs(normals @ self.means.T)
        parts = np.empty((len(normals), len(self.share)))
        parts[:, :-1] = axis_density(cosine, self.kappa)
        parts[:, -1] = 1 / (2 * np.pi)
        parts *= self.share
        total = parts.sum(axis=1)
        return parts / total[:, None], total


def _improve(state: _State, normals: Floats, weights: Floats, passes: int) -> None:
    """Expectation and maximization, until the likelihood stops growing."""
    for _ in range(passes):
        membership, total = state.membership(normals)
        likelihood = float((weights * np.log(total)).sum())
        grown = likelihood - state.likelihood
        state.likelihood = likelihood
        if grown < 1e-7 * len(normals):
            return
        part = membership * weights[:, None]
        state.share = part.sum(axis=0) / weights.sum()
        for j in range(len(state.kappa)):
            if part[:, j].sum() > 1:
                found = mean_axis(normals, part[:, j])
                state.means[j], state.kappa[j], state.a95[j] = found


def _begin(normals: Floats, count: int, random: np.random.Generator) -> _State:
    """Initial sets whose means are joints far from one another."""
    chosen = [int(random.integers(len(normals)))]
    while len(chosen) < count:
        away = 1 - ((normals @ normals[chosen].T) ** 2).max(axis=1)
        away = np.maximum(away, 1e-9)
        chosen.append(int(random.choice(len(normals), p=away / away.sum())))
    share = np.full(count + 1, 1 / (count + 1))
    return _State(normals[chosen].copy(), np.full(count, 15.0), share, np.zeros(count))


def _best(normals: Floats, weights: Floats, count: int) -> _State | None:
    """The most likely sets of a given number, or None if one of them has too few joints."""
    random = np.random.default_rng(count)
    some = random.permutation(len(normals))[:SAMPLE]
    tried = []
    for _ in range(STARTS):
        state = _begin(normals[some], count, random)
        _improve(state, normals[some], weights[some], FIRST_PASSES)
        tried.append(state)
    best = max(tried, key=lambda state: state.likelihood)
    best.likelihood = -np.inf
    _improve(best, normals, weights, MOST_PASSES)
    few = best.share[:-1].min() * weights.sum() < LEAST_MEMBERS
    return None if few else best


def fit_sets(normals: Floats, count: int | None = None, weights: Floats | None = None) -> Fit:
    """Find the sets among joints.

    A mixture of Fisher distributions on axes and one uniform background is fitted by expectation and
    maximization (Dempster, Laird & Rubin 1977). The same joints give the same sets.

    Args:
        normals: Unit normals, up or down, shape (joints, 3).
        count: Number of sets; None for the smallest Bayesian information criterion.
        weights: Weights of the joints, shape (joints,), e.g. Terzaghi's; 1 each if None.

    Raises:
        CaseError: The joints have no sets, or not this number of sets.
    """
    number = len(normals)
    w = np.ones(number) if weights is None else weights * number / weights.sum()
    found: dict[int, _State] = {}
    bic: dict[int, float] = {}
    if count is None:
        bic[0] = 2 * number * float(np.log(2 * np.pi))
    for n in range(1, MOST_SETS + 1) if count is None else [count]:
        state = _best(normals, w, n) if number >= LEAST_MEMBERS * n else None
        if state is not None:
            found[n] = state
            bic[n] = 4 * n * float(np.log(number)) - 2 * state.likelihood
    if not bic or min(bic, key=lambda n: bic[n]) == 0:
        fitting = "no set" if count is None else f"fewer than {count} sets"
        raise CaseError(
            f"among {number} joints {fitting} can be distinguished from a uniform background: "
            f"measure more, or "
            "name the sets in a column 'set'"
        )
    state = found[min(found, key=lambda n: bic[n])]
    order = np.argsort(-state.share[:-1], kind="stable")
    membership = state.membership(normals)[0][:, [*order.tolist(), len(order)]]
    sets = [
        JointSet(
            f"set{place + 1}",
            state.means[j],
            float(state.kappa[j]),
            float(state.a95[j]),
            float(state.share[j]),
        )
        for place, j in enumerate(order.tolist())
    ]
    return Fit(sets, membership, bic)


def given_sets(normals: Floats, names: Sequence[str], weights: Floats | None = None) -> Fit:
    """Mean and scatter of named sets.

    Args:
        normals: Unit normals, up or down, shape (joints, 3).
        names: Set of each joint; an empty name for none.
        weights: Weights of the joints, shape (joints,); 1 each if None.

    Raises:
        CaseError: A set has a single joint, or there are no names.
    """
    w = np.ones(len(normals)) if weights is None else weights * len(normals) / weights.sum()
    labels = np.array(names)
    kinds = [str(name) for name in dict.fromkeys(names) if name]
    if not kinds:
        raise CaseError("the column of sets is empty; fill it in or remove it")
    kinds.sort(key=lambda name: -w[labels == name].sum())
    membership = np.column_stack([labels == name for name in [*kinds, ""]]).astype(float)
    sets = []
    for name in kinds:
        here = labels == name
        if here.sum() < 2:
            raise CaseError(f"set {name} has a single joint; a mean needs two")
        mean, kappa, a95 = mean_axis(normals[here], w[here])
        sets.append(JointSet(name, mean, kappa, a95, float(w[here].sum() / w.sum())))
    return Fit(sets, membership, {})
