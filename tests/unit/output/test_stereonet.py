"""The equal-area net: places of lines, and density of poles."""

import numpy as np
import pytest

from cdem.joints.directions import line
from cdem.output.stereonet import density, net, project


@pytest.mark.parametrize("plunge", [0.0, 30.0, 45.0, 90.0])
def test_radius_on_the_net(plunge):
    # Lambert: sqrt(2) sin((90 - p) / 2); 0.5412 for 45 deg
    trend = np.array([0.0, 90, 200])
    x, y = project(line(trend, np.full(3, plunge)))
    radius = np.sqrt(2) * np.sin(np.radians(90 - plunge) / 2)
    assert x == pytest.approx(radius * np.sin(np.radians(trend)), abs=1e-12)
    assert y == pytest.approx(radius * np.cos(np.radians(trend)), abs=1e-12)


def test_poles_that_look_up_lie_opposite():
    up = -line(np.array([90.0]), np.array([30.0]))
    x, y = project(up)
    assert x[0] > 0 and y[0] == pytest.approx(0)


def test_the_grid_of_the_net_projects_back():
    axis, vectors = net()
    inside = np.isfinite(vectors[..., 0])
    x, y = project(vectors[inside])
    wanted = np.stack(np.meshgrid(axis, axis), axis=-1)[inside]
    assert np.abs(np.column_stack([x, y]) - wanted).max() < 1e-12
    assert np.linalg.norm(vectors[inside], axis=1) == pytest.approx(1)


def test_density_has_the_mean_one_and_is_high_at_clusters():
    _, vectors = net()  # equal areas: the mean over the net is that over the half sphere
    places = vectors[np.isfinite(vectors[..., 0])]
    one = line(np.array([120.0]), np.array([20.0]))
    values = density(places, np.repeat(one, 50, axis=0))
    assert values.mean() == pytest.approx(1, abs=2e-3)
    # 2 pi times Fisher's k / 2 pi at its centre, k = 2 (1 + 50 / 9)
    assert density(one, np.repeat(one, 50, axis=0))[0] == pytest.approx(2 * (1 + 50 / 9), rel=1e-9)
