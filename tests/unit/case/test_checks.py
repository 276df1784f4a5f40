"""Contradictions between the parts of a case: names, settings of stages, the mesh file."""

from __future__ import annotations

import pytest
from shared.cases import INCLINE
from shared.joints import SETS, jointed_case

import cdem
from cdem import Case, CaseError


def test_wrong_names_are_reported_beside_other_mistakes(write):
    """A key, a value, a group of a pair, a group of a block and a stage's setting, all at once."""
    text = INCLINE.replace("law: elastic", "lwa: elastic").replace("fix: [x, y, z]", "fix: x")
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
        text = INCLINE.replace("between: [bed, block]", "between: [bed, blok]")
        Case.load(write(text.replace("interfaces.base.cohesion: 0", "interfaces.base.cohesion: x")))
    assert len(str(error.value).splitlines()) == 2


def test_a_similar_mesh_file_is_suggested(write, tmp_path):
    (tmp_path / "slope.msh").touch()
    with pytest.raises(CaseError, match=r"slop\.msh .*did you mean slope\.msh\?"):
        Case.load(write(INCLINE.replace("  blocks:\n", "  mesh: slop.msh\n  blocks:\n")))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "bed: {material: granite",
            "bed: {material: granit",
            "slope.yaml:12:9: groups.bed.material: no material 'granit'; did you mean granite?",
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
            "surface: {group: block",
            "surface: {group: blok",
            "loads.tractions.0.surface.group: no group 'blok'; did you mean block?",
        ),
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
            "stages.1.set.time.safety: a stage can change interfaces.*, loads.*, groups.*, materials.*, water.* only",
        ),
        (
            "interfaces.base.cohesion: 0",
            "groups.block.material: rock",
            "'material' of a group is fixed at the start and cannot change",
        ),
        (
            "interfaces.base.cohesion: 0",
            "materials.rock.young_modulus: 1e9",
            "'young_modulus' of a material is fixed at the start and cannot change",
        ),
        (
            "interfaces.base.cohesion: 0",
            "groups.block.velocity: [1, 0, 0]",
            "'velocity' of a group is fixed at the start and cannot change",
        ),
        ("name: slide", "name: settle", "stages.1.name: 'settle' is the name of two entries"),
        ("  blocks:\n", "  mesh: slop.msh\n  blocks:\n", "slope.yaml:5:3: model.mesh: no file "),
        (
            "  blocks:\n",
            f"  mesh: {'x' * 300}/a.msh\n  blocks:\n",
            "slope.yaml:5:3: model.mesh: no fi",
        ),
    ],
)
def test_contradictions_are_answered(complaint, old, new, message):
    assert message in complaint(old, new)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"model.joints": [SETS[0] | {"group": "rok"}]}, "no group 'rok'; did you mean rock?"),
        ({"model.joints": [SETS[0], SETS[0]]}, "'a' is the name of two entries"),
        ({"model.joints": SETS, "interfaces.pairs": [{"joint": "d"}]}, "no joint set 'd'"),
        ({"interfaces.pairs": [{"joint": "a"}]}, "the case has: none"),
        ({"model.joints": SETS, "model.split": {"rock": "one"}}, "cannot be one block"),
    ],
)
def test_mistakes_about_joints_are_named(changes, message):
    with pytest.raises(cdem.CaseError) as error:
        jointed_case(changes)
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("field", "gravity", "fits"),
    [
        ({"level": 5}, [0, 0, -9.81], True),
        ({"level": 5}, [1, 0, -9.81], False),
        ({"formula": "100"}, [1, 0, -9.81], True),  # pressures do not depend on gravity
        ({"table": "water.csv"}, [0, 1, -9.81], True),
        ({"formula": "100"}, [1, 0, 0], False),
    ],
)
def test_gravity_beside_water(write, field, gravity, fits):
    water = f"water: {{fields: [{field}]}}\n".replace("'", '"')
    text = INCLINE.replace("gravity: [0, 0, -9.81]", f"gravity: {gravity}") + water
    assert str(gravity) in text
    if fits:
        Case.load(write(text))
        return
    with pytest.raises(CaseError, match="must point along -z in a case with water"):
        Case.load(write(text))
