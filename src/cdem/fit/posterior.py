"""Which parameters agree with the observations: Bayes' rule, sampled by Metropolis' walk."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.fit.emulator import Emulator, Part

Floats = NDArray[np.float64]

FIRST = 4096
"""Points of the prior from which the walks choose their starts."""
WALKS, WARM, STEPS = 200, 90, 160
"""Walks, their steps before the first that counts, and steps that count."""
BEST_SCALE = 2.38
"""Length of a step over the deviation, times the root of the number of parameters (Gelman, Roberts
& Gilks 1996)."""
SHARE = 0.05
"""Share of the steps that go anywhere in the prior, so that no walk stays on one of two peaks."""


@dataclass(frozen=True)
class Likelihood:
    """How well an observation agrees with some parameters.

    Normal, with the covariance of the observation plus the variance of the emulator.

    Attributes:
        emulator: The result as a function of the parameters.
        values: Observed values, shape (size,).
        covariance: Covariance of the observation and the model, shape (size, size).
    """

    emulator: Emulator | Part
    values: Floats
    covariance: Floats

    def misfit(self, place: Floats) -> float:
        """Squared misfit at some parameters, chi squared with as many degrees as there are values."""
        return float(self.prepared().at(place[None])[1][0])

    def prepared(self) -> _Whitened:
        """The same in coordinates in which the covariance is the unit matrix."""
        whole = self.covariance + self.emulator.rest
        root = np.linalg.cholesky(whole + 1e-10 * np.trace(whole) / len(whole) * np.eye(len(whole)))
        basis = np.asarray(np.linalg.solve(root, self.emulator.basis.T), np.float64)
        gap = np.asarray(np.linalg.solve(root, self.values - self.emulator.mean), np.float64)
        return _Whitened(self.emulator, basis, gap)


@dataclass(frozen=True)
class _Whitened:
    """A likelihood with a unit covariance.

    Attributes:
        emulator: Gives scores of the components.
        basis: The components, shape (size, components).
        gap: Observed values less the mean of the runs, shape (size,).
    """

    emulator: Emulator | Part
    basis: Floats
    gap: Floats

    def at(self, places: Floats) -> tuple[Floats, Floats]:
        """Logarithm of the likelihood and the squared misfit, each of shape (points,).

        The misfit is chi squared with as many degrees of freedom as the observation has values.
        """
        mean, variance = self.emulator.scores(places)
        left = self.gap - mean @ self.basis.T
        if not self.basis.shape[1]:
            misfit = np.full(len(places), float(self.gap @ self.gap))
            return -0.5 * misfit, misfit
        # (I + B V B^T)^-1 by the identity of Woodbury, one small system a point
        inner = np.eye(self.basis.shape[1]) + (self.basis.T @ self.basis)[None] * variance[:, None]
        seen = left @ self.basis
        solved = np.linalg.solve(inner.transpose(0, 2, 1), seen[..., None])[..., 0]
        misfit = (left**2).sum(axis=1) - (seen * variance * solved).sum(axis=1)
        return -0.5 * (misfit + np.linalg.slogdet(inner)[1]), misfit


@dataclass
class Posterior:
    """Parameters that agree with the observations.

    Attributes:
        places: Parameters in units of their priors, shape (samples, parameters).
        best: The most likely of them, shape (parameters,).
        mixing: Ratio of the variance over all walks to the variance within a walk, by parameter: the
            root is Gelman and Rubin's R, near 1 where the walks agree.
    """

    places: Floats
    best: Floats
    mixing: Floats


def sample(likelihood: Likelihood, parameters: int, seed: int) -> Posterior:
    """Sample the parameters by many walks after Metropolis, from starts drawn by their likelihood.

    Args:
        likelihood: Agreement with all observations.
        parameters: Number of parameters.
        seed: Seed of the walks: equal seeds give equal samples.
    """
    random = np.random.default_rng(seed)
    whole = likelihood.prepared()
    first = random.random((FIRST, parameters))
    logs = whole.at(first)[0]
    weights = np.exp(logs - logs.max())
    start = random.choice(FIRST, WALKS, p=weights / weights.sum())
    here, log_here = first[start], logs[start]
    kept: list[Floats] = []
    scale = np.sqrt(np.maximum(_variance(first, weights), 1e-8))
    for step in range(WARM + STEPS):
        if step in (WARM // 3, 2 * WARM // 3):
            recent = np.concatenate(kept[-WARM // 3 :])
            scale = np.maximum(recent.std(axis=0), 1e-4)
        jump = scale * BEST_SCALE / np.sqrt(parameters) * random.standard_normal(here.shape)
        anywhere = random.random(WALKS) < SHARE
        there = np.where(anywhere[:, None], random.random(here.shape), here + jump)
        inside = ((there >= 0) & (there <= 1)).all(axis=1)
        log_there = np.where(inside, whole.at(np.clip(there, 0, 1))[0], -np.inf)
        take = np.log(random.random(WALKS)) < log_there - log_here
        here = np.where(take[:, None], there, here)
        log_here = np.where(take, log_there, log_here)
        kept.append(here)
    walks = np.array(kept[WARM:])
    places = walks.reshape(-1, parameters)
    candidates = np.concatenate([first[np.argmax(logs)][None], places])
    best = candidates[int(np.argmax(whole.at(candidates)[0]))]
    return Posterior(places, best, _mixing(walks))


def _variance(places: Floats, weights: Floats) -> Floats:
    """Weighted variance of each column."""
    share = weights / weights.sum()
    return share @ (places - share @ places) ** 2


def _mixing(walks: Floats) -> Floats:
    """Gelman and Rubin's (1992) estimate of the variance over the variance within a walk."""
    steps = len(walks)
    within = walks.var(axis=0, ddof=1).mean(axis=0)
    between = steps * walks.mean(axis=0).var(axis=0, ddof=1)
    return ((steps - 1) / steps * within + between / steps) / np.maximum(within, 1e-300)
