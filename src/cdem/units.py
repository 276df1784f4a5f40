"""Numbers with units: "30 GPa", "21 deg", "2 t/m3" become SI numbers; wrong units are refused."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

Dimension = tuple[int, int, int, int]  # powers of kilogram, metre, second, radian

# Every unit that a case may use, by dimension: powers of (kg, m, s, rad), then factors to SI.
DIMENSIONS: dict[str, tuple[Dimension, dict[str, float]]] = {
    "ratio": ((0, 0, 0, 0), {"1": 1.0, "%": 1e-2}),
    "length": (
        (0, 1, 0, 0),
        {"m": 1.0, "km": 1e3, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "ft": 0.3048, "in": 0.0254},
    ),
    "mass": ((1, 0, 0, 0), {"kg": 1.0, "g": 1e-3, "t": 1e3, "kt": 1e6, "Mt": 1e9}),
    "time": (
        (0, 0, 1, 0),
        {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0, "d": 86400.0},
    ),
    "frequency": ((0, 0, -1, 0), {"Hz": 1.0, "kHz": 1e3}),
    "angle": ((0, 0, 0, 1), {"rad": 1.0, "deg": math.pi / 180, "°": math.pi / 180}),
    "force": ((1, 1, -2, 0), {"N": 1.0, "kN": 1e3, "MN": 1e6, "GN": 1e9}),
    "stress": (
        (1, -1, -2, 0),
        {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5, "psi": 6894.757293168361},
    ),
    "energy": ((1, 2, -2, 0), {"J": 1.0, "kJ": 1e3, "MJ": 1e6, "GJ": 1e9}),
}
UNITS: dict[str, tuple[float, Dimension]] = {
    name: (factor, powers)
    for powers, factors in DIMENSIONS.values()
    for name, factor in factors.items()
}

SMALLEST, LARGEST = 1e-30, 1e30  # products of larger numbers overflow
MOST_POWER_DIGITS = 2  # most characters of a power with its sign
SHOWN = 60  # most characters of a value in a message
_TYPESET = {ord("−"): "-", ord("‐"): "-", ord("–"): "-"} | dict.fromkeys(map(ord, "“”„‘’«»\"'"))
"""Minus signs and quotes of word processors."""
_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*", re.DOTALL)
_FACTOR = re.compile(r"([*/·.]?)\s*(1|[^\W\d]+|[%°])(?:\^?([-+]?\d+))?\s*")


def parse_unit(text: str) -> tuple[float, Dimension]:
    """Read a unit such as ``kg/m3``, ``m/s^2`` or ``kN m``.

    Args:
        text: Known units joined by a space, ``*`` or ``/``; a power follows as ``2`` or ``^2``.

    Returns:
        The factor to SI, and the powers of (kg, m, s, rad).

    Raises:
        ValueError: A part of the text is not a known unit.

    Example:
        >>> parse_unit("t/m3")
        (1000.0, (1, -3, 0, 0))
    """
    scale, powers, position = 1.0, [0, 0, 0, 0], 0
    while position < len(text):
        match = _FACTOR.match(text, position)
        if match is None or match[2] not in UNITS or len(match[3] or "") > MOST_POWER_DIGITS:
            raise ValueError(f"unknown unit '{text}'{_did_you_mean(text)}")
        factor, dimension = UNITS[match[2]]
        exponent = int(match[3] or 1) * (-1 if match[1] == "/" else 1)
        scale *= factor**exponent
        powers = [p + exponent * d for p, d in zip(powers, dimension, strict=True)]
        position = match.end()
    return scale, (powers[0], powers[1], powers[2], powers[3])


def to_number(value: object, unit: str) -> float:
    """Read a number, or a string with a unit, as a number in ``unit``.

    Args:
        value: A real number, taken to be in ``unit`` already, or text such as ``"30 GPa"``.
        unit: Unit of the result, e.g. ``"Pa"``, ``"deg"`` or ``"1"``.

    Returns:
        A finite number in ``unit``; 0 for a value below 1e-30, which comes from rounding.

    Raises:
        ValueError: Not a number, not finite, too large, an unknown unit or one of another
            dimension.

    Example:
        >>> to_number("30 GPa", "Pa"), to_number(21, "deg")
        (30000000000.0, 21.0)
    """
    if isinstance(value, str):
        value = value.translate(_TYPESET).strip()
        if re.match(r"[-+]?\d{1,3}(?:[ _'\u202f\u00a0]\d{3})+(?!\d)", value):
            raise ValueError(
                f"must be a number without marks between its digits, got {describe(value)}; write "
                "5000000 or 5e6 for 5 000 000"
            )
        if re.match(r"\s*[-+]?\d+,\d", value):
            raise ValueError(
                f"must be a number without a comma, got {describe(value)}; write 2700 for 2,700 "
                "and 2.7 for 2,7"
            )
        match = _NUMBER.fullmatch(value)
        if match is None:
            unit_too = "" if unit == "1" else f" or a text such as '3 {unit}'"
            raise ValueError(f"must be a number{unit_too}, got {describe(value)}")
        number = float(match[1])
        if match[2]:
            number *= _ratio(match[2], unit, value)
    elif isinstance(value, bool) or not hasattr(value, "__float__"):
        raise ValueError(f"must be a number [{unit}], got {describe(value)}")
    else:
        try:
            number = float(value)
        except OverflowError:  # a whole number of hundreds of digits
            number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"must be a finite number, got {describe(value)}")
    if abs(number) > LARGEST:
        raise ValueError(f"must lie within -1e30 and 1e30 [{unit}], got {describe(value)}")
    return number if abs(number) >= SMALLEST else 0.0


def coordinates(point: Iterable[float]) -> str:
    """Coordinates [m] as text: exact to a millimetre on maps, without the noise of rounding."""
    return ", ".join(f"{x:.10g}" for x in point)


def describe(value: object) -> str:
    """Describe a value in the words of a case file, for error messages."""
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "a mapping (key: value)"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    text = str(value)
    text = text if len(text) <= SHOWN else text[:SHOWN] + "..."
    return f"'{text}'" if isinstance(value, str) else text


def _ratio(text: str, unit: str, whole: str) -> float:
    target, wanted = parse_unit(unit)
    names = [name for name, (_, powers) in UNITS.items() if powers == wanted]
    allowed = "use one of: " + ", ".join(names) if names else f"use {unit} or the like"
    try:
        factor, dimension = parse_unit(text)
    except ValueError as error:
        hint = "" if "did you mean" in str(error) else f"; {allowed}"
        raise ValueError(f"{error} in '{whole}'{hint}") from None
    if dimension != wanted:
        raise ValueError(f"'{whole}' has the wrong dimension; {allowed}")
    return factor / target  # exactly 1 for the same unit, so "21 deg" stays 21


def _did_you_mean(text: str) -> str:
    """Suggest a unit that differs in case only: ``Gpa`` for ``GPa``, ``KN`` for ``kN``."""
    for word in re.findall(r"[^\W\d]+", text):
        close = [name for name in UNITS if name.lower() == word.lower() and name != word]
        if word not in UNITS and close:
            return f"; did you mean {close[0]}?"
    return ""
