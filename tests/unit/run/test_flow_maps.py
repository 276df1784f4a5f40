"""Largest values over a grid, of boxes whose motion is known, against numbers made by hand."""

from __future__ import annotations

import numpy as np
import pytest

from cdem.errors import CdemError
from cdem.mesh import primitives
from cdem.mesh.element_volumes import Solids
from cdem.run.flow_maps import FlowMaps, Moment

DENSITY = 2500.0


def moment(time, at, size=(1, 1, 2), velocity=(0, 0, 0), divisions=(1, 1, 1), piece=None):
    made = primitives.box("rock", size, divisions)
    solids = Solids.of(made.points + np.asarray(at, float), made.cells)
    velocity = np.tile(np.asarray(velocity, float), (len(solids.middle), 1))
    piece = np.zeros(len(solids.middle), int) if piece is None else np.asarray(piece)
    return Moment(time, solids, velocity, DENSITY * solids.volumes(), piece)


def test_a_box_that_slides_leaves_its_numbers_where_it_was():
    # 2 m high, 3 m/s in x and 4 m/s down; a look every quarter of a cell
    maps, v = FlowMaps(1.0, start=10.0), (3.0, 0.0, -4.0)
    for k in range(17):
        maps.take_in(moment(10.0 + k / 12, (0.25 * k, 5, 0), velocity=v))
    assert maps.low == (0, 5)
    assert maps.layers.shape[1:] == (1, 5)
    exact = {
        "thickness_max": 2.0,
        "velocity_max": 5.0,
        "velocity_mean_max": 5.0,
        "momentum_max": 10.0,
        "energy_area_max": 0.5 * DENSITY * 2 * 25,
        "energy_piece_max": 0.5 * DENSITY * 2 * 25,
        "pressure_max": DENSITY * 25,
    }
    for name, value in exact.items():
        np.testing.assert_allclose(maps[name], value, rtol=1e-12, err_msg=name)
    # the front is in the next cell at the first look after it has come to its edge
    np.testing.assert_allclose(maps["arrival"], [[0, *(np.arange(4) + 0.25) / 3]], atol=1e-12)
    assert maps.jump == pytest.approx(0.25)
    assert maps.last == 10.0 + 16 / 12


def test_the_mean_velocity_of_a_column_is_that_of_its_volume():
    # two cubes, one on the other, that meet: the fastest is no mean
    one = moment(0.0, (0, 0, 0), (1, 1, 1), (4, 0, 0))
    two = moment(0.0, (0, 0, 1), (1, 1, 1), (-1, 0, 0))
    solids = Solids(
        np.concatenate([one.solids.triangles, two.solids.triangles]),
        np.concatenate([one.solids.owner, two.solids.owner + 1]),
        np.concatenate([one.solids.middle, two.solids.middle]),
    )
    both = Moment(
        0.0, solids, np.vstack([one.velocity, two.velocity]), np.full(2, DENSITY), np.array([3, 8])
    )
    maps = FlowMaps(1.0, start=0.0)
    maps.take_in(both)
    assert maps["velocity_max"] == pytest.approx(4.0)
    assert maps["velocity_mean_max"] == pytest.approx(1.5)
    assert maps["momentum_max"] == pytest.approx(3.0)
    assert maps["energy_area_max"] == pytest.approx(0.5 * DENSITY * 17)
    assert maps["energy_piece_max"] == pytest.approx(0.5 * DENSITY * 16)


def test_a_piece_brings_all_its_energy_to_each_cell_that_it_covers():
    maps = FlowMaps(1.0, start=0.0)
    maps.take_in(moment(0.0, (0, 0, 0), (4, 1, 1), (2, 0, 0), (4, 1, 1), piece=[1, 1, 7, 1]))
    np.testing.assert_allclose(maps["energy_piece_max"], [[15000, 15000, 5000, 15000]])


def test_maps_grow_to_all_sides_and_keep_what_they_held():
    maps = FlowMaps(1.0, start=0.0)
    for time, at in enumerate([(0, 0, 0), (-3, 0, 0), (0, 2, 0), (2, -4, 0)]):
        maps.take_in(moment(float(time), at))
    assert maps.low == (-3, -4)
    found = {(int(x) - 3, int(y) - 4): maps["arrival"][y, x] for y, x in np.argwhere(maps.affected)}
    assert found == {(0, 0): 0, (-3, 0): 1, (0, 2): 2, (2, -4): 3}
    assert maps["thickness_max"].sum() == pytest.approx(8.0)
    assert maps.jump == pytest.approx(np.hypot(2, 6))


def test_thin_rock_has_not_met_a_cell():
    for cell, met in ((10.0, 0.1), (0.5, 0.05)):
        maps = FlowMaps(cell, start=0.0)
        assert maps.met == pytest.approx(met)
        maps.take_in(moment(0.0, (0, 0, 0), (cell, cell, 0.9 * met)))
        assert not maps.affected.any()
        maps.take_in(moment(1.0, (0, 0, 0), (cell, cell, 1.1 * met)))
        assert maps.affected.all()


def test_a_huge_map_is_refused():
    maps = FlowMaps(1e-3, start=0.0)
    with pytest.raises(CdemError, match="choose a larger cell"):
        maps.take_in(moment(0.0, (0, 0, 0), (9, 9, 1)))
