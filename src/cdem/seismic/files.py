"""Records in files: PEER `.at2`, text of one or two columns, arrays of NumPy."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.seismic.processing import UNITS
from cdem.units import LARGEST, SMALLEST

LEAST, MOST = 10, 1_000_000
"""Fewest and most samples of a record."""
EVEN = 1e-6
"""Largest deviation of a time from an even step, as a part of the duration [1]."""
PEER_UNITS = {
    "G": "g", "M/S2": "m/s2", "M/S/S": "m/s2", "M/SEC2": "m/s2", "CM/S2": "cm/s2",
    "CM/S/S": "cm/s2", "CM/SEC2": "cm/s2", "CM/SEC/SEC": "cm/s2", "GAL": "cm/s2",
    "M/S": "m/s", "M/SEC": "m/s", "CM/S": "cm/s", "CM/SEC": "cm/s", "M": "m", "CM": "cm",
}  # fmt: skip
"""Units as PEER's headers write them."""
TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3}
"""Units of a column of times [s]."""


class Series(NamedTuple):
    """Samples of a file.

    Attributes:
        samples: In `unit`.
        step: Time between them [s]; None if the file does not tell.
        unit: A key of `UNITS`; None if the file does not tell.
    """

    samples: NDArray[np.float64]
    step: float | None
    unit: str | None


def read_at2(text: str, where: str) -> Series:
    """Samples of a PEER file: four lines of header, NPTS and DT in the last, then numbers.

    Args:
        text: The file.
        where: Its name, for errors.

    Raises:
        CaseError: It is no such file; with its line.
    """
    lines = text.split("\n")
    head = next((i for i, line in enumerate(lines[:10]) if _is_size(line)), None)
    if head is None:
        raise CaseError(
            f"{where}: no line with NPTS and DT among the first 10; a PEER file has NPTS= 4000, "
            "DT= .005 SEC in its fourth line; give other text files the ending .csv or .txt"
        )
    count, step = _size(lines[head], f"{where}:{head + 1}")
    rows = [_row(line, f"{where}:{i}") for i, line in enumerate(lines[head + 1 :], head + 2)]
    samples = np.array([number for row in rows for number in row], float)
    if len(samples) != count:
        raise CaseError(
            f"{where}:{head + 1}: NPTS is {count:,}, but {len(samples):,} numbers follow; the file "
            "is cut short, or has lines that do not belong to it"
        )
    return checked(Series(samples, step, _peer_unit(lines[:head])), where)


