"""Layered ground under waves that go straight up."""

import numpy as np
import pytest

from cdem.seismic.site_response import (
    Layer,
    at_surface,
    deconvolved,
    surface_over_outcrop,
    surface_over_within,
)

GROUND = [Layer(10, 1900, 250, 0), Layer(20, 2000, 500, 0), Layer(30, 2200, 900, 0),
          Layer(0, 2600, 2000, 0)]  # fmt: skip
"""Ground of three layers."""


def ricker(step=0.002, count=8000, frequency=4.0, at=1.0):
    """A pulse with a peak of 1."""
    q = (np.pi * frequency * (np.arange(count) * step - at)) ** 2
    return (1 - 2 * q) * np.exp(-q)


@pytest.mark.parametrize(
    ("damping", "expected"),
    [(0.0, [1.2278, 6.25, 1.0, 6.25]), (0.05, [1.2226, 4.1871, 0.9640, 2.4936])],
)
def test_one_layer_amplifies_as_computed_before(damping, expected):
    """H 30 m, 300 m/s, 2000 over 1500 m/s, 2500 at 1, 2.5, 5, 7.5 Hz."""
    layers = [Layer(30, 2000, 300, damping), Layer(0, 2500, 1500, 0)]
    found = np.abs(surface_over_outcrop(layers, np.array([1, 2.5, 5, 7.5])))
    np.testing.assert_allclose(found, expected, atol=1e-4)
    if damping:
        within = np.abs(surface_over_within(layers, np.array([2.5])))
        assert within[0] == pytest.approx(12.763, abs=1e-3)


def test_one_layer_without_damping_is_the_closed_form():
    """1/sqrt(cos^2 kH + a^2 sin^2 kH) over the outcrop."""
    f = np.linspace(0.1, 20, 200)
    k, ratio = 2 * np.pi * f / 300, 2000 * 300 / (2500 * 1500)
    found = np.abs(surface_over_outcrop([Layer(30, 2000, 300, 0), Layer(0, 2500, 1500, 0)], f))
    expected = 1 / np.sqrt(np.cos(30 * k) ** 2 + ratio**2 * np.sin(30 * k) ** 2)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_peaks_of_three_layers_are_as_computed_before():
    """5.779, 5.664 and 4.219 at 3.183, 6.727 and 9.966 Hz."""
    found = np.abs(surface_over_outcrop(GROUND, np.array([3.183, 6.727, 9.966])))
    np.testing.assert_allclose(found, [5.779, 5.664, 4.219], atol=1e-3)


def test_a_layer_cut_in_two_is_the_same_ground():
    """Also with damping."""
    f = np.linspace(0.5, 15, 60)
    whole = [Layer(10, 1900, 250, 0.03), Layer(0, 2600, 2000, 0.01)]
    cut = [Layer(4, 1900, 250, 0.03), Layer(6, 1900, 250, 0.03), whole[1]]
    np.testing.assert_allclose(
        surface_over_outcrop(cut, f), surface_over_outcrop(whole, f), rtol=1e-12
    )


def test_a_deconvolved_surface_gives_back_the_wave():
    """Peak of the surface 6.4745; round trip 1.4e-9 of the peak."""
    wave = ricker()
    surface = at_surface(GROUND, wave, 0.002)
    assert np.abs(surface).max() == pytest.approx(6.4745, abs=1e-4)
    back, largest = deconvolved(GROUND, surface, 0.002, 20.0)
    assert np.abs(back - wave).max() < 5e-9 and largest == pytest.approx(0.5)


def test_deconvolution_of_damped_ground_grows_with_frequency_and_stops():
    """The factor is told; nothing is left above the highest frequency."""
    ground = [Layer(60, 1900, 200, 0.05), Layer(0, 2600, 2000, 0)]
    noise = np.random.default_rng(1).normal(size=4000)
    grown = [deconvolved(ground, noise, 0.005, f)[1] for f in (10.0, 20.0, 40.0)]
    assert grown[0] < grown[1] < grown[2] and grown[2] > 5
    left = deconvolved(ground, noise, 0.005, 10.0)[0]
    spectrum = np.abs(np.fft.rfft(left))
    assert spectrum[np.fft.rfftfreq(4000, 0.005) > 12].max() < 0.02 * spectrum.max()
