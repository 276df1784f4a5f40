"""Which parameters agree with the observations: Bayes' rule, sampled by Metropolis' walk."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

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

    Normal errors of the scores of the components: those of the observation and those of the emulator.
    Parts of an observation that no component describes say nothing about the parameters.

    Attributes:
        emulator: The result as a function of the parameters.
        values: Observed values, shape (size,).
        covariance: Covariance of the observation and the model, shape (size, size).
    """

    emulator: Emulator | Part
    values: Floats
    covariance: Floats

    def at(self, places: Floats) -> Floats:
        """Logarithm of the likelihood at some parameters, shape (points,)."""
        mean, variance = self.emulator.scores(places)
        if not mean.shape[1]:
            return np.zeros(len(places))
        seen, own = self._seen
        left = seen - mean
        whole = own + variance[:, :, None] * np.eye(len(seen))
        solved = np.linalg.solve(whole, left[..., None])[..., 0]
        return -0.5 * ((left * solved).sum(axis=1) + np.linalg.slogdet(whole)[1])

    @cached_property
    def _seen(self) -> tuple[Floats, Floats]:
        """Scores of the observation, shape (components,), and their covariance."""
        project: Floats = np.asarray(np.linalg.pinv(self.emulator.basis.T), np.float64)
        return project @ (self.values - self.emulator.mean), project @ self.covariance @ project.T

    def misfit(self, place: Floats) -> float:
        """Squared misfit of the values, chi squared with as many degrees as there are values.

        Args:
            place: Parameters, shape (parameters,).
        """
        mean, variance = (one[0] for one in self.emulator.scores(place[None]))
        basis = self.emulator.basis
        whole = self.covariance + (basis.T * variance) @ basis + np.diag(self.emulator.rest)
        left = self.values - self.emulator.mean - mean @ basis
        return float(left @ np.linalg.solve(whole, left))


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
    first = random.random((FIRST, parameters))
    logs = likelihood.at(first)
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
        log_there = np.where(inside, likelihood.at(np.clip(there, 0, 1)), -np.inf)
        take = np.log(random.random(WALKS)) < log_there - log_here
        here = np.where(take[:, None], there, here)
        log_here = np.where(take, log_there, log_here)
        kept.append(here)
    walks = np.array(kept[WARM:])
    places = walks.reshape(-1, parameters)
    candidates = np.concatenate([first[np.argmax(logs)][None], places])
    best = candidates[int(np.argmax(likelihood.at(candidates)))]
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
