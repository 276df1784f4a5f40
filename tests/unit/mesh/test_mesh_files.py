"""Mesh files: what they hold, and what is said of those that hold nothing."""

import meshio
import numpy as np
import pytest

from cdem.errors import MeshError
from cdem.mesh.mesh_files import read_mesh

TETS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1.0]])


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(MeshError, match=r"none\.msh: no such mesh file; give a path relative"):
        read_mesh(tmp_path / "none.msh")


def test_groups_are_those_of_their_cells(tmp_path):
    """Two tets in two physical groups of gmsh, and a surface."""
    path = tmp_path / "two.msh"
    cells = [("tetra", TETS), ("triangle", [[0, 1, 2]])]
    tags = [np.array([7, 3]), np.array([5])]
    names = {"upper": np.array([7, 3]), "lower": np.array([3, 3]), "base": np.array([5, 2])}
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    mesh = meshio.Mesh(POINTS, cells, cell_data=data, field_data=names)
    meshio.write(path, mesh, file_format="gmsh22", binary=False)
    read = read_mesh(path)
    assert np.array_equal(read.cells["tet4"], TETS)
    assert [read.group_names[g] for g in read.cell_group["tet4"]] == ["upper", "lower"]
    assert [faces.tolist() for faces in read.surfaces["base"]] == [[[0, 1, 2]]]


def test_a_surface_is_no_volume(tmp_path):
    path = tmp_path / "skin.vtk"
    meshio.write_points_cells(path, POINTS, [("triangle", TETS[:, :3])], file_format="vtk")
    with pytest.raises(MeshError, match="holds no volume elements"):
        read_mesh(path)
