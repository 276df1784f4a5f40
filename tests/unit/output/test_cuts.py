"""Planes to cut by, and the lines of a cut."""

import numpy as np
import pytest

from cdem.errors import CdemError
from cdem.output.cuts import Plane, outlines
from cdem.output.reader import Surface
from cdem.output.scene import View


@pytest.mark.parametrize(
    "text, right, up, back",
    [
        ("y=2", [1, 0, 0], [0, 0, 1], [0, -1, 0]),
        ("x = 2", [0, 1, 0], [0, 0, 1], [1, 0, 0]),
        ("z=-2e1", [1, 0, 0], [0, 1, 0], [0, 0, 1]),
        ("0,0,10,0", [1, 0, 0], [0, 0, 1], [0, -1, 0]),
        ("3,0,3,-8", [0, -1, 0], [0, 0, 1], [-1, 0, 0]),
    ],
)
def test_a_plane_and_its_viewer(text, right, up, back):
    plane = Plane.parse(text)
    view = View.framing(np.eye(3), plane.back)
    assert plane.back == pytest.approx(back)
    assert view.right == pytest.approx(right)
    assert view.up == pytest.approx(up)


@pytest.mark.parametrize("text", ["", "w=1", "y=", "y=two", "1,2,3", "1,2,1,2", "y=1,2"])
def test_what_is_no_plane_is_told(text):
    with pytest.raises(CdemError, match="--slice"):
        Plane.parse(text)


def test_lines_run_round_blocks_not_round_elements():
    """Two squares of one block and a triangle of another in a row: 3 + 2 + ... edges, one is inner."""
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0], [3, 0, 0]])
    polygons = np.array([[0, 1, 2, 3], [1, 4, 5, 2], [4, 6, 5, -1]])
    cut = Surface(0.0, points.astype(float), polygons, {}, {"block": np.array([7, 7, 8])}, [])
    found = {tuple(edge) for edge in outlines(cut).tolist()}
    assert found == {(0, 1), (2, 3), (0, 3), (1, 4), (2, 5), (4, 5), (4, 6), (5, 6)}
