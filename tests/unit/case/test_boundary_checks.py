"""Checks of boundaries that need no mesh."""

import re

import pytest

from cdem.case.case import Case
from cdem.errors import CaseError

FOOT = {"surface": {"group": "a", "normal": [0, 0, -1]}}
SIDE = {"name": "side", "surface": {"group": "a", "normal": [1, 0, 0]}}
STAGES = [{"name": "rest", "mode": "static"}, {"name": "shake", "mode": "dynamic", "duration": 1}]
WAVE = {"samples": [0, 1, 2, 1, 0, -1, -2, -1, 0, 1, 0], "unit": "m/s", "step": 0.01, "scale": 0.1}


def case(*boundaries, stages=STAGES):
    """A cube with boundaries; the first is a quiet base with an input, unless it says otherwise."""
    data = {
        "model": {"blocks": [{"group": "a", "box": {"size": [1, 1, 1]}}]},
        "materials": {"r": {"density": 2600, "young_modulus": 1e10, "poisson_ratio": 0.2}},
        "groups": {"a": {"material": "r"}},
        "interfaces": {"default": {"friction_angle": 30}},
        "records": {"kobe": WAVE},
        "boundaries": list(boundaries),
        "stages": stages,
    }
    return Case.from_dict(data)


def base(**more):
    """A quiet base that begins with the shaking."""
    return {"name": "base", "quiet": True, "stage": "shake"} | FOOT | more


INPUT = {"record": "kobe", "direction": [1, 0, 0]}
WRONG = {
    "nothing": (base(quiet=False), "boundaries.0: does nothing: give quiet: true, free_field or"),
    "static": (base(stage="rest"), "boundaries.0.stage: base would begin with the static stage rest"),
    "no stage": (base(stage=None), "boundaries.0.stage: base would begin with the static stage rest"),
    "other stage": (base(stage="go"), "no stage 'go'; the case has: rest, shake"),
    "not quiet": (base(quiet=False, input=INPUT), "a compliant input needs a quiet base: write quiet"),
    "rigid": (base(input=INPUT | {"kind": "rigid"}), "is quiet and driven: leave out quiet, or write"),
    "direction": (base(input=INPUT | {"direction": [0, 0, 0]}), "direction must not be [0, 0, 0]"),
    "record": (base(input=INPUT | {"record": "x"}), "boundaries.0.input.record: no record 'x'"),
    "list": (base(input=[INPUT, INPUT | {"record": "x"}]), "boundaries.0.input.1.record: no record"),
    "motion": (base(quiet=False, input=INPUT | {"kind": "rigid", "motion": "outcrop"}),
               "motion has no effect with kind: rigid"),
    "twice": (base(quiet=False, input=[INPUT | {"kind": "rigid"}] * 2),
              "two rigid inputs move it along the same axis"),
    "group": (base(surface={"group": "b", "normal": [0, 0, 1]}), "boundaries.0.surface.group: no gr"),
}  # fmt: skip
SIDES = {
    "no base": (SIDE | {"free_field": {"base": "x"}, "stage": "shake"}, "no boundary 'x' beside this"),
    "itself": (SIDE | {"free_field": {"base": "side"}, "stage": "shake"}, "no boundary 'side' beside"),
    "stage": ({"free_field": {"base": "base"}, "stage": "again"} | SIDE, "base begins with another st"),
    "input": (SIDE | {"free_field": {"base": "base"}, "stage": "shake", "quiet": True, "input": INPUT},
              "a side with free_field takes its motion from the base"),
    "name": (SIDE | {"name": "base", "quiet": True, "stage": "shake"}, "'base' is the name of two"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_boundary_is_one_clear_line(name):
    boundary, told = WRONG[name]
    with pytest.raises(CaseError, match=re.escape(told)) as error:
        case(boundary)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("name", SIDES)
def test_a_wrong_side_is_one_clear_line(name):
    side, told = SIDES[name]
    stages = [*STAGES, {"name": "again", "mode": "dynamic", "duration": 1}]
    with pytest.raises(CaseError, match=re.escape(told)) as error:
        case(base(), side, stages=stages)
    assert "\n" not in str(error.value)


def test_a_side_of_a_side_is_refused():
    sides = [SIDE | {"free_field": {"base": "west"}, "stage": "shake"},
             {"name": "west", "surface": {"group": "a", "normal": [-1, 0, 0]}, "stage": "shake",
              "free_field": {"base": "base"}}]  # fmt: skip
    with pytest.raises(CaseError, match="west is a side itself"):
        case(base(), *sides)


def test_moduli_that_change_beside_columns_are_refused():
    band = {"ratio": 0.02, "band": [1, 10], "reference": 2}
    side = SIDE | {"free_field": {"base": "base"}, "stage": "shake"}
    for first, second in (
        ({}, {"maxwell": band}),
        ({"maxwell": band}, {"maxwell": band | {"ratio": 0.01}}),
    ):
        stages = [*STAGES[:1], STAGES[1] | {"damping": first},
                  {"name": "again", "mode": "dynamic", "duration": 1, "damping": second}]  # fmt: skip
        with pytest.raises(
            CaseError, match=r"stages\.2\.damping: the moduli of the ground would change"
        ):
            case(base(), side, stages=stages)
        stages[2]["damping"] = first
        case(base(), side, stages=stages)


@pytest.mark.parametrize(
    "given, moves",
    [
        ({"direction": [3, 0, 4]}, [0.3, 0, 0.4]),
        ({"direction": [0, -2, 0], "motion": "upgoing"}, [0, -1, 0]),
        ({"direction": [0, 5, 0], "kind": "rigid"}, [0, 1, 0]),
    ],
)
def test_an_outcrop_moves_twice_as_far_as_the_wave_below(given, moves):
    boundary = base(quiet=given.get("kind") != "rigid", input=INPUT | given)
    (found,) = case(boundary).boundaries[0].inputs
    assert found.motion_of_record == pytest.approx(moves)
