"""Maps of yield accelerations and displacements."""

import numpy as np
import pytest
from shared.hills import frustum, joint

from cdem.screening.bodies import Ground, Limits
from cdem.screening.fos_map import screen
from cdem.screening.loads import Loads
from cdem.screening.shaking import Earthquake, shake
from cdem.seismic.displacement import slip_by_jibson

SETS = [joint("J1", 55, 135, 30, 20e3), joint("J2", 55, 225, 30, 20e3)]
LIMITS = Limits(200, 1e5, 26e3)


@pytest.fixture(scope="module")
def found():
    return screen(Ground(frustum(4.0)), SETS, LIMITS, stride=8, yields=True)


def test_cells_have_the_least_yield_and_the_largest_slip(found):
    quake = Earthquake(0.4, 6.5)
    shaken = shake(found, quake)
    assert (np.isfinite(shaken.yields) == np.isfinite(found.factor)).all()
    for body, least in zip(found.bodies, shaken.listed_yields, strict=True):
        assert (shaken.yields[body.window][body.cells] <= least).all()
        assert (least > 0) == (body.factor >= 1)
    known = np.isfinite(shaken.yields) & (shaken.yields > 0)
    assert shaken.slip[known] == pytest.approx(slip_by_jibson(shaken.yields[known], 0.4, 6.5))
    assert np.isnan(shaken.slip[shaken.yields <= 0]).all()
    assert shaken.moving == sum(body.factor < 1 for body in found.every) > 0
    lines = "\n".join(shaken.lines())
    assert f"{shaken.moving:,} bodies move without shaking" in lines
    assert "magnitude 6.5, PGA 0.4 g (Jibson 2007)" in lines


def test_shaking_at_rest_does_not_matter_for_the_yield(found):
    shaken = screen(found.ground, SETS, LIMITS, 8, loads=Loads(kh=0.1), yields=True)
    both = [shake(one, Earthquake(0.3)) for one in (found, shaken)]
    same = np.isfinite(both[0].yields) & np.isfinite(both[1].yields)
    assert both[0].yields[same].min() == pytest.approx(both[1].yields[same].min())
