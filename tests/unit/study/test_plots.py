"""Effects of parameters."""

from __future__ import annotations

import math

import pytest

from cdem.study.plots import effects


def test_effects_of_lists_and_of_drawn_values(study, table_of):
    """One at a time: the other parameter stays at its first value. Drawn: rank correlations."""
    alone = study(
        "parameters: {a: [1, 2, 4], b: [10, 30]}\ncombine: one-at-a-time\n"
        "set: {loads.gravity: [0, = a, = b]}\nresults: [f]"
    )
    assert effects(table_of(alone, lambda a, b: a * b), "f") == {"a": (10, 40), "b": (10, 30)}
    drawn = study(
        "parameters: {a: {uniform: {low: 1, high: 2}}, b: {uniform: {low: 0, high: 1}}}\n"
        "sampling: {count: 100}\nset: {loads.gravity: [0, = a, = b]}\nresults: [f]"
    )
    found = effects(table_of(drawn, lambda a, b: math.exp(-5 * a) + 1e-9 * b), "f")
    assert found["a"] == (0, pytest.approx(-1))  # however curved
    assert abs(found["b"][1]) < 0.3
