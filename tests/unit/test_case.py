"""Cases: what they accept, fill in, write back, and how they say what is wrong."""

from __future__ import annotations

import copy

import numpy as np
import pytest

from cdem import Case, CaseError
from cdem.case.types import Stiffness

CASE = """\
cdem: 1
title: Block on an incline
units: SI
model:
  blocks:
    - {group: bed, box: {size: [10, 4, 1], divisions: [10, 4, 1]}}
    - {group: block, polyhedron: {vertices: [[0, 0, 1], [1, 0, 1], [0, 1, 1], [0, 0, 2]]}}
  split: {block: elements, bed: connected}
materials:
  granite: {density: "2.7 t/m3", young_modulus: "50 GPa", poisson_ratio: 0.25, law: elastic}
groups:
  bed: {material: granite, fix: [x, y, z]}
  block:
    material: granite
    velocity: [0, 0, "1 cm/s"]
interfaces:
  default: {friction_angle: "26 deg", stiffness_n: auto, stiffness_s: "5 E/h"}
  pairs:
    - {between: [bed, block], name: base, cohesion: "10 kPa", stiffness_n: "2 GPa/m"}
loads:
  gravity: [0, 0, -9.81]
  tractions:
    - {surface: {group: block, normal: [1, 0, 0]}, traction: [1, 0, 0], history: [[0, 0], [1, 1]]}
  velocities:
    - {surface: lid, components: [x], velocity: [1, 0, 0]}
  supports:
    - {box: {min: [0, 0, 0], max: [1, 1, 1]}, group: bed, fix: [z]}
stages:
  - {name: settle, mode: static}
  - {name: slide, mode: dynamic, duration: "2 s", damping: {contact: "10 %"},
     set: {interfaces.base.cohesion: 0, loads.gravity.2: -5}}
contact: {refresh: 50}
histories:
  - {name: toe, point: [0, 0, 0], quantities: [displacement]}
"""


@pytest.fixture
def write(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def write(text: str) -> str:
        (tmp_path / "slope.yaml").write_text(text)
        return "slope.yaml"

    return write


def test_units_are_read_and_defaults_filled_in(write):
    case = Case.load(write(CASE))
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


def test_a_pair_takes_what_it_does_not_say_from_the_default(write):
    case = Case.load(write(CASE))
    pair = case.interfaces.pairs[0]
    assert (pair.friction_angle, pair.cohesion) == (26, 10e3)
    assert pair.stiffness_n == Stiffness(2e9, relative=False)
    assert pair.stiffness_s == Stiffness(5, relative=True)
    assert case.interfaces.default.stiffness_n.as_pair() == (0, 10)
    case.set("interfaces.default.friction_angle", 20)
    case.set("interfaces.default.cohesion", 5)
    assert (pair.friction_angle, pair.cohesion) == (20, 10e3)


def test_a_pair_without_default_needs_a_friction_angle(write):
    text = CASE.replace('  default: {friction_angle: "26 deg", ', "  # {")
    with pytest.raises(CaseError, match=r"friction_angle is missing, and so is interfaces.default"):
        Case.load(write(text))


def test_a_written_case_reads_the_same(write):
    case = Case.load(write(CASE))
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
    case = Case.load(write(CASE), ["time.safety=0.5"])
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
    case = Case.load(write(CASE))
    case.set(path, value)
    assert read(case)


def test_wrong_names_are_reported_beside_other_mistakes(write):
    """A key, a value, a group of a pair, a group of a block and a stage's setting, all at once."""
    text = CASE.replace("law: elastic", "lwa: elastic").replace("fix: [x, y, z]", "fix: x")
    text = text.replace("between: [bed, block]", "between: [bed, blok]")
    with pytest.raises(CaseError) as error:
        Case.load(write(text.replace("{group: block, poly", "{group: blok, poly")))
    lines = str(error.value).splitlines()
    assert [line.split(": ")[1] for line in lines] == [
        "model.blocks.1.group",
        "materials.granite.lwa",
        "groups.bed.fix",
        "interfaces.pairs.0.between.1",
    ]
    with pytest.raises(CaseError) as error:
        text = CASE.replace("between: [bed, block]", "between: [bed, blok]")
        Case.load(write(text.replace("interfaces.base.cohesion: 0", "interfaces.base.cohesion: x")))
    assert len(str(error.value).splitlines()) == 2


def test_an_override_is_blamed_for_what_it_made(write):
    with pytest.raises(CaseError, match=r"^--set tme.step=3: tme: unknown key; did you mean time"):
        Case.load(write(CASE), ["tme.step=3"])


def test_set_leaves_the_original_of_a_copy_alone(write):
    case = Case.load(write(CASE))
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
        ("contact.check.deep", 1, "contact.check has nothing inside"),
        ("groups.block", {"material": "granite", "fx": []}, "unknown key; did you mean fix?"),
    ],
)
def test_set_refuses(write, path, value, message):
    case = Case.load(write(CASE))
    with pytest.raises(CaseError, match=message.replace("?", "[?]").replace("(", "[(]")):
        case.set(path, value)


