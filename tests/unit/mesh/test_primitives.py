"""Boxes and polyhedra: their volumes and outward faces."""

import numpy as np
import pytest

from cdem.errors import MeshError
from cdem.mesh import primitives
from cdem.mesh.blocks import build_topology
from cdem.mesh.element_shapes import NODES, reference_gradients, volumes


@pytest.mark.parametrize("shape", NODES)
def test_boxes_fill_their_volume(shape):
    t = build_topology(primitives.box("a", (1, 2, 3), (2, 2, 2), shape=shape), {})
    volume = sum(
        reference_gradients(s, t.node_position[t.element_nodes[s]])[1].sum() for s in NODES
    )
    assert volume == pytest.approx(6, rel=1e-12)
    x = t.node_position[np.where(t.face_nodes < 0, t.face_nodes[:, 2:3], t.face_nodes)]
    outward = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    assert (np.einsum("ij,ij->i", outward, x.mean(axis=1) - [0.5, 1, 1.5]) > 0).all()


def test_polyhedra():
    corners = np.array(np.meshgrid([0, 1], [0, 2], [0, 3])).reshape(3, -1).T
    block = primitives.polyhedron("a", corners)
    volume = reference_gradients("tet4", block.points[block.cells["tet4"]])[1].sum()
    assert volume == pytest.approx(6, rel=1e-12)
    np.testing.assert_allclose(block.points[-1], [0.5, 1, 1.5])
    with pytest.raises(MeshError, match="not convex"):
        primitives.polyhedron("a", [*corners, [0.5, 1, 1.4]])


def test_round_off_does_not_choose_the_triangles_of_a_polyhedron():
    """Opposite corners of a square lie at half a turn, where the sign of an angle is round-off."""
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    turned = corners @ np.linalg.qr(np.random.default_rng(3).random((3, 3)))[0]
    random = np.random.default_rng(4)
    faces = [
        primitives.outward_faces(turned + random.normal(0, 1e-16, turned.shape), None)
        for _ in range(20)
    ]
    assert all(one == faces[0] for one in faces)
    assert all(face[0] == min(face) for face in faces[0])


def test_mirrored_cells_of_tets_fit_and_have_no_preferred_direction():
    mesh = primitives.box("rock", [4, 4, 4], [4, 4, 4], shape="tet4", mirrored=True)
    tets = mesh.cells["tet4"]
    assert (volumes("tet4", mesh.points[tets]) > 0).all()
    faces = np.sort(tets[:, [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]].reshape(-1, 3), axis=1)
    corners, count = np.unique(faces, axis=0, return_counts=True)
    assert (count == 1).sum() == 6 * 4 * 4 * 2 and set(count) == {1, 2}
    x = mesh.points[corners[count == 2]]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    area = np.linalg.norm(normal, axis=1)
    moment = np.einsum("fx,fy,f->xy", normal, normal, 1 / area)
    np.testing.assert_allclose(moment, moment[0, 0] * np.eye(3), atol=1e-12 * moment[0, 0])
