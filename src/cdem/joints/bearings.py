"""Bearings in common notations: `031`, `N45E`, `N 120`, `S20°W`, `40 SE`, `40°30'`."""

from __future__ import annotations

import re

import numpy as np

WINDS = {
    name: 22.5 * k
    for k, name in enumerate(
        [
            "N",
            "NNE",
            "NE",
            "ENE",
            "E",
            "ESE",
            "SE",
            "SSE",
            "S",
            "SSW",
            "SW",
            "WSW",
            "W",
            "WNW",
            "NW",
            "NNW",
        ]  # clockwise from north
    )
}
_ANGLE = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(?:°|deg|degrees|grad|d)?"
_MINUTES = r"(?:\s*(\d+(?:\.\d+)?)\s*['′’](?:\s*(\d+(?:\.\d+)?)\s*(?:\"|″|”|''))?)?"
_PLAIN = re.compile(_ANGLE + _MINUTES, re.IGNORECASE)
_BEARING = re.compile(r"([NESW])\s*" + _ANGLE + _MINUTES + r"\s*([NESW])?", re.IGNORECASE)
_SIDED = re.compile(_ANGLE + _MINUTES + r"\s*([NESWO]{1,3})", re.IGNORECASE)
_PAIR = re.compile(r"(.+?)\s*(?:[/∠,]|\s)\s*(\S+(?:\s*[NESW]{1,3})?)")


LONGEST = 40
"""Most characters of an angle: more are no angle, and would take the patterns very long."""


def angle(word: str) -> float:
    """An angle [deg], with or without a degree sign and minutes; NaN for other text."""
    found = _match(_PLAIN, word)
    return np.nan if found is None else _degrees(found[1], found[2], found[3])


def azimuth(word: str) -> float:
    """A bearing [deg] clockwise from north: a number, a wind, `N45E`, `N120`; NaN for other text."""
    word = word.strip()
    if (name := wind(word)) is not None:
        return name
    found = _match(_BEARING, word)
    if found is None:
        return angle(word)
    begin, turn = WINDS[found[1].upper()], _degrees(found[2], found[3], found[4])
    if found[5] is None:
        return turn if begin == 0 else np.nan
    side = (WINDS[found[5].upper()] - begin) % 360
    if side not in (90, 270) or turn < 0:
        return np.nan
    return (begin + turn * (1 if side == 90 else -1)) % 360


def wind(word: str) -> float | None:
    """Direction of a compass point [deg]: `SE`, `nnw`; German and French `SO` are ambiguous.

    O is east in German and west in French and Spanish, so only names without it are known.
    """
    return WINDS.get(word.strip().upper())


def sided(word: str) -> tuple[float, str]:
    """An angle and the side of its dip, empty without one: `40 SE`; NaN for other text."""
    found = _match(_SIDED, word)
    if found is None:
        return angle(word), ""
    return _degrees(found[1], found[2], found[3]), found[4].upper()


def pair(word: str) -> tuple[str, str] | None:
    """Both halves of an attitude in one word: `N45E 40SE`, `120/40`, `120°∠40°`."""
    found = _match(_PAIR, word)
    return None if found is None else (found[1], found[2])


def _match(pattern: re.Pattern[str], word: str) -> re.Match[str] | None:
    word = word.strip()
    return pattern.fullmatch(word) if len(word) <= LONGEST else None


def _degrees(whole: str, minutes: str | None, seconds: str | None) -> float:
    value = float(whole)
    part = float(minutes or 0) / 60 + float(seconds or 0) / 3600
    return value - part if whole.startswith("-") else value + part
