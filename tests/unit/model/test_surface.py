"""Surface laws: their faces, what the audit says of them, what a stage may change."""

import numpy as np
import pytest
from scenes import case

from cdem import Simulation
from cdem.errors import CaseError
from cdem.model.build import build
from cdem.rows import rows_of

BOXES = [
    {"group": "a", "box": {"size": [2, 3, 1], "divisions": [2, 3, 1]}},
    {"group": "b", "box": {"size": [1, 1, 1], "shape": "tet4"}, "translate": [5, 0, 0]},
]


def pressed(*surfaces, **more):
    """Two boxes with these entries of `loads.surfaces`."""
    return case(BOXES, {"a": {}, "b": {}}, loads={"surfaces": list(surfaces)}, **more)


def top(group, **more):
    return {"surface": {"group": group, "normal": [0, 0, 1]}, "pressure": "2 kPa"} | more


def test_each_entry_has_its_faces_its_parameters_and_a_curve():
    built = build(pressed(top("a"), top("b", history=[[0, 0.5]]), top("a", pressure=7)))
    core = built.core
    assert core.model()["surface.parameters"].reshape(3, -1)[:, 0].tolist() == [2000, 2000, 7]
    assert core.model()["surface.curve"].tolist() == [0, 1, 0]
    quads, triangles = (rows_of(core, f"surface_{kind}.entry") for kind in ("quads", "triangles"))
    assert quads.numbers[:, 0].tolist() == [0] * 6 + [2] * 6
    assert triangles.numbers[:, 0].tolist() == [1] * 2
    assert core.model()["surface_quads.area"].tolist() == pytest.approx([1.0] * 12)
    report = built.modules["surface"].report(built)
    assert [(one["faces"], one["area"]) for one in report] == [(6, 6.0), (2, 1.0), (6, 6.0)]


def test_a_case_without_has_none_of_their_arrays():
    built = build(pressed())
    assert not len(built.core.model()["surface.law"])
    assert not len(built.core.fields()["node.surface"])
    assert built.modules["surface"].lines(built.modules["surface"].report(built)) == []


STAGES = [{"name": s, "mode": "dynamic", "duration": 1e-3} for s in ("one", "two")]


def test_a_stage_may_change_parameters_and_history_and_nothing_else():
    stages = [STAGES[0], STAGES[1] | {"set": {"loads.surfaces.0.pressure": "8 kPa"}}]
    sim = Simulation(pressed(top("a"), stages=stages), threads=1)
    force = []
    for stage in ("one", "two"):
        sim.run_stage(stage)
        force.append(rows_of(sim.core, "node.surface").force[:, 2].sum())
    assert force == pytest.approx([-12e3, -48e3], rel=1e-4)
    for key, value in (("surface", {"group": "b", "normal": [0, 0, 1]}), ("stage", "two")):
        sim = Simulation(pressed(top("a"), stages=STAGES), threads=1)
        with pytest.raises(CaseError, match="another entry with stage"):
            sim.set(f"loads.surfaces.0.{key}", value)
    sim = Simulation(pressed(stages=STAGES), threads=1)
    with pytest.raises(CaseError, match="another entry with stage"):
        sim.set("loads.surfaces", [top("a")])


def test_an_entry_with_a_stage_acts_from_its_begin_on():
    sim = Simulation(pressed(top("a", stage="two"), stages=STAGES), threads=1)
    sim.run_stage("one")
    assert not rows_of(sim.core, "node.surface").force.any()
    assert np.abs(sim.fields["velocity"]).max() < 1e-9
    sim.run_stage("two")
    speed = sim.fields["velocity"][sim.build.nodes_of("a"), 2].mean()
    mass = sim.fields["mass"][sim.build.nodes_of("a")].sum()
    assert speed == pytest.approx(-12e3 * 1e-3 / mass, rel=0.2)
    assert np.abs(sim.fields["velocity"][sim.build.nodes_of("b")]).max() < 1e-9


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (top("a", law="gas"), "law"),
        (top("a", friction_angle=3), "friction_angle"),
        (top("c"), "'c'"),
        (top("a", stage="three"), "no stage 'three'"),
        ({"surface": {"group": "a", "normal": [0, 0, 1]}}, "pressure"),
    ],
)
def test_a_wrong_entry_is_told_with_its_place(entry, words):
    with pytest.raises(CaseError, match=r"loads\.surfaces\.0") as caught:
        pressed(entry, stages=STAGES)
    assert words in str(caught.value)
