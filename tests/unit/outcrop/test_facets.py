"""Areas, extents and planes of facets against known patches."""

import numpy as np
import pytest

from cdem.joints.directions import pole
from cdem.outcrop.facets import area_of, axes, measure


def test_axes_are_strike_dip_and_normal():
    strike, down, up = axes(pole(30, 90))
    assert strike == pytest.approx([0, 1, 0], abs=1e-12)
    assert down == pytest.approx([-np.cos(np.pi / 6), 0, 0.5])  # up the dip
    assert up == pytest.approx(pole(30, 90))
    assert axes(-pole(30, 90))[2] == pytest.approx(pole(30, 90))


@pytest.mark.parametrize(("wide", "tall"), [(1.0, 1.0), (2.0, 0.3)])
def test_area_of_a_rectangle(wide, tall):
    random = np.random.default_rng(4)
    spacing = 0.03  # points as after thinning: about evenly spaced
    x, y = np.meshgrid(np.arange(spacing / 2, wide, spacing), np.arange(spacing / 2, tall, spacing))
    flat = np.column_stack([x.ravel(), y.ravel()]) + 0.3 * spacing * random.uniform(
        -1, 1, (x.size, 2)
    )
    assert area_of(flat) == pytest.approx(wide * tall, rel=0.03)


def test_area_leaves_out_holes_and_corners():
    flat = np.random.default_rng(4).uniform(0, 1, (6_000, 2))
    flat = flat[~((flat[:, 0] > 0.5) & (flat[:, 1] > 0.5))]  # an L
    flat = flat[np.linalg.norm(flat - 0.25, axis=1) > 0.15]
    assert area_of(flat) == pytest.approx(0.75 - np.pi * 0.15**2, rel=0.03)


def test_points_on_a_line_have_no_area():
    assert area_of(np.column_stack([np.arange(9.0), np.arange(9.0)])) == 0


@pytest.mark.parametrize("dip", [2, 40, 88])
def test_length_and_width(dip):
    random, frame = np.random.default_rng(4), axes(pole(dip, 130))
    flat = random.uniform(-1, 1, (3_000, 2)) * [1.5, 0.4]
    x = np.column_stack([flat, 0.004 * random.normal(size=3_000)]) @ frame
    x[:30] += 0.1 * frame[2]  # outliers
    label = np.zeros(3_000, np.int32)
    facets = measure(x, label, label)
    assert facets.lengths[0] == pytest.approx([3.0, 0.8], rel=0.03)
    assert facets.areas[0] == pytest.approx(2.4, rel=0.05)
    assert facets.rms[0] == pytest.approx(0.004, rel=0.06)
    off = float(np.arccos(min(1.0, facets.normals[0] @ frame[2])))
    assert off < 5 * facets.tilt[0] < 0.003


def test_the_rim_does_not_turn_the_plane():
    x = np.random.default_rng(1).uniform(0, 1, (2_000, 3)) * [1, 1, 0]
    core = np.zeros(2_000, np.int32)
    core[x[:, 0] > 0.9] = -1
    x[:, 2] += np.where(core < 0, 0.02, 0)
    facets = measure(x, core, np.zeros(2_000, np.int32))
    assert facets.normals[0, 2] == pytest.approx(1, abs=1e-12)
    assert facets.areas[0] == pytest.approx(1, rel=0.04)
