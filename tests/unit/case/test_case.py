"""Cases: what they accept, fill in, write back and change, and where they say things stand."""

from __future__ import annotations

import copy

import numpy as np
import pytest
from shared.cases import FALL, INCLINE

from cdem import Case, CaseError


def test_units_are_read_and_defaults_filled_in(write):
    case = Case.load(write(INCLINE))
    assert case.materials["granite"].young_modulus == 50e9
    assert case.materials["granite"].density == 2700
    assert case.groups["block"].velocity == [0, 0, 0.01]
    assert case.stages[0].tolerance == 1e-5
    assert case.stages[0].damping.local == 0.8
    assert case.stages[1].damping.local == 0
    assert case.stages[1].damping.contact == pytest.approx(0.1)
    assert case.contact.refresh == 50
    assert case.loads.tractions[0].history == [(0, 0), (1, 1)]
    assert case.loads.tractions[0].surface.group == "block"
    assert case.loads.velocities[0].surface == "lid"


def test_a_written_case_reads_the_same(write):
    case = Case.load(write(INCLINE))
    again = Case.load(write(case.dump()))
    assert again.model_dump() == case.model_dump()
    assert again.dump() == case.dump()
    again.set("interfaces.default.friction_angle", 20)  # inheritance survives writing
    assert again.interfaces.pairs[0].friction_angle == 20


def test_a_case_may_be_built_in_python_with_arrays():
    case = Case(
        model={"blocks": [{"group": "rock", "box": {"size": np.ones(3)}}]},
        materials={
            "granite": {"density": np.float64(2700), "young_modulus": 5e10, "poisson_ratio": 0.25}
        },
        groups={"rock": {"material": "granite"}},
        stages=[{"name": "fall", "mode": "dynamic", "duration": 1}],
    )
    case.groups["rock"].velocity = (1, 0, "2 km/h")
    assert case.groups["rock"].velocity[2] == pytest.approx(2 / 3.6)
    with pytest.raises(CaseError, match="title: must be a text, got a list"):
        case.title = [1]
    with pytest.raises(CaseError, match=r"^case: model: is missing"):
        Case.from_dict({"materials": {}, "groups": {}, "stages": []})


def test_where_finds_lines_and_columns(write):
    case = Case.load(write(INCLINE), ["time.safety=0.5"])
    assert case.where("materials.granite.density") == "slope.yaml:10:13"
    assert case.where("groups.block.velocity.1") == "slope.yaml:15:19"
    assert case.where("groups.block.gravity") == "slope.yaml:13:3"  # not written: the nearest
    assert case.where("stages.1.set.interfaces.base.cohesion") == "slope.yaml:31:12"
    assert case.where("time.safety") == "--set time.safety=0.5"


@pytest.mark.parametrize(
    ("path", "value", "read"),
    [
        ("loads.gravity.2", "-1 m/s2", lambda c: c.loads.gravity == [0, 0, -1]),
        ("loads.gravity", [0, 1, 0], lambda c: c.loads.gravity == [0, 1, 0]),
        ("stages.slide.duration", 3, lambda c: c.stages[1].duration == 3),
        ("interfaces.base.cohesion", "1 MPa", lambda c: c.interfaces.pairs[0].cohesion == 1e6),
        ("groups.bed.fix", ["z"], lambda c: c.groups["bed"].fix == ["z"]),
        ("model.split.bed", "one", lambda c: c.model.split["bed"] == "one"),
        ("loads.tractions.0.history.1.1", 2, lambda c: c.loads.tractions[0].history[1] == (1, 2)),
    ],
)
def test_set_changes_one_value(write, path, value, read):
    case = Case.load(write(INCLINE))
    case.set(path, value)
    assert read(case)


def test_an_override_is_blamed_for_what_it_made(write):
    with pytest.raises(CaseError, match=r"^--set tme.step=3: tme: unknown key; did you mean time"):
        Case.load(write(INCLINE), ["tme.step=3"])


