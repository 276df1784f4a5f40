"""The results of runs as a smooth function of their parameters: Gaussian processes.

A result is a vector: a number, or heights at many cells. Its principal components are emulated one
by one (Higdon, Gattiker, Williams & Rightley 2008, J. Am. Stat. Assoc. 103, 570-583).
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import BackendError

Floats = NDArray[np.float64]

KEPT = 0.999
"""Share of the variance of a result over the runs that its principal components keep."""
MOST_COMPONENTS = 8
RESTARTS = 2
LENGTHS = (0.2, 20.0)
"""Bounds of the lengths of correlation, in units of the range of a parameter."""
NOISE = (1e-8, 1.0)
"""Bounds of the variance of the scatter from run to run, over the variance of a component."""


@dataclass
class LeftOut:
    """Prediction of each run from all others.

    Attributes:
        error: Prediction less result, shape (runs, size of the result).
        deviation: Standard deviation of the prediction, the same shape.
    """

    error: Floats
    deviation: Floats

    @property
    def rms(self) -> float:
        """Root mean square of the error, in the unit of the result."""
        return float(np.sqrt((self.error**2).mean()))

    @property
    def inside(self) -> float:
        """Share of results within 1.645 deviations; 0.90 is right."""
        return float((np.abs(self.error) <= 1.645 * self.deviation).mean())


class Emulator:
    """A result as a function of the parameters.

    Args:
        places: Parameters of the runs in units of their ranges, shape (runs, parameters).
        results: Result of each run, shape (runs, size).
        seed: Seed of the search for the lengths of correlation.

    Attributes:
        mean: Mean result over the runs, shape (size,).
        basis: Principal components, shape (components, size).
        rest: Variance over the runs of what the components leave, shape (size,).

    Raises:
        BackendError: scikit-learn is not installed.
    """

    def __init__(self, places: Floats, results: Floats, seed: int) -> None:
        self.mean = results.mean(axis=0)
        self._results = results
        scores, self.basis = _components(results - self.mean)
        left = results - self.mean - scores @ self.basis
        self.rest = (left**2).sum(axis=0) / max(1, len(results) - 1)
        self._scale = scores.std(axis=0)
        self._scores = scores / self._scale
        self._processes = [_process(places, column, seed) for column in self._scores.T]

    def scores(self, places: Floats) -> tuple[Floats, Floats]:
        """Mean and variance of the scores of the components at some parameters.

        Args:
            places: Parameters in units of their ranges, shape (points, parameters).

        Returns:
            Two arrays of shape (points, components).
        """
        found = [process.predict(places, return_std=True) for process in self._processes]
        shape = (len(places), len(found))
        mean = np.array([mean for mean, _ in found]).T.reshape(shape)
        deviation = np.array([deviation for _, deviation in found]).T.reshape(shape)
        return mean * self._scale, (deviation * self._scale) ** 2

    def at(self, places: Floats) -> Floats:
        """The result at some parameters, shape (points, size)."""
        return self.mean + self.scores(places)[0] @ self.basis

    def part(self, columns: slice, scale: float) -> Part:
        """Some columns of the result, times a number."""
        left_out = self.left_out()
        return Part(
            self,
            self.mean[columns] * scale,
            self.basis[:, columns] * scale,
            self.rest[columns] * scale**2,
            LeftOut(left_out.error[:, columns] * scale, left_out.deviation[:, columns] * scale),
        )

    def left_out(self) -> LeftOut:
        """Leave-one-out prediction of each run (Rasmussen & Williams 2006, Eq. 5.12).

        The lengths of correlation and the components are of all runs.
        """
        scores, variances = np.zeros_like(self._scores), np.zeros_like(self._scores)
        for k, process in enumerate(self._processes):
            own = process.alpha * np.eye(len(self._scores))
            inverse = np.linalg.inv(process.kernel_(process.X_train_) + own)
            variances[:, k] = 1 / np.diag(inverse)
            scores[:, k] = self._scores[:, k] - (inverse @ self._scores[:, k]) * variances[:, k]
        found = self.mean + (scores * self._scale) @ self.basis
        spread = (variances * self._scale**2) @ self.basis**2 + self.rest
        return LeftOut(found - self._results, np.sqrt(spread))


@dataclass
class Part:
    """A part of a result, with the scores of the whole.

    Attributes:
        whole: Emulator of the whole.
        mean, basis, rest: As in `Emulator`.
        left_out: Prediction of each run from all others.
    """

    whole: Emulator
    mean: Floats
    basis: Floats
    rest: Floats
    left_out: LeftOut

    def scores(self, places: Floats) -> tuple[Floats, Floats]:
        """As `Emulator.scores`."""
        return self.whole.scores(places)

    def at(self, places: Floats) -> Floats:
        """The part at some parameters, shape (points, size)."""
        return self.mean + self.scores(places)[0] @ self.basis


def _components(results: Floats) -> tuple[Floats, Floats]:
    """Scores, shape (runs, components), and principal components, shape (components, size)."""
    u, s, vt = np.linalg.svd(results, full_matrices=False)
    if not s.any():
        return np.zeros((len(results), 0)), np.zeros((0, results.shape[1]))
    share = np.cumsum(s**2) / (s**2).sum()
    count = min(int(np.searchsorted(share, KEPT)) + 1, MOST_COMPONENTS)
    return u[:, :count] * s[:count], vt[:count]


def missing(error: ImportError) -> BackendError:
    """The error for a missing library of the extra `fit`."""
    return BackendError(f"a fit needs scikit-learn: pip install 'cdem[fit]' ({error})")


def _process(places: Floats, values: Floats, seed: int) -> Any:
    """A fitted Gaussian process of scikit-learn."""
    try:
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel
    except ImportError as error:
        raise missing(error) from None
    lengths = np.full(places.shape[1], 0.5)
    kernel = ConstantKernel(1.0, (1e-2, 1e3)) * Matern(lengths, LENGTHS, nu=2.5)
    process = GaussianProcessRegressor(
        kernel + WhiteKernel(1e-3, NOISE),
        n_restarts_optimizer=RESTARTS,
        random_state=seed % 2**32,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # a length at its bound
        return process.fit(places, values)
