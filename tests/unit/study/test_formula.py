"""Formulas of a study."""

from __future__ import annotations

import math

import pytest

from cdem.study.formula import Formula


def test_formula():
    assert Formula("= 2 * sin(30) + a.b ** 2").value({"a.b": 3}) == pytest.approx(10)
    assert Formula("= max(a, 2, 1) - atan2(1, 1)").value({"a": 50}) == pytest.approx(5)
    assert math.isnan(Formula("= 1 / a").value({"a": 0}))
    assert math.isnan(Formula("= (0 - 8) ** 0.5").value({}))
    with pytest.raises(ValueError, match="sin takes 1"):
        Formula("= sin(1, 2)")
    with pytest.raises(ValueError, match="phi is no number"):
        Formula("= phi").value({"phi": "10 deg"})
