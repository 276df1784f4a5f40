"""Thinning of clouds: one point a voxel, and a size that suits spacing, noise and number."""

import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.outcrop import thinning
from cdem.outcrop.thinning import thin, voxels


def plane(count, noise=0.0, seed=1):
    """Points on a level square of 1 m."""
    random = np.random.default_rng(seed)
    x = np.column_stack([random.uniform(0, 1, (count, 2)), np.zeros(count)])
    return x + noise * random.normal(size=x.shape)


def test_a_voxel_keeps_the_mean_of_its_points():
    x = np.array([[0.0, 0, 0], [0.4, 0, 0.2], [1.5, 0, 0]])
    assert np.sort(voxels(x, 1.0)[:, 0]).tolist() == [0.2, 1.5]
    assert voxels(x, 1.0)[:, 2].max() == pytest.approx(0.1)


def test_the_resolution_is_the_mean_spacing():
    found = thin(plane(10_000))
    # twice the median distance to the nearest of random points: sqrt(ln 2 / (pi density))
    assert found.resolution == pytest.approx(2 * np.sqrt(np.log(2) / np.pi / 1e4), rel=0.05)
    assert found.notes[0].startswith("10,000 points thinned to ")


def test_doubled_points_do_not_change_it():
    x = plane(5_000)
    assert thin(np.concatenate([x, x])).resolution == pytest.approx(thin(x).resolution, rel=0.05)


def test_noise_makes_it_coarser():
    found = thin(plane(20_000, noise=0.01))
    assert found.resolution > 2 * 0.01 and "because of the noise" in found.notes[0]


def test_the_number_of_points_is_bounded(monkeypatch):
    monkeypatch.setattr(thinning, "MOST_POINTS", 2_000)
    found = thin(plane(10_000))
    assert 1_000 < len(found.points) <= 2_000 and "at most 2,000 points" in found.notes[0]


@pytest.mark.parametrize(
    ("points", "resolution", "words"),
    [
        (plane(50), None, "50 points are no outcrop"),
        (plane(500), 0.5, "points are left at a resolution of 0.5 m"),
        (plane(500) * 1e4, 1e-9, "too small for a cloud of this extent"),
        (np.repeat(plane(10), 20, axis=0), None, "most points of the cloud lie at one place"),
    ],
)
def test_what_is_refused(points, resolution, words):
    with pytest.raises(CaseError, match=words):
        thin(points, resolution)
