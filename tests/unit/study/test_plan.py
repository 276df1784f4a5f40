"""The runs that follow from a study, and what knows them again."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from shared.cases import STATIC_FALL

import cdem
from cdem.errors import CaseError
from cdem.study.plan import plan
from cdem.study.study import Study

FRICTION = "interfaces.default.friction_angle"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            f"parameters: {{{FRICTION}: [10, 95]}}",
            f"study.yaml:2:14: {FRICTION} = 95: {FRICTION}: must lie in [0, 90) [deg], got 95",
        ),
        ("parameters: {loads.gravty: [0]}", "unknown key; did you mean gravity?"),
        ("parameters: {a: [1]}\nset: {loads.gravty: = a}", "study.yaml:3:7: loads.gravty: loads"),
        (
            f"parameters: {{{FRICTION}: [30]}}\n"
            "critical: {parameter: materials.rock.densty, between: [1, 2]}",
            "study.yaml:3:12: materials.rock.densty: densty: unknown key; did you mean density?",
        ),
    ],
)
def test_cases_that_are_wrong_stop_the_study_before_anything_runs(study, text, message, tmp_path):
    with pytest.raises(CaseError) as error:
        plan(study(text), tmp_path)
    assert message in str(error.value)


def test_a_critical_search_over_a_case_that_ends_in_motion_stops_the_study(study, tmp_path):
    text = f"parameters: {{{FRICTION}: [20]}}\ncritical: {{factor: true, between: [1, 2]}}"
    with pytest.raises(CaseError, match=r"cube.yaml:6.*the last stage must be static"):
        plan(study(text), tmp_path)
    (tmp_path / "cube.yaml").write_text(STATIC_FALL)
    assert len(plan(study(text), tmp_path)) == 1


def test_drawn_values_that_are_wrong_are_runs_that_failed(study, tmp_path):
    drawn = study(
        "parameters: {interfaces.default.cohesion: {normal: {mean: 0, deviation: 1}}}\n"
        "sampling: {count: 20}"
    )
    failed = [run for run in plan(drawn, tmp_path) if run.status == "failed"]
    assert len(failed) == 10  # one value in each twentieth of the distribution
    assert "must be at least 0 [Pa]" in failed[0].why


def test_formulas_and_units_reach_the_case(study, tmp_path):
    runs = plan(
        study(
            "parameters:\n"
            "  phi: [20, 40]\n"
            "  interfaces.default.cohesion: {values: [2], unit: kPa}\n"
            f"set: {{{FRICTION}: = atan(tan(phi) / 2), loads.gravity: [0, = -phi, 0]}}"
        ),
        tmp_path,
    )
    case = runs[1].task["case"]
    assert case["interfaces"]["default"]["cohesion"] == "2 kPa"
    half = math.degrees(math.atan(math.tan(math.radians(40)) / 2))
    assert case["interfaces"]["default"]["friction_angle"] == pytest.approx(half)
    assert case["loads"]["gravity"] == [0, -40.0, 0]


def test_identity_is_that_of_case_and_action(study, tmp_path):
    """The same case by another way is the same run; another title of the study changes nothing."""
    (tmp_path / "cube.yaml").write_text(STATIC_FALL)
    [one] = plan(study(f"parameters: {{{FRICTION}: [20]}}"), tmp_path)
    [same] = plan(
        study(f"title: x\nparameters: {{a: [10]}}\nset: {{{FRICTION}: = 2 * a}}"), tmp_path
    )
    [other] = plan(study(f"parameters: {{{FRICTION}: [21]}}"), tmp_path)
    [sought] = plan(
        study(f"parameters: {{{FRICTION}: [20]}}\ncritical: {{factor: true, between: [1, 2]}}"),
        tmp_path,
    )
    assert one.identity == same.identity
    assert len({run.identity for run in (one, other, sought)}) == 3


def test_a_mesh_counts_by_what_it_holds(tmp_path):
    """Another folder is the same run; another mesh in a file of the same name is not."""
    home = Path(cdem.__file__).parent / "templates"

    def identity(folder: str, more: str) -> str:
        (tmp_path / folder).mkdir()
        for name in ("landslide.yaml", "slope.msh"):
            (tmp_path / folder / name).write_text((home / name).read_text() + more)
        study = Study(
            case=str(tmp_path / folder / "landslide.yaml"), parameters={"time.safety": [0.5]}
        )
        return plan(study, tmp_path)[0].identity

    assert identity("a", "") == identity("b", "") != identity("c", "\n")
