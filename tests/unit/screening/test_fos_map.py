"""The map: every cell has the least factor of its bodies; refined where it is low."""

import numpy as np
import pytest
from shared.hills import frustum, joint

from cdem.errors import CaseError
from cdem.screening.bodies import Ground, Limits
from cdem.screening.fos_map import screen

SETS = [
    joint("J1", 55, 135, 30, 20e3),
    joint("J2", 55, 225, 30, 20e3),
    joint("J3", 48, 80, 32, 15e3),
]


@pytest.fixture(scope="module")
def ground():
    return Ground(frustum(4.0))


@pytest.fixture(scope="module")
def found(ground):
    return screen(ground, SETS, Limits(50, 1e5, 26e3), stride=4)


def test_cells_have_the_least_of_their_bodies(found):
    assert found.count > 100 and 0.2 < np.isfinite(found.factor).mean() < 0.6
    known = np.isfinite(found.factor)
    assert (np.isfinite(found.volume) == known).all() and ((found.mode > 0) == known).all()
    assert set(np.unique(found.mode)) <= {0, 1, 2, 3}
    for body in found.bodies:
        assert (found.factor[body.window][body.cells] <= body.factor).all()
    assert found.bodies[0].factor == np.nanmin(found.factor)
    factors = [body.factor for body in found.bodies]
    assert factors == sorted(factors)
    assert ((found.volume[known] >= 50) & (found.volume[known] <= 1e5)).all()


def test_bodies_of_the_list_differ(found):
    covered = np.zeros(found.factor.shape, bool)
    for body in found.bodies:
        assert covered[body.window][body.cells].mean() <= 0.5
        covered[body.window][body.cells] = True


def test_a_coarse_search_is_refined_where_the_factor_is_low(ground, found):
    fine = screen(ground, SETS, Limits(50, 1e5, 26e3), stride=1)
    assert found.tried < 0.8 * fine.tried
    low = fine.factor < 1.0
    assert np.isfinite(found.factor[low]).mean() > 0.95  # no saw teeth there
    assert np.nanmin(found.factor) == pytest.approx(np.nanmin(fine.factor), rel=0.02)


def test_without_cohesion_the_map_shows_directions_alone(ground):
    pair = [joint("J1", 55, 135, 30), joint("J2", 55, 225, 30)]
    found = screen(ground, pair, Limits(50, 1e5, 26e3))
    both = found.factor[found.mode == 1]
    assert len(both) > 50 and both == pytest.approx(0.701351, abs=1e-6)


def test_with_cohesion_larger_bodies_have_lower_factors(ground):
    least = [
        np.nanmin(screen(ground, SETS[:2], Limits(50, most, 26e3)).factor)
        for most in (4e3, 1e4, 1e5)
    ]
    assert least[0] > least[1] > least[2]
    near = screen(ground, SETS[:2], Limits(50, 1e4, 26e3))
    assert 0 < near.at_limit < near.count


def test_progress_and_what_is_refused(ground):
    told = []
    screen(
        ground,
        SETS[:2],
        Limits(50, 1e5, 26e3),
        report=lambda words, part: told.append((words, part)),
    )
    assert told[0][0] == "bodies of J1" and "J1 and J2" in told[-1][0]
    assert [part for _, part in told] == sorted(part for _, part in told)
    with pytest.raises(CaseError, match="the first must be below the second"):
        screen(ground, SETS, Limits(5, 5, 26e3))
    with pytest.raises(CaseError, match="stride 0"):
        screen(ground, SETS, Limits(5, 50, 26e3), stride=0)
