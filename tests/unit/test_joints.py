"""Joint planes, the exact cutter, and interfaces by set of joints."""

import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import cdem
from cdem import Case
from cdem.case.bodies_schema import Joint, Model
from cdem.cli import run_commands
from cdem.joints import cell_mesh, convex_cells, cutting, joints
from cdem.mesh import primitives
from cdem.mesh.blocks import block_labels, build_topology
from cdem.output.render import snapshot

ALL = np.array([True])


def cube(size=2.0, divisions=(1, 1, 1), shape="hex8"):
    piece = primitives.box("rock", (size, size, size), divisions, shape=shape)
    return convex_cells.from_mesh(piece, ["rock"], block_labels(piece, {}))


def cut(c, planes, **more):
    for number, (normal, offset) in enumerate(planes):
        size = np.linalg.norm(normal)
        c, _ = cutting.cut(c, np.array(normal) / size, offset / size, number, among=ALL, **more)
    return c


def polygons(c):
    """Corner positions of every face."""
    return [c.points[c.corner[a:b]] for a, b in zip(c.first[:-1], c.first[1:], strict=True)]


def area_vector(x):
    return 0.5 * np.cross(x - x[0], np.roll(x, -1, axis=0) - x[0]).sum(axis=0)


def sides_that_are_single(c):
    """Directed edges of a cell whose reverse is not in the same cell exactly once."""
    a, b = c.corner, c.corner[c.following()]
    sides = list(zip(c.cell[c.owner()].tolist(), a.tolist(), b.tolist(), strict=True))
    reverse = {(k, v, u) for k, u, v in sides}
    return len(sides) - len(set(sides)), set(sides) ^ reverse


def test_a_cube_cut_by_known_planes():
    # x = 0.5 halves into 2 and 6 m3; x + y + z = 1.5 takes a corner of 1.5^3 / 6 m3 across it
    c = cut(cube(), [((1, 0, 0), 0.5), ((1, 1, 1), 1.5)])
    corner, beyond = 1.5**3 / 6, 1.0**3 / 6  # of the whole, and the part of it with x > 0.5
    assert sorted(c.volumes()) == pytest.approx(
        sorted([2 - corner + beyond, corner - beyond, 6 - beyond, beyond]), rel=1e-13
    )
    for x, source in zip(polygons(c), c.source, strict=True):
        if source == 0:
            assert x[:, 0] == pytest.approx(0.5, abs=1e-14)
        elif source == 1:
            assert x.sum(axis=1) == pytest.approx(1.5, abs=1e-14)
        else:  # on the cube's own sides
            assert (np.isclose(x, 0).all(axis=0) | np.isclose(x, 2).all(axis=0)).any()
    area = [sum(area_vector(x) @ n for x, s in zip(polygons(c), c.source, strict=True)
                if s == k and area_vector(x) @ n > 0) for k, n in ((0, [1, 0, 0]), (1, [1, 1, 1]))]  # fmt: skip
    assert area == pytest.approx([4, 3 * np.sqrt(3) * 1.5**2 / 2 / np.sqrt(3)], rel=1e-13)


def test_planes_through_corners_and_edges_and_along_sides():
    c = cut(cube(), [((1, -1, 0), 0), ((1, 1, 1), 2), ((1, 0, 0), 2), ((0, 0, 1), 0)])
    # the diagonal plane halves; x + y + z = 2 meets three corners of the cube; the sides cut nothing
    assert sorted(c.volumes()) == pytest.approx([2 / 3, 2 / 3, 10 / 3, 10 / 3], rel=1e-13)
    assert not (c.source >= 2).any()


def test_thin_parts_are_not_cut_off():
    whole, left = cutting.cut(cube(), np.array([1.0, 0, 0]), 1.95, 0, among=ALL, thinnest=0.1)
    assert (whole.blocks, left) == (1, 1)
    parts, left = cutting.cut(cube(), np.array([1.0, 0, 0]), 1.85, 0, among=ALL, thinnest=0.1)
    assert (parts.blocks, left) == (2, 0)


