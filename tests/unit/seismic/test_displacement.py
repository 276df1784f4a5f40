"""Permanent displacements: a record's table against the integrator, Jibson's equations by hand."""

import math

import numpy as np
import pytest

from cdem.seismic.displacement import slip_by_jibson, slip_of_record
from cdem.seismic.measures import newmark_slip
from cdem.seismic.processing import GRAVITY, of_acceleration


@pytest.fixture(scope="module")
def quake():
    """A burst of waves of two frequencies, stronger to one side."""
    t = np.arange(0, 12, 0.01)
    a = np.exp(-(((t - 5) / 2) ** 2)) * (np.sin(8 * t) + 0.4 * np.sin(17 * t) + 0.15)
    return of_acceleration(0.3 * GRAVITY * a / np.abs(a).max(), 0.01)


def test_slips_are_those_of_the_integrator(quake):
    yields = np.array([0.004, 0.02, 0.05, 0.11, 0.2, 0.27, 0.295])
    exact = [
        max(newmark_slip(sign * quake.acceleration, quake.step, k * GRAVITY) for sign in (1, -1))
        for k in yields
    ]
    found = slip_of_record(quake, yields)
    assert found[:6] == pytest.approx(exact[:6], rel=0.01)  # reached: 0.0017
    assert found[6] == pytest.approx(exact[6], abs=1e-5)


def test_no_slip_above_the_peak_and_no_number_without_strength(quake):
    found = slip_of_record(quake, np.array([0.31, np.inf, 0.0, -0.1, -np.inf, np.nan]))
    assert found[:2].tolist() == [0, 0] and np.isnan(found[2:]).all()
    found = slip_by_jibson(np.array([0.31, np.inf, 0.0, -0.1, np.nan]), 0.3)
    assert found[:2].tolist() == [0, 0] and np.isnan(found[2:]).all()


def test_jibson():
    # log D [cm] = 0.215 + log((1 - r)^2.341 r^-1.438), or -2.710 + log(...) + 0.424 M
    for r in (0.1, 0.5, 0.9):
        one = 0.215 + 2.341 * math.log10(1 - r) - 1.438 * math.log10(r)
        two = -2.710 + 2.335 * math.log10(1 - r) - 1.478 * math.log10(r) + 0.424 * 6.8
        assert slip_by_jibson(np.array([0.4 * r]), 0.4)[0] == pytest.approx(10**one / 100)
        assert slip_by_jibson(np.array([0.4 * r]), 0.4, 6.8)[0] == pytest.approx(10**two / 100)
