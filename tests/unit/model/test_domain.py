"""The box that blocks must not leave: what it is read from, what begins outside, what has left."""

import numpy as np
import pytest
from scenes import case

import cdem
from cdem.case.bodies_schema import Domain
from cdem.model.domain import bounds, leaving

BLOCKS = [
    {"group": "a", "box": {"size": [1, 1, 1]}},
    {"group": "b", "box": {"size": [1, 1, 1]}, "translate": [3, 0, 0]},
]


def boxed(**domain):
    return case(BLOCKS, {"a": {}, "b": {}}, model={"domain": domain})


def test_sides_may_be_open_and_have_units():
    domain = boxed(min=[None, None, "-2000 mm"], max=[5, None, None]).model.domain
    low, high = bounds(domain)
    assert low.tolist() == [-np.inf, -np.inf, -2] and high.tolist() == [5, np.inf, np.inf]


@pytest.mark.parametrize(
    ("domain", "said"),
    [
        ({}, "is open on all sides"),
        ({"min": [None] * 3}, "is open on all sides"),
        ({"min": [0, 0, 2], "max": [9, 9, 2]}, "min must be below max, but along z"),
        ({"min": [0, 0]}, "needs at least 3 entries"),
        ({"min": [0, 0, "1 kg"]}, "kg"),
        ({"low": [0, 0, 0]}, "unknown key"),
    ],
)
def test_a_domain_without_sense_is_refused(domain, said):
    with pytest.raises(cdem.CaseError, match=said):
        boxed(**domain)


@pytest.mark.parametrize(
    ("domain", "said"),
    [
        (
            {"max": [3.5, None, None]},
            r"model.domain.max: is 3.5 m along x, but group 'b' begins at \(4",
        ),
        (
            {"min": [-1, 0.25, 0]},
            r"model.domain.min: is 0.25 m along y, but group 'a' begins at \(0, 0",
        ),
    ],
)
def test_the_whole_model_must_begin_inside(domain, said):
    with pytest.raises(cdem.CaseError, match=said):
        cdem.Simulation(boxed(**domain))
    cdem.Simulation(boxed(min=[0, 0, 0], max=[4, 1, 1]))  # its sides belong to it


def test_bodies_leave_as_a_whole_and_once():
    domain = Domain(min=[0, None, None], max=[None, None, 5])
    middle = np.array([[-1, 0, 0], [1, 0, 0], [-1, 9, 0], [1, 0, 6], [1, 0, 9], [np.nan, 0, 0]])
    body, out = np.array([0, 0, 2, 3, 3, 4], np.int32), np.zeros(6, bool)
    # the first hangs on one that is inside
    assert leaving(domain, middle, body, out).tolist() == [2, 3, 4]
    out[[3, 4]] = True
    assert leaving(domain, middle, body, out).tolist() == [2]
