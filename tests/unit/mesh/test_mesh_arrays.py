"""Meshes taken apart into arrays, and HDF5 files that are read that way."""

import meshio
import numpy as np

from cdem.mesh.mesh import Mesh
from cdem.mesh.mesh_arrays import from_arrays, to_arrays
from cdem.mesh.mesh_files import read_mesh

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1.0]])
TETS = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])


def test_a_mesh_comes_back_whole(tmp_path):
    surfaces = {"a": [np.array([[0, 1, 2]])], "a 0": [], "b": [TETS[:, :3], TETS]}
    mesh = Mesh(
        POINTS, {"tet4": TETS}, {"tet4": np.array([1, 0], np.int32)}, ["ü b", "c"], surfaces, ["n"]
    )
    np.savez(tmp_path / "a.npz", **to_arrays(mesh))
    with np.load(tmp_path / "a.npz", allow_pickle=False) as arrays:
        back = from_arrays(dict(arrays))
    assert np.array_equal(back.points, POINTS) and list(back.cells) == ["tet4"]
    assert np.array_equal(back.cells["tet4"], TETS) and back.cell_group["tet4"].tolist() == [1, 0]
    assert (back.group_names, back.notes) == (["ü b", "c"], ["n"])
    assert {n: [p.tolist() for p in parts] for n, parts in back.surfaces.items()} == {
        n: [p.tolist() for p in parts] for n, parts in surfaces.items()
    }


def test_hdf5_meshes_are_read(tmp_path):
    path = tmp_path / "a.med"
    mesh = meshio.Mesh(POINTS, [("tetra", TETS)])
    mesh.write(path)
    read = read_mesh(path)
    assert np.array_equal(read.cells["tet4"], TETS) and np.array_equal(read.points, POINTS)
