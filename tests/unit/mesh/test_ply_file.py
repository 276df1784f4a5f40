"""PLY files have as many vertices and faces as their headers name."""

import meshio
import numpy as np
import pytest

from cdem.errors import MeshError
from cdem.mesh.ply_file import read_ply

POINTS = np.array([[0, 0, 5], [2, 0, 5], [0, 3, 5], [2, 3, 6.0]])
TRIANGLES = np.array([[0, 1, 2], [1, 3, 2]])
HEAD = "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"


@pytest.mark.parametrize("binary", [True, False])
def test_points_and_faces(tmp_path, binary):
    path = tmp_path / "a.ply"
    meshio.Mesh(POINTS, [("triangle", TRIANGLES)]).write(path, binary=binary)
    found = read_ply(path)
    assert np.array_equal(found.points, POINTS)
    assert np.array_equal(found.cells[0].data, TRIANGLES)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("not one", "has no header of a PLY file with vertices"),
        (HEAD.format(3) + "0 0 0\n", "has no header of a PLY file with vertices"),
        ("ply\nformat ascii 1.0\nend_header\n", "has no header of a PLY file with vertices"),
        (HEAD.format(3) + "end_header\n0 0 0\n1 0 0\n", "names 3 points and has 2: it is cut off"),
    ],
)
def test_what_is_refused(tmp_path, text, message):
    path = tmp_path / "a.ply"
    path.write_text(text)
    with pytest.raises(MeshError, match=message):
        read_ply(path)


def test_a_file_that_is_cut_off_after_a_face(tmp_path):
    path = tmp_path / "a.ply"
    meshio.Mesh(POINTS, [("triangle", TRIANGLES.astype(np.int32))]).write(path, binary=True)
    path.write_bytes(path.read_bytes()[:-13])  # a face is a byte and three numbers
    with pytest.raises(MeshError, match="names 2 faces and has 1: it is cut off"):
        read_ply(path)
