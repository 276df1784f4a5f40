"""Quantiles and their bands against the binomial distribution."""

import math

import numpy as np
import pytest

from cdem.rockfall.statistics import quantile_of, ranks_of, share_of, short


def at_most(k, n, p):
    return sum(math.comb(n, i) * p**i * (1 - p) ** (n - i) for i in range(k + 1))


@pytest.mark.parametrize(
    "count, level", [(10, 0.5), (59, 0.95), (200, 0.95), (200, 0.5), (500, 0.99)]
)
def test_ranks_are_the_narrowest_that_miss_with_a_fortieth_on_each_side(count, level):
    """P(true quantile < x_(r)) = P(B <= r - 1) and P(it > x_(s)) = 1 - P(B <= s - 1), B ~ Bin(n, p)."""
    below, above = ranks_of(count, level)
    assert below == 0 or at_most(below - 1, count, level) <= 0.025
    assert at_most(below, count, level) > 0.025
    assert above == count + 1 or 1 - at_most(above - 1, count, level) <= 0.025
    assert 1 - at_most(above - 2, count, level) > 0.025


def test_the_band_covers_the_true_quantile_as_often_as_it_says():
    random = np.random.default_rng(4)
    true, held = -math.log(0.05), 0
    for _ in range(1000):
        q = quantile_of(random.exponential(size=150), 0.95)
        held += q.low <= true and (q.high is None or true <= q.high)
    assert 0.94 <= held / 1000 < 0.98  # discrete: never less than it says


def test_a_small_sample_has_no_upper_bound():
    q = quantile_of(np.arange(20.0), 0.95)
    assert q.value == pytest.approx(18.05)
    assert q.high is None
    assert q.text().endswith("to ?)")
    one = quantile_of(np.array([3.0]), 0.5)
    assert (one.value, one.low, one.high) == (3.0, None, None)


def test_the_share_of_wilson():
    low, high = share_of(5, 50)  # Wilson's closed form by hand: 0.0435 to 0.2136
    assert (low, high) == (pytest.approx(0.0435, abs=1e-4), pytest.approx(0.2136, abs=1e-4))
    assert share_of(0, 10)[0] < 1e-15
    assert share_of(10, 10)[1] > 1 - 1e-15


def test_numbers_are_short():
    assert [short(v) for v in (0.12345, 999.4, 1234.5)] == ["0.123", "999", "1,234"]
