"""Twin experiments with the runs of a study: how often does a fit find the parameters of a run?

    python tools/fit_twins.py FIT.yaml --trials 20

One run after the other is left out. Its own results, with random errors as the fit file states them,
take the place of the observations; the other runs must find its parameters. Prints how many hidden
parameters lie within their 90 % band, and the mean width of the bands.
"""

import argparse
from dataclasses import replace

import numpy as np

from cdem.fit.find import find
from cdem.fit.fitting import Fit
from cdem.fit.runs import Runs, runs_of


def trial(runs: Runs, hidden: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Whether the band of each parameter holds the hidden value, and its width."""
    random = np.random.default_rng(seed)
    rest = np.arange(len(runs.used)) != hidden
    observed = [
        replace(one, values=random.multivariate_normal(result[hidden], one.covariance))
        for one, result in zip(runs.observed, runs.results, strict=True)
    ]
    others = replace(
        runs,
        used=runs.used[rest],
        observed=observed,
        results=[result[rest] for result in runs.results],
    )
    low, high = np.quantile(find(others, seed).samples, (0.05, 0.95), axis=0)
    return (low <= runs.used[hidden]) & (runs.used[hidden] <= high), high - low


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("fit", help="fit file of a finished study")
    parser.add_argument("--trials", type=int, default=20)
    asked = parser.parse_args()
    runs = runs_of(Fit.load(asked.fit))
    chosen = np.linspace(0, len(runs.used) - 1, min(asked.trials, len(runs.used))).astype(int)
    found = [trial(runs, int(hidden), seed) for seed, hidden in enumerate(chosen)]
    hits = np.sum([hit for hit, _ in found], axis=0)
    widths = np.mean([width for _, width in found], axis=0)
    print(f"{len(runs.used)} runs, {len(chosen)} trials")
    for k, prior in enumerate(runs.priors):
        before = np.ptp(prior.value(np.array([0.05, 0.95])))
        print(
            f"  {prior.name}: {hits[k]} of {len(chosen)} in the 90 % band; mean width {widths[k]:.3g}, "
            f"{before:.3g} before"
        )


if __name__ == "__main__":
    main()
