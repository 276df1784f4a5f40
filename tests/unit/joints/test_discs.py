"""Joints of finite size: which blocks discs cut, which faces they hold, and what is drawn."""

import numpy as np
import pytest
from ruamel.yaml import YAML
from shared.cells import cube
from shared.joints import block_volumes, jointed_case, model_of

import cdem
from cdem.case.bodies_schema import Joint
from cdem.errors import CaseError
from cdem.joints import discs, joints
from cdem.joints.directions import pole
from cdem.mesh import primitives


def read_text(text):
    return YAML(typ="safe").load(text)


FILE = {"name": "dfn", "discs": {"file": "discs.csv"}}
SURFACES = [{"name": "dfn"}, {"name": "dfn.bridge"}]


def cut_box(rows, divisions, size=4.0, **more):
    piece = primitives.box("rock", (size,) * 3, (divisions,) * 3, shape="tet4")
    model = model_of([FILE | more], thinnest=0)
    return joints.cut_model([(piece, None)], model, {"dfn": rows})


def area(mesh, name):
    """Of a surface whose both sides are there [m2]."""
    x = np.concatenate([mesh.points[part] for part in mesh.surfaces[name]])
    return np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1).sum() / 4


def some_discs(count, low, high, radii):
    rng = np.random.default_rng(3)
    return [
        discs.Disc(rng.uniform(low, high, 3), pole(rng.uniform(0, 90), rng.uniform(0, 360)),
                   rng.uniform(*radii))
        for _ in range(count)
    ]  # fmt: skip


def test_area_of_discs_inside():
    # the sum of pi r^2; faces count by their centres: 0.25 % off with 16 cells, 0.17 % with 24
    rows = some_discs(8, 1.1, 2.9, (0.6, 1.0))
    mesh = cut_box(rows, 12)
    assert area(mesh, "dfn") == pytest.approx(sum(np.pi * d.radius**2 for d in rows), rel=0.01)
    assert mesh.discs == {"dfn": (8, 8)} and area(mesh, "dfn.bridge") > area(mesh, "dfn")
    volumes = block_volumes(mesh, SURFACES)[1]
    assert volumes.sum() == pytest.approx(64, rel=1e-12) and len(volumes) > 8


def test_both_sides_of_a_cut_are_of_one_kind():
    mesh = cut_box(some_discs(8, 0.5, 3.5, (0.6, 1.0)), 6)
    t, _ = block_volumes(mesh, SURFACES)
    kind = t.face_kind[t.pair_faces]
    assert (kind[:, 0] == kind[:, 1]).all() and set(np.unique(kind)) == {1, 2}


def test_a_disc_cuts_only_blocks_that_it_meets():
    def volumes(center, radius, normal=(0, 0, 1)):
        two = [{"name": "wall", "normal": [1, 0, 0], "origin": [2, 0, 0]}, FILE]
        piece = primitives.box("rock", (4, 4, 4))
        row = discs.Disc(np.array(center, float), np.array(normal, float), radius)
        mesh = joints.cut_model([(piece, None)], model_of(two, thinnest=0), {"dfn": [row]})
        return sorted(block_volumes(mesh, [{"name": "wall"}, *SURFACES])[1].round(9).tolist())

    assert volumes((1, 2, 1), 0.9) == [8, 24, 32]  # in the left half
    assert volumes((1, 2, 1), 1.1) == [8, 8, 24, 24]  # reaches into the right one
    assert volumes((-1, 2, 1), 0.9) == [32, 32]  # beside both
    assert volumes((-1, 2, 1), 1.1) == [8, 24, 32]  # reaches in by its rim
    assert volumes((1, -0.6, 1), 0.5) == [32, 32]


def test_a_disc_between_cells_and_another_in_its_plane():
    # z = 2 is a plane of the mesh; of two discs in one plane the second claims bridges of the first
    flat = np.array([0, 0, 1.0])
    first = discs.Disc(np.array([1, 1, 2.0]), flat, 0.8)
    second = discs.Disc(np.array([3, 3, 2.0]), flat, 0.8)
    one, both = (cut_box(rows, 12) for rows in ([first], [first, second]))
    assert area(one, "dfn") + area(one, "dfn.bridge") == pytest.approx(16, rel=1e-12)
    assert area(both, "dfn") == pytest.approx(2 * area(one, "dfn"), rel=1e-12)
    assert area(both, "dfn") + area(both, "dfn.bridge") == pytest.approx(16, rel=1e-12)


