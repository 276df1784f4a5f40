"""Formulas of a study."""

from __future__ import annotations

import math

import pytest

from cdem.case.formula import Formula


def test_formula():
    assert Formula("= 2 * sin(30) + a.b ** 2").value({"a.b": 3}) == pytest.approx(10)
    assert Formula("= max(a, 2, 1) - atan2(1, 1)").value({"a": 50}) == pytest.approx(5)
    assert math.isnan(Formula("= 1 / a").value({"a": 0}))
    assert math.isnan(Formula("= (0 - 8) ** 0.5").value({}))
    with pytest.raises(ValueError, match="sin takes 1"):
        Formula("= sin(1, 2)")
    with pytest.raises(ValueError, match="phi is not a number"):
        Formula("= phi").value({"phi": "10 deg"})


@pytest.mark.parametrize(
    "text",
    ["= " + "-" * 5000 + "1", "= " + "-" * 900 + "1", "= " + "(" * 400 + "1" + ")" * 400,
     "= " + "sin(" * 150 + "1" + ")" * 150, "= 1" + " + 1" * 240, "= x\0"],
)  # fmt: skip
def test_formulas_that_nobody_writes_are_refused(text):
    with pytest.raises(ValueError, match=r"characters|operations in a row|not a formula"):
        Formula(text)


def test_a_formula_reaches_nothing_but_numbers():
    assert Formula("= a.__class__").names == {"a.__class__"}
    with pytest.raises(ValueError, match="is unknown"):
        Formula("= a.__class__").value({"a": 1.0})
    for text in ("= (1).real", "= [1][0]", "= (lambda: 1)()", "= __import__(a)", "= f'{a}'"):
        with pytest.raises(ValueError, match=r"formula is made of|is unknown"):
            Formula(text)
