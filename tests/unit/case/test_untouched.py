"""Untouched: a case is compared by its objects, at every depth."""

import pytest
from scenes import case

from cdem.case.untouched import Untouched

CHANGES = {
    "a number of the case": lambda c: setattr(c.time, "safety", 0.123),
    "a number in a dict": lambda c: setattr(c.materials["rock"], "density", 2600),
    "another entry of a dict": lambda c: c.materials.update(other=c.materials["rock"]),
    "one entry less of a list": lambda c: c.stages.pop(),
    "a number in a list": lambda c: setattr(c.stages[0], "duration", 2.0),
    "a list of numbers": lambda c: c.model.blocks[0].box.__dict__.update(size=[1, 1, 3]),
}


def scene():
    return case([{"group": "rock", "box": {"size": [1, 1, 1]}}], {"rock": {}})


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_a_change_is_seen(change):
    changed = scene()
    untouched = Untouched(changed)
    assert untouched.holds()
    change(changed)
    assert not untouched.holds()


def test_an_equal_value_is_no_change_until_it_changes():
    this = scene()
    untouched = Untouched(this)
    this.stages[0] = this.stages[0].model_copy(deep=True)
    assert untouched.holds()
    this.stages[0].duration = 2.0
    assert not untouched.holds()
