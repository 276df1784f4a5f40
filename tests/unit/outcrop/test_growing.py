"""Regions on two planes that meet, on steps, and on one plane in parts."""

import numpy as np
import pytest

from cdem.outcrop.growing import Plane, Rules, grow, take_rims
from cdem.outcrop.merging import merged
from cdem.outcrop.normals import normals_of

RULES = Rules(angle=12, tolerance=0.006, points=20)


def square(count, seed=1):
    """Points on a level square of 1 m with a noise of 2 mm."""
    random = np.random.default_rng(seed)
    x = np.column_stack([random.uniform(0, 1, (count, 2)), np.zeros(count)])
    return x + 0.002 * random.normal(size=x.shape)


def regions(x):
    """Numbers of regions with their rims, and planes."""
    found = normals_of(x)
    core, planes = grow(x, found, RULES)
    return take_rims(x, found, core, planes, RULES.tolerance), planes, core


def test_two_faces_that_meet_in_an_edge():
    x = np.concatenate([square(3_000), square(3_000, 2)[:, [2, 1, 0]]])  # level, and upright
    label, planes, core = regions(x)
    assert len(planes) == 2
    level = label[np.arange(6_000) < 3_000]
    for plane, axis in zip(
        planes, (2, 0) if abs(planes[0].normal[2]) > 0.9 else (0, 2), strict=True
    ):
        assert abs(plane.normal[axis]) > np.cos(np.radians(0.5))
    assert (core >= 0).mean() < 0.98 < (label >= 0).mean()  # the edge has rims
    assert (level == np.bincount(level[level >= 0]).argmax()).mean() > 0.97


def test_a_low_step_parts_two_faces():
    x = np.concatenate([square(3_000), square(3_000, 2) + [1, 0, 0.03]])
    assert len(regions(x)[1]) == 2


def test_a_crack_does_not_part_a_face():
    x = square(4_000)
    x = x[np.abs(x[:, 0] - 0.5) > 0.01]
    label, planes, _ = regions(x)
    assert len(planes) == 1 and (label == 0).mean() > 0.99


def test_regions_in_one_plane_are_merged():
    x, found = square(4_000), normals_of(square(4_000))
    halves = (x[:, 0] > 0.5).astype(np.int32)
    planes = [Plane(np.array([0, 0, 1.0]), x[halves == k][0]) for k in (0, 1)]
    for k, plane in enumerate(planes):
        plane.add(x[halves == k])
        plane.fit()
    both = x - x.mean(axis=0)
    deviation = np.sqrt(np.linalg.eigvalsh(both.T @ both / len(x))[0])
    assert planes[0].deviation_with(planes[1]) == pytest.approx(deviation)
    assert merged(found, halves, planes, RULES).tolist() == [0, 0]
    strict = Rules(angle=12, tolerance=1.9 * deviation, points=20)
    assert merged(found, halves, planes, strict).tolist() == [0, 1]
    planes[1].normal = np.array([np.sin(0.12), 0, np.cos(0.12)])
    assert merged(found, halves, planes, RULES).tolist() == [0, 1]


def test_a_plane_is_fitted_to_its_points():
    random = np.random.default_rng(2)
    x = random.uniform(0, 1, (500, 3)) * [1, 1, 0] + [5e3, 5e3, 7]
    plane = Plane(np.array([1.0, 0, 0]), x[0])
    for part in np.array_split(x, 20):
        plane.add(part)
    plane.fit()
    assert abs(plane.normal[2]) == pytest.approx(1, abs=1e-12) and plane.count == 500
    assert plane.center == pytest.approx(x.mean(axis=0))


def test_no_regions_in_a_bush():
    x = np.random.default_rng(1).uniform(0, 1, (3_000, 3))
    found = normals_of(x)
    label, planes = grow(x, found, RULES)
    assert not planes and (take_rims(x, found, label, planes, 0.01) == -1).all()
