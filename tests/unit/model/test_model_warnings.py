"""Geometry of a model that is possible but odd."""

from __future__ import annotations

import numpy as np
import pytest

from cdem import Case, CaseError, Simulation
from cdem.errors import MeshError, ModelError
from cdem.mesh.blocks import build_topology
from cdem.mesh.primitives import box
from cdem.model.model_warnings import crowded_edges

BONDED = {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}


def two(gap: float, interfaces, **more) -> Case:
    """A block over a bed, which are meshed otherwise."""
    return resting(
        [
            {"group": "bed", "box": {"size": [4, 4, 1], "divisions": [3, 3, 1]}},
            {"group": "block", "box": {"size": [2, 2, 1]}, "translate": [0.5, 0.5, 1 + gap]},
        ],
        interfaces,
        **more,
    )


def resting(blocks, interfaces, **more) -> Case:
    """Blocks of the groups bed, which is fixed, and block."""
    return Case(
        model={"blocks": blocks},
        materials={"rock": {"density": 2700, "young_modulus": "10 GPa", "poisson_ratio": 0.25}},
        groups={"bed": {"material": "rock", "fix": ["x", "y", "z"]}, "block": {"material": "rock"}},
        interfaces=interfaces,
        loads={"gravity": [0, 0, -9.81]},
        stages=[{"name": "fall", "mode": "dynamic", "duration": 0.01}],
        **more,
    )


def told(case: Case) -> list[str]:
    return Simulation(case, threads=1).audit.warnings


def test_a_gap_that_leaves_a_named_strength_idle_is_told_with_its_width():
    pair = {"name": "base", "between": ["bed", "block"], **BONDED}
    assert told(two(0, {"pairs": [pair], "default": {"friction_angle": 30}})) == []
    warnings = told(two(1e-3, {"pairs": [pair], "default": {"friction_angle": 30}}))
    assert warnings == [
        "case: interfaces.pairs.0: cohesion and tensile_strength bond nothing: no faces of bed and "
        "block touch at the start, the nearest vertex is about 0.001 m from the other's surface; "
        "place them face on face if they should be bonded"
    ]


def test_an_idle_default_is_told_but_not_one_that_a_pair_inherits():
    warnings = told(two(1e-3, {"default": BONDED, "pairs": [{"between": ["bed", "block"]}]}))
    assert len(warnings) == 1
    assert "interfaces.default: cohesion and tensile_strength bond nothing" in warnings[0]


def test_strength_inside_one_block_is_told():
    pairs = [{"between": ["bed", "bed"], **BONDED}]
    warnings = told(two(0, {"default": {"friction_angle": 30}, "pairs": pairs}))
    assert len(warnings) == 1
    assert "bond nothing: group bed is one block (see model.split)" in warnings[0]


def test_strict_refuses_what_is_told_and_writes_nothing(tmp_path):
    case = two(1e-3, {"default": BONDED})
    with pytest.raises(CaseError) as error:
        Simulation(case, threads=1, output=tmp_path / "out", strict=True)
    assert "bond nothing" in str(error.value)
    assert str(error.value).endswith("\n1 warning, which --strict does not allow")
    assert not (tmp_path / "out").exists()
    Simulation(two(0, {"default": BONDED}), threads=1, strict=True)


def with_extra_cell(cells) -> None:
    mesh = box("rock", (2, 1, 1), (2, 1, 1))
    mesh.cells["hex8"] = np.vstack([mesh.cells["hex8"], cells])
    mesh.cell_group["hex8"] = np.zeros(len(mesh.cells["hex8"]), np.int32)
    build_topology(mesh, {})


def test_elements_inside_one_another_are_refused():
    mesh = box("rock", (2, 1, 1), (2, 1, 1))
    build_topology(mesh, {})
    with pytest.raises(MeshError, match="group 'rock' lie inside one another"):
        with_extra_cell(mesh.cells["hex8"][:1])  # one is there twice: three meet at a face
    for shape in ("tet4", "wedge6", "pyramid5"):
        build_topology(box("rock", (2, 2, 2), (2, 2, 2), shape=shape), {})