def test_overrides_replace_values_and_make_mappings(write):
    case = Case.load(
        write(CASE),
        ["interfaces.base.friction_angle=12 deg", "time.mass_scaling.step=1 ms", "title=A = B"],
    )
    assert case.interfaces.pairs[0].friction_angle == 12
    assert case.time.mass_scaling.step == pytest.approx(1e-3)
    assert case.title == "A = B"


BAD = [  # what is written, what stands there instead, the message
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
        "density:",
        "densty:",
        "slope.yaml:10:13: materials.granite.densty: unknown key; did you mean density?",
    ),
    (
        '"2.7 t/m3"',
        '"2.7 t/n3"',
        "slope.yaml:10:13: materials.granite.density: unknown unit 't/n3'",
    ),
    ('"50 GPa"', '"50 Gpa"', "unknown unit 'Gpa'; did you mean GPa?"),
    ('"50 GPa"', '"50 m"', "'50 m' has the wrong dimension; use one of: Pa, kPa, MPa, GPa"),
    ('"50 GPa"', "5O", "unknown unit 'O' in '5O'; use one of: Pa, kPa"),
    ('"50 GPa"', "-1", "must be above 0 [Pa], got -1"),
    ('"2.7 t/m3"', "0", "must be above 0 [kg/m3], got 0"),
    ('"50 GPa"', "[1]", "must be a number [Pa], got a list of 1"),
    ('"50 GPa"', "true", "must be a number [Pa], got true"),
    (
        '"50 GPa"',
        ".nan",
        "slope.yaml:10:34: materials.granite.young_modulus: must be a finite number",
    ),
    ('"50 GPa"', ".inf", "must be a finite number, got inf"),
    ('"50 GPa"', "1e400", "must be a finite number"),
    (
        "0.25",
        "0.7",
        "slope.yaml:10:59: materials.granite.poisson_ratio: must lie in [0, 0.5) [1], got 0.7",
    ),
    ("0.25", "0.5", "must lie in [0, 0.5)"),
    ("law: elastic", "law: elastc", "must be elastic, got 'elastc'; did you mean elastic?"),
    (
        "bed: {material: granite",
        "bed: {material: granit",
        "slope.yaml:12:9: groups.bed.material: no material 'granit'; did you mean granite?",
    ),
    ("fix: [x, y, z]", "fix: [x, w]", "groups.bed.fix.1: must be x, y or z, got 'w'"),
    (
        "fix: [x, y, z]",
        "fix: x",
        "slope.yaml:12:28: groups.bed.fix: must be a list, e.g. [a, b], got 'x'",
    ),
    ('[0, 0, "1 cm/s"]', "[0, 0]", "groups.block.velocity: needs at least 3 entries, got 2"),
    (
        '"1 cm/s"',
        '"1 cm"',
        "slope.yaml:15:22: groups.block.velocity.2: '1 cm' has the wrong dimension",
    ),
    (
        "between: [bed, block]",
        "between: [bed, blok]",
        "slope.yaml:19:23: interfaces.pairs.0.between.1: no group 'blok'; did you mean block?",
    ),
    (
        "split: {block: ",
        "split: {blocks: ",
        "model.split.blocks: no group 'blocks'; did you mean block?",
    ),
    (
        ", polyhedron:",
        ", box: {size: [1, 1, 1]}, polyhedron:",
        "model.blocks.1: give exactly one of box, polyhedron, file; got box and polyhedron",
    ),
    (
        "size: [10, 4, 1]",
        "size: [10, 0, 1]",
        "slope.yaml:6:37: model.blocks.0.box.size.1: must be above 0 [m], got 0",
    ),
    (
        "divisions: [10, 4, 1]",
        "divisions: [10, 0.5, 1]",
        "model.blocks.0.box.divisions.1: must be a whole number, got 0.5",
    ),
    (
        "  gravity: [0, 0, -9.81]",
        "  pore_pressure: 1",
        "loads.pore_pressure: unknown key; possible are gravity, tractions, velocities, supports",
    ),
    (
        "normal: [1, 0, 0]",
        "normel: [1, 0, 0]",
        "loads.tractions.0.surface.normel: unknown key; did you mean normal?",
    ),
    (
        "surface: {group: block",
        "surface: {group: blok",
        "loads.tractions.0.surface.group: no group 'blok'; did you mean block?",
    ),
    (
        "history: [[0, 0], [1, 1]]",
        "history: [[1, 0], [1, 1]]",
        "loads.tractions.0: history: times must increase",
    ),
    (
        "history: [[0, 0], [1, 1]]",
        "history: []",
        "loads.tractions.0.history: needs at least 1 entry, got 0",
    ),
    (
        "normal: [1, 0, 0]}, traction",
        "normal: [0, 0, 0]}, traction",
        "normal must not be [0, 0, 0]",
    ),
    (
        "{surface: lid, ",
        "{",
        "loads.velocities.0: give exactly one of group, surface, point, box; got none of them",
    ),
    ("mode: static", "mode: quick", "stages.0.mode: must be static or dynamic, got 'quick'"),
    (
        "mode: static",
        "mode: static, tolerance: 2",
        "stages.0.tolerance: must lie in (0, 1) [1], got 2",
    ),
    (
        "mode: static",
        "mode: static, duration: 2",
        "stages.0: duration has no meaning in a static stage",
    ),
    (', duration: "2 s"', "", "slope.yaml:30:5: stages.1: a dynamic stage needs a duration"),
    (
        "interfaces.base.cohesion: 0",
        "interfaces.bse.cohesion: 0",
        "slope.yaml:31:12: stages.1.set.interfaces.bse.cohesion: no entry 'bse' in "
        "interfaces; it has: base, 0",
    ),
    (
        "interfaces.base.cohesion: 0",
        "interfaces.base.cohesion: -1",
        "slope.yaml:31:12: stages.1.set.interfaces.base.cohesion: must be at least 0 [Pa], got -1",
    ),
    (
        "interfaces.base.cohesion: 0",
        "time.safety: 0.5",
        "stages.1.set.time.safety: a stage can change interfaces.*, loads.*, groups.* only",
    ),
    (
        "interfaces.base.cohesion: 0",
        "groups.block.material: rock",
        "'material' of a group holds from the start and cannot change",
    ),
    (
        "interfaces.base.cohesion: 0",
        "groups.block.velocity: [1, 0, 0]",
        "'velocity' of a group holds from the start and cannot change",
    ),
    ("name: slide", "name: settle", "stages.1.name: 'settle' is the name of two entries"),
    ("refresh: 50", "refresh: 0", "contact.refresh: must be at least 1, got 0"),
    ("refresh: 50", "refresh: often", "contact.refresh: must be displacement, got 'often'"),
    ("refresh: 50", "tolerance: atuo", "contact.tolerance: must be a number, got 'atuo'"),
    (
        "quantities: [displacement]",
        "quantities: [energy]",
        "histories.0: energy needs a group, not a point",
    ),
    (
        "quantities: [displacement]",
        "quantities: [velocity, displacement, velocity]",
        "velocity is listed twice",
    ),
    ("  blocks:\n", "  mesh: slop.msh\n  blocks:\n", "slope.yaml:5:3: model.mesh: no file "),
    ("cdem: 1\n", "cdem: 2\n", "slope.yaml:1:1: cdem: must be 1, got 2"),
    (
        "units: SI\n",
        "units: SI\nunits: SI\n",
        "slope.yaml:4:1: units: key is there twice; keep one",
    ),
    ("groups:\n", "groups: [\n", "not valid YAML"),
    (
        "materials:\n",
        "materials: 3\nother:\n",
        "slope.yaml:9:1: materials: must be a mapping (key: value), got 3",
    ),
]


