"""Triangles of STL files, text and binary; damaged ones are refused."""

import struct

import numpy as np
import pytest

from cdem.errors import MeshError
from cdem.mesh.stl_file import read_stl

FACET = (
    "facet normal 0 0 1\nouter loop\nvertex 0 0 5\nvertex 2 0 5\nvertex 0 3 5\nendloop\nendfacet\n"
)
CORNERS = [[0, 0, 5], [2, 0, 5], [0, 3, 5]]


def test_text(tmp_path):
    path = tmp_path / "a.stl"
    path.write_text(f"solid a slope\n{FACET}{FACET.upper()}endsolid a slope\n")
    points, rounding = read_stl(path)
    assert points.tolist() == CORNERS * 2
    assert rounding == 5 * 2.0**-24


def test_binary_that_begins_like_text(tmp_path):
    path = tmp_path / "a.stl"
    facet = struct.pack("<12fH", 0, 0, 1, *np.ravel(CORNERS), 0)
    path.write_bytes(b"solid".ljust(80) + struct.pack("<I", 2) + facet * 2)
    assert read_stl(path)[0].tolist() == CORNERS * 2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("solid a\nfacet\nvertex 0 0 0\n", r"ends within a facet; is it complete"),
        ("solid a\nvertex 0 0 0\nendfacet\n", r"a\.stl:3: a facet has three vertices"),
        ("solid a\nvertex 0 0\n", r"a\.stl:2: cannot be read: vertex 0 0"),
        ("solid a\nvertex 0 0 0 0\n", r"a\.stl:2: cannot be read: vertex 0 0 0 0"),
        ("solid a\nvertex 0,5 0 0\n", r"a\.stl:2: cannot be read: vertex 0,5 0 0"),
        ("\0\1\2", r"is no complete STL"),
        ("", r"is no complete STL"),
    ],
)
def test_what_is_refused(tmp_path, text, message):
    path = tmp_path / "a.stl"
    path.write_text(text)
    with pytest.raises(MeshError, match=message):
        read_stl(path)


def test_a_truncated_binary_file(tmp_path):
    path = tmp_path / "a.stl"
    path.write_bytes(b" " * 80 + struct.pack("<I", 1000) + b"\0" * 60)
    words = "1000 triangles of a binary file take 50084 bytes, but it has 144"
    with pytest.raises(MeshError, match=words):
        read_stl(path)
