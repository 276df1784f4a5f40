"""The motion of the ground over a line source."""

from types import SimpleNamespace

import numpy as np
import pytest

from cdem.verification.line_source import DEPTH, HOLE, half_plane, motion

ROCK = SimpleNamespace(young_modulus=25e9, poisson_ratio=0.25, density=2500.0)


def test_the_ground_comes_to_rest_as_equilibrium_demands():
    """4 (1 - nu) times the displacement of an endless rock, M r / (2 pi rho c_p² r²)."""
    x, pressure = 75.0, 1e7
    moment = pressure * np.pi * HOLE**2 * 3
    whole = moment * np.array([x, DEPTH]) / (2 * np.pi * 30e9 * (x * x + DEPTH**2))
    assert motion(ROCK, pressure, x, np.array([100.0]))[:, 0] == pytest.approx(3 * whole, rel=1e-3)


@pytest.mark.parametrize(
    ("x", "axis", "peak", "time"),
    [
        (25.0, 0, 0.17486e-3, 32.7e-3),
        (150.0, 0, 0.15577e-3, 61.1e-3),
        (0.0, 1, 0.35212e-3, 30.9e-3),
    ],
)
def test_peaks_are_those_of_an_integral_over_wave_numbers(x, axis, peak, time):
    """Computed before, with the formula checked against that integral to 1e-5; M of 1 GN."""
    t = np.arange(0, 0.09, 1e-4)
    u = motion(ROCK, 1e9 / (3 * np.pi * HOLE**2), x, t)[axis]
    assert u.max() == pytest.approx(peak, rel=1e-4)
    assert t[u.argmax()] == pytest.approx(time, abs=1.5e-4)


def test_nothing_moves_before_the_p_wave():
    assert not motion(ROCK, 1e7, 50.0, np.array([0.0, 0.02])).any()


def test_the_mesh_has_one_hole_and_no_gap():
    plane = half_plane(2.5, 50.0, 30.0)
    x = plane.points[plane.quads]
    diagonals = x[:, 2] - x[:, 0], x[:, 3] - x[:, 1]
    area = 0.5 * (diagonals[0][:, 0] * diagonals[1][:, 1] - diagonals[0][:, 1] * diagonals[1][:, 0])
    assert (area > 0).all()
    polygon = 16 * 0.5 * np.sin(np.pi / 16)
    assert area.sum() == pytest.approx(50 * 80 - polygon)
