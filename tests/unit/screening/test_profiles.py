"""Plane failure of profiles against the triangle below a long face."""

import numpy as np
import pytest
from shared.hills import joint

from cdem.screening.bodies import Ground, Limits
from cdem.screening.profiles import screen_profiles
from cdem.terrain.heights import Grid

HEIGHT, FACE, DIP = 40.0, 60.0, 35.0
ALL = Limits(0, 1e9, 26e3)


def bench(cell, azimuth):
    """A face that dips to an azimuth, flat ground above and below."""
    x = np.arange(-120, 120 + cell / 2, cell)
    down = np.array([np.sin(np.radians(azimuth)), np.cos(np.radians(azimuth))])
    away = x[None] * down[0] + x[:, None] * down[1]
    return Ground(Grid(-120, -120, (cell, cell), np.clip(HEIGHT / 2 - away * np.tan(np.radians(FACE)), 0, HEIGHT)))  # fmt: skip


@pytest.mark.parametrize("azimuth", [90.0, 200.0])
def test_a_triangle_from_the_toe(azimuth):
    # Hoek & Bray: area H^2 / 2 (cot dip - cot face), length H / sin dip
    ground = bench(0.5, azimuth)
    plane = joint("a", DIP, azimuth, 28, 30e3)
    found = screen_profiles(ground, [plane], ALL)
    dip, face = np.radians(DIP), np.radians(FACE)
    area = HEIGHT**2 / 2 * (1 / np.tan(dip) - 1 / np.tan(face))
    held = 30e3 * HEIGHT / np.sin(dip) + 26e3 * area * np.cos(dip) * plane.tangent
    middle = found.factor[200:280, 200:280]
    assert np.nanmin(middle) == pytest.approx(held / (26e3 * area * np.sin(dip)), rel=0.02)
    assert set(np.unique(found.set_of)) == {0, 1} and found.count > 100


def test_friction_only_and_the_ways_that_do_not_daylight():
    ground = bench(2.0, 90.0)
    sets = [joint("a", DIP, 90, 28), joint("steep", 65, 90, 20), joint("back", 35, 270, 20)]
    found = screen_profiles(ground, sets, ALL)
    factors = found.factor[np.isfinite(found.factor)]
    assert factors == pytest.approx(np.tan(np.radians(28)) / np.tan(np.radians(DIP)), rel=1e-12)
    assert (found.set_of[np.isfinite(found.factor)] == 1).all()


def test_volumes_as_wide_as_long():
    ground = bench(2.0, 90.0)
    plane = joint("a", DIP, 90, 28, 30e3)
    plan = HEIGHT / np.tan(np.radians(DIP))
    volume = plan * HEIGHT / 2 * (plan - HEIGHT / np.tan(np.radians(FACE)))
    assert screen_profiles(ground, [plane], Limits(1.2 * volume, 1e9, 26e3)).count == 0
    some = screen_profiles(ground, [plane], Limits(0.7 * volume, 1e9, 26e3)).count
    every = screen_profiles(ground, [plane], ALL).count
    assert 0 < some < every


def test_profiles_that_leave_the_map_do_not_count():
    x = np.arange(0, 100, 2.0)
    rising = Ground(Grid(0, 0, (2, 2), np.tile(-np.tan(np.radians(50)) * x, (50, 1))))
    assert screen_profiles(rising, [joint("a", 35, 90, 20)], ALL).count == 0
