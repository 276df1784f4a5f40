"""Limit analysis of the verification problems: blocks whose limit is known by hand."""

from __future__ import annotations

import numpy as np
import pytest

from cdem.verification.masonry import course, linear_programme, tilt_limit, turning_limit

DEGREES = 180 / np.pi


@pytest.mark.parametrize("friction, exact", [(40, DEGREES * np.arctan(0.25)), (10, 10)])
def test_a_slender_block_topples_or_slides(friction, exact):
    assert tilt_limit([(0, 0, 1, 4, 1)], friction, 0) == pytest.approx(exact, abs=1e-3)


def test_three_on_one_another_topple_at_the_lowest_joint():
    tower = [(0, n, 1, 1, 1) for n in range(3)]
    exact = DEGREES * np.arctan(1 / 3)
    assert turning_limit(tower) == pytest.approx(exact)
    assert tilt_limit(tower, 40, 0) == pytest.approx(exact, abs=1e-3)


def test_a_wedge_of_running_bond():
    """By hand: 1, 2, ... 5 half blocks turn over the corner under the lowest half block."""
    wall = [(*box, 1) for n in range(6) for box in course(n, 0, 6, 2, 1, half=n % 2 == 1)]
    n = np.arange(1, 6)
    exact = DEGREES * np.arctan((n**2 / 2).sum() / (n * (n - 0.5)).sum())
    assert turning_limit(wall) == pytest.approx(exact)
    assert tilt_limit(wall, 45, 0) == pytest.approx(exact, abs=1e-3)
    assert tilt_limit(wall, 45, 45) > exact + 1  # head joints with friction hold it


def test_the_programme_without_a_solution_says_so():
    x = linear_programme(np.array([1.0, 2.0]), np.array([[1.0, 1.0]]), np.array([3.0]))
    assert x == pytest.approx([3, 0], abs=1e-4)
    with pytest.raises(ArithmeticError, match="does not converge"):
        linear_programme(np.array([1.0]), np.array([[1.0]]), np.array([-1.0]))
