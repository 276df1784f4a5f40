"""OBJ: faces with their parts; the files of their looks stay closed."""

from cdem.mesh.obj_file import read_obj


def test_faces_parts_and_other_lines(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(
        "# a comment\nmtllib none.mtl\nv 0 0 0 0.5 0.5 0.5\nv 1 0 0\nv 0 1 0\no one\n"
        "f 1 2/7 3/7/7\ng two\nf -3 -2 -1\nusemtl red\nl 1 2\n"
    )
    found = read_obj(path)
    assert found.points.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert found.loops == [[0, 1, 2], [0, 1, 2]] and found.parts == ["one", "two"]
    assert found.others == {"mtllib": 1, "usemtl": 1, "l": 1}
