"""Fields of a run: pieces, and the surface with its sets of joints."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import simulate
from shared.joints import SETS, jointed_case

import cdem
from cdem.case.output_fields import OUTPUT_FIELDS
from cdem.joints import directions
from cdem.output.render import snapshot
from cdem.run.fields import bonds_of, pieces_of, surface_of, values_of, visible_faces


@pytest.mark.parametrize(("kind", "divisions"), [("quads", [1, 1, 1]), ("overlaps", [2, 1, 1])])
def test_blocks_hang_together_by_one_point(kind, divisions):
    upper = {"size": [2, 1, 1], "divisions": divisions}
    blocks = [
        {"group": "a", "box": {"size": [2, 1, 1]}},
        {"group": "b", "box": upper, "translate": [0, 0, 1]},
    ]
    bond = {"friction_angle": 0, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
    sim = simulate(blocks, {"a": {}, "b": {}}, interfaces={"default": bond})
    bonds = sim.core.fields()[f"{kind}.bond"]
    first = bonds[:1].copy()
    bonds[:] = 0
    assert len(set(pieces_of(sim))) == 2
    bonds[:1] = first
    assert len(set(pieces_of(sim))) == 1


def test_surfaces_that_are_drawn_know_the_set():
    sim = cdem.Simulation(jointed_case({"model.joints": SETS}), threads=1)
    surface = snapshot(sim)
    faces = surface.faces.reshape(-1, 4)[:, 1:]
    for number, joint in enumerate(SETS, start=1):
        x = surface.points[faces[surface.cell_data["joint"] == number]]
        normal = joint.get("normal") or directions.pole(joint["dip"], joint["dip_direction"])
        along = (x - joint["origin"]) @ normal / np.linalg.norm(normal) / joint["spacing"]
        assert len(x) > 10 and np.abs(along - np.round(along)).max() < 1e-9
    assert set(surface.cell_data["joint"]) == {0, 1, 2, 3}


def test_every_field_of_nodes_and_elements_has_a_row_for_each():
    sim = cdem.Simulation(jointed_case({"model.joints": SETS}), threads=1)
    t = sim.build.topology
    rows = {"nodes": len(t.node_position), "elements": sum(map(len, t.element_nodes.values()))}
    known = [field for field in OUTPUT_FIELDS if field.on != "faces"]
    values = values_of(sim, known)
    assert {field.name: len(values[field.name]) for field in known} == {
        field.name: rows[field.on] for field in known
    }
    _, faces, points, cells = surface_of(sim, values)
    assert set(points) | set(cells) == {field.name for field in OUTPUT_FIELDS} - {"water_pressure"}
    element = t.face_element[visible_faces(sim)[0]]
    assert (cells["block"] == values["block"][element]).all() and len(faces) == len(element)


@pytest.mark.parametrize("shape", ["hex8", "tet4"])
def test_faces_that_met_slide_and_part(shape):
    """The upper of two boxes is moved along x and up; the lower one's other elements know nothing."""
    box = {"size": [1, 1, 1], "divisions": [1, 1, 2], "shape": shape}
    blocks = [{"group": "a", "box": box}, {"group": "b", "box": box, "translate": [0, 0, 2 - 1]}]
    sim = simulate(blocks, {"a": {}, "b": {}}, interfaces={"default": {"friction_angle": 30}})
    values = values_of(sim, [f for f in OUTPUT_FIELDS if f.name in ("slip", "opening")])
    assert max(values["slip"].max(), values["opening"].max()) < 1e-12
    t = sim.build.topology
    sim.motion[np.unique(t.element_nodes[shape][t.element_group[shape] == 1]), :3] += [0.3, 0, 0.1]
    values = values_of(sim, [f for f in OUTPUT_FIELDS if f.name in ("slip", "opening")])
    z = t.node_position[t.element_nodes[shape]][:, :, 2]
    touch = np.isclose(z, 1).sum(axis=1) >= 3
    assert touch.sum() >= 2
    assert values["slip"] == pytest.approx(0.3 * touch)
    assert values["opening"] == pytest.approx(0.1 * touch)


def test_bonds_of_faces_that_do_not_match_are_whole_at_the_start():
    """The last overlap counted what lies behind the list of points."""
    above = {"group": "a", "box": {"size": [1, 1, 0.5]}, "translate": [0.3, 0.1, 0]}
    below = {
        "group": "b",
        "box": {"size": [2, 2, 0.5], "divisions": [2, 2, 1], "shape": "tet4"},
        "translate": [0, 0, -0.5],
    }
    bond = {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}
    sim = simulate([above, below], {"a": {}, "b": {}}, interfaces={"default": bond})
    assert sim.audit.counts["bonded_pairs"] > 0
    intact = bonds_of(sim)[1]
    assert (intact == 1).all()


def thrown(fields):
    """A cube thrown upwards, which falls back below its start, then another stage."""
    stages = [{"name": n, "mode": "dynamic", "duration": t} for n, t in (("up", 0.3), ("on", 0.1))]
    return simulate(
        [{"group": "box", "box": {"size": [1, 1, 1]}}],
        {"box": {"velocity": [0, 0, 2]}},
        loads={"gravity": [0, 0, -10]},
        output={"fields": fields},
        stages=stages,
        time={"step": 1e-4},
    )


def test_a_peak_velocity_is_the_largest_speed_since_the_stage_began():
    """Up with 2 m/s, on top after 0.2 s, down with 1 m/s; then from 1 to 2 m/s."""
    sim = thrown(["peak_velocity"])
    (field,) = (f for f in OUTPUT_FIELDS if f.name == "peak_velocity")

    def peaks():
        return values_of(sim, [field])["peak_velocity"]

    assert not peaks().any()
    sim.run_stage("up")
    np.testing.assert_allclose(peaks(), 2.0, rtol=1e-3)
    sim.run_until(0.35)
    np.testing.assert_allclose(peaks(), 1.5, rtol=1e-3)
    sim = thrown(["velocity"])
    sim.run()
    assert not peaks().any()


def test_peaks_go_on_in_a_resumed_run(tmp_path):
    """To the bit."""
    whole = thrown(["peak_velocity"])
    whole.run_stage("up")
    first = cdem.Simulation(whole.given_case, output=tmp_path / "out", threads=1)
    first.run_until(0.12)
    first.checkpoint()
    first.close()
    again = cdem.Simulation(whole.given_case, output=tmp_path / "out", resume=True, threads=1)
    again.run_stage("up")
    assert (again.core.array("node.peak")[0] == whole.core.array("node.peak")[0]).all()
    assert again.core.array("node.peak")[0].any()
