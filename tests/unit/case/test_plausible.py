"""Values of a case that are unusual or impossible: where, what, what is usual, what was meant."""

from __future__ import annotations

import pytest
import yaml
from shared.cases import FALL

from cdem import Case, CaseError
from cdem.case.plausible import RANGES, range_of, written


def load(tmp_path, *settings: str) -> Case:
    """FALL with values replaced, from a file, so that lines are known."""
    file = tmp_path / "fall.yaml"
    file.write_text(FALL)
    return Case.load(file, settings)


def in_file(tmp_path, old: str, new: str) -> Case:
    file = tmp_path / "fall.yaml"
    assert old in FALL
    file.write_text(FALL.replace(old, new))
    return Case.load(file)


def test_a_usual_case_has_no_warnings(tmp_path):
    assert load(tmp_path).warnings == []


@pytest.mark.parametrize(
    ("old", "new", "place", "said"),
    [
        ("2700", "2.7", "2:20: materials.rock.density",
         '2.7 kg/m3 is not possible; usual is 500 kg/m3 to 8000 kg/m3; '
         'did you mean "2.7 t/m3"?'),
        ('"1 GPa"', "5", "2:35: materials.rock.young_modulus",
         '5 Pa is not possible; usual is 1 MPa to 1000 GPa; did you mean "5 GPa" or "5 MPa"?'),
        ("[0, 0, -10]", "[0, 0, -98000]", "5:9: loads.gravity", "98000 m/s2 is not possible"),
    ],
)  # fmt: skip
def test_the_impossible_is_refused(tmp_path, old, new, place, said):
    with pytest.raises(CaseError) as error:
        in_file(tmp_path, old, new)
    assert f"fall.yaml:{place}: {said}" in str(error.value)
    assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("friction_angle: 30", "friction_angle: 0.35",
         '4:24: interfaces.default.friction_angle: 0.35 deg is unusual; usual is 2 deg to 75 deg; '
         'did you mean "0.35 rad"?'),
        ("loads: {gravity: [0, 0, -10]}", "output: {every: 1}",
         "fall.yaml: loads.gravity: is not given, so there is no weight"),
        ("[0, 0, -10]", "[0, 0, 9.81]", "5:9: loads.gravity: [0, 0, 9.81] m/s2 points up"),
        ("[0, 0, -10]", "[0, -9.81, 0]", "has no downward part"),
        ('"5 ms"', '"5 ms", damping: {local: 0.99}', "stages.0.damping.local: 0.99 is unusual"),
        ('"5 ms"', '"5 ms", damping: {local: 0.8}', "0.8 in a dynamic stage slows every motion"),
        ("cohesion: 0", "cohesion: 10",
         '10 Pa is unusual; usual is 100 Pa to 100 GPa; did you mean "10 kPa" or "10 MPa"?'),
        ('"1 GPa"', '"2 kPa"', 'young_modulus: 2 kPa is unusual'),
    ],
)  # fmt: skip
def test_the_unusual_is_told(tmp_path, old, new, said):
    text = FALL.replace("output: {frames: false}\n", "").replace(old, new)
    assert new in text
    file = tmp_path / "fall.yaml"
    file.write_text(text)
    warnings = Case.load(file).warnings
    assert len(warnings) == 1
    assert said in warnings[0]


def test_no_gravity_on_purpose_is_not_told(tmp_path):
    assert in_file(tmp_path, "[0, 0, -10]", "[0, 0, 0]").warnings == []


def test_a_pair_is_not_told_what_the_default_was(tmp_path):
    data = yaml.safe_load(FALL)
    data["interfaces"] = {
        "default": {"friction_angle": 0.35},
        "pairs": [{"between": ["cube", "cube"], "cohesion": 1e6}],
    }
    assert [w.split(":")[1] for w in Case(**data).warnings] == [
        " interfaces.default.friction_angle"
    ]


def test_what_a_stage_sets_is_looked_at_too(tmp_path):
    stage = '"5 ms", set: {interfaces.default.friction_angle: 0.35, loads.gravity.2: 9.81}'
    told = in_file(tmp_path, '"5 ms"', stage).warnings
    assert len(told) == 2
    assert "stages.0.set: gives interfaces.default.friction_angle: 0.35 deg" in told[0]
    assert "stages.0.set: gives loads.gravity: [0, 0, 9.81] m/s2 points up" in told[1]
    with pytest.raises(CaseError, match=r"stages\.0\.set: gives loads\.gravity: 6000 m/s2"):
        in_file(tmp_path, '"5 ms"', '"5 ms", set: {loads.gravity.2: -6000}')


def test_an_override_is_named(tmp_path):
    told = load(tmp_path, "interfaces.default.friction_angle=0.35").warnings
    assert told[0].startswith("--set interfaces.default.friction_angle=0.35: interfaces.default")


@pytest.mark.parametrize("entry", RANGES, ids=lambda entry: entry.quantity)
def test_ranges_hold_one_another(entry):
    low, high = entry.usual
    assert low < high
    assert entry.judge(low) == entry.judge(high) == (False, "")
    assert range_of(entry.quantity) is entry
    assert entry.source
    if entry.possible:
        assert entry.possible[0] <= low
        assert entry.possible[1] >= high
        impossible, said = entry.judge(1.01 * entry.possible[1])
        assert impossible
        assert "is not possible" in said


def test_stresses_are_written_with_a_prefix():
    assert written(5e9, "Pa") == "5 GPa"
    assert written(-2500, "Pa/m") == "-2.5 kPa/m"
    assert written(2.7, "kg/m3") == "2.7 kg/m3"
    assert written(0.3, "1") == "0.3"


def test_stiffness_of_contacts_is_looked_at(tmp_path):
    (warning,) = load(tmp_path, "interfaces.default.contact_stiffness=5").warnings
    assert "contact_stiffness: 5 Pa/m is unusual" in warning
    assert load(tmp_path, "interfaces.default.contact_stiffness=0.3 E/h").warnings == []


def test_restitution_is_looked_at(tmp_path):
    (warning,) = load(tmp_path, "interfaces.default.restitution=0.08").warnings
    assert "restitution: 0.08 is unusual; usual is 0.1 to 1" in warning
    two = load(tmp_path, "interfaces.default.restitution={normal: 0.5, tangential: 0.06}").warnings
    assert "restitution.tangential: 0.06 is unusual" in two[0]


def test_a_number_far_beyond_all_units_is_answered_too(tmp_path):
    """1e22 GPa would be more than a number of a case may be."""
    with pytest.raises(CaseError, match=r"young_modulus: 1e\+13 GPa is not possible; usual is"):
        load(tmp_path, "materials.rock.young_modulus=1e22")


@pytest.mark.parametrize(
    "quantity, value, told",
    [
        ("density", 1e5, "100000 kg/m3 is unusual"),
        ("density", 2.7e7, "2.7e+07 kg/m3 is unusual"),
        ("density", 2.7e-9, "(is the whole model in mm, t, s?)"),
        ("gravity", 9810, "(is the whole model in mm, t, s?)"),
        ("Young's modulus", 1e4, "10 kPa is unusual"),
    ],
)
def test_scaled_densities_and_models_in_mm_are_warned_of(quantity, value, told):
    impossible, said = range_of(quantity).judge(value)
    assert not impossible and told in said
