"""Numbers of a case: units and ranges."""

import pytest


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            '"2.7 t/m3"',
            '"2.7 t/n3"',
            "slope.yaml:10:13: materials.granite.density: unknown unit 't/n3'",
        ),
        ('"50 GPa"', '"50 Gpa"', "unknown unit 'Gpa'; did you mean GPa?"),
        ('"50 GPa"', '"50 m"', "'50 m' has the wrong dimension; use one of: Pa, kPa, MPa, GPa"),
        ('"50 GPa"', "5O", "unknown unit 'O' in '5O'; use one of: Pa, kPa"),
        ('"50 GPa"', "-1", "must be above 0 [Pa], got -1"),
        ('"2.7 t/m3"', "0", "must be above 0 [kg/m3], got 0"),
        ('"50 GPa"', "[1]", "must be a number [Pa], got a list of 1"),
        ('"50 GPa"', "true", "must be a number [Pa], got true"),
        (
            '"1 cm/s"',
            '"1 cm"',
            "slope.yaml:15:22: groups.block.velocity.2: '1 cm' has the wrong dimension",
        ),
    ],
)
def test_numbers_that_are_not_allowed_are_answered(complaint, old, new, message):
    assert message in complaint(old, new)