def test_density_gives_the_area_for_volume():
    # P32 = density pi E[r^2], discs cut off by the sides included; their areas scatter
    joint = Joint(name="d", dip=40, dip_direction=70, scatter={"fisher": 10},
                  discs={"density": 0.2, "radius": {"uniform": {"min": 0.3, "max": 0.9}}})  # fmt: skip
    corners = cube(40.0).points
    rows = discs.draw_discs(joint, joint.discs, corners)
    assert len(rows) == round(0.2 * 41.8**3)
    rng = np.random.default_rng(1)
    # area inside by points spread over each disc
    radii, centers, normals = (
        np.array([getattr(disc, name) for disc in rows]) for name in ("radius", "center", "normal")
    )
    across = np.linalg.svd(normals[:, None])[2][:, 1:]
    r, turn = np.sqrt(rng.random((len(rows), 50))), 2 * np.pi * rng.random((len(rows), 50))
    plane = radii[:, None, None] * np.stack([r * np.cos(turn), r * np.sin(turn)], axis=2)
    x = centers[:, None] + plane @ across
    inside = np.pi * radii**2 @ ((x > 0) & (x < 40)).all(axis=2).mean(axis=1)
    mean = (0.9**3 - 0.3**3) / (3 * 0.6)
    spread = np.sqrt((0.9**5 - 0.3**5) / (5 * 0.6) / mean**2 / (0.2 * 64_000))  # 1 % of the sum
    assert inside / 64_000 == pytest.approx(0.2 * np.pi * mean, rel=4 * spread)


@pytest.mark.parametrize(
    "radius, mean",
    [
        ({"uniform": {"min": 1, "max": 3}}, 2.0),
        # r^-3 from 1 to 10: (1 - 1/10) / ((1 - 1/100) / 2)
        ({"power": {"exponent": 3, "min": 1, "max": 10}}, 0.9 / 0.495),
        ({"lognormal": {"mean": 2, "deviation": 0.5, "max": 50}}, 2.0),
        (2.5, 2.5),
    ],
)
def test_radii(radius, mean):
    joint = Joint(name="d", normal=[0, 0, 1], discs={"count": 4000, "radius": radius})
    rows = discs.draw_discs(joint, joint.discs, cube().points)
    r = np.array([disc.radius for disc in rows])
    assert abs(r.mean() - mean) <= 4 * r.std() / np.sqrt(4000)
    again = discs.draw_discs(joint, joint.discs, cube().points)
    assert [d.radius for d in again] == r.tolist()


@pytest.mark.parametrize(
    "joint, told",
    [
        ({"discs": {"count": 3}}, "random discs need a radius"),
        ({"discs": {"count": 3, "density": 1, "radius": 1}}, "give exactly one of file, density"),
        ({"discs": {"count": 3, "radius": 1}, "spacing": 1}, "spacing has no effect with random"),
        ({"discs": {"file": "a.csv"}, "seed": 1}, "dip has no effect with discs of a file"),
        ({"bridge": "b"}, "bridge goes with discs only"),
        (
            {"discs": {"count": 3, "radius": 1}, "bridge": "dfn"},
            "'dfn' is the name of two surfaces",
        ),
    ],
)
def test_what_does_not_fit_is_refused(joint, told):
    with pytest.raises(CaseError, match=told):
        jointed_case({"model.joints": [{"name": "dfn", "dip": 30, "dip_direction": 0} | joint]})


@pytest.mark.parametrize(
    "text, told",
    [
        ("x,y,z,dip,radius\n1,1,1,0,1\n", "needs columns x, y, z, dip, dip_direction, radius"),
        ("x,y,z,dip,dip_direction,radius\n1,1,1,0,0,-1\n", "disc 1: radius is -1"),
        ("x,y,z,dip,dip_direction,radius\n1,1,1,0,0,1\n1,1,1,95,0,1\n", "disc 2: dip is 95"),
        ("x,y,z,dip,dip_direction,radius\n1,a,1,0,0,1\n", "disc 1: y is nan"),
    ],
)
def test_files_that_are_wrong_are_refused(tmp_path, text, told):
    (tmp_path / "discs.csv").write_text(text)
    with pytest.raises(CaseError, match=told):
        discs.read_discs(tmp_path / "discs.csv")


def test_a_case_is_checked(tmp_path):
    (tmp_path / "discs.csv").write_text("x,y,z,dip,dip_direction,radius\n5,5,5,0,0,2\n")
    box = {
        "group": "rock",
        "box": {"size": [10, 10, 10], "divisions": [10, 10, 2], "shape": "tet4"},
    }
    file = {"file": str(tmp_path / "discs.csv")}
    case = jointed_case({"model.joints": [{"name": "dfn", "discs": file}], "model.blocks": [box]})
    audit = cdem.Simulation(case, threads=1).audit
    of = audit.discs["dfn"]
    assert (of["discs"], of["met"]) == (1, 1)
    assert of["joint_area"] + of["bridge_area"] == pytest.approx(100)
    assert "joint set dfn: 1 discs, 1 of them meet blocks; joint 12" in audit.text()
    assert any("rock bridges of joint set dfn have no strength" in w for w in audit.warnings)

    case = jointed_case(
        {
            "model.joints": [{"name": "dfn", "discs": file}],
            "model.blocks": [box],
            "interfaces.pairs": [{"joint": "dfn.bridge", "cohesion": 1e6, "tensile_strength": 1e6}],
        }
    )
    audit = cdem.Simulation(case, threads=1).audit
    assert audit.warnings == [] or not any("no strength" in w for w in audit.warnings)
    case = cdem.Case.from_dict(read_text(case.dump()))  # as case.yaml of a result folder
    assert case.model.joints[0].discs.file == file["file"]
    (row,) = audit.interfaces
    assert row["joint"] == "dfn.bridge" and row["area"] == pytest.approx(of["bridge_area"])
