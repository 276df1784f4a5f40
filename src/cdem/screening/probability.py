"""Probability of failure of the bodies of a screening, by sampling of what is uncertain."""

from __future__ import annotations

import math
import multiprocessing
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.run.progress import clock
from cdem.screening.bodies import Ground, Limits, batches
from cdem.screening.fos_map import FosMap, screen_coarsely
from cdem.screening.planes import JointPlane
from cdem.screening.uncertain import Sample, Uncertain
from cdem.study.plots import rank_correlation
from cdem.terrain.heights import Grid

Floats = NDArray[np.float64]
Report = Callable[[str, float], None]

HIGHEST = 100.0
"""Larger factors of safety count as this one in means and deviations."""


@dataclass
class Probability:
    """What becomes of bodies in all samples.

    Attributes:
        uncertain: The distributions.
        columns: Drawn values of each parameter, in the units of the file, shape (samples,).
        map: Share of the samples in which a body with F < 1 covers a cell; nan where no body is.
        lowest: Lowest factor of safety of each sample; nan without a body.
        unstable: Share of the map that bodies with F < 1 cover, for each sample [1].
        worst: Factor of the worst body of the map in each sample; nan where directions are drawn.
        listed: Probability, mean factor and reliability index of each listed body, shape (bodies, 3);
            nan where directions are drawn.
    """

    uncertain: Uncertain
    columns: dict[str, Floats]
    map: Floats
    lowest: Floats
    unstable: Floats
    worst: Floats
    listed: Floats

    @property
    def count(self) -> int:
        """Number of samples."""
        return len(self.lowest)

    @property
    def target(self) -> tuple[str, Floats]:
        """The result that the influence refers to, with its name."""
        if np.isfinite(self.worst).any():
            return "F of the worst body", self.worst
        return "the lowest F", self.lowest

    def influence(self) -> dict[str, float]:
        """Rank correlation of each parameter with the target, the largest first."""
        target = self.target[1]
        known = np.isfinite(target)
        found = {n: rank_correlation(x[known], target[known]) for n, x in self.columns.items()}
        return dict(sorted(found.items(), key=lambda one: -abs(np.nan_to_num(one[1]))))


def standard_error(probability: float, count: int) -> float:
    """Standard error of a probability from independent samples [1]."""
    return math.sqrt(probability * (1 - probability) / count)


def evaluate(
    found: FosMap,
    planes: Sequence[JointPlane],
    uncertain: Uncertain,
    columns: dict[str, Floats],
    *,
    stride: int = 4,
    workers: int = 1,
    report: Report | None = None,
) -> Probability:
    """Evaluate the bodies of a map with drawn values.

    Where no direction is drawn the bodies of the map are evaluated; else each sample has a search of
    its own, at every `stride`-th cell.

    Args:
        found: The map.
        planes: Its sets.
        uncertain: The distributions.
        columns: Values drawn from them.
        stride: Cells between the points of the search.
        workers: Local processes for the searches; 1 for none.
        report: Called with a text and the fraction done.
    """
    samples = list(uncertain.samples(columns, planes, found.loads))
    if uncertain.turns:
        return _searched(found, uncertain, columns, samples, stride, workers, report)
    count, hits = len(samples), np.zeros(found.factor.shape, np.int64)
    lowest, unstable = np.full(count, np.nan), np.zeros(count)
    numbers = {id(body): k for k, body in enumerate(found.every)}
    of_list = [numbers[id(body)] for body in found.bodies]
    listed = np.empty((count, len(of_list)))
    parts = [(some, batch, [[p.name for p in planes].index(q.name) for q in batch.planes])
             for some, batch in batches(found.every)]  # fmt: skip
    factor = np.empty(len(found.every))
    for number, sample in enumerate(samples):
        tangents = np.array([plane.tangent for plane in sample.planes])
        cohesions = np.array([plane.cohesion for plane in sample.planes])
        for some, batch, of in parts:
            factor[some] = batch.factors(sample.loads, tangents[of], cohesions[of])[0]
        hit = np.zeros(hits.shape, bool)
        for k in np.flatnonzero(factor < 1).tolist():
            body = found.every[k]
            hit[body.window] |= body.cells
        hits += hit
        lowest[number], unstable[number] = factor.min(initial=np.inf), hit.mean()
        listed[number] = factor[of_list]
        if report:
            report("samples", (number + 1) / count)
    lowest[np.isinf(lowest)] = np.nan if not len(factor) else HIGHEST
    share = np.where(np.isfinite(found.factor), hits / count, np.nan)
    worst = listed[:, 0].copy() if len(of_list) else np.full(count, np.nan)
    return Probability(uncertain, columns, share, lowest, unstable, worst, _moments(listed))