def test_a_folded_mesh_is_refused():
    mesh = box("rock", (1, 1, 1), shape="tet4")
    tet = mesh.cells["tet4"][0]  # a second one over a face of it, to its inner side
    mesh.points = np.vstack([mesh.points, mesh.points[tet].mean(axis=0)])
    folded = np.array([[tet[0], tet[1], tet[2], len(mesh.points) - 1]])
    mesh.cells["tet4"] = np.vstack([[tet], folded])
    mesh.cell_group["tet4"] = np.zeros(2, np.int32)
    with pytest.raises(MeshError, match=r"same side of it; 1 such face"):
        build_topology(mesh, {})


def test_bodies_that_hang_together_by_an_edge_are_told():
    mesh = box("rock", (2, 2, 1), (2, 2, 1))
    mesh.cells["hex8"] = mesh.cells["hex8"][[0, 3]]  # two of four cells, across a corner
    mesh.cell_group["hex8"] = np.zeros(2, np.int32)
    said = list(crowded_edges(build_topology(mesh, {})))
    assert len(said) == 1
    assert said[0].startswith(
        "group rock: more than two outer faces meet at 1 edge(s), the first at (1, 1, 0.5)"
    )
    assert list(crowded_edges(build_topology(mesh, {"rock": "elements"}))) == []


def test_a_body_given_twice_is_refused():
    data = two(0, {"default": {"friction_angle": 30}}).model_dump(mode="json", exclude_none=True)
    data["model"]["blocks"].append(data["model"]["blocks"][1])
    with pytest.raises(ModelError, match=r"\(group block\).* remove duplicates"):
        told(Case(**data))


@pytest.mark.parametrize(
    ("second", "expected"),
    [((0.2, 8), "differ 5 times"), ((0.4, 4), None), ((2.0, 1), "differ 5 times")],
)
def test_tiles_whose_areas_differ_are_told_where_a_larger_face_lies_on_them(second, expected):
    """Tiles of 0.5 x 0.4 m beside others of 0.2 x 0.2, 0.4 x 0.4 and 2 x 1.6 m, under 1 x 1 m."""
    blocks, x = [], 0.0
    while x < 6:
        length, rows = [(0.5, 4), second][len(blocks) % 2]
        tiles = {"size": [length, 1.6, 0.5], "divisions": [1, rows, 1]}
        blocks.append({"group": "bed", "box": tiles, "translate": [x, 0, 0]})
        x += length
    block = {"group": "block", "box": {"size": [1, 1, 0.5]}, "translate": [0.3, 0.3, 0.5]}
    case = resting([*blocks, block], {"default": {"friction_angle": 0}})
    said = [text for text in told(case) if "areas" in text]
    assert len(said) == (expected is not None)
    assert not expected or (expected in said[0] and "group block lies on faces of bed" in said[0])


@pytest.mark.parametrize(
    ("cells", "stiffness", "part"),
    [
        (1, "10 MPa/m", None),
        (2, "10 MPa/m", "0.62"),
        (3, "10 MPa/m", "0.56"),
        (3, "100 GPa/m", None),
        (3, "1 E/h", None),
    ],
)
def test_a_soft_joint_between_unlike_faces_is_told_with_the_stiffness_it_has(
    cells, stiffness, part
):
    """A block on one of the same outline: (1 + 1 / n^2) / 2 of k A for n x n faces on one."""
    bed = {"group": "bed", "box": {"size": [2, 2, 1]}}
    block = {
        "group": "block",
        "box": {"size": [2, 2, 1], "divisions": [cells, cells, 1]},
        "translate": [0, 0, 1],
    }
    joint = {"friction_angle": 30, "stiffness_n": "100 GPa/m", "stiffness_s": stiffness}
    told = Simulation(resting([bed, block], {"default": joint}), threads=1).audit.warnings
    told = [line for line in told if "differ in size" in line]
    assert len(told) == (part is not None)
    assert not part or f"has about {part} of the stiffness" in told[0]
