"""Units: every unit converts, and only to its own dimension."""

from __future__ import annotations

import math

import pytest

from cdem.units import DIMENSIONS, UNITS, parse_unit, to_number


@pytest.mark.parametrize(
    ("text", "unit", "number"),
    [
        ("30 GPa", "Pa", 30e9),
        ("30GPa", "Pa", 30e9),
        ("10 cm", "m", 0.1),
        ("21 deg", "deg", 21.0),
        ("21°", "deg", 21.0),
        (f"{math.pi} rad", "deg", 180.0),
        ("2.7 t/m3", "kg/m3", 2700.0),
        ("2.7 t/m^3", "kg/m3", 2700.0),
        ("2.7 t m-3", "kg/m3", 2700.0),
        ("9.81 m/s^2", "m/s2", 9.81),
        ("5 MPa/mm", "Pa/m", 5e9),
        ("1 N/mm2", "Pa", 1e6),
        ("20 kN*m", "J", 20e3),
        ("60 deg/s", "rad/s", math.pi / 3),
        ("50 Hz", "1/s", 50.0),
        ("1 1/min", "1/s", 1 / 60),
        ("10 %", "1", 0.1),
        ("-1.5e-3 mm", "m", -1.5e-6),
        (".5", "m", 0.5),
        (7, "m", 7.0),
    ],
)
def test_numbers(text, unit, number):
    assert to_number(text, unit) == pytest.approx(number, rel=1e-15)


@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_keeps_its_own_numbers_exactly(unit):
    assert to_number(f"0.1 {unit}", unit) == 0.1


SI = ("1", "m", "kg", "s", "Hz", "rad", "N", "Pa", "J")
PREFIXES = {"u": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6, "G": 1e9}
OTHERS = {
    "%": 0.01, "ft": 0.3048, "in": 0.0254, "g": 1e-3, "t": 1e3, "min": 60, "h": 3600, "d": 86400,
    "deg": math.pi / 180, "°": math.pi / 180, "bar": 1e5, "psi": 0.45359237 * 9.80665 / 0.0254**2,
}  # fmt: skip


@pytest.mark.parametrize("unit", UNITS)
def test_a_unit_is_a_prefix_and_an_si_unit_or_one_of_the_others(unit):
    """A pound is 0.45359237 kg, of weight 9.80665 N/kg."""
    named = dict.fromkeys(SI, 1.0) | OTHERS
    factor = named[unit] if unit in named else PREFIXES[unit[0]] * named[unit[1:]]
    assert UNITS[unit][0] == pytest.approx(factor, rel=1e-15)


@pytest.mark.parametrize("dimension", DIMENSIONS)
def test_every_dimension_has_its_si_unit(dimension):
    assert 1.0 in DIMENSIONS[dimension][1].values()


@pytest.mark.parametrize(
    ("value", "unit", "message"),
    [
        ("30 GPa", "m", "wrong dimension; use one of: m, km"),
        ("30 GPa", "m/s2", "wrong dimension; use m/s2 or the like"),
        ("30 Gpa", "Pa", "did you mean GPa"),
        ("30 parsec", "m", "unknown unit 'parsec' in '30 parsec'; use one of: m, km"),
        ("3 m//s", "m/s", "unknown unit"),
        ("3 m/", "m/s", "unknown unit"),
        ("1,5 m", "m", "unknown unit|must be a number"),
        ("", "m", "must be a number"),
        ("m", "m", "must be a number"),
        (None, "m", "got nothing"),
        (True, "m", "got true"),
        ({}, "m", "got a mapping"),
        (math.nan, "m", "finite"),
        ("1e999 m", "m", "finite"),
        (10**400, "m", "finite"),
        (1e31, "Pa", "must lie within -1e30 and 1e30"),
        ("-1e28 GPa", "Pa", "must lie within -1e30 and 1e30"),
        ("1 km999", "m", "unknown unit"),
        ("1 km" + "9" * 5000, "m", "unknown unit"),
        ("2,700", "kg/m3", "without a comma, got '2,700'; write 2700"),
    ],
)
def test_wrong_numbers(value, unit, message):
    with pytest.raises(ValueError, match=message):
        to_number(value, unit)


def test_what_rounding_leaves_is_zero():
    assert to_number(-1.5e-32, "m/s") == 0 and to_number("1e-300 m", "m") == 0
    assert to_number(1e-29, "m") == 1e-29 and to_number(1e30, "Pa") == 1e30


def test_one_degree_is_not_a_plain_number():
    assert parse_unit("deg")[1] != parse_unit("1")[1]
