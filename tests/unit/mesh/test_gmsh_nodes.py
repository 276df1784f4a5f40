"""Elements of gmsh files that name nodes which are not there, and elements that are cut short."""

import meshio
import numpy as np
import pytest

from cdem.errors import MeshError
from cdem.mesh.mesh_files import read_mesh

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [9, 9, 9.0]])
TETS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])


def write(path, form, binary, tets=TETS):
    meshio.Mesh(POINTS, [("tetra", tets)]).write(path, file_format=form, binary=binary)
    return path


@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("form", ["gmsh22", "gmsh"])
@pytest.mark.parametrize("node", [-1, 0, 8])
def test_a_node_that_is_not_there_is_named_with_its_element(tmp_path, form, binary, node):
    """0 and -1 would be taken for the last nodes."""
    path = write(tmp_path / "a.msh", form, binary, np.array([[0, 1, 2, 3], [1, 2, 3, node - 1]]))
    with pytest.raises(MeshError, match=rf"a\.msh: element 2 names node {node}, which the file"):
        read_mesh(path)


@pytest.mark.parametrize("form", ["gmsh22", "gmsh"])
def test_a_gap_in_the_ids_is_no_node(tmp_path, form):
    path = write(tmp_path / "a.msh", form, False)
    text = path.read_text()
    path.write_text(text.replace("5 1.0", "77 1.0").replace("\n5\n6\n", "\n77\n6\n"))
    with pytest.raises(MeshError, match=r"element 2 names node 5, which the file does not have"):
        read_mesh(path)


@pytest.mark.parametrize("form", ["gmsh22", "gmsh"])
def test_ids_may_have_gaps_and_zeros_in_front(tmp_path, form):
    path = write(tmp_path / "a.msh", form, False)
    text = path.read_text()
    text = text.replace("5 1.0", "0077 1.0").replace("\n5\n6\n", "\n0077\n6\n")
    path.write_text(text.replace("2 3 4 5", "2 3 4 77"))
    assert np.array_equal(read_mesh(path).cells["tet4"], TETS)


def test_an_element_that_is_cut_short_does_not_take_its_tags_for_nodes(tmp_path):
    path = write(tmp_path / "a.msh", "gmsh22", False)
    path.write_text(path.read_text().replace("2 3 4 5", "2 3 4"))
    with pytest.raises(MeshError, match="element 2 has 3 nodes and needs 4"):
        read_mesh(path)


def test_an_id_belongs_to_one_node(tmp_path):
    path = write(tmp_path / "a.msh", "gmsh22", False)
    path.write_text(path.read_text().replace("\n6 9.0", "\n5 9.0"))
    with pytest.raises(MeshError, match="declares 6 nodes, but has 5 different ids"):
        read_mesh(path)
