"""Sets of joints: where planes lie, and models cut by them."""

import json

import numpy as np
import pytest
from shared.joints import SETS, block_volumes, jointed_case, model_of

import cdem
from cdem import Case
from cdem.case.bodies_schema import Joint
from cdem.joints import directions, joints
from cdem.mesh import primitives


@pytest.mark.parametrize("divisions, shape", [((3, 3, 3), "tet4"), ((2, 3, 1), "wedge6")])
def test_a_meshed_body_gives_the_blocks_of_the_whole_one(divisions, shape):
    volumes = []
    for piece in (
        primitives.box("rock", (10, 10, 10)),
        primitives.box("rock", (10, 10, 10), divisions, shape=shape),
    ):
        t, volume = block_volumes(
            joints.cut_model([(piece, None)], model_of(SETS, thinnest=0)), SETS
        )
        volumes.append(np.sort(volume))
        corners = t.face_nodes[:, :3]
        x = t.node_position[corners]
        outer = np.ones(len(corners), bool)
        outer[t.pair_faces] = False  # every inner face has its like on the other side
        on_box = (np.isclose(x, 0).all(axis=1) | np.isclose(x, 10).all(axis=1)).any(axis=1)
        assert (on_box == outer).all()
        assert ((t.face_kind > 0) == ~outer).all()
    assert volumes[0] == pytest.approx(volumes[1], rel=1e-6)


def test_polyhedra_are_cut_as_one_cell_and_groups_left_alone():
    case = {
        "model": {
            "blocks": [
                {"group": "rock", "polyhedron": {"vertices": [[x, y, z] for x in (0, 2)
                    for y in (0, 2) for z in (0, 2)]}},
                {"group": "bed", "box": {"size": [2, 2, 1]}, "translate": [0, 0, -1]},
            ],
            "joints": [{"name": "wall", "group": "rock", "normal": [1, 0, 0], "origin": [1, 0, 0]}],
            "translate": [0.5, 0, 0],
        },
        "materials": {"m": {"density": 2500, "young_modulus": 1e6, "poisson_ratio": 0.2}},
        "groups": {"rock": {"material": "m"}, "bed": {"material": "m"}},
        "interfaces": {"default": {"friction_angle": 30}},
        "stages": [{"name": "run", "mode": "dynamic", "duration": 1}],
    }  # fmt: skip
    b = cdem.Simulation(cdem.Case.from_dict(case), threads=1).build
    t = b.topology
    assert {k: len(v) for k, v in t.element_nodes.items() if len(v)} == {"tet4": 24, "hex8": 1}
    volume = b.assembly.element_volume["tet4"]
    assert np.bincount(t.element_block["tet4"], volume)[t.block_group == 1] == pytest.approx(4 * np.array([0.5, 1.5]))  # fmt: skip


def test_persistence_is_the_chance_of_a_cut():
    def blocks(**more):
        sets = [
            {"name": "n", "normal": [1, 0, 0], "spacing": 1, "origin": [0.5, 0, 0]},
            {"name": "p", "normal": [0, 1, 0], "spacing": 1, "origin": [0, 0.5, 0], **more},
        ]
        piece = primitives.box("rock", (40, 20, 1))
        return block_volumes(joints.cut_model([(piece, None)], model_of(sets)), sets)[1]

    # every one of 41 columns is met by 20 planes, and each of these cuts one block of it
    assert len(blocks()) == 41 * 21
    count = len(blocks(persistence=0.3)) - 41
    assert abs(count - 0.3 * 820) < 4 * np.sqrt(820 * 0.3 * 0.7)
    assert (blocks(persistence=0.3) == blocks(persistence=0.3)).all()
    other = blocks(persistence=0.3, seed=1)
    assert len(other) != count + 41 or (other != blocks(persistence=0.3)).any()


@pytest.mark.parametrize("kappa", [5.0, 200.0])
def test_fisher_scatter(kappa):
    joint = Joint(
        name="s", dip=50, dip_direction=120, spacing=0.01, seed=3, scatter={"fisher": kappa}
    )
    normals = np.array([n for n, _, _ in joints.planes(joint, np.array([[0.0, 0, 0], [20, 0, 0]]))])
    assert len(normals) > 5000
    mean = normals.mean(axis=0)
    length = np.linalg.norm(mean)  # Fisher (1953): coth(kappa) - 1 / kappa
    assert length == pytest.approx(1 / np.tanh(kappa) - 1 / kappa, rel=5e-3 * np.sqrt(5 / kappa))
    off = np.degrees(np.arccos(mean / length @ directions.pole(50, 120)))
    assert off < 3 * 81 / np.sqrt(kappa * len(normals))


