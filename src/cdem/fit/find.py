"""The fit of a study to observations: emulators, posterior, and doubts about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.fit.emulator import Emulator, Part, missing
from cdem.fit.observed import Observed
from cdem.fit.posterior import Likelihood, Posterior, sample
from cdem.fit.runs import Runs

Floats = NDArray[np.float64]

UNLIKELY = 0.01
"""An observation with a smaller chance of its misfit is not explained by the model."""
EDGE, MANY = 0.02, 0.10
"""More than this share of the samples within this share of an end of the prior gives a note."""
APART = 1.2
"""Largest variance over all walks, over the variance within one, without a note."""
TOO_SURE = 0.75
"""Least share of runs within the 90 % band of their prediction, without a note."""


@dataclass
class Found:
    """A fit.

    Attributes:
        runs: The runs and the observations.
        emulators: The part of each observation in the emulator of all.
        posterior: Parameters that agree with the observations.
        misfits: Squared misfit of each observation at the best parameters.
        notes: Messages for the user.
    """

    runs: Runs
    emulators: list[Part]
    posterior: Posterior
    misfits: list[float]
    notes: list[str] = field(default_factory=list)

    @property
    def samples(self) -> Floats:
        """Samples of the posterior in the units of the study, shape (samples, parameters)."""
        return self.values_of(self.posterior.places)

    def values_of(self, places: Floats) -> Floats:
        """Parameters from units of their priors, shape (points, parameters)."""
        columns = [p.value(places[:, k]) for k, p in enumerate(self.runs.priors)]
        return np.column_stack(columns)

    @property
    def chances(self) -> list[float]:
        """Chance of a misfit as large as the observed one, for each observation."""
        from scipy.stats import chi2

        sizes = [len(one.values) for one in self.runs.observed]
        pairs = zip(self.misfits, sizes, strict=True)
        return [float(chi2.sf(misfit, size)) for misfit, size in pairs]


def find(runs: Runs, seed: int) -> Found:
    """Find the parameters of a study that agree with observations.

    Args:
        runs: The runs and the observations.
        seed: Seed of the emulators and of the samples.

    Raises:
        BackendError: scikit-learn is not installed.
    """
    with _one_thread():  # small matrices: more threads would wait for one another
        whole, parts = emulate(runs, seed)
        observed = [
            Likelihood(part, one.values, one.covariance)
            for part, one in zip(parts, runs.observed, strict=True)
        ]
        posterior = sample(together(whole, runs.observed), len(runs.priors), seed)
        misfits = [one.misfit(posterior.best) for one in observed]
    found = Found(runs, parts, posterior, misfits, list(runs.notes))
    found.notes += doubts(found)
    return found


def emulate(runs: Runs, seed: int) -> tuple[Emulator, list[Part]]:
    """An emulator of all observations together, each over its deviation, and the part of each.

    A run that runs farther than its neighbours by chance does so in all its observations. Components
    of all together carry this: errors of one component are alike in all observations.
    """
    deviations = [one.deviation for one in runs.observed]
    pairs = zip(runs.results, deviations, strict=True)
    whole = Emulator(runs.places, np.hstack([values / d for values, d in pairs]), seed)
    ends = np.cumsum([0, *(len(one.values) for one in runs.observed)]).tolist()
    columns = [slice(a, b) for a, b in pairwise(ends)]
    return whole, [whole.part(c, d) for c, d in zip(columns, deviations, strict=True)]


def together(whole: Emulator, observed: Sequence[Observed]) -> Likelihood:
    """Agreement with all observations, whose own errors are independent of one another."""
    ends = np.cumsum([0, *(len(one.values) for one in observed)]).tolist()
    covariance = np.zeros((ends[-1], ends[-1]))
    for one, (a, b) in zip(observed, pairwise(ends), strict=True):
        covariance[a:b, a:b] = one.covariance / one.deviation**2
    values = np.concatenate([one.values / one.deviation for one in observed])
    return Likelihood(whole, values, covariance)


def _one_thread() -> Any:
    """Linear algebra on one thread."""
    try:
        from threadpoolctl import threadpool_limits
    except ImportError as error:  # comes with scikit-learn
        raise missing(error) from None
    return threadpool_limits(1)


def doubts(found: Found) -> list[str]:
    """Notes about a fit that should not be believed."""
    notes = []
    trio = zip(found.runs.observed, found.emulators, found.chances, strict=True)
    for one, part, chance in trio:
        left_out = part.left_out
        unit = f" {one.unit}" if one.unit else ""
        if left_out.rms > one.deviation:
            notes.append(
                f"{one.name}: runs are predicted to {left_out.rms:.3g}{unit}, worse than the "
                f"deviation of {one.deviation:.3g}: more runs give a narrower band"
            )
        if left_out.inside < TOO_SURE:
            notes.append(
                f"{one.name}: only {100 * left_out.inside:.0f} % of the runs lie within the 90 % band "
                "of their prediction: the band below is too narrow"
            )
        if chance < UNLIKELY:
            notes.append(
                f"{one.name}: no parameters of the study explain it (chance of the misfit "
                f"{chance:.1g}): the model lacks something, the ranges are too narrow, or its "
                "deviation is too small"
            )
    for k, prior in enumerate(found.runs.priors):
        places = found.posterior.places[:, k]
        for share, end in (((places < EDGE).mean(), 0.0), ((places > 1 - EDGE).mean(), 1.0)):
            if share > MANY:
                value = float(prior.value(np.array(end)))
                notes.append(
                    f"{prior.name}: lies at the end of its range, {value:.4g}; a wider study may "
                    "give more"
                )
        if found.posterior.mixing[k] > APART:
            notes.append(f"{prior.name}: the walks do not agree yet; another seed may differ")
    return notes
