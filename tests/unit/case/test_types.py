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
        ('"50 GPa"', '"2,700"', "must be a number without a comma, got '2,700'; write 2700 for"),
        (
            '"50 GPa"',
            "2,700",
            "materials.granite.700: is a key without a value; if it ends a num",
        ),
        ('"50 GPa"', "9" * 400, "young_modulus: is a number with too many digits"),
        ("[0, 0, -9.81]", "-9.81", "loads.gravity: must be a list, e.g. [0, 0, -9.81] (x, y, z)"),
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


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("name: toe", "name: a/b", "slope.yaml:34:6: histories.0.name: names files, so it cannot"),
        (
            "name: toe",
            "name: '<b>'",
            "histories.0.name: names files, so it cannot contain the char",
        ),
        ("name: toe", f"name: {'x' * 300}", "names files, so it cannot be longer than 200 bytes"),
        ("name: toe", 'name: "a\\nb"', "must be plain text of one line, got the character '\\n'"),
        ("name: settle", 'name: "\\e[2J"', "stages.0.name: must be plain text of one line"),
        ("  granite: {", '  "a\\0": {}\n  granite: {', "materials.a\\x00: must be plain text"),
        ("title: Block on an incline", 'title: "a\\nb"', "title: must be plain text of one line"),
    ],
)
def test_names_are_plain_and_those_of_histories_fit_files(complaint, old, new, message):
    assert message in complaint(old, new)
