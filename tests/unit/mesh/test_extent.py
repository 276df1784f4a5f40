"""Size and place of a mesh."""

from __future__ import annotations

import numpy as np
import pytest

from cdem.errors import MeshError
from cdem.mesh.extent import check_extent
from cdem.mesh.primitives import box


def made(size, away=0.0):
    mesh = box("rock", size, (2, 2, 2))
    mesh.points = mesh.points + away
    return mesh


@pytest.mark.parametrize("size", [(50, 50, 30), (0.1, 0.05, 0.05), (20_000, 8_000, 3_000)])
def test_usual_sizes_are_not_noted(size):
    mesh = made(size)
    check_extent(mesh)
    assert mesh.notes == []


@pytest.mark.parametrize(
    ("size", "said"),
    [
        ((1e5, 1e4, 1e3), "length of the model: 100000 m is unusual; usual is 0.001 m to 50000 m"),
        ((4e4, 4e4, 3e4), "height of the model: 30000 m is unusual"),
        ((1e-4, 1e-4, 1e-4), "length of the model: 0.0001 m is unusual"),
    ],
)
def test_millimetres_are_noted(size, said):
    mesh = made(size)
    check_extent(mesh)
    assert len(mesh.notes) == 1
    assert mesh.notes[0].startswith(said)
    assert "is the mesh in mm or cm?" in mesh.notes[0]


def test_a_body_larger_than_the_earth_is_refused():
    with pytest.raises(MeshError, match="2e\\+07 m is not possible"):
        check_extent(made((2e7, 1, 1)))


def test_map_coordinates_are_fine_and_far_ones_are_noted_then_refused():
    mesh = made((2, 2, 2), away=np.array([5e5, 5e6, 0]))  # UTM
    check_extent(mesh)
    assert mesh.notes == []
    mesh = made((2, 2, 2), away=1e9)
    check_extent(mesh)
    assert len(mesh.notes) == 1
    assert "e.g. model.translate: [-1e+09, -1e+09, -1e+09]" in mesh.notes[0]
    with pytest.raises(MeshError, match="times their size from the origin"):
        check_extent(made((2, 2, 2), away=1e15))
