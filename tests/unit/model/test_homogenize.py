"""Compliance of tets with springs on their faces."""

from __future__ import annotations

import numpy as np
import pytest

from cdem.errors import ModelError
from cdem.mesh import element_shapes
from cdem.model import homogenize
from cdem.model.homogenize import BondedTets, compliance, displacements, elasticity

CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


def pair():
    """A tet and its mirror image behind the face x = 0."""
    x = np.stack([CORNERS, CORNERS * [-1, 1, 1]])
    x[1, [1, 2]] = x[1, [2, 1]]
    return BondedTets(x, np.array([[0, 1]]), np.array([[[0, 2, 3], [0, 1, 3]]]), np.zeros(1, int))


def test_a_layer_adds_its_opening_along_its_normal():
    """1/E of the pair along x: that of the rock, and A / (k V) of the face."""
    u = displacements(pair(), 10.0, 0.2, 7.0)
    c = compliance(pair(), u, 10.0, 0.2, np.ones(2, bool))
    own = np.linalg.inv(elasticity(10.0, 0.2))
    added = 0.5 / 7.0 / (1 / 3)
    expected = own.copy()
    expected[0, 0] += added
    expected[[3, 5], [3, 5]] += added
    np.testing.assert_allclose(c, expected, atol=2e-5)


def test_vectors_point_out_of_the_first_tet():
    np.testing.assert_allclose(pair().vectors, [[-0.5, 0, 0]])


def test_only_tets_with_four_neighbours_lie_inside():
    assert pair().inner(1).tolist() == [False, False]


def test_elasticity_is_that_of_the_elements():
    lame, shear = element_shapes.lame_constants(np.array([10.0]), np.array([0.2]))
    assert (lame[0], shear[0]) == pytest.approx((10 * 0.2 / (1.2 * 0.6), 10 / 2.4))
    np.testing.assert_array_equal(elasticity(10.0, 0.2), element_shapes.elasticity(lame, shear)[0])


def test_no_equilibrium_is_an_error(monkeypatch):
    monkeypatch.setattr(homogenize, "MOST_ITERATIONS", 0)
    with pytest.raises(ModelError, match="no equilibrium of its elements and bonds was found"):
        displacements(pair(), 10.0, 0.2, 1e-3)
