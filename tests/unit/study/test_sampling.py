"""Lists and grids combined, and values drawn."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cdem.study.sampling import draw, quantile, rows
from cdem.study.schema import Parameter, Sampling


@pytest.mark.parametrize(
    ("combine", "expected"),
    [
        ("product", [(1, 5), (1, 6), (1, 7), (2, 5), (2, 6), (2, 7), (3, 5), (3, 6), (3, 7)]),
        ("together", [(1, 5), (2, 6), (3, 7)]),
        ("one-at-a-time", [(1, 5), (2, 5), (3, 5), (1, 6), (1, 7)]),
    ],
)
def test_lists_and_grids_combine(study, combine, expected):
    found = rows(
        study(
            "parameters: {a.b: [1, 2, 3], c.d: {grid: {first: 5, last: 7, count: 3}}}\n"
            f"combine: {combine}"
        ),
        [{}],
    )
    assert [(row["a.b"], row["c.d"]) for row in found] == expected


KINDS = {
    "uniform": ({"low": 2, "high": 4}, 3, 2 / math.sqrt(12)),
    "normal": ({"mean": 5, "deviation": 2}, 5, 2),
    "lognormal": ({"mean": 5, "deviation": 2}, 5, 2),
    "triangular": ({"low": 0, "mode": 1, "high": 5}, 2, math.sqrt((25 + 1 - 5) / 18)),
}


@pytest.mark.parametrize("kind", KINDS)
def test_latin_hypercube_takes_one_value_of_each_stratum(kind):
    """And so mean and deviation come close to those of the distribution."""
    numbers, mean, deviation = KINDS[kind]
    parameter = Parameter(**{kind: numbers})
    count = 200
    drawn = draw({"x": parameter, "y": parameter}, Sampling(count=count, seed=3))
    x, y = (np.array([row[name] for row in drawn]) for name in "xy")
    edges = [quantile(parameter, i / count) for i in range(count)] + [np.inf]
    for values in (x, y):
        assert (np.histogram(values, edges)[0] == 1).all()
        assert values.mean() == pytest.approx(mean, rel=0.01)
        assert values.std() == pytest.approx(deviation, rel=0.05)
    assert abs(np.corrcoef(x, y)[0, 1]) < 0.2  # the strata of two parameters meet at random


def test_draws_are_those_of_seed_and_method():
    parameters = {"x": Parameter(uniform={"low": 0, "high": 1})}
    latin = Sampling(count=50, seed=3)
    assert draw(parameters, latin) == draw(parameters, latin)
    assert draw(parameters, latin) != draw(parameters, Sampling(count=50, seed=4))
    free = [row["x"] for row in draw(parameters, Sampling(method="monte-carlo", count=50))]
    assert (np.histogram(free, 50, (0, 1))[0] != 1).any()


def test_limits_cut_a_distribution_off():
    normal = Parameter(normal={"mean": 0, "deviation": 1, "low": 0.5, "high": 1})
    assert quantile(normal, 0.0) == pytest.approx(0.5)
    assert quantile(normal, 0.999999) == pytest.approx(1, abs=1e-5)
    lognormal = Parameter(lognormal={"mean": 1, "deviation": 1, "low": 0.5})
    assert quantile(lognormal, 0.0) == pytest.approx(0.5)