def read_columns(text: str, where: str) -> Series:
    """Samples of a text of one column, or of two with the times first; units stand in its header.

    Raises:
        CaseError: It is no such file; with its line.
    """
    lines = [
        (number, line.strip())
        for number, line in enumerate(text.split("\n"), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        raise CaseError(f"{where}: has no rows")
    has_head = not _is_number(_cells(lines[0][1])[0])
    units = _units(lines[0][1]) if has_head else []
    numbers = _table(lines[has_head:], len(units), where)
    unit = _known_unit(units[-1], where) if units else None
    if numbers.shape[1] == 1:
        return checked(Series(numbers[:, 0], None, unit), where)
    step = even_step(numbers[:, 0] * _time_unit(units[0] if units else None, where), where)
    return checked(Series(numbers[:, 1].copy(), step, unit), where)


def _units(line: str) -> list[str | None]:
    """Units of the columns in a first line such as ``time [s], acceleration [g]``."""
    found = [re.search(r"\[(.*)\]", name) for name in re.split(r"[,;]", line)]
    return [match[1].strip() if match else None for match in found]


def _table(lines: list[tuple[int, str]], named: int, where: str) -> NDArray[np.float64]:
    """Numbers of some lines, shape (lines, 1 or 2).

    Args:
        lines: Each with its number.
        named: Number of columns in the header; 0 without one.
        where: Name of the file.
    """
    rows = [(number, _row(line, f"{where}:{number}")) for number, line in lines]
    width = len(rows[0][1]) if rows else max(named, 1)
    if width not in (1, 2) or named not in (0, width):
        raise CaseError(
            f"{where}:{rows[0][0] if rows else 1}: has {width} columns, {named or 'none'} with a "
            "name; a record has one column, or two with the times first; use a file for each "
            "component"
        )
    for number, row in rows:
        if len(row) != width:
            raise CaseError(f"{where}:{number}: has {len(row)} numbers, not {width}")
    return np.array([row for _, row in rows], float).reshape(-1, width)


def of_array(array: NDArray, where: str) -> Series:
    """Samples of an array: one row of numbers, or two columns with the times [s] first.

    Raises:
        CaseError: It has another shape, or holds no numbers.
    """
    if array.dtype.kind not in "fiu" or array.ndim not in (1, 2) or array.size > 2 * MOST:
        raise CaseError(
            f"{where}: holds {array.dtype} of shape {array.shape}; a record is a row of at most "
            f"{MOST:,} numbers, or two columns with the times first"
        )
    if array.ndim == 2 and array.shape[1] != 2:
        raise CaseError(f"{where}: has {array.shape[1]} columns, not 1 or 2 (time, value)")
    numbers = np.asarray(array, float).reshape(len(array), -1)
    step = even_step(numbers[:, 0], where) if numbers.shape[1] == 2 else None
    return checked(Series(numbers[:, -1].copy(), step, None), where)


def even_step(times: NDArray[np.float64], where: str) -> float:
    """Step of evenly spaced times [s].

    Raises:
        CaseError: They are not even.
    """
    if len(times) < LEAST:
        raise _too_few(len(times), where)
    step = float(times[-1] - times[0]) / (len(times) - 1)
    off = np.abs(times - (times[0] + step * np.arange(len(times))))
    if not step > 0 or not (off <= EVEN * step * len(times)).all():
        row = int(np.argmax(off)) if step > 0 and np.isfinite(off).all() else 0
        raise CaseError(
            f"{where}: its times are not evenly spaced (row {row + 1}: {times[row]:g} s); "
            "interpolate it to an even step, or give one column of values, and its step in the case"
        )
    return step


def checked(series: Series, where: str) -> Series:
    """The same samples, once they are enough, finite, and not all 0.

    Raises:
        CaseError: They are not.
    """
    samples, step, _ = series
    if not LEAST <= len(samples) <= MOST:
        raise _too_few(len(samples), where)
    sound = np.abs(samples) <= LARGEST  # not a NaN
    if not sound.all():
        row = int(np.argmin(sound))
        raise CaseError(f"{where}: sample {row + 1:,} is {samples[row]}; a record has numbers only")
    if not (np.abs(samples) >= SMALLEST).any():
        raise CaseError(f"{where}: all {len(samples):,} samples are 0; is this the right file?")
    if step is not None and not 1e-7 <= step <= 10:
        raise CaseError(f"{where}: the time between samples is {step:g} s, not 1e-7 to 10 s")
    return series


def _too_few(count: int, where: str) -> CaseError:
    return CaseError(f"{where}: has {count:,} samples; a record has {LEAST} to {MOST:,}")


def _is_size(line: str) -> bool:
    return re.search(r"\bNPTS\b", line, re.IGNORECASE) is not None


def _size(line: str, where: str) -> tuple[int, float]:
    """NPTS and DT of ``NPTS=  4000, DT=   .0050 SEC``, or of the older ``4000 .0050 NPTS, DT``."""
    number = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
    points = re.search(rf"NPTS\s*[=:]\s*{number}", line, re.IGNORECASE)
    step = re.search(rf"DT\s*[=:]\s*{number}", line, re.IGNORECASE)
    if points and step:
        found = points[1], step[1]
    elif old := re.match(rf"\s*{number}[\s,]+{number}\s.*NPTS.*DT", line, re.IGNORECASE):
        found = old[1], old[2]
    else:
        raise CaseError(f"{where}: {line.strip()[:60]!r} has no NPTS= and DT= with numbers")
    count = float(found[0])
    if count != int(count) or not 0 < count <= MOST:
        raise CaseError(f"{where}: NPTS is {found[0]}; a record has {LEAST} to {MOST:,} samples")
    return int(count), float(found[1])


def _peer_unit(head: list[str]) -> str | None:
    """Unit in the header of a PEER file, as in ``ACCELERATION TIME SERIES IN UNITS OF G``."""
    for line in head:
        if match := re.search(r"UNITS?\s+OF\s+([A-Za-z/0-9]+)", line, re.IGNORECASE):
            return PEER_UNITS.get(match[1].upper())
    return None


def _known_unit(unit: str | None, where: str) -> str | None:
    if unit is not None and unit not in UNITS:
        raise CaseError(f"{where}: unknown unit [{unit[:20]}]; use one of: {', '.join(UNITS)}")
    return unit


def _time_unit(unit: str | None, where: str) -> float:
    if (unit or "s") not in TIMES:
        raise CaseError(f"{where}: its times are in [{unit}]; use one of: {', '.join(TIMES)}")
    return TIMES[unit or "s"]


def _cells(line: str) -> list[str]:
    return re.split(r"\s*[,;]\s*|\s+", line.strip())


def _row(line: str, where: str) -> list[float]:
    cells = _cells(line) if line.strip() else []
    if not all(map(_is_number, cells)):
        raise CaseError(f"{where}: {line.strip()[:40]!r} is not a row of numbers")
    return [float(cell) for cell in cells]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
