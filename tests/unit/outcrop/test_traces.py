"""Lengths in windows, and ends that are seen."""

import numpy as np
import pytest
from shared.outcrops import ledges

from cdem.outcrop.extraction import extract
from cdem.outcrop.traces import ends_seen, mean_length


@pytest.mark.parametrize("law", ["exponential", "uniform"])
def test_the_mean_of_lengths_cut_by_a_window(law):
    """Mauldon (1998): twice the length over the ends, for any law and about any middle points."""
    random = np.random.default_rng(8)
    mean, wide, count = 5.0, 6.0, 40_000
    lengths = (
        random.exponential(mean, count)
        if law == "exponential"
        else (random.uniform(0, 2 * mean, count))
    )
    middle = random.uniform(-40, 46, count)
    low, high = middle - lengths / 2, middle + lengths / 2
    met = (high > 0) & (low < wide)
    inside = np.minimum(high, wide)[met] - np.maximum(low, 0)[met]
    found = mean_length(inside, np.column_stack([low > 0, high < wide])[met])
    assert found.mean == pytest.approx(mean, rel=0.06)
    assert found.naive < 0.8 * mean and found.traces == met.sum()


def test_no_end_seen():
    found = mean_length(np.array([2.0, 4.0]), np.zeros((2, 2), bool))
    assert (found.mean, found.naive, found.seen) == (np.inf, 3.0, 0)


def test_ends_at_steps_are_seen_and_ends_at_the_cut_are_not():
    x, _, _ = ledges(width=6, rows=4, mean=2.0, density=1500)
    found = extract(x)
    facets, seen = found.facets, ends_seen(found.points, found.facets, found.resolution)
    dips = np.degrees(np.arccos(facets.normals[:, 2]))
    tops = np.abs(dips - 30) < 1.5
    tops &= facets.lengths[:, 1] < 0.4
    right = []
    for k in np.flatnonzero(tops):
        sign = np.sign(facets.frames[k, 0, 0])
        ends = facets.centers[k, 0] + np.array([-1, 1]) * facets.lengths[k, 0] / 2
        own = seen[k] if sign > 0 else seen[k, ::-1]
        right += (own == [ends[0] > 0.1, ends[1] < 5.9]).tolist()
    assert len(right) > 12 and np.mean(right) > 0.9 and 0.5 < seen[tops].mean() < 1
