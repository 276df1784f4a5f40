"""Water and shaking: options, heads, forces."""

import numpy as np
import pytest
from shared.hills import frustum

from cdem.errors import CaseError
from cdem.screening.loads import Loads, force_on, read_water
from cdem.terrain.heights import Grid

GROUND = Grid(0, 0, (10, 10), np.full((4, 5), 100.0))


def test_forces_of_weight_shaking_crack_and_uplift():
    normals = np.array([[0.6, 0, 0.8], [0, 0, 1.0]])
    force = force_on(
        np.array([10.0]), np.array([0, 1.0]), 0.2, 0.1, 3.0, np.array([[5.0, 1.0]]), normals
    )
    # across 0.2 x 10 + 3 to the north, 0.9 x 10 down, 5 and 1 along the normals
    assert force == pytest.approx(np.array([[3.0, 5.0, -9.0 + 4.0 + 1.0]]))


def test_heads_of_a_share_and_of_a_table():
    bed, thickness = np.array([90.0, 95, 99]), np.array([10.0, 5, 1])
    assert (Loads(share=0.4).heads(slice(3), bed, thickness) == thickness).all()
    table = Loads(share=1, level=np.array([93.0, 200, np.nan]))
    assert table.heads(slice(3), bed, thickness).tolist() == [3, 5, 0]  # at most the ground; dry
    at = Loads(share=1, level=np.full((4, 5), 93.0)).heads_at
    xy = np.array([[11.0, 12.0], [20, 20]])
    assert at(GROUND, xy, np.array([90.0, 95]), np.array([10.0, -1])) == pytest.approx([3, 0])


@pytest.mark.parametrize("text", ["0", "0.35", "1"])
def test_a_number_is_a_share(text):
    assert read_water(text, GROUND) == (float(text), None, [])


def test_a_height_needs_its_unit():
    share, level, notes = read_water("120 m", GROUND)
    assert share == 1 and (level == 120).all() and "above the ground in 100.0 %" in notes[0]
    assert read_water(None, GROUND) == (0, None, [])
    for wrong, why in (("120", "must lie in 0 to 1"), ("-0.1", "in 0 to 1"), ("wet", "must be a number"),
                       ("3 kPa", "wrong dimension"), ("nan", "must be")):  # fmt: skip
        with pytest.raises(CaseError, match=why) as error:
            read_water(wrong, GROUND)
        assert str(error.value).startswith(f"--water {wrong}") and "\n" not in str(error.value)


def test_a_grid_of_heights(tmp_path):
    head = "ncols 3\nnrows 4\nxllcorner -5\nyllcorner -5\ncellsize 10\nNODATA_value -9999\n"
    path = tmp_path / "table.asc"
    path.write_text(head + "90 90 90\n90 90 90\n90 -9999 90\n90 90 101\n")
    share, level, notes = read_water(str(path), GROUND)
    assert (
        share == 1
        and level[3, 0] == 90
        and np.isnan(level[0, 4])
        and np.isnan(level[1, 1])
        and level[1, 2] == 90
    )
    assert "dry there" in notes[0] and "the ground counts there" in notes[1]
    far = frustum(10.0)
    with pytest.raises(CaseError, match="no height of the water table on the map"):
        read_water(str(path), Grid(far.west + 9e4, far.south, far.step, far.values))


def test_words():
    assert Loads().text() == "dry" and not Loads().is_wet
    loads = Loads(0.1, -0.05, 0.5, crack=8.0)
    assert loads.text() == (
        "water table at 0.5 of the height between plane and ground, tension crack of 8 m in "
        "profiles, shaken by 0.1 g in the direction of sliding, -0.05 g up"
    )
    assert Loads(share=1, level=np.zeros((1, 1))).text() == "with a water table"
