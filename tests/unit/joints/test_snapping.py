"""Points of tets next to a plane move onto it: no slivers, and outer faces stay."""

from dataclasses import replace

import numpy as np
import pytest
from shared.cells import ALL, cube

from cdem.case.bodies_schema import Joint, Model
from cdem.joints import convex_cells, cutting
from cdem.joints.joints import cut_model
from cdem.joints.snapping import CLOSE, onto_plane
from cdem.mesh import primitives
from cdem.mesh.mesh import Mesh

NORMAL = np.array([np.sin(0.6), 0.0, np.cos(0.6)])
OFFSET = float(NORMAL @ [2.03, 1, 2.02])
"""A plane that passes points of a grid of 1 m by a few centimetres."""


def tets(size=4, **more) -> Mesh:
    return primitives.box("rock", (size,) * 3, (size,) * 3, shape="tet4", **more)


def cells(mesh: Mesh, block=None) -> convex_cells.Cells:
    count = len(mesh.cells["tet4"])
    return convex_cells.from_mesh(
        mesh, mesh.group_names, np.zeros(count, int) if block is None else block
    )


def least_height(c: convex_cells.Cells) -> float:
    """Volume of the thinnest cell over its longest side cubed."""
    size = np.array([np.ptp(c.points[np.unique(c.corner[c.cell[c.owner()] == k])], axis=0).max()
                     for k in range(len(c.block))])  # fmt: skip
    return float((c.volumes() / size**3).min())


def test_a_plane_cuts_no_slivers_and_the_body_keeps_its_shape():
    c = cells(tets())
    moved, count, way = onto_plane(c, NORMAL, OFFSET, ALL)
    assert count >= 5 and 0 < way < 2 * CLOSE
    plain, snapped = (cutting.cut(x, NORMAL, OFFSET, 0, among=ALL)[0] for x in (c, moved))
    assert snapped.volumes().sum() == pytest.approx(64, rel=1e-14)
    assert least_height(snapped) > 5 * least_height(plain)
    on = (c.points == 0) | (c.points == 4)
    assert (moved.points[on] == c.points[on]).all()  # along sides and edges, or not at all
    distance = moved.points @ NORMAL - OFFSET
    went = (moved.points != c.points).any(axis=1)
    assert np.abs(distance[went]).max() < 1e-14
    assert (snapped.block == 0).sum() and snapped.blocks == 2


def test_corners_and_points_far_away_stay():
    c = cells(tets())
    corner = np.ones(3) / np.sqrt(3)
    assert onto_plane(c, corner, 0.05, ALL)[1:] == (0, 0.0)
    assert onto_plane(c, np.array([0, 0, 1.0]), 2.5, ALL)[0] is c


def test_points_of_faces_along_the_plane_stay():
    """They would slide by more than twice their distance: here by three and a half times."""
    lean = np.array([np.sin(0.3), 0.0, np.cos(0.3)])
    assert onto_plane(cells(tets()), lean, float(lean @ [2, 2, 3.99]), ALL)[1] == 0


def test_no_tet_loses_more_than_four_fifths_of_its_volume():
    random = np.random.default_rng(3)
    mesh = tets()
    inner = ((mesh.points > 0) & (mesh.points < 4)).all(axis=1)
    mesh.points[inner] += random.uniform(-0.45, 0.45, (inner.sum(), 3))
    c, moves = cells(mesh), 0  # some tets are inside out

    def volumes(points):
        x = points[mesh.cells["tet4"]]
        return np.linalg.det(x[:, 1:] - x[:, :1])

    for _ in range(300):
        normal = random.normal(size=3)
        normal /= np.linalg.norm(normal)
        moved, count, _ = onto_plane(c, normal, float(normal @ random.uniform(1, 3, 3)), ALL)
        before = volumes(c.points)
        good = before > 0
        assert (volumes(moved.points)[good] > 0.2 * (1 - 1e-9) * before[good]).all()
        moves += count
    assert moves > 300


