"""Samples of parameters against posteriors in closed form."""

import numpy as np
import pytest

from cdem.fit.posterior import Likelihood, sample


class Line:
    """An exact emulator: the results are a matrix times the parameters."""

    def __init__(self, matrix: np.ndarray, variance: float = 0.0) -> None:
        self.basis = np.asarray(matrix, float).T
        self.mean = np.zeros(self.basis.shape[1])
        self.rest = np.zeros(self.basis.shape[1])
        self.variance = variance

    def scores(self, places):
        return places, np.full(places.shape, self.variance)


def likelihood(matrix, values, deviation, variance=0.0) -> Likelihood:
    values = np.asarray(values, float)
    return Likelihood(
        Line(np.asarray(matrix), variance), values, deviation**2 * np.eye(len(values))
    )


def test_one_parameter_and_one_value_give_a_normal_distribution():
    one = likelihood([[2.0]], [1.1], 0.1)
    found = sample(one, 1, seed=1)
    assert found.places.mean() == pytest.approx(0.55, abs=0.005)
    assert found.places.std() == pytest.approx(0.05, rel=0.06)
    assert found.best[0] == pytest.approx(0.55, abs=0.01)
    assert one.misfit(found.best) == pytest.approx(0, abs=0.05)
    assert found.mixing.max() < 1.2


def test_the_variance_of_the_emulator_widens_the_band():
    found = sample(likelihood([[2.0]], [1.0], 0.1, variance=0.05**2), 1, seed=1)
    assert found.places.std() == pytest.approx(np.hypot(0.1, 2 * 0.05) / 2, rel=0.06)


def test_two_observations_of_one_sum_leave_the_difference_open():
    """x + y is known to 0.02 / sqrt(2); x - y is as wide as the prior allows: |x - y| <= 1."""

    class Sum(Line):
        def scores(self, places):
            return places.sum(axis=1, keepdims=True), np.zeros((len(places), 1))

    both = Likelihood(Sum(np.ones((2, 1))), np.ones(2), 0.02**2 * np.eye(2))
    x, y = sample(both, 2, seed=3).places.T
    assert (x + y).std() == pytest.approx(0.02 / np.sqrt(2), rel=0.1)
    assert (x - y).std() == pytest.approx(2 / np.sqrt(12), rel=0.1)


def test_two_peaks_keep_their_weights():
    """(x - 0.5)^2 = 0.09: 0.2 and 0.8 are equally likely, and no walk stays on one of them."""

    class Bowl(Line):
        def scores(self, places):
            return (places - 0.5) ** 2, np.zeros(places.shape)

    emulator = Bowl(np.array([[1.0]]))
    found = sample(Likelihood(emulator, np.array([0.09]), np.array([[1e-4]])), 1, seed=1)
    assert (found.places < 0.5).mean() == pytest.approx(0.5, abs=0.1)


def test_equal_seeds_give_equal_samples():
    one = likelihood([[2.0]], [1.1], 0.1)
    assert (sample(one, 1, 7).places == sample(one, 1, 7).places).all()
    assert (sample(one, 1, 7).places != sample(one, 1, 8).places).any()


def test_correlated_errors_count_less_than_independent_ones():
    """Ten values with wholly correlated errors are one value."""
    matrix, values = np.ones((10, 1)), np.full(10, 0.5)
    whole = np.full((10, 10), 0.1**2) + 1e-9 * np.eye(10)
    found = sample(Likelihood(Line(matrix), values, whole), 1, seed=1)
    alone = sample(likelihood([[1.0]], [0.5], 0.1), 1, seed=1)
    assert found.places.std() == pytest.approx(alone.places.std(), rel=0.1)
