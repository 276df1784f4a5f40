"""Meshes placed and merged."""

import numpy as np

from cdem.case.bodies_schema import Rotate
from cdem.mesh.mesh import Mesh, merge, place


def piece(x: float, *groups: str) -> Mesh:
    """Tets side by side from x on, one in each group, and the base of the first as a surface."""
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    tets = np.arange(4 * len(groups)).reshape(-1, 4)
    return Mesh(
        np.concatenate([points + [x + i, 0, 0] for i in range(len(groups))]),
        {"tet4": tets},
        {"tet4": np.arange(len(groups), dtype=np.int32)},
        list(groups),
        {"base": [tets[:1, [0, 2, 1]]]},
    )


def test_cells_keep_their_groups_and_surfaces_their_points():
    """Groups of the same name are one, wherever they stand in their pieces."""
    merged = merge([piece(0, "a", "b"), piece(10, "c", "a")])
    groups = [merged.group_names[g] for g in merged.cell_group["tet4"]]
    assert groups == ["a", "b", "c", "a"] and len(merged.group_names) == 3
    assert merged.points[merged.cells["tet4"][:, 0], 0].tolist() == [0, 1, 10, 11]
    assert [merged.points[part[0], 0].tolist() for part in merged.surfaces["base"]] == [
        [0, 0, 1],
        [10, 10, 11],
    ]


def test_a_mesh_is_rotated_about_its_origin_before_it_is_moved():
    """A right-handed quarter turn about z through (1, 0, 0) takes (0, 0, 0) to (1, -1, 0)."""
    quarter = Rotate(axis=[0, 0, 2], angle=90, origin=[1, 0, 0])
    placed = place(piece(0, "a"), quarter, [0, 0, 5])
    expected = [[1, -1, 5], [1, 0, 5], [0, -1, 5], [1, -1, 6]]
    np.testing.assert_allclose(placed.points, expected, atol=1e-15)
