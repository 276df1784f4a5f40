"""Passages of lines and largest values in cells, against closed forms."""

import numpy as np
import pytest

from cdem.rockfall.fall import COLUMNS
from cdem.rockfall.ground import Ground
from cdem.rockfall.maps import quantiles
from cdem.rockfall.tracks import Track, cells_of, crossings, passages

FLAT = Ground(-50.0, -50.0, np.array([5.0, 5.0]), np.zeros((31, 31)), np.zeros((30, 30), np.int16))


def track(t, places, velocity, **more):
    rows = np.zeros((len(t), len(COLUMNS)))
    rows[:, 0], rows[:, 1:4], rows[:, 4:7] = t, places, velocity
    for name, values in more.items():
        rows[:, COLUMNS.index(name)] = values
    return Track(rows, 100.0)


def test_a_throw_passes_at_the_height_of_its_parabola():
    """z = z0 + w t - g t2/2 at t = x/u, and v2 = u2 + (w - g t)2."""
    g, u, w = 9.81, 12.0, 5.0
    t = np.arange(0, 3, 0.01)
    z = 20 + w * t - g * t**2 / 2
    velocity = np.column_stack([u + 0 * t, 0 * t, w - g * t])
    path = track(t, np.column_stack([u * t, 1 + 0 * t, z]), velocity, bottom=-0.5, top=0.6,
                 rotation=40.0)  # fmt: skip
    found = passages(path, np.array([[17.3, -10.0], [17.3, 20.0]]), FLAT)
    when = 17.3 / u
    height = 20 + w * when - g * when**2 / 2
    assert len(found["time"]) == 1
    assert found["time"][0] == pytest.approx(when, abs=1e-9)
    assert found["height"][0] == pytest.approx(height, abs=g * 0.01**2 / 8 * 1.01)
    assert found["top"][0] - found["height"][0] == pytest.approx(0.6)
    assert found["bottom"][0] - found["height"][0] == pytest.approx(-0.5)
    assert found["along"][0] == pytest.approx(11.0)
    assert found["velocity"][0] == pytest.approx(np.hypot(u, w - g * when), rel=1e-6)
    assert found["energy"][0] == pytest.approx(50 * (u**2 + (w - g * when) ** 2) + 40, rel=1e-5)
    assert found["azimuth"][0] == pytest.approx(90.0)
    assert found["inclination"][0] == pytest.approx(
        np.degrees(np.arctan2(w - g * when, u)), abs=1e-3
    )


def test_the_height_normal_to_a_slope():
    z = np.repeat(np.arange(31)[None] * 5.0, 31, axis=0)  # rises by 45 deg to the east
    slope = Ground(-50.0, -50.0, np.array([5.0, 5.0]), z, np.zeros((30, 30), np.int16))
    path = track([0, 1], np.array([[0, 0, 52.0], [2, 0, 54.0]]), np.ones((2, 3)))
    found = passages(path, np.array([[1.0, -5], [1.0, 5]]), slope)
    assert found["height"][0] == pytest.approx(2.0)
    assert found["height_normal"][0] == pytest.approx(2.0 / np.sqrt(2))


def test_every_passage_counts_and_corners_count_once():
    line = np.array([[0.0, -10], [0.0, 0.0], [10.0, 10.0]])
    there_and_back = track(
        np.arange(4),
        np.array([[-1, -5, 0], [1, -5, 0], [-1, -5, 0], [-1, 30, 0.0]]),
        np.ones((4, 3)),
    )
    number, along = crossings(there_and_back, line)
    np.testing.assert_allclose(number, [0.5, 1.5])
    np.testing.assert_allclose(along, 5.0)
    corner = track([0, 1], np.array([[-1, 0, 0], [1, 0, 0.0]]), np.ones((2, 3)))
    assert len(crossings(corner, line)[0]) == 1
    beside = track([0, 1], np.array([[-1, -11, 0], [1, -11, 0.0]]), np.ones((2, 3)))
    assert not len(crossings(beside, line)[0])
    assert crossings(beside, np.zeros((2, 2)))[0].size == 0


def test_cells_have_the_largest_values_of_a_run():
    path = track(
        [0, 1, 2], np.array([[0.5, 0.5, 1], [3.5, 0.5, 2], [0.5, 0.5, 4.0]]),
        np.array([[1, 0, 0], [2, 0, 0], [3.0, 0, 0]]),
    )  # fmt: skip
    cells = cells_of(path, FLAT, np.zeros(2), 1.0, 10)
    assert cells.number.tolist() == [0, 1, 2, 3]
    assert cells.entries.tolist() == [2, 2, 2, 1]
    assert cells.height[0] == pytest.approx(4.0)
    assert cells.velocity.tolist() == sorted(cells.velocity, reverse=True)
    assert cells.energy[0] == pytest.approx(50 * 9.0)


def test_quantiles_in_cells_are_those_of_numpy():
    random = np.random.default_rng(3)
    number, of = random.integers(0, 12, 400), random.normal(size=400)
    found = quantiles(number, of, 13, 0.95, 30)
    for k in range(13):
        some = of[number == k]
        if len(some) < 30:
            assert np.isnan(found[k])
        else:
            assert found[k] == pytest.approx(np.quantile(some, 0.95), rel=1e-12)
