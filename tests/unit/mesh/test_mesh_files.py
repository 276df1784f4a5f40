"""Mesh files: what they hold, and what is said of those that hold nothing."""

import contextlib
import gzip
import io

import meshio
import numpy as np
import pytest

from cdem.case import input_file
from cdem.errors import MeshError
from cdem.mesh.blocks import check_elements
from cdem.mesh.element_shapes import NODES, volumes
from cdem.mesh.mesh_files import read_mesh
from cdem.mesh.primitives import box

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
    with pytest.raises(MeshError, match="contains no volume elements"):
        read_mesh(path)


@pytest.mark.parametrize("kind", [".mesh", ".vol", ".vtk", ".inp", ".bdf", ".su2"])
@pytest.mark.parametrize("node", [-1, 50])
def test_other_formats_name_no_node_that_is_not_there(tmp_path, kind, node):
    path = tmp_path / f"a{kind}"
    with contextlib.redirect_stdout(io.StringIO()):
        meshio.write_points_cells(path, POINTS, [("tetra", [[0, 1, 2, 3], [1, 2, 3, node]])])
    with pytest.raises(MeshError, match=r"names node|is missing"):
        read_mesh(path)


@pytest.mark.parametrize(
    ("name", "raw", "message"),
    [
        ("a.off", b"OFF\n3 1 0\n0", "a.off: unknown kind of mesh; .*known are: .avs"),
        ("a.dxf", b"", "a.dxf: unknown kind of mesh; export the volume elements"),
        ("a.stl", b"solid", r"contains surfaces, .* read with model.blocks: \[{group: NAME, file"),
        ("a.off", b"OFF", "unknown kind of mesh"),
        ("a.ply", b"ply", "contains surfaces, .* closed convex bodies are read with model.blocks"),
        ("a.msh", b"", "a.msh: cannot be read"),
        (
            "a.post",
            b"!\n!\n$ENTER COMPONENT NAME=DFLT_COMP\n$STRUCTURE\n$COOR\n1 0.0 0.0 0.0\n2 1.0 0 0\n!\n"
            b"$ELEMENT TYPE=TET4\n!\n",
            "contains no volume elements",
        ),
        ("a.msh", b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n9\n1 0 0", "declares 9 nodes"),
        ("a.msh", b"(10 (0 1 ", "a.msh: cannot be read"),
        ("a.inp", b"*NODE\n1, x, 0, 0\n", "cannot be read"),
        ("a.msh.gz", b"no gzip", "a.msh.gz: cannot be read .*; is it complete"),
        (
            "a.msh.gz",
            gzip.compress(b"$MeshFormat\n" * 9, mtime=0)[:-20],
            "a.msh.gz: cannot be read",
        ),
        (
            "a.msh.gz",
            gzip.compress(bytes(50_000_000), mtime=0),
            "unpacks to more than 100 times its size",
        ),
        ("a.vtu", b"<!DOCTYPE a [<!ENTITY b 'c'>]><VTKFile/>", "cannot be read .*DTDForbidden"),
        (
            "a.msh",
            b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n2147483647 0 0 0\n$EndNodes\n"
            b"$Elements\n0\n$EndElements\n",
            "needs more memory than a sound file",
        ),
    ],
)
def test_files_that_are_no_meshes(tmp_path, name, raw, message):
    path = tmp_path / name
    path.write_bytes(raw)
    with pytest.raises(MeshError, match=message):
        read_mesh(path)


@pytest.mark.parametrize(
    ("name", "raw"), [("a.node", b"# Th"), ("a.mdpa", b"Begin Nodes\n1 0 0 0\n")]
)
def test_readers_of_meshio_that_never_end_are_ended(tmp_path, monkeypatch, name, raw):
    monkeypatch.setattr(input_file, "LEAST_SECONDS", 0.3)
    path = tmp_path / name
    path.write_bytes(raw)
    with pytest.raises(MeshError, match=rf"{name}: reading it takes more than 0.3 s .*; is it"):
        read_mesh(path)


@pytest.mark.parametrize("shape", list(NODES))
def test_elements_that_are_all_inside_out_are_turned(tmp_path, shape):
    """As netgen numbers tets; the volume is that of the box."""
    made = box("rock", (2, 3, 4), (2, 2, 2), shape=shape)
    cells = made.cells[shape].copy()
    mirrored = made.points * [1, 1, -1]
    path = tmp_path / "a.vtk"
    name = {"tet4": "tetra", "pyramid5": "pyramid", "wedge6": "wedge", "hex8": "hexahedron"}[shape]
    meshio.write_points_cells(path, mirrored, [(name, cells)])
    read = read_mesh(path)
    total = volumes(shape, read.points[read.cells[shape]])
    assert (total > 0).all() and total.sum() == pytest.approx(24, rel=1e-12)
    assert "were numbered inside out" in read.notes[0] and str(len(cells)) in read.notes[0]
    check_elements(read)


def test_some_elements_inside_out_stay_an_error(tmp_path):
    path = tmp_path / "a.vtk"
    meshio.write_points_cells(path, POINTS, [("tetra", [[0, 2, 1, 3], [1, 2, 3, 4]])])
    with pytest.raises(MeshError, match=r"element 0 of group 'default', .* is inverted"):
        check_elements(read_mesh(path))
