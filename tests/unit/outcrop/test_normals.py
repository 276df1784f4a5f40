"""Normals and noise of points drawn on a plane."""

import numpy as np
import pytest

from cdem.joints.directions import pole
from cdem.outcrop.facets import axes
from cdem.outcrop.normals import normals_of


def test_a_plane_with_noise():
    random = np.random.default_rng(3)
    normal = pole(50, 120)
    flat = np.column_stack([random.uniform(0, 1, (4_000, 2)), 0.002 * random.normal(size=4_000)])
    found = normals_of(flat @ axes(normal))
    off = np.degrees(np.arccos(np.minimum(np.abs(found.normals @ normal), 1)))
    assert np.median(off) < 3 and np.percentile(off, 95) < 8
    # a quarter lies below: of deviations with 21 degrees of freedom these are 10 % smaller
    assert found.noise == pytest.approx(0.002 * 0.9, rel=0.05)
    assert (found.neighbours[:, 0] == np.arange(4_000)).all()


def test_some_points_only():
    x = np.random.default_rng(3).uniform(0, 1, (100, 3))
    assert normals_of(x, every=10).normals.shape == (10, 3)