def test_a_larger_body_has_the_same_joints():
    joint = Joint(name="s", dip=50, dip_direction=120, spacing=1, scatter={"fisher": 50})
    corner = np.array([[0.0, 0, 0], [3, 3, 3]])
    few = {tuple(n): o for n, o, _ in joints.planes(joint, corner)}
    more = {tuple(n): o for n, o, _ in joints.planes(joint, 3 * corner)}
    assert len(more) > len(few) > 5 and few.items() <= more.items()


@pytest.mark.parametrize(
    "dip, direction, normal",
    [(0, 77, (0, 0, 1)), (90, 0, (0, 1, 0)), (90, 270, (-1, 0, 0)), (45, 180, (0, -1, 1))],
)
def test_pole(dip, direction, normal):
    assert directions.pole(dip, direction) == pytest.approx(
        normal / np.linalg.norm(normal), abs=1e-15
    )


def test_models_that_cannot_be_cut_are_refused():
    tiny = jointed_case({"model.joints": [SETS[0] | {"spacing": "10 um"}]})
    with pytest.raises(cdem.CaseError, match="give a wider spacing than 1e-05 m"):
        cdem.Simulation(tiny, threads=1)
    warped = primitives.box("rock", (1, 1, 1))
    warped.points[7] += [0.1, 0, 0]
    with pytest.raises(cdem.MeshError, match="1 of their sides are warped"):
        joints.cut_model([(warped, None)], model_of(SETS))


CASE = """\
model:
  blocks: [{group: rock, box: {size: [6, 6, 6]}}]
  joints:
    - {name: bedding, dip: "30 deg", dip_direction: "90 deg", spacing: 2, scatter: {fisher: 500}}
    - {name: cross, group: rock, dip: 85, dip_direction: 5, spacing: 2.5, persistence: 0.7}
    - {name: fault, normal: [1, 0, 0.3], origin: [3, 3, 3]}
materials: {m: {density: 2500, young_modulus: "1 GPa", poisson_ratio: 0.2}}
groups: {rock: {material: m}}
interfaces:
  default: {friction_angle: 30, cohesion: "1 MPa", stiffness_n: "2 GPa/m", stiffness_s: "2 GPa/m"}
  pairs: [{name: fault, joint: fault, friction_angle: 10, tensile_strength: "1 kPa"}]
loads: {gravity: [0, 0, -10], supports: [{box: {min: [0, 0, 0], max: [6, 6, 0]}, fix: [x, y, z]}]}
stages:
  - {name: settle, mode: static, max_steps: 20}
  - {name: run, mode: dynamic, duration: 1, max_steps: 20, set: {interfaces.fault.cohesion: 0}}
output: {frames: false}
"""


@pytest.mark.usefixtures("no_report")
def test_a_jointed_case_is_checked_and_run(run_cli, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rock.yaml").write_text(CASE)
    status, out, _ = run_cli("check", "rock.yaml")
    assert status == 0
    for name in ("bedding", "cross", "fault"):
        assert f"rock - rock, joint {name}: " in out
    status, _, err = run_cli("run", "rock.yaml", "--quiet", "--threads", "1")
    assert (status, err) == (0, "")
    summary = json.loads((tmp_path / "rock.results" / "summary.json").read_text())
    assert summary["steps"] == 40 and summary["counts"]["blocks"] > 12
    resolved = Case.load(tmp_path / "rock.results" / "case.yaml")
    assert resolved.model.joints[1].persistence == 0.7
    status, out, _ = run_cli("check", "rock.yaml", "--set", "model.joints.2.origin=[90, 0, 0]")
    assert status == 0 and "joint set fault makes no cut" in out


def test_a_group_of_which_joints_leave_nothing_is_named(tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(
        "model:\n  blocks: [{group: a, box: {size: [2, 2, 1.0e-12]}}, {group: b, box: {size: [1, 1, 1]}}]\n"
        "  joints: [{name: x, normal: [1, 0, 0], spacing: 0.7}]\n"
        "materials: {m: {density: 2500, young_modulus: 1e9, poisson_ratio: 0.2}}\n"
        "groups: {a: {material: m}, b: {material: m}}\n"
        "stages: [{name: fall, mode: dynamic, duration: 1}]\n"
    )
    with pytest.raises(cdem.MeshError, match=r"model.joints: group 'a' has vanished"):
        cdem.Simulation(path)