def test_set_leaves_the_original_of_a_copy_alone(write):
    case = Case.load(write(INCLINE))
    other = copy.deepcopy(case)
    other.set("interfaces.base.cohesion", 0)
    assert case.interfaces.pairs[0].cohesion == 10e3


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("interfaces.bas.cohesion", 0, "no entry 'bas' in interfaces; it has: base, 0"),
        ("interfaces.pairs.3.cohesion", 0, "no entry '3' in interfaces.pairs; it has: base, 0"),
        ("loads.gravty", 0, "unknown key; did you mean gravity?"),
        ("interfaces.base.cohesion", -1, "interfaces.pairs.0.cohesion: must be at least 0"),
        ("interfaces.base.cohesion", "1 m", "wrong dimension"),
        ("loads.gravity.z", 1, "no entry 'z' in loads.gravity; it has: 0 to 2"),
        ("contact.check.deep", 1, "contact.check has no entries"),
        ("groups.block", {"material": "granite", "fx": []}, "unknown key; did you mean fix?"),
    ],
)
def test_set_refuses(write, path, value, message):
    case = Case.load(write(INCLINE))
    with pytest.raises(CaseError, match=message.replace("?", "[?]").replace("(", "[(]")):
        case.set(path, value)


def test_overrides_replace_values_and_make_mappings(write):
    case = Case.load(
        write(INCLINE),
        ["interfaces.base.friction_angle=12 deg", "time.mass_scaling.step=1 ms", "title=A = B"],
    )
    assert case.interfaces.pairs[0].friction_angle == 12
    assert case.time.mass_scaling.step == pytest.approx(1e-3)
    assert case.title == "A = B"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            '"50 GPa"',
            ".nan",
            "slope.yaml:10:34: materials.granite.young_modulus: must be a finite number",
        ),
        ('"50 GPa"', ".inf", "must be a finite number, got inf"),
        ('"50 GPa"', "1e400", "must be a finite number"),
        (
            "units: SI\n",
            "units: SI\nunits: SI\n",
            "slope.yaml:4:1: units: this key is given twice; keep one",
        ),
        ("groups:\n", "groups: [\n", "not valid YAML"),
    ],
)
def test_files_that_are_wrong_say_where_and_how_to_mend(complaint, old, new, message):
    assert message in complaint(old, new)


def test_all_problems_are_said_at_once_in_order(write):
    text = INCLINE.replace("0.25", "0.7").replace("mode: static", "mode: quick")
    with pytest.raises(CaseError) as caught:
        Case.load(write(text))
    assert [line.split(": ")[1] for line in str(caught.value).splitlines()] == [
        "materials.granite.poisson_ratio",
        "stages.0.mode",
    ]


def test_the_mesh_is_found_from_the_folder_of_the_case(write, tmp_path, monkeypatch):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "a.msh").touch()
    text = INCLINE.replace("  blocks:\n", "  mesh: a.msh\n  blocks:\n")
    (tmp_path / "sub" / "case.yaml").write_text(text)
    case = Case.load(tmp_path / "sub" / "case.yaml")
    assert case.path_of(case.model.mesh) == tmp_path / "sub" / "a.msh"
    assert Case.load(write(case.dump())).model.mesh == str(tmp_path / "sub" / "a.msh")


def test_blame_names_the_place(write):
    case = Case.load(write(INCLINE))
    message = r"^slope.yaml:6:7: model.blocks.0: no volume"
    with pytest.raises(CaseError, match=message), case.blame("model.blocks.0"):
        raise ValueError("no volume")


def test_schema_knows_units_and_refuses_unknown_keys():
    schema = Case.schema()
    modulus = schema["$defs"]["MaterialElastic"]["properties"]["young_modulus"]
    assert modulus["unit"] == "Pa"
    assert schema["$defs"]["MaterialElastic"]["additionalProperties"] is False
    assert "creep_rate" not in str(schema)

    def undescribed(name, part):
        return [
            f"{name}.{k}" for k, v in part.get("properties", {}).items() if not v.get("description")
        ]

    parts = {"case": schema} | schema["$defs"]
    assert [missing for name, part in parts.items() for missing in undescribed(name, part)] == []


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("interfaces.default.friction_angle", "interfaces.default is not given, so its entries"),
        ("groups.none.fix.0", "groups.none is not given, so its entries cannot change"),
        ("loads.gravity.²", "no entry '²' in loads.gravity; it has: 0 to 2"),
        (f"loads.gravity.{'9' * 900}", "in loads.gravity; it has: 0 to 2"),
    ],
)
def test_a_setting_of_what_is_not_there_is_answered(write, path, message):
    text = FALL.replace("interfaces: {default: {friction_angle: 30, cohesion: 0}}\n", "")
    with pytest.raises(CaseError) as caught:
        Case.load(write(text.replace('"5 ms"', f'"5 ms", set: {{"{path}": 1}}')))
    assert "stages.0.set." in str(caught.value) and message in str(caught.value)
    with pytest.raises(CaseError) as caught:
        Case.load(write(text)).set(path, 1)
    assert message in str(caught.value)