@pytest.mark.parametrize(("old", "new", "message"), BAD)
def test_bad_cases_say_where_what_and_how_to_mend(write, old, new, message):
    assert old in CASE
    with pytest.raises(CaseError) as caught:
        Case.load(write(CASE.replace(old, new, 1)))
    assert message in str(caught.value)


def test_all_problems_are_said_at_once_in_order(write):
    text = CASE.replace("0.25", "0.7").replace("mode: static", "mode: quick")
    with pytest.raises(CaseError) as caught:
        Case.load(write(text))
    assert [line.split(": ")[1] for line in str(caught.value).splitlines()] == [
        "materials.granite.poisson_ratio",
        "stages.0.mode",
    ]


def test_a_similar_mesh_file_is_suggested(write, tmp_path):
    (tmp_path / "slope.msh").touch()
    with pytest.raises(CaseError, match=r"slop\.msh .*did you mean slope\.msh\?"):
        Case.load(write(CASE.replace("  blocks:\n", "  mesh: slop.msh\n  blocks:\n")))


def test_the_mesh_is_found_from_the_folder_of_the_case(write, tmp_path, monkeypatch):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "a.msh").touch()
    text = CASE.replace("  blocks:\n", "  mesh: a.msh\n  blocks:\n")
    (tmp_path / "sub" / "case.yaml").write_text(text)
    case = Case.load(tmp_path / "sub" / "case.yaml")
    assert case.path_of(case.model.mesh) == tmp_path / "sub" / "a.msh"
    assert Case.load(write(case.dump())).model.mesh == str(tmp_path / "sub" / "a.msh")


def test_blame_names_the_place(write):
    case = Case.load(write(CASE))
    message = r"^slope.yaml:6:7: model.blocks.0: no volume"
    with pytest.raises(CaseError, match=message), case.blame("model.blocks.0"):
        raise ValueError("no volume")


def test_schema_knows_units_and_refuses_unknown_keys():
    schema = Case.schema()
    modulus = schema["$defs"]["Material"]["properties"]["young_modulus"]
    assert modulus["unit"] == "Pa"
    assert schema["$defs"]["Material"]["additionalProperties"] is False
    assert "pore_pressure" not in str(schema)

    def undescribed(name, part):
        return [
            f"{name}.{k}" for k, v in part.get("properties", {}).items() if not v.get("description")
        ]

    parts = {"case": schema} | schema["$defs"]
    assert [missing for name, part in parts.items() for missing in undescribed(name, part)] == []
