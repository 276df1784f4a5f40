"""Measures of motions against closed forms, and against numbers computed before the code."""

import math

import numpy as np
import pytest
from shared.signals import G, synthetic

from cdem.seismic.measures import (
    arias,
    fourier_amplitude,
    highest_frequency,
    measures,
    newmark_slip,
    oscillate,
    rotated_spectrum,
    spectrum,
)
from cdem.seismic.processing import of_acceleration


def test_measures_of_the_synthetic_record_are_as_computed_before():
    """PGA, PGV, Arias intensity, duration and CAV of waves/record.py."""
    _, a = synthetic()
    found = measures(of_acceleration(a, 0.005))
    assert found.pga / G == pytest.approx(0.36495, abs=1e-5)
    assert found.pgv == pytest.approx(0.32926, abs=1e-5)
    assert found.last_velocity == pytest.approx(-0.0096, abs=1e-4)
    assert found.arias == pytest.approx(1.76636, abs=1e-5)
    assert found.duration == pytest.approx(5.315, abs=1e-9)
    assert found.cav == pytest.approx(7.7178, abs=1e-4)


def test_the_spectrum_of_the_synthetic_record_is_as_computed_before():
    """Sa at 5 % by matrix exponentials."""
    _, a = synthetic()
    found = spectrum(a, 0.005, np.array([0.1, 0.2, 0.5, 1.0, 2.0])) / G
    np.testing.assert_allclose(found, [0.40801, 0.83673, 0.42788, 0.92173, 0.05397], atol=1e-5)


def test_an_oscillator_without_damping_doubles_a_step():
    """Largest displacement 2 a/w^2."""
    found = spectrum(np.ones(4001), 0.001, np.array([1.0]), 0.0)
    assert found[0] == pytest.approx(2, rel=1e-11)


def test_an_oscillator_follows_a_ramp_in_closed_form():
    """Undamped: u = -s (t - sin(w t)/w) / w^2."""
    t, w = np.arange(500) * 0.01, 2 * math.pi / 0.7
    found = oscillate(3 * t, 0.01, np.array([0.7]), 0.0)[:, 0]
    np.testing.assert_allclose(found, -3 * (t - np.sin(w * t) / w) / w**2, atol=1e-13)


def test_a_stiff_oscillator_moves_with_the_ground():
    """Below the shortest period of the motion the spectrum is its peak."""
    _, a = synthetic()
    assert spectrum(a, 0.005, np.array([0.005]))[0] == pytest.approx(np.abs(a).max(), rel=0.01)


def test_a_rotated_spectrum_does_not_depend_on_the_axes():
    """A motion along 30 deg: RotD100 is its own spectrum, RotD50 that times cos 45 deg."""
    _, a = synthetic()
    periods, c, s = np.array([0.2, 1.0]), math.cos(math.pi / 6), math.sin(math.pi / 6)
    middle, most = rotated_spectrum(c * a, s * a, 0.005, periods)
    own = spectrum(a, 0.005, periods)
    np.testing.assert_allclose(most, own, rtol=1e-12)
    np.testing.assert_allclose(middle, own / math.sqrt(2), rtol=1e-3)


def test_arias_intensity_of_a_sine():
    """pi/(2 g) times half the square of its amplitude in each second."""
    t = np.arange(10001) * 1e-3
    found = arias(2 * np.sin(2 * np.pi * t), 1e-3)[-1]
    assert found == pytest.approx(math.pi / (2 * G) * 20, rel=1e-9)


def test_fourier_amplitude_of_a_short_pulse_is_its_area():
    """At low frequencies."""
    pulse = np.zeros(1000)
    pulse[10:13] = 5
    f, amplitude = fourier_amplitude(pulse, 0.01)
    assert f[0] == 0 and amplitude[0] == pytest.approx(0.15) and amplitude[1] < 0.15


def test_the_highest_frequency_of_a_burst_is_just_above_its_own():
    """99 % of the energy of its velocity."""
    t = np.arange(4000) * 0.005
    burst = np.exp(-(((t - 10) / 3) ** 2)) * np.sin(2 * np.pi * 4 * t)
    assert highest_frequency(burst, 0.005) == pytest.approx(4.1, abs=0.1)


def test_the_slip_of_a_half_sine_is_the_closed_form():
    """0.5 g, 1 Hz, yield 0.2 g: 0.280944 m; samples every 0.2 ms are (w DT)^2/12 off."""
    w, peak, least = 2 * math.pi, 0.5 * G, 0.2 * G
    start = math.asin(least / peak) / w

    def speed(t):
        """Until the pulse is over, at 0.5 s."""
        return peak / w * (math.cos(w * start) - math.cos(w * t)) - least * (t - start)

    sine = (math.sin(w * 0.5) - math.sin(w * start)) / w
    during = (
        peak / w * (math.cos(w * start) * (0.5 - start) - sine) - least * (0.5 - start) ** 2 / 2
    )
    slip = during + speed(0.5) ** 2 / (2 * least)
    assert slip == pytest.approx(0.280945, abs=1e-6)
    t = np.arange(10001) * 2e-4
    pulse = np.where(t <= 0.5, 0.5 * G * np.sin(2 * np.pi * t), 0)
    assert newmark_slip(pulse, 2e-4, 0.2 * G) == pytest.approx(slip, rel=1e-6)


@pytest.mark.parametrize(
    ("dip", "friction", "slip", "turned"),
    [(0, 8, 0.08280, 0.09130), (10, 20, 0.04048, 0.04624),
     (20, 30, 0.04392, 0.05018), (30, 35, 0.33490, 0.35082)],
)  # fmt: skip
def test_slip_on_planes_under_the_synthetic_record(dip, friction, slip, turned):
    """As waves/record.py finds by small steps."""
    _, a = synthetic()
    least = G * math.tan(math.radians(friction - dip))
    factor = math.cos(math.radians(friction - dip)) / math.cos(math.radians(friction))
    assert factor * newmark_slip(a, 0.005, least) == pytest.approx(slip, abs=1e-5)
    assert factor * newmark_slip(-a, 0.005, least) == pytest.approx(turned, abs=1e-5)


def test_a_block_that_slides_at_the_end_of_a_record_comes_to_rest():
    """1 m/s2 above the yield for 1 s, then 1 m/s that the yield of 1 m/s2 stops: half a metre each."""
    assert newmark_slip(np.full(101, 2.0), 0.01, 1.0) == pytest.approx(1.0, rel=1e-12)
    assert newmark_slip(np.full(101, 2.0), 0.01, 0.0) == math.inf


def test_slip_with_stops_and_starts_inside_one_step():
    """A zigzag of samples every 0.5 s gives the slip of the same lines every 0.1 ms."""
    corners = np.array([0, 3, -4, 5, -20, 4, 4, -6, 1.0, 0])
    fine = np.interp(np.arange(45001) / 5000, np.arange(10), corners)
    coarse = newmark_slip(corners, 0.5, 1.0)
    assert coarse == pytest.approx(newmark_slip(fine, 1e-4, 1.0), rel=1e-9)
    assert newmark_slip(corners, 0.5, 10.0) == 0.0
