"""Bodies and joints of a case: what is refused."""

import pytest
from shared.joints import jointed_case

import cdem


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"model.joints": [{"name": "a", "dip": 30}]}, "give dip and dip_direction, or normal"),
        ({"model.joints": [{"name": "a", "dip": 30, "normal": [0, 0, 1]}]}, "not both"),
        ({"model.joints": [{"name": "a", "normal": [0, 0, 0]}]}, "must not be [0, 0, 0]"),
    ],
)
def test_mistakes_about_joints_are_named(changes, message):
    with pytest.raises(cdem.CaseError) as error:
        jointed_case(changes)
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            ", polyhedron:",
            ", box: {size: [1, 1, 1]}, polyhedron:",
            "model.blocks.1: give exactly one of box, polyhedron, file; got box and polyhedron",
        ),
        (
            "size: [10, 4, 1]",
            "size: [10, 0, 1]",
            "slope.yaml:6:37: model.blocks.0.box.size.1: must be above 0 [m], got 0",
        ),
        (
            "divisions: [10, 4, 1]",
            "divisions: [10, 0.5, 1]",
            "model.blocks.0.box.divisions.1: must be a whole number, got 0.5",
        ),
    ],
)
def test_mistakes_are_answered(complaint, old, new, message):
    assert message in complaint(old, new)