def test_a_tet_that_is_inside_out_is_left_to_those_who_refuse_it():
    mesh = tets()
    mesh.cells["tet4"][5] = mesh.cells["tet4"][5][[1, 0, 2, 3]]
    assert onto_plane(cells(mesh), NORMAL, OFFSET, ALL)[1] >= 1


def test_only_tets_move():
    hexahedra = primitives.box("rock", (4, 4, 4), (4, 4, 4))
    c = convex_cells.from_mesh(hexahedra, ["rock"], np.zeros(64, int))
    assert onto_plane(c, NORMAL, OFFSET, ALL)[0] is c
    whole = cube(4)
    assert onto_plane(whole, NORMAL, OFFSET, ALL)[0] is whole


def test_points_without_a_cell_stay():
    """A mesh of which one group is cut has the points of all."""
    c = cells(tets())
    lonely = replace(c, points=np.concatenate([c.points, [[2.03, 1, 2.03]]]))
    moved, count, _ = onto_plane(lonely, NORMAL, OFFSET, ALL)
    assert count == onto_plane(c, NORMAL, OFFSET, ALL)[1]
    assert (moved.points[-1] == lonely.points[-1]).all()


def test_points_between_blocks_slide_along_their_border():
    mesh = tets()
    middle = mesh.points[mesh.cells["tet4"]].mean(axis=1)
    c = cells(mesh, (middle[:, 0] > 2).astype(int))
    moved = onto_plane(c, NORMAL, OFFSET, ALL)[0]
    border = c.points[:, 0] == 2
    assert (moved.points[border, 0] == 2).all()
    assert (moved.points[border] != c.points[border]).any()


def test_points_of_a_curved_surface_stay():
    mesh = tets()
    top = mesh.points[:, 2] == 4
    mesh.points[top, 2] += 0.002 * mesh.points[top, 0] ** 2
    c = cells(mesh)
    moved, count, _ = onto_plane(c, NORMAL, OFFSET, ALL)
    upright = onto_plane(c, np.array([1.0, 0, 0]), 2.03, ALL)[0]
    inner = ~((c.points <= 0) | (c.points >= 4)).any(axis=1)
    assert count > 0 and (moved.points[top] == c.points[top]).all()
    went = (upright.points != c.points).any(axis=1)
    assert went[inner & (c.points[:, 0] == 2)].all() and not went[top].any()


def test_points_where_two_surfaces_meet_stay():
    mesh = tets()
    top = mesh.points[:, 2] == 4
    faces = mesh.cells["tet4"][:, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]].reshape(-1, 3)
    faces = faces[top[faces].all(axis=1)]
    left = mesh.points[faces].mean(axis=1)[:, 0] < 2
    mesh.surfaces = {"left": [faces[left]], "right": [faces[~left]]}
    c = cells(mesh)
    steep, through = np.array([0.9, 0.0, np.sqrt(0.19)]), np.array([2.05, 0, 4])
    moved = onto_plane(c, steep, float(steep @ through), ALL)[0]
    between = top & (mesh.points[:, 0] == 2)
    went = (moved.points != c.points).any(axis=1)
    assert went.any()
    sources = c.source[np.unique(c.owner()[np.isin(c.corner, np.flatnonzero(between))])]
    assert len(np.unique(sources[sources < -1])) == 2
    assert not went[between].any()


def test_a_joint_in_tets_is_plane_to_the_last_point():
    """A vertex a few millimetres from it was a step that held the block above."""
    dip = np.radians(35)
    start = [4, 0, 2 + 3e-4 - 2 * np.tan(dip)]  # passes points by 0.2 mm
    joint = Joint(name="plane", dip=35, dip_direction=90, origin=start)
    mesh = cut_model([(tets(), None)], Model(blocks=[], mesh="x.msh", joints=[joint]))
    points = np.unique(np.concatenate([part.ravel() for part in mesh.surfaces["plane"]]))
    normal = np.array([np.sin(dip), 0, np.cos(dip)])
    off = (mesh.points[points] - start) @ normal
    assert np.abs(off).max() < 1e-12
    assert any("points of tets moved onto the planes" in note for note in mesh.notes)
