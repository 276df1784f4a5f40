"""Gaussian processes for the results of runs: values between runs, errors of runs left out."""

import numpy as np
import pytest

from cdem.fit.emulator import Emulator


def places(count: int, parameters: int) -> np.ndarray:
    return np.random.default_rng(5).random((count, parameters))


def test_a_smooth_result_is_predicted_between_its_runs():
    used = places(30, 2)
    x, y = used.T
    emulator = Emulator(used, np.column_stack([np.sin(2 * x) + y**2]), seed=1)
    new = np.array([[0.3, 0.4], [0.6, 0.7]])
    expected = np.sin(2 * new[:, 0]) + new[:, 1] ** 2
    assert emulator.at(new)[:, 0] == pytest.approx(expected, abs=5e-3)


def test_a_profile_is_predicted_by_its_components():
    used = places(25, 1)
    s = np.linspace(0, 1, 60)
    profiles = used * np.sin(3 * s) + used**2 * s  # two components are exact
    emulator = Emulator(used, profiles, seed=1)
    assert len(emulator.basis) <= 2
    expected = 0.5 * np.sin(3 * s) + 0.25 * s
    assert emulator.at(np.array([[0.5]]))[0] == pytest.approx(expected, abs=0.02)


def test_runs_left_out_are_predicted_as_by_a_process_without_them():
    """The closed form equals a fit without the run, with the same lengths of correlation."""
    used = places(12, 1)
    results = np.sin(5 * used)
    emulator = Emulator(used, results, seed=1)
    left_out = emulator.left_out()
    process = emulator._processes[0]
    from sklearn.gaussian_process import GaussianProcessRegressor

    for run in (0, 5):
        rest = np.arange(12) != run
        again = GaussianProcessRegressor(process.kernel_, optimizer=None)
        again.fit(used[rest], emulator._scores[rest, 0])
        mean, deviation = again.predict(used[run : run + 1], return_std=True)
        scale = emulator._scale[0] * emulator.basis[0, 0]
        error = emulator.mean[0] + mean[0] * scale - results[run, 0]
        assert left_out.error[run, 0] == pytest.approx(error, abs=1e-9)
        assert left_out.deviation[run, 0] == pytest.approx(deviation[0] * abs(scale), rel=1e-3)


def test_the_deviation_of_a_prediction_holds_for_runs_that_scatter():
    random = np.random.default_rng(2)
    used = places(80, 1)
    results = used + 0.1 * random.standard_normal((80, 1))
    left_out = Emulator(used, results, seed=1).left_out()
    assert left_out.rms == pytest.approx(0.1, rel=0.25)
    assert left_out.inside == pytest.approx(0.9, abs=0.08)


def test_a_result_that_never_changes_has_no_components():
    emulator = Emulator(places(9, 1), np.full((9, 3), 4.0), seed=1)
    assert emulator.at(np.array([[0.2]])).tolist() == [[4.0, 4.0, 4.0]]
    assert emulator.left_out().rms == 0
