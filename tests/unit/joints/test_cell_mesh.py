"""Cells meshed inside: what joints made are faces of their set."""

from shared.cells import cube, cut

from cdem.joints import cell_mesh
from cdem.mesh.blocks import build_topology


def test_planes_along_the_elements_of_a_mesh_make_joint_faces():
    c = cut(cube(divisions=(2, 2, 2)), [((1, 0, 0), 1)])
    assert c.blocks == 2
    assert (c.source == 0).sum() == 8
    t = build_topology(cell_mesh.to_mesh(c, ["rock"], [], ["wall"]), {}, ["wall"])
    assert len(t.block_group) == 2 and len(t.pair_faces) == 8
    assert (t.face_kind[t.pair_faces] == 1).all() and (t.face_kind == 1).sum() == 16
