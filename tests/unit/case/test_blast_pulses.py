"""Pulses of blasts: rows of time and factor against their formulas."""

import math

import numpy as np
import pytest

from cdem.case.blast_pulses import (
    ERROR,
    friedlander,
    from_zero,
    highest_frequency,
    second_time,
    two_exponentials,
)

RISE, FALL = 0.2011797e-3, 0.5e-3  # of 0.5 and 0.1 ms [s]


def test_the_second_time_constant_gives_the_peak_its_time():
    """0.5 and 0.1 ms have their peak at ln 5 / (1 / 0.1 - 1 / 0.5) = 0.2011797 ms."""
    assert second_time(RISE, FALL) == pytest.approx(0.1e-3, rel=1e-6)
    assert second_time(0.999, 1) == pytest.approx(0.998, rel=1e-3)  # nearly t exp(-t)


def test_two_exponentials_are_followed_to_a_ten_thousandth_of_the_peak():
    rows = np.array(two_exponentials(RISE, FALL))
    t = np.linspace(0, 2 * rows[-1, 0], 100_001)
    second = 0.1e-3
    norm = math.exp(-RISE / FALL) - math.exp(-RISE / second)
    exact = (np.exp(-t / FALL) - np.exp(-t / second)) / norm
    assert np.abs(np.interp(t, *rows.T) - exact).max() < 1.01 * ERROR  # where it ends
    assert rows[:, 1].max() == pytest.approx(1, abs=1e-6)
    assert rows[0].tolist() == [0, 0]
    assert rows[-1, 1] == 0
    assert len(rows) < 400


@pytest.mark.parametrize(("decay", "suction"), [(0, False), (1.5, False), (1, True), (3, True)])
def test_friedlander_is_followed_too_with_and_without_suction(decay, suction):
    rows = np.array(friedlander(2e-3, decay, suction=suction))
    t = np.linspace(1e-7, 2 * rows[-1, 0], 100_001)
    exact = (1 - t / 2e-3) * np.exp(-decay * t / 2e-3)
    if not suction:
        exact = np.maximum(exact, 0)
    assert np.abs(np.interp(t, *rows.T) - exact).max() < 2 * ERROR
    assert rows[0].tolist() == [0, 0]
    assert (rows[:, 1].min() < 0) == suction


def test_a_pulse_that_begins_with_a_jump_gets_a_row_without_pressure_before_it():
    assert from_zero([(0, 0.0), (1, 1.0)]) == [(0, 0.0), (1, 1.0)]
    assert from_zero([(0, 1.0), (2, 0.5)]) == [(0, 0.0), (2e-6, 1.0), (2, 0.5)]
    assert from_zero([(3, 1.0)]) == [(3, 0.0), (3 + 1e-6, 1.0)]


def test_the_highest_frequency_follows_from_the_rise_or_after_a_jump_from_the_fall():
    assert highest_frequency(two_exponentials(RISE, FALL)) == pytest.approx(1 / (math.pi * RISE))
    jump = friedlander(2e-3, 0, suction=False)
    assert highest_frequency(jump) == pytest.approx(1 / (math.pi * 1e-3), rel=0.01)
    assert highest_frequency(from_zero([(0, 1.0), (1, 1.0)])) < 1  # it never falls
