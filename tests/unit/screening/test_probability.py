"""Probabilities: the same factors as the map with drawn values; searches of their own."""

import numpy as np
import pytest
from shared.hills import frustum, joint

from cdem.screening.bodies import Ground, Limits
from cdem.screening.fos_map import screen, screen_coarsely
from cdem.screening.loads import Loads
from cdem.screening.probability import evaluate, standard_error
from cdem.screening.uncertain import Uncertain

SETS = [joint("J1", 55, 135, 30, 20e3), joint("J2", 55, 225, 30, 20e3)]
LIMITS = Limits(200, 1e5, 26e3)


@pytest.fixture(scope="module")
def found():
    return screen(Ground(frustum(5.0)), SETS, LIMITS, stride=1)


def drawn(parameters, count=6):
    return Uncertain(uncertain=1, parameters=parameters,
                     sampling={"count": count, "method": "monte-carlo"})  # fmt: skip


def test_each_sample_is_a_screening_with_its_values(found):
    uncertain = drawn({
        "J1.friction_angle": {"uniform": {"low": 20, "high": 40}},
        "J2.cohesion": {"uniform": {"low": 0, "high": 40}, "unit": "kPa"},
        "water": {"uniform": {"low": 0, "high": 0.5}},
        "kh": {"uniform": {"low": 0, "high": 0.2}},
    })  # fmt: skip
    columns = uncertain.draw()
    told = []
    chance = evaluate(found, SETS, uncertain, columns, report=lambda *words: told.append(words))
    assert told[-1] == ("samples", 1.0) and chance.count == 6
    hits, worst = np.zeros(found.factor.shape), found.bodies[0]
    for number, one in enumerate(uncertain.samples(columns, SETS, found.loads)):
        again = screen(found.ground, one.planes, LIMITS, stride=1, loads=one.loads)
        assert chance.lowest[number] == pytest.approx(np.nanmin(again.factor))
        assert chance.unstable[number] == (again.factor < 1).mean()
        hits += again.factor < 1
        same = [b for b in again.every if (b.point == worst.point).all() and b.name == worst.name]
        assert chance.worst[number] == pytest.approx(same[0].factor)
    assert np.nan_to_num(chance.map) == pytest.approx(hits / 6)
    assert len(chance.listed) == len(found.bodies)
    assert ((chance.listed[:, 0] >= 0) & (chance.listed[:, 0] <= 1)).all()
    assert np.isfinite(chance.map).sum() == np.isfinite(found.factor).sum()


def test_searches_for_drawn_directions(found):
    uncertain = drawn({"J1.dip": {"uniform": {"low": 50, "high": 60}}}, 3)
    columns = uncertain.draw()
    chance = evaluate(found, SETS, uncertain, columns, stride=3)
    hits = np.zeros(found.factor.shape)
    for number, one in enumerate(uncertain.samples(columns, SETS, Loads())):
        alone = screen_coarsely(found.ground, one.planes, LIMITS, 3, Loads())
        assert chance.lowest[number] == np.nanmin(alone.factor)
        hits += alone.factor < 1
    assert np.nan_to_num(chance.map) == pytest.approx(hits / 3)
    assert np.isnan(chance.listed).all() and np.isnan(chance.worst).all()
    assert chance.target[0] == "the lowest F" and set(chance.influence()) == {"J1.dip"}


@pytest.mark.slow
def test_processes_find_the_same(found):
    uncertain = drawn({"J1.dip": {"uniform": {"low": 50, "high": 60}}}, 4)
    columns = uncertain.draw()
    one, two = (evaluate(found, SETS, uncertain, columns, stride=3, workers=n) for n in (1, 2))
    assert np.array_equal(one.map, two.map, equal_nan=True)
    assert (one.lowest == two.lowest).all() and (one.unstable == two.unstable).all()


def test_no_bodies(found):
    empty = screen(found.ground, SETS, Limits(1e7, 1e8, 26e3))
    uncertain = drawn({"J1.cohesion": {"uniform": {"low": 0, "high": 1}}}, 3)
    chance = evaluate(empty, SETS, uncertain, uncertain.draw())
    assert np.isnan(chance.lowest).all() and np.isnan(chance.map).all()
    assert (chance.unstable == 0).all() and chance.listed.shape == (0, 3)


def test_the_standard_error():
    assert standard_error(0.3, 84) == pytest.approx(0.05)