def test_planes_along_the_elements_of_a_mesh_make_joint_faces():
    c = cut(cube(divisions=(2, 2, 2)), [((1, 0, 0), 1)])
    assert c.blocks == 2
    assert (c.source == 0).sum() == 8
    t = build_topology(cell_mesh.to_mesh(c, ["rock"], [], ["wall"]), {}, ["wall"])
    assert len(t.block_group) == 2 and len(t.pair_faces) == 8
    assert (t.face_kind[t.pair_faces] == 1).all() and (t.face_kind == 1).sum() == 16


@st.composite
def bodies(draw):
    """A convex body: a box or the hull of points on a sphere, anywhere and of any size."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size = 10.0 ** draw(st.integers(-3, 4))
    if draw(st.booleans()):
        c = cube(size)
    else:
        x = random.normal(size=(draw(st.integers(4, 12)), 3))
        x = size * x / np.linalg.norm(x, axis=1)[:, None] + 10 * size * random.random(3)
        c = convex_cells.from_polyhedron(x, primitives.outward_faces(x, None), 0)
    return c, size, random


@settings(deadline=None, max_examples=40, suppress_health_check=[HealthCheck.too_slow])
@given(bodies(), st.integers(1, 12), st.booleans())
def test_what_is_cut_stays_exact_closed_and_convex(body, count, close):
    c, size, random = body
    before, low, high = c.volumes().sum(), c.points.min(axis=0), c.points.max(axis=0)
    planes = []
    for _ in range(count):
        kind = random.integers(4)
        normal = random.normal(size=3)
        at = random.uniform(low, high)
        if kind == 1 and planes:  # nearly parallel to the last, and near it
            normal = planes[-1][0] + 10.0 ** random.integers(-12, 0) * random.normal(size=3)
            at = at + (planes[-1][1] - at @ normal) * normal / (normal @ normal)
        elif kind == 2:  # through three corners of what is there by now
            at, b, d = c.points[random.choice(len(c.points), 3, replace=len(c.points) < 3)]
            normal = np.cross(b - at, d - at)
        elif kind == 3:
            normal = np.eye(3)[random.integers(3)]
        if np.linalg.norm(normal) < 1e-9 * size**2:
            continue
        planes.append((normal, at @ normal))
        normal = normal / np.linalg.norm(normal)
        c, _ = cutting.cut(c, normal, at @ normal, len(planes) - 1, among=ALL)
    volumes = c.volumes()
    assert volumes.sum() == pytest.approx(before, rel=1e-12)
    assert sides_that_are_single(c) == (0, set())

    faces = polygons(c)
    near = 4 * c.near  # corners within `near` of a plane count as on it
    net = np.zeros((len(planes), 3))
    for x, cell, source in zip(faces, c.cell, c.source, strict=True):
        vector = area_vector(x)
        if source >= 0:
            net[source] += vector
        if np.linalg.norm(vector) < (1e-4 * size) ** 2:
            continue  # too small to have a normal
        own = np.unique(c.corner[np.flatnonzero(c.cell[c.owner()] == cell)])
        height = (c.points[own] - x[0]) @ vector / np.linalg.norm(vector)
        assert height.max() <= near * max(1.0, 1e2 * size / np.sqrt(np.linalg.norm(vector)))
    assert np.abs(net).max(initial=0) <= 1e-12 * size**2 * max(1, len(faces))

    if close:
        closed, _ = cell_mesh.close_short_edges(c, 0.01 * size)
        assert sides_that_are_single(closed) == (0, set())
        made = cell_mesh.to_mesh(closed, ["rock"], [], [str(k) for k in range(len(planes))])
        x = made.points[made.cells["tet4"]]
        tets = np.linalg.det(x[:, 1:] - x[:, :1]) / 6
        assert tets.sum() == pytest.approx(closed.volumes().sum(), rel=1e-12)


def model(sets, **more):
    return Model.model_validate({"mesh": "any", "joints": sets, **more})


SETS = [
    {"name": "a", "dip": 30, "dip_direction": 100, "spacing": 2, "origin": [5, 5, 5]},
    {"name": "b", "dip": 75, "dip_direction": 20, "spacing": 3, "origin": [5, 5, 5]},
    {"name": "c", "normal": [1, 0.1, 0.2], "spacing": 2.5, "origin": [5, 5, 5]},
]


def block_volumes(made, sets):
    t = build_topology(made, {}, [s["name"] for s in sets])
    x = t.node_position[t.element_nodes["tet4"]]
    return t, np.bincount(t.element_block["tet4"], np.linalg.det(x[:, 1:] - x[:, :1]) / 6)


@pytest.mark.parametrize("divisions, shape", [((3, 3, 3), "tet4"), ((2, 3, 1), "wedge6")])
def test_a_meshed_body_gives_the_blocks_of_the_whole_one(divisions, shape):
    volumes = []
    for piece in (
        primitives.box("rock", (10, 10, 10)),
        primitives.box("rock", (10, 10, 10), divisions, shape=shape),
    ):
        t, volume = block_volumes(joints.cut_model([(piece, None)], model(SETS, thinnest=0)), SETS)
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
        "materials": {"m": {"density": 1, "young_modulus": 1e6, "poisson_ratio": 0.2}},
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
        return block_volumes(joints.cut_model([(piece, None)], model(sets)), sets)[1]

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
    off = np.degrees(np.arccos(mean / length @ joints.pole(50, 120)))
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
    assert joints.pole(dip, direction) == pytest.approx(normal / np.linalg.norm(normal), abs=1e-15)


BAD = [
    ({"model.joints": [{"name": "a", "dip": 30}]}, "give dip and dip_direction, or normal"),
    ({"model.joints": [{"name": "a", "dip": 30, "normal": [0, 0, 1]}]}, "not both"),
    ({"model.joints": [{"name": "a", "normal": [0, 0, 0]}]}, "must not be [0, 0, 0]"),
    ({"model.joints": [SETS[0] | {"group": "rok"}]}, "no group 'rok'; did you mean rock?"),
    ({"model.joints": [SETS[0], SETS[0]]}, "'a' is the name of two entries"),
    ({"model.joints": SETS, "interfaces.pairs": [{"joint": "d"}]}, "no joint set 'd'"),
    ({"interfaces.pairs": [{"joint": "a"}]}, "the case has: none"),
    ({"interfaces.pairs": [{"cohesion": 1}]}, "give exactly one of between, joint"),
    ({"model.joints": SETS, "interfaces.pairs": [{"joint": "a"}] * 2}, "a is listed twice"),
    ({"model.joints": SETS, "model.split": {"rock": "one"}}, "cannot be one block"),
]


def case(changes):
    data = {
        "model": {"blocks": [{"group": "rock", "box": {"size": [10, 10, 10]}}]},
        "materials": {"m": {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.2}},
        "groups": {"rock": {"material": "m"}},
        "interfaces": {"default": {"friction_angle": 30}},
        "stages": [{"name": "run", "mode": "dynamic", "duration": 1}],
    }
    for path, value in changes.items():
        part, key = path.split(".")
        data[part][key] = value
    return cdem.Case.from_dict(data)


@pytest.mark.parametrize("changes, message", BAD)
def test_mistakes_are_named(changes, message):
    with pytest.raises(cdem.CaseError) as error:
        case(changes)
    assert message in str(error.value)


def test_models_that_cannot_be_cut_are_refused():
    tiny = case({"model.joints": [SETS[0] | {"spacing": "10 um"}]})
    with pytest.raises(cdem.CaseError, match="give a wider spacing than 1e-05 m"):
        cdem.Simulation(tiny, threads=1)
    warped = primitives.box("rock", (1, 1, 1))
    warped.points[7] += [0.1, 0, 0]
    with pytest.raises(cdem.MeshError, match="1 of their sides are warped"):
        joints.cut_model([(warped, None)], model(SETS))


def test_interfaces_follow_the_joint_then_the_groups():
    b = cdem.Simulation(
        case({
            "model.joints": SETS,
            "interfaces.pairs": [{"joint": "b", "friction_angle": 11, "cohesion": 5},
                                 {"between": ["rock", "rock"], "friction_angle": 22, "cohesion": 5}],
        }), threads=1,
    ).build  # fmt: skip
    t, a = b.topology, b.assembly
    law = b.arrays["triangles.interface"][: a.counts["triangles.count"]]
    kind = t.face_kind[a.pair_faces["triangles"]]
    assert (kind[:, 0] == kind[:, 1]).all() and set(kind[:, 0]) == {1, 2, 3}
    assert ((kind[:, 0] == 2) == (law == 0)).all() and set(law) == {0, 1}
    table = b.arrays["interface.of"].reshape(4, 4)
    assert (table == [[1, 1, 0, 1]] * 4).all()  # what touches a face of set b has its law


def test_surfaces_that_are_drawn_know_the_set():
    sim = cdem.Simulation(case({"model.joints": SETS}), threads=1)
    surface = snapshot(sim)
    faces = surface.faces.reshape(-1, 4)[:, 1:]
    for number, joint in enumerate(SETS, start=1):
        x = surface.points[faces[surface.cell_data["joint"] == number]]
        normal = joint.get("normal") or joints.pole(joint["dip"], joint["dip_direction"])
        along = (x - joint["origin"]) @ normal / np.linalg.norm(normal) / joint["spacing"]
        assert len(x) > 10 and np.abs(along - np.round(along)).max() < 1e-9
    assert set(surface.cell_data["joint"]) == {0, 1, 2, 3}


@pytest.mark.parametrize("persistence, fisher", [(1.0, 200.0), (0.6, 200.0)])
def test_all_of_every_joint_is_bonded(persistence, fisher):
    """Where neighbours were cut differently, the true overlaps of their faces add up."""
    more = {"persistence": persistence, "scatter": {"fisher": fisher}}
    b = cdem.Simulation(
        case(
            {
                "model.joints": [s | more for s in SETS],
                "interfaces.default": {"friction_angle": 30, "cohesion": 1e6},
            }
        ),
        threads=1,
    ).build
    a = b.assembly
    made = b.arrays["face.area"][b.topology.face_kind > 0].sum() / 2
    kinds = ("triangles", "overlaps")
    bonded = [b.arrays[f"{k}.area"][: a.counts[f"{k}.count"]].sum() for k in kinds]
    assert sum(bonded) == pytest.approx(made, rel=1e-9)
    assert bonded[1] > 0.1 * made or persistence == 1


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


def test_a_jointed_case_is_checked_and_run(cdem, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        run_commands, "write_report", lambda folder, silent: None
    )  # it takes seconds
    (tmp_path / "rock.yaml").write_text(CASE)
    status, out, _ = cdem("check", "rock.yaml")
    assert status == 0
    for name in ("bedding", "cross", "fault"):
        assert f"rock - rock, joint {name}: " in out
    status, _, err = cdem("run", "rock.yaml", "--quiet", "--threads", "1")
    assert (status, err) == (0, "")
    summary = json.loads((tmp_path / "rock.results" / "summary.json").read_text())
    assert summary["steps"] == 40 and summary["counts"]["blocks"] > 12
    resolved = Case.load(tmp_path / "rock.results" / "case.yaml")
    assert resolved.model.joints[1].persistence == 0.7
    status, out, _ = cdem("check", "rock.yaml", "--set", "model.joints.2.origin=[90, 0, 0]")
    assert status == 0 and "joint set fault cuts nothing" in out
