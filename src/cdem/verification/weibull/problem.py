"""Strength of bonds that differs from pair to pair: Weibull (1951)."""

import math

import numpy as np

from cdem.rows import rows_of

LENGTHS = (1, 2, 4, 8, 16)
"""Pairs in a chain."""


def theory(shape):
    """Standard deviation of strength over its mean."""
    mean = math.gamma(1 + 1 / shape)
    return math.sqrt(math.gamma(1 + 2 / shape) - mean**2) / mean


def strengths(simulation, strength, stiffness):
    """Tensile strength of every pair over the interface's, from when its bonds break."""
    pairs = simulation.build.assembly.counts["quads.count"]
    found, step = np.full(pairs, np.nan), simulation.core.scalars()["dt"]
    while np.isnan(found).any():
        simulation.step(1)
        bond = rows_of(simulation.core, "quads.bond").numbers
        pulled = stiffness * (simulation.step_count - 0.5) * step  # at 1 m/s, between two steps
        found[np.isnan(found) & (bond[:, 0] == 0)] = pulled / strength
    return found


def run(study):
    """Distribution of the strength of pairs, and of the weakest of N of them."""
    simulation = study.simulate()
    law = simulation.case.interfaces.pairs[0]
    shape = law.heterogeneity.weibull
    factors = strengths(simulation, law.tensile_strength, law.stiffness_n.value)
    drawn = simulation.build.arrays["quads.strength"][: len(factors)]
    spread = theory(shape)
    study.check("strength of a pair: measured over drawn, largest error", theory=0, within=2e-2,
                ours=np.abs(factors / drawn - 1).max(), absolute=True)  # fmt: skip
    count = len(factors)
    study.check("mean strength of a pair", theory=1, within=2 * spread / math.sqrt(count),
                ours=factors.mean())  # fmt: skip
    # a standard deviation varies by sqrt((kurtosis - 1) / 4n) of itself: kurtosis 2.88 at m = 5
    study.check("standard deviation of the strength of a pair", theory=spread,
                within=2 * math.sqrt((2.88 - 1) / 4 / count), ours=factors.std())  # fmt: skip
    weakest = []
    for length in LENGTHS:
        chains = factors[: count // length * length].reshape(-1, length).min(axis=1)
        weakest.append(chains.mean())
        if length > 1:
            study.check(f"mean strength of a chain of {length}", theory=length ** (-1 / shape),
                        within=2 * spread / math.sqrt(len(chains)), ours=chains.mean())  # fmt: skip
    ordered = np.sort(factors)
    study.curve("Strength of pairs", "strength over its mean", "share that has broken", {
        "theory": (ordered, 1 - np.exp(-((ordered * math.gamma(1 + 1 / shape)) ** shape))),
        ".pairs": (ordered, (np.arange(count) + 0.5) / count)})  # fmt: skip
    study.curve("Strength of chains", "pairs in a chain", "mean strength", {
        "theory": (LENGTHS, np.array(LENGTHS) ** (-1 / shape)), ".chains": (LENGTHS, weakest)})  # fmt: skip
