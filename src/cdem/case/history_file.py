"""Histories in files: `history: {file: blast.csv}` becomes the rows of that file."""

from __future__ import annotations

import re
from typing import Any

from cdem.case.input_file import read_text, reading
from cdem.case.source import Keys, Source
from cdem.errors import CaseError
from cdem.units import to_number

COLUMNS = (("time", "s"), ("factor", "1"))
"""Columns of such a file, with their units in a case."""
MEND = (
    "a history is a text file of two columns, time and factor, separated by commas, semicolons or "
    "blanks; units other than s and 1 stand in its first line: time [ms], factor"
)
MOST_ROWS = 1_000_000
"""Most rows of a history."""


def with_histories(value: Any, source: Source, keys: Keys = ()) -> Any:
    """Replace histories that name a file by the rows of the file.

    Args:
        value: Plain data of a case, or a part of it; stays unchanged.
        source: Origin of the data; relative names start at its folder.
        keys: Path of the part in the case.

    Raises:
        CaseError: A file cannot be read; names the file and the problem.
    """
    if isinstance(value, list):
        return [with_histories(one, source, (*keys, i)) for i, one in enumerate(value)]
    if not isinstance(value, dict):
        return value
    return {
        key: _rows(one["file"], source, (*keys, key))
        if is_file_of_history(key, one)
        else with_histories(one, source, (*keys, key))
        for key, one in value.items()
    }


def is_file_of_history(key: str, value: Any) -> bool:
    """Whether a value names the file of a history; the key may be a path of `set`."""
    return (
        key.rsplit(".", 1)[-1] == "history"
        and isinstance(value, dict)
        and set(value) == {"file"}
        and isinstance(value["file"], str)
    )


def _rows(file: str, source: Source, keys: Keys) -> list[list[float]]:
    path = source.folder / file
    with source.blame(".".join(map(str, keys))), reading(path, CaseError, MEND):
        text = read_text(path, "history")
        lines = [
            (number, line.strip())
            for number, line in enumerate(text.split("\n"), 1)
            if line.strip() and not line.lstrip().startswith("#")
        ]
        units = [unit for _, unit in COLUMNS]
        if lines and not _is_number(_cells(lines[0][1])[0]):
            units = _units(lines[0][1], f"{path}:{lines[0][0]}")
            lines = lines[1:]
        if not 1 <= len(lines) <= MOST_ROWS:
            raise CaseError(f"{path}: has {len(lines):,} rows, not 1 to {MOST_ROWS:,}; {MEND}")
        scales = [to_number(f"1 {unit}", of) for unit, (_, of) in zip(units, COLUMNS, strict=True)]
        return [_row(line, scales, f"{path}:{number}") for number, line in lines]


def _cells(line: str) -> list[str]:
    return re.split(r"\s*[,;]\s*|\s+", line)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _units(line: str, where: str) -> list[str]:
    """Units that the first line gives for the columns, e.g. ``time [ms], factor [1]``."""
    names = [name.strip() for name in re.split(r"[,;]", line)]
    if len(names) != len(COLUMNS):
        raise CaseError(f"{where}: names {len(names)} columns, not 2; {MEND}")
    units = []
    for name, (column, of) in zip(names, COLUMNS, strict=True):
        unit = match[1] if (match := re.search(r"\[(.*)\]", name)) else of
        try:
            to_number(f"1 {unit}", of)
        except ValueError as error:
            raise CaseError(f"{where}: {column}: {error}") from None
        units.append(unit)
    return units


def _row(line: str, scales: list[float], where: str) -> list[float]:
    cells = _cells(line)
    if len(cells) != len(COLUMNS) or not all(map(_is_number, cells)):
        raise CaseError(f"{where}: {line[:40]!r} is not two numbers; {MEND}")
    return [float(cell) * scale for cell, scale in zip(cells, scales, strict=True)]
