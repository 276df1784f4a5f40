"""Facets of one plane are one joint; spacing of planes whose places are known."""

import numpy as np
import pytest

from cdem.joints.directions import pole
from cdem.outcrop.facets import Facets, axes
from cdem.outcrop.joint_planes import joint_planes, spacing_of
from cdem.outcrop.persistence import areal_persistence

MEAN = pole(60, 150)
FRAME = axes(MEAN)


def facets(rows, tilt=1e-4):
    """Facets of 1 m2 by place along strike and dip, and along the normal [m]."""
    rows, count = np.array(rows, float), len(rows)
    return Facets(
        rows @ FRAME + [40, 50, 60],
        np.repeat(FRAME[None], count, axis=0),
        np.ones(count),
        np.ones((count, 2)),
        np.full(count, 0.005),
        np.full(count, tilt),
        [np.arange(4)] * count,
    )


def test_facets_in_a_plane_are_one_joint():
    some = facets([(0, 0, 0), (9, 3, 0.01), (0, 0, 0.5), (5, 5, 0.49), (1, 1, 1.7)])
    assert joint_planes(some, 0.02).tolist() == [0, 0, 1, 1, 2]
    assert joint_planes(facets([(0, 0, 0), (9, 3, 0.05)]), 0.02).tolist() == [0, 1]
    # the errors of the normals allow more with the distance
    assert joint_planes(facets([(0, 0, 0), (9, 3, 0.05)], tilt=1e-3), 0.02).tolist() == [0, 0]


def test_spacing_of_planes_through_the_outcrop():
    some = facets([(0, 0, 0), (9, 3, 0), (0, 0, 0.5), (3, 0, 1.5), (1, 1, 2.1)])
    found = spacing_of(some, joint_planes(some, 0.02), MEAN, np.array([40.0, 50, 60]))
    assert (found.planes, found.persistent) == (4, pytest.approx(0.7))
    assert (found.pairs, found.exposed) == (1, pytest.approx(0.5))  # only the third is above


def test_positions_of_tilted_planes_are_those_at_the_middle():
    some = facets([(0, 0, 0), (8, 0, 1.0)])
    turn = np.radians(2)  # about the dip: the second plane falls 0.28 m on its way to the middle
    some.frames[1] = np.array(
        [
            np.cos(turn) * FRAME[0] + np.sin(turn) * FRAME[2],
            FRAME[1],
            np.cos(turn) * FRAME[2] - np.sin(turn) * FRAME[0],
        ]
    )
    found = spacing_of(some, np.array([0, 1]), MEAN, np.array([40.0, 50, 60]))
    assert found.persistent == pytest.approx(1.0 - 8 * np.tan(turn))


def test_a_single_plane_has_no_spacing():
    found = spacing_of(facets([(0, 0, 0)]), np.array([0]), MEAN, np.zeros(3))
    assert found.planes == 1 and np.isnan(found.persistent) and np.isnan(found.exposed)
    assert np.isnan(areal_persistence(np.zeros((9, 3)), facets([(0, 0, 0)]), np.array([0]), np.nan))


def test_persistence_is_the_area_over_that_of_the_cloud_beside_the_plane():
    x, y, z = np.meshgrid(np.linspace(-1, 1, 21), np.linspace(-1.5, 1.5, 31), [-0.2, 0.2, 5.0])
    cloud = np.column_stack([x.ravel(), y.ravel(), z.ravel()]) @ FRAME + [40, 50, 60]
    one = facets([(0, 0, 0)])
    assert areal_persistence(cloud, one, np.array([0]), 1.0) == pytest.approx(1 / 6)
    assert areal_persistence(cloud, one, np.array([0]), 0.1) != areal_persistence(
        cloud, one, np.array([0]), 1.0
    )
