"""The bracket of a search whose trials are faked."""

from functools import partial

import numpy as np
import pytest

from cdem.study.criterion import Criterion
from cdem.study.critical import Critical, Trial, _narrow, _widen


def searched(holds, tightens=0.0, tolerance=0.01):
    """A search for a factor: bodies slide above `holds`, and rest later up to `holds + tightens`."""
    found = Critical(np.nan, np.nan, Criterion())

    def step(value, *, hasty):
        stable = value <= holds + (0 if hasty else tightens)
        saw = "at rest" if stable else "sliding"
        found.trials.append(Trial(value, stable, saw, "", 1, 0.0, sure=stable or not hasty))
        if stable:
            found.stable, found.failed = value, found.nearest_failure()
        else:
            found.failed = value
        return found.trials[-1]

    _widen(partial(step, hasty=True), 1.0, 1.5)
    _narrow(found, step, tolerance, hasty=True)
    return found


@pytest.mark.parametrize("holds", [0.3, 0.9, 1.2, 4.0])
def test_only_the_failure_next_to_the_factor_is_watched_to_its_end(holds):
    found = searched(holds)
    assert found.stable <= holds < found.failed <= found.stable + 0.01
    assert [t.value for t in found.trials if t.sure and not t.stable] == [found.failed]


@pytest.mark.parametrize("tightens", [0.004, 0.05, 0.2, 0.5, 2.0])
def test_where_what_slides_comes_to_rest_the_search_goes_on(tightens):
    """Also beyond the highest factor that was tried."""
    found = searched(1.2, tightens)
    assert found.stable <= 1.2 + tightens < found.failed <= found.stable + 0.01
    assert found.trial_that_failed.sure


def test_a_slip_before_rest_is_told():
    found = searched(1.2)
    assert found.caution() == ""
    found.slip = 0.043
    assert "rests only after a slip of 0.043 m" in found.caution()
