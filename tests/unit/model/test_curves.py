"""Times of curves that count from a stage."""

from __future__ import annotations

from cdem.model.curves import Curve, add_curve, constant


def test_without_a_stage_times_are_those_of_the_run():
    curve = Curve([-1.0, 1.0], [0.0, 2.0], None)
    assert curve.in_run({"shake": 5.0}) == ([-1.0, 1.0], [0.0, 2.0])
    assert curve.at_start == 1.0


def test_the_first_value_holds_until_the_stage_begins():
    curve = Curve([0.0, 0.5], [3.0, 2.0], "shake")
    assert curve.in_run({"rest": 0.0}) == ([0.0], [3.0])
    assert curve.in_run({"rest": 0.0, "shake": 4.25}) == ([4.25, 4.75], [3.0, 2.0])
    assert curve.at_start == 3.0


def test_a_load_without_history_has_the_constant():
    curves = constant()
    assert add_curve(None, None, curves) == 0
    assert add_curve([(0, 1), (1, 0)], "shake", curves) == 1
    assert curves[1] == Curve([0.0, 1.0], [1.0, 0.0], "shake")
