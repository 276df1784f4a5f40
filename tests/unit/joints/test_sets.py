"""Fisher statistics against closed forms; known sets found again among others."""

import numpy as np
import pytest
from shared.joints import drawn_joints

from cdem.errors import CaseError
from cdem.joints.directions import dips, line, pole, poles
from cdem.joints.sets import axis_density, fit_sets, given_sets, mean_axis


def cone(dip, direction, angle, count):
    """Axes evenly on a cone about a pole, every other one reversed."""
    mean = pole(dip, direction)
    across = line(np.array(direction - 90.0), np.array(0.0))
    turn = 2 * np.pi * np.arange(count) / count
    side = np.cos(turn)[:, None] * across + np.sin(turn)[:, None] * np.cross(mean, across)
    axes = np.cos(np.radians(angle)) * mean + np.sin(np.radians(angle)) * side
    return axes * np.where(np.arange(count) % 2, -1, 1)[:, None]


@pytest.mark.parametrize(("dip", "direction"), [(32, 90), (88, 5), (3, 200), (90, 45)])
def test_axes_on_a_cone(dip, direction):
    # R = N cos t: kappa = (N - 1) / (N (1 - cos t)), a95 by Fisher (1953)
    count, angle = 25, 10.0
    mean, kappa, a95 = mean_axis(cone(dip, direction, angle, count))
    assert abs(mean @ pole(dip, direction)) == pytest.approx(1, abs=1e-12)
    cosine = np.cos(np.radians(angle))
    assert kappa == pytest.approx((count - 1) / (count * (1 - cosine)), rel=1e-9)
    wanted = 1 - (1 - cosine) / cosine * (20 ** (1 / (count - 1)) - 1)
    assert a95 == pytest.approx(np.degrees(np.arccos(wanted)), rel=1e-9)


def test_weights_stand_for_repeated_axes():
    axes = cone(40, 120, 12, 5)
    weights = np.array([1.0, 3, 2, 1, 4])
    repeated = np.repeat(axes, weights.astype(int), axis=0)
    for a, b in zip(mean_axis(axes, weights), mean_axis(repeated), strict=True):
        assert np.allclose(a, b, rtol=1e-12)


@pytest.mark.parametrize("kappa", [0.5, 10.0, 400.0])
def test_density_over_the_half_sphere_is_one(kappa):
    at, weight = np.polynomial.legendre.leggauss(200)
    total = np.pi * (weight * axis_density((at + 1) / 2, np.array(kappa))).sum()
    assert total == pytest.approx(1, rel=1e-9)


def test_known_sets_are_found_again():
    truth = [(32, 90, 80, 120), (85, 5, 40, 90), (65, 272, 25, 70)]
    fit = fit_sets(drawn_joints(truth, uniform=40))
    assert min(fit.bic, key=fit.bic.get) == 3 == len(fit.sets)
    for found, (dip, direction, kappa, count) in zip(fit.sets, truth, strict=True):
        apart = np.degrees(np.arccos(min(1, abs(found.normal @ pole(dip, direction)))))
        assert apart < 2 * found.a95 < 10
        assert found.kappa == pytest.approx(kappa, rel=3 / np.sqrt(count))
        assert found.share == pytest.approx(count / 320, abs=0.04)
    assert fit.background == pytest.approx(0.125, abs=0.05)
    assert np.allclose(fit.membership.sum(axis=1), 1)


def test_the_number_of_sets_may_be_given_and_none_may_be_there():
    joints = drawn_joints([(32, 90, 80, 60), (85, 5, 40, 60)], uniform=5)
    assert [len(fit_sets(joints, n).sets) for n in (1, 2)] == [1, 2]
    with pytest.raises(CaseError, match="among 80 joints no set can be distinguished"):
        fit_sets(drawn_joints([], uniform=80))
    with pytest.raises(CaseError, match="fewer than 3 sets"):
        fit_sets(joints[:9], 3)


def test_weights_of_terzaghi_shift_the_shares():
    joints = drawn_joints([(10, 90, 200, 60), (80, 90, 200, 60)])
    weights = np.where(np.arange(120) < 60, 1.0, 3.0)
    fit = fit_sets(joints, 2, weights)
    assert fit.sets[0].dip == pytest.approx(80, abs=3)
    assert [s.share for s in fit.sets] == pytest.approx([0.75, 0.25], abs=0.02)


def test_sets_of_the_table():
    axes = np.concatenate([cone(30, 90, 5, 4), cone(70, 200, 5, 6), pole(0, 0)[None]])
    fit = given_sets(axes, ["b"] * 4 + ["a"] * 6 + [""])
    assert [s.name for s in fit.sets] == ["a", "b"] and fit.bic == {}
    assert [s.dip for s in fit.sets] == pytest.approx([70, 30])
    assert [s.dip_direction for s in fit.sets] == pytest.approx([200, 90])
    assert fit.background == pytest.approx(1 / 11)
    with pytest.raises(CaseError, match="set a has a single joint"):
        given_sets(axes[:2], ["a", ""])
    with pytest.raises(CaseError, match="is empty"):
        given_sets(axes[:2], ["", ""])


def test_dips_undo_poles():
    dip, direction = np.array([0.0, 10, 89, 90]), np.array([0.0, 359, 180, 271])
    back = dips(-poles(dip, direction))
    assert np.allclose(back[0], dip)
    assert np.allclose(back[1][1:3], direction[1:3])
