"""Blocks of meshes: their faces, edges and pairs."""

import dataclasses

import numpy as np
import pytest

from cdem.errors import MeshError
from cdem.mesh import blocks, mesh, primitives
from cdem.mesh.blocks import build_topology

SPRINGS = {"hex8": 24, "wedge6": 18, "pyramid5": 16, "tet4": 12}


def one_element(shape):
    box = primitives.box("a", (1, 1, 1), shape=shape)
    cell = box.cells[shape][:1]
    used, numbers = np.unique(cell, return_inverse=True)
    return mesh.Mesh(
        box.points[used], {shape: numbers.reshape(cell.shape)}, {shape: np.zeros(1, int)}, ["a"]
    )


@pytest.mark.parametrize("shape", SPRINGS)
def test_semi_springs_of_one_element(shape):
    t = build_topology(one_element(shape), {})
    assert (t.face_nodes >= 0).sum() == SPRINGS[shape]
    assert (t.edge_faces >= 0).all()
    faces, edges, nodes = len(t.face_nodes), len(t.edge_nodes), len(t.node_position)
    assert nodes - edges + faces == 2  # Euler


@pytest.mark.parametrize("shape", ["tet4", "wedge6"])
@pytest.mark.parametrize("piece", [1, 40])
def test_edges_found_in_pieces_are_those_found_at_once(monkeypatch, shape, piece):
    """Blocks larger than a piece, and several in one."""
    both = mesh.merge(
        [
            primitives.box("whole", (1, 1, 1), (2, 2, 2), shape=shape),
            primitives.box("cut", (1, 1, 1), (2, 2, 2), shape=shape),
        ]
    )
    at_once = build_topology(both, {"cut": "elements"})
    monkeypatch.setattr(blocks, "PIECE", piece)
    for name, array in dataclasses.asdict(build_topology(both, {"cut": "elements"})).items():
        np.testing.assert_equal(array, getattr(at_once, name), name)


def test_a_fully_split_box_pairs_every_inner_face_once():
    t = build_topology(primitives.box("a", (1, 1, 1), (3, 3, 3), shape="tet4"), {"a": "elements"})
    assert len(t.block_group) == 162
    assert 2 * len(t.pair_faces) + 2 * 6 * 9 == len(t.face_nodes)
    assert len(np.unique(t.pair_faces)) == t.pair_faces.size
    for (a, b), shift in zip(t.pair_faces, t.pair_shift, strict=True):
        for k in range(3):
            xa = t.node_position[t.face_nodes[a, k]]
            xb = t.node_position[t.face_nodes[b, (shift - k) % 3]]
            assert (xa == xb).all()


def test_boxes_side_by_side_are_mated_by_place():
    left, right = primitives.box("a", (1, 1, 1)), primitives.box("b", (1, 1, 1))
    right.points = right.points + [1 + 1e-12, 0, 0]
    t = build_topology(mesh.merge([left, right]), {})
    assert len(t.pair_faces) == 1


def test_a_face_has_one_mate_where_bodies_lie_inside_one_another():
    rng = np.random.default_rng(1)
    for _ in range(50):
        face = rng.random((3, 3))
        normal = np.cross(face[1] - face[0], face[2] - face[0])
        pieces = []
        for side in (1, -1, 1):  # two on one side
            apex = face.mean(0) + side * normal + np.cross(normal, rng.normal(size=3))
            points = np.vstack([face if side > 0 else face[::-1], apex])
            cells = {"tet4": np.array([[0, 1, 2, 3]])}
            pieces.append(mesh.Mesh(points, cells, {"tet4": np.zeros(1, int)}, ["a"]))
        t = build_topology(mesh.merge(pieces), {})
        assert len(t.pair_faces) == 1


def test_inverted_element_is_an_error():
    bad = one_element("tet4")
    bad.cells["tet4"] = bad.cells["tet4"][:, [1, 0, 2, 3]]
    with pytest.raises(MeshError, match=r"tet4 element 0 of group 'a'.*is inverted"):
        build_topology(bad, {})


def test_nodes_of_a_large_block_lie_as_its_elements_come_to_them(monkeypatch):
    box = primitives.box("a", (2, 1, 1), (4, 3, 3), shape="tet4")
    small = build_topology(box, {})
    monkeypatch.setattr("cdem.mesh.blocks.LARGE_BLOCK", 10)
    large = build_topology(box, {})
    seen = large.element_nodes["tet4"].ravel()
    _, first = np.unique(seen, return_index=True)
    assert (np.diff(first) > 0).all()
    assert (np.diff(small.node_point) > 0).all()
    for t in (small, large):
        assert np.array_equal(
            t.node_position[t.element_nodes["tet4"]],
            box.points[box.cells["tet4"][t.element_cell["tet4"]]],
        )


TETS = [[0, 1, 2, 3], [1, 2, 3, 4], [1, 2, 3, 5]]
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [2, 2, 2.0]])


@pytest.mark.parametrize("rows", [[0, 0], [0, 1, 0], [0, 1, 2], [1, 1, 1, 1]])
def test_elements_that_are_there_twice_are_refused(rows):
    cells = np.array([TETS[row] for row in rows])
    made = mesh.Mesh(CORNERS, {"tet4": cells}, {"tet4": np.zeros(len(cells), int)}, ["rock"])
    with pytest.raises(MeshError, match=r"'rock' lie inside one another: they share a face at"):
        build_topology(mesh.drop_unused(made), {})


@pytest.mark.parametrize("far, refused", [(1e6, False), (1e12, True), (1e25, True), (1e200, True)])
def test_points_whose_places_are_not_exact_are_refused(far, refused):
    made = one_element("hex8")
    made.points = made.points + [far, 0, 0]
    if not refused:
        assert len(build_topology(made, {}).face_nodes) == 6
        return
    with pytest.raises(MeshError, match=r"so far from the origin|is not finite"):
        build_topology(made, {})


def test_a_body_that_lies_a_million_elements_off_is_refused():
    """Points closer than 1e-9 of the model would be taken for one."""
    near, far = one_element("hex8"), one_element("hex8")
    far.points = far.points + [0, 0, 4e6]
    with pytest.raises(MeshError, match=r"the model is 4e\+06 m wide, and its smallest hex8"):
        build_topology(mesh.merge([near, far]), {})
