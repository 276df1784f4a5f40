"""Rows of large arrays: order, equality, and work in pieces."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cdem.mesh import arrays


@settings(deadline=None)
@given(st.integers(0, 2**32), st.integers(1, 5), st.sampled_from([1, 3, 1000, 2**30]))
def test_order_and_equality_of_rows_are_those_of_numpy(seed, columns, largest):
    """Numbers that need one key, and numbers that need several."""
    rng = np.random.default_rng(seed)
    table = rng.integers(-1, largest, (50, columns), endpoint=True)
    table[rng.integers(0, 50, 30)] = table[rng.integers(0, 50, 30)]
    assert (arrays.order_of_rows(table) == np.lexsort(table.T[::-1])).all()
    _, number = np.unique(table, axis=0, return_inverse=True)
    assert (arrays.same_rows(table) == number.reshape(-1)).all()


@pytest.mark.parametrize("largest", [0, 5, 2**40, 2**62])
def test_numbers_in_order_keep_the_order_of_equal_ones(largest):
    """Whether or not number and place fit into one."""
    rng = np.random.default_rng(1)
    keys = rng.integers(0, largest, 50, endpoint=True)
    keys[rng.integers(0, 50, 30)] = keys[rng.integers(0, 50, 30)]
    ordered, place = arrays.in_order(keys)
    assert (place == np.argsort(keys, kind="stable")).all()
    assert (ordered == np.sort(keys)).all()
    assert all(len(some) == 0 for some in arrays.in_order(keys[:0]))


def test_work_in_pieces_is_work_at_once(monkeypatch):
    monkeypatch.setattr(arrays, "PIECE", 7)
    a = np.arange(40.0).reshape(20, 2)
    assert (arrays.in_pieces(lambda x: x.sum(axis=1), a) == a.sum(axis=1)).all()
    assert arrays.in_pieces(lambda x: x.sum(axis=1), a[:0]).shape == (0,)
