"""Volumes, levels, cuts and columns of all element shapes, each against another way."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from cdem.mesh import primitives
from cdem.mesh.element_shapes import NODES, reference_gradients
from cdem.mesh.element_volumes import Solids

FAR = np.array([5e5, 3e6, 800.0])  # where maps put a slope


EAST = np.array([1.0, 0.0, 0.0])


def rough(shape: str, shift=0.0) -> Solids:
    """A box whose inner and outer nodes are all displaced: warped faces, no right angles."""
    made = primitives.box("rock", [4, 3, 2], (4, 3, 2), shape=shape)
    noise = 0.1 * np.random.default_rng(1).standard_normal(made.points.shape)
    return Solids.of(made.points + noise + shift, made.cells)


def box(size, at=(0, 0, 0), shape="hex8", divisions=(1, 1, 1)) -> Solids:
    made = primitives.box("rock", size, divisions, shape=shape)
    return Solids.of(made.points + at, made.cells)


@pytest.mark.parametrize("shape", NODES)
def test_volumes_are_those_of_the_elements(shape):
    made = primitives.box("rock", [4, 3, 2], (4, 3, 2), shape=shape)
    made.points += 0.1 * np.random.default_rng(2).standard_normal(made.points.shape)
    exact = reference_gradients(shape, made.points[made.cells[shape]])[1].sum(axis=1)
    np.testing.assert_allclose(Solids.of(made.points, made.cells).volumes(), exact, rtol=1e-12)


def test_centroids_of_a_wedge_and_of_a_pyramid():
    wedge = np.array([[0, 0, 0], [3, 0, 0], [0, 3, 0], [0, 0, 2], [3, 0, 2], [0, 3, 2]], float)
    pyramid = np.array([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 4]], float)
    points = np.vstack([wedge, pyramid])
    cells = {"pyramid5": 6 + np.arange(5)[None], "wedge6": np.arange(6)[None]}
    np.testing.assert_allclose(
        Solids.of(points, cells).centroids(), [[1, 1, 1], [1, 1, 1]], atol=1e-14
    )


@pytest.mark.parametrize("shape", NODES)
@pytest.mark.parametrize("cell", [0.37, 1.0, 50.0])
def test_columns_sum_to_the_volume(shape, cell):
    solids = rough(shape)
    _, thickness = solids.columns(cell)
    assert thickness.sum() * cell**2 == pytest.approx(solids.volumes().sum(), rel=1e-12)
    assert thickness.min() > -1e-12
    far = rough(shape, FAR)
    assert far.columns(cell)[1].sum() * cell**2 == pytest.approx(far.volumes().sum(), rel=1e-9)


def test_columns_of_a_box_are_its_height_times_what_it_covers():
    low, thickness = box([3, 1, 7], at=[-1.5, 10.25, 5]).columns(1.0)
    assert low == (-2, 10)
    np.testing.assert_allclose(
        thickness, [[2.625, 5.25, 5.25, 2.625], [0.875, 1.75, 1.75, 0.875]], atol=1e-12
    )


def test_a_block_that_hangs_over_another_adds_up():
    made = [primitives.box("rock", [1, 1, h]) for h in (1, 2)]
    points = np.vstack([made[0].points, made[1].points + [0, 0, 5]])
    cells = {"hex8": np.vstack([made[0].cells["hex8"], 8 + made[1].cells["hex8"]])}
    np.testing.assert_allclose(Solids.of(points, cells).columns(1.0)[1], [[3.0]], atol=1e-14)


@pytest.mark.parametrize("shape", NODES)
def test_the_level_below_which_a_share_lies_agrees_with_the_columns(shape):
    solids = rough(shape)
    (first, _), thickness = solids.columns(0.5)
    below = np.cumsum(thickness.sum(axis=0)) * 0.25
    total = solids.volumes().sum()
    for number, volume in enumerate(below[:-1]):
        level = solids.level_below_which(volume / total, EAST, np.ones(len(solids.middle)))
        assert level == pytest.approx(0.5 * (first + number + 1), abs=1e-8)


def test_the_level_knows_density_and_direction():
    made = [primitives.box("rock", [1, 1, 1]) for _ in range(2)]
    points = np.vstack([made[0].points, made[1].points + [1, 0, 0]])
    solids = Solids.of(
        points, {"hex8": np.vstack([made[0].cells["hex8"], 8 + made[1].cells["hex8"]])}
    )
    heavy = np.array([3.0, 1.0])
    assert solids.level_below_which(0.5, EAST, heavy) == pytest.approx(2 / 3, abs=1e-11)
    assert solids.level_below_which(0.5, -EAST, heavy) == pytest.approx(-2 / 3, abs=1e-11)
    assert solids.level_below_which(0.95, EAST, heavy) == pytest.approx(1.8, abs=1e-11)
    tet = Solids.of(np.vstack([np.zeros(3), np.eye(3)]), {"tet4": np.arange(4)[None]})
    for x in (0.1, 0.5, 0.9):  # what is below x is all but a similar tet
        share = 1 - (1 - x) ** 3
        assert tet.level_below_which(share, EAST, np.ones(1)) == pytest.approx(x, abs=1e-11)


@pytest.mark.parametrize("shape", NODES)
def test_cuts_integrate_to_the_volume(shape):
    # between the corners' places the area is a quadratic: two Gauss points integrate it exactly
    made = primitives.box("rock", [1, 1, 1], shape=shape)
    made.points += 0.1 * np.random.default_rng(3).standard_normal(made.points.shape)
    solids = Solids.of(made.points, made.cells)
    places = np.unique(solids.triangles[:, :, 0])
    total = 0.0
    for a, b in pairwise(places):
        for root in (-1, 1):
            x = 0.5 * (a + b) + root * 0.5 * (b - a) / np.sqrt(3)
            total += 0.5 * (b - a) * solids.cut_areas(np.array([x, -9]), np.array([0, 1]), 18).sum()
    assert total == pytest.approx(solids.volumes().sum(), rel=1e-11)


def test_shares_ahead_of_a_plane():
    solids = box([2, 4, 3], divisions=(2, 2, 1))
    share = solids.shares_ahead(np.array([0.25, 7.0]), EAST[:2])
    x = solids.middle[:, 0]
    np.testing.assert_allclose(share, np.where(x < 1, 0.75, 1.0), atol=1e-14)
    share = solids.shares_ahead(np.array([9.0, 3.5]), np.array([0.0, -1.0]))
    y = solids.middle[:, 1]
    np.testing.assert_allclose(share, np.where(y < 2, 1.0, 0.75), atol=1e-14)


def test_a_cut_ends_where_its_line_ends():
    solids = box([2, 4, 3], divisions=(2, 4, 1), shape="tet4")
    north = np.array([0.0, 1.0])
    for begin, length, area in [(-1, 9, 12), (0.5, 1, 3), (3.5, 5, 1.5), (5, 2, 0)]:
        cut = solids.cut_areas(np.array([0.7, begin]), north, length)
        assert cut.sum() == pytest.approx(area, abs=1e-12)
    turned = solids.cut_areas(np.array([0.7, 1.5]), -north, 1.0)
    assert turned.sum() == pytest.approx(3, abs=1e-12)