def _moments(factors: Floats) -> Floats:
    """Probability, mean and reliability index of factors, shape (samples, bodies)."""
    bounded = np.minimum(factors, HIGHEST)
    mean = bounded.mean(axis=0)
    spread = bounded.std(axis=0, ddof=1) if len(factors) > 1 else np.zeros(len(mean))
    with np.errstate(divide="ignore", invalid="ignore"):
        index = np.where(spread > 1e-12, (mean - 1) / spread, np.nan)
    return np.stack([(factors < 1).mean(axis=0), mean, index], axis=1)


def _searched(
    found: FosMap,
    uncertain: Uncertain,
    columns: dict[str, Floats],
    samples: list[Sample],
    stride: int,
    workers: int,
    report: Report | None,
) -> Probability:
    """Results of a search for each sample."""
    shape, count = found.factor.shape, len(samples)
    hits, covered = np.zeros(shape, np.int64), np.isfinite(found.factor)
    lowest, unstable = np.full(count, np.nan), np.zeros(count)
    start = time.monotonic()
    for number, (least, bits, known) in enumerate(_searches(found, samples, stride, workers)):
        hit = np.unpackbits(bits, count=found.factor.size).reshape(shape).astype(bool)
        covered |= np.unpackbits(known, count=found.factor.size).reshape(shape).astype(bool)
        hits += hit
        lowest[number], unstable[number] = least, hit.mean()
        if report:
            done = (number + 1) / count
            left = clock((time.monotonic() - start) * (1 / done - 1))
            report(f"{number + 1:,} of {count:,} searches, {left} left", done)
    share = np.where(covered, hits / count, np.nan)
    nothing = np.full((len(found.bodies), 3), np.nan)
    worst = np.full(count, np.nan)
    return Probability(uncertain, columns, share, lowest, unstable, worst, nothing)


Searched = tuple[float, NDArray[np.uint8], NDArray[np.uint8]]
"""Lowest factor; bits of the cells with F < 1, and of those with a body."""


def _searches(
    found: FosMap, samples: list[Sample], stride: int, workers: int
) -> Iterator[Searched]:
    """The results of all samples, in their order."""
    limits, ground = found.limits, found.ground
    if workers == 1:
        for sample in samples:
            yield _one(ground, limits, stride, sample)
        return
    way = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(
        workers, mp_context=way, initializer=_prepare, initargs=(ground.grid, limits, stride)
    )
    try:
        yield from pool.map(_of_worker, samples)
    finally:
        pool.shutdown(cancel_futures=True)


def _one(ground: Ground, limits: Limits, stride: int, sample: Sample) -> Searched:
    factor = screen_coarsely(ground, sample.planes, limits, stride, sample.loads).factor
    known = np.isfinite(factor)
    least = float(np.min(factor[known])) if known.any() else math.nan
    with np.errstate(invalid="ignore"):
        return least, np.packbits(factor < 1), np.packbits(known)


_prepared: list[tuple[Ground, Limits, int]] = []
"""What a process of the pool works with."""


def _prepare(grid: Grid, limits: Limits, stride: int) -> None:
    _prepared.append((Ground(grid), limits, stride))


def _of_worker(sample: Sample) -> Searched:
    return _one(*_prepared[-1], sample)
