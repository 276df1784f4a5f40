"""Interfaces: what a pair takes from the default, and what is refused."""

from __future__ import annotations

import pytest
import scenes
from shared.cases import INCLINE
from shared.joints import SETS, jointed_case

import cdem
from cdem import Case, CaseError
from cdem.case.types import AUTO, Stiffness


def test_a_pair_takes_what_it_does_not_say_from_the_default(write):
    case = Case.load(write(INCLINE))
    pair = case.interfaces.pairs[0]
    assert (pair.friction_angle, pair.cohesion) == (26, 10e3)
    assert pair.stiffness_n == Stiffness(2e9, relative=False)
    assert pair.stiffness_s == Stiffness(5, relative=True)
    assert case.interfaces.default.stiffness_n == AUTO
    case.set("interfaces.default.friction_angle", 20)
    case.set("interfaces.default.cohesion", 5)
    assert (pair.friction_angle, pair.cohesion) == (20, 10e3)


def test_a_pair_without_default_needs_a_friction_angle(write):
    text = INCLINE.replace('  default: {friction_angle: "26 deg", ', "  # {")
    with pytest.raises(
        CaseError, match=r"friction_angle is missing here and in interfaces.default"
    ):
        Case.load(write(text))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "stiffness_n: auto,",
            'stiffness_n: auto, dilation_angle: "30 deg",',
            "default: dilation_angle must not be larger than friction_angle, 26",
        ),
        (
            'name: base, cohesion: "10 kPa",',
            "name: base, dilation_angle: 5,",
            "pairs.0: dilation_angle needs dilation_slip",
        ),
        (
            "stiffness_n: auto,",
            "stiffness_n: auto, heterogeneity: {weibull: 5},",
            "default: heterogeneity varies bonds; it needs cohesion or tensile_strength above 0",
        ),
        (
            'name: base, cohesion: "10 kPa",',
            'name: base, cohesion: "10 kPa", heterogeneity: {weibull: 0.5},',
            "weibull: must be at least 1",
        ),
        (
            "stiffness_n: auto,",
            "stiffness_n: soft,",
            "must be auto, a number [Pa/m], '3 GPa/m' or '1 E/h', got 'soft'",
        ),
    ],
)
def test_mistakes_are_answered(complaint, old, new, message):
    assert message in complaint(old, new)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"interfaces.pairs": [{"cohesion": 1}]}, "give exactly one of between, joint"),
        ({"model.joints": SETS, "interfaces.pairs": [{"joint": "a"}] * 2}, "a is listed twice"),
    ],
)
def test_mistakes_about_joints_are_named(changes, message):
    with pytest.raises(cdem.CaseError) as error:
        jointed_case(changes)
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, (1, 1)),
        ({"restitution": 0.5}, (0.5, 1)),
        ({"restitution": {"tangential": 0.8}}, (1, 0.8)),
        ({"restitution": {"normal": "0.3", "tangential": 0.8}}, (0.3, 0.8)),
    ],
)
def test_restitution_is_one_number_or_two(given, expected):
    case = jointed_case({"interfaces.default": {"friction_angle": 30, **given}})
    assert case.interfaces.default.coefficients() == expected


def test_a_pair_takes_the_restitution_of_the_default():
    pairs = [{"joint": "a"}, {"joint": "b", "restitution": 0.9}]
    default = {"friction_angle": 30, "restitution": {"normal": 0.4}}
    case = jointed_case(
        {"model.joints": SETS, "interfaces.pairs": pairs, "interfaces.default": default}
    )
    assert case.interfaces.fixed()["restitution"] == [(0.4, 1), (0.9, 1), (0.4, 1)]


@pytest.mark.parametrize("value", [0.05, 1.01, -0.5, {"normal": 0.01}, {"shear": 0.5}, "high"])
def test_a_wrong_restitution_is_refused(value):
    with pytest.raises(CaseError, match="restitution"):
        jointed_case({"interfaces.default": {"friction_angle": 30, "restitution": value}})


@pytest.mark.parametrize(
    "setting",
    [
        {"interfaces.default.restitution": 0.5},
        {"interfaces.default.restitution": {"tangential": 0.5}},
        {"interfaces.default": {"friction_angle": 20}},
    ],
)
def test_a_stage_cannot_change_the_restitution(setting):
    stage = {"name": "late", "mode": "dynamic", "duration": 1, "set": setting}
    default = {"friction_angle": 30, "restitution": 0.7}
    with pytest.raises(CaseError, match="'restitution' of an interface is fixed at the start"):
        scenes.case(
            [{"group": "a", "box": {"size": [1, 1, 1]}}],
            {"a": {}},
            interfaces={"default": default},
            stages=[stage],
        )


def test_a_stage_cannot_change_how_strength_varies():
    setting = {"interfaces.default.heterogeneity": {"weibull": 5, "seed": 2}}
    default = {"friction_angle": 30, "cohesion": 1, "heterogeneity": {"weibull": 5}}
    with pytest.raises(CaseError, match="'heterogeneity' of an interface is fixed at the start"):
        scenes.case(
            [{"group": "a", "box": {"size": [1, 1, 1]}}],
            {"a": {}},
            interfaces={"default": default},
            stages=[{"name": "late", "mode": "dynamic", "duration": 1, "set": setting}],
        )


@pytest.mark.parametrize("value", [-0.1, 1, "2 m"])
def test_a_wrong_rolling_resistance_is_refused(value):
    with pytest.raises(CaseError, match="rolling_resistance"):
        jointed_case({"interfaces.default": {"friction_angle": 30, "rolling_resistance": value}})
