"""Point clouds as text: x, y, z in the first three or in named columns."""

from __future__ import annotations

import io
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.joints.attitudes import NAMES as PLANE_NAMES
from cdem.joints.attitudes import is_heading as names_planes
from cdem.joints.disc_files import NAMES
from cdem.joints.tables import number, plain

Floats = NDArray[np.float64]

COMMENTS = ("#", "//", "%")
MARKS = (";", "\t", ",")
"""Separators of columns, besides spaces; the first that occurs in a line counts."""
NORMALS = {name for axis in ("nx", "ny", "nz") for name in PLANE_NAMES[axis]}
"""Headings of normals, which clouds have too."""
LOOKED_AT = 40
"""First lines in which the points must begin."""
LONGEST_LINE = 10_000


def read_text_points(path: Path, notes: list[str]) -> Floats:
    """Read a cloud as text; call it inside `reading`.

    Args:
        path: One point a line. Comments, a count of points and a line of names may come first.
        notes: Receives columns that are not used.

    Returns:
        [unit of the file], shape (points, 3).

    Raises:
        CaseError: It has no rows of three numbers, or is a table of joints; names the place.
    """
    with path.open("rb") as file:
        lines = [
            file.readline(LONGEST_LINE).decode("utf-8-sig", "replace") for _ in range(LOOKED_AT)
        ]
    head, skipped = _begin(lines)
    _refuse_table(path, head)
    if skipped == len(lines):
        raise CaseError(
            f"{path}: no line of three numbers among its first {LOOKED_AT}; a cloud has x y z in each"
        )
    words = _words(lines[skipped])
    if len(head) != len(words):
        head = []
    at = _columns(head)
    idle = [name or "?" for i, name in enumerate(head) if i not in at]
    if not head and len(words) > 3:
        idle = [f"{len(words) - 3} after x, y, z"]
    if idle:
        notes.append(f"columns not used: {', '.join(idle)}")
    return _load(path, lines[skipped], skipped, at)


def _begin(lines: list[str]) -> tuple[list[str], int]:
    """Names of the columns, if any, and the number of lines before the first point."""
    head: list[str] = []
    for skipped, line in enumerate(lines):
        words = _words(line)
        if line.lstrip().startswith(COMMENTS):
            words = _words(line.lstrip("#/% "))
        elif _numbers(words, 3):
            return head, skipped
        if len(words) > 1 and not _numbers(words, 1):
            head = words
    return head, len(lines)


def _words(line: str) -> list[str]:
    mark = next((m for m in MARKS if m in line), None)
    return [w.strip().strip('"') for w in line.strip().rstrip(mark).split(mark)]


def _numbers(words: list[str], least: int) -> bool:
    """Whether the first words are numbers, so many at least."""
    return len(words) >= least and all(
        np.isfinite(number(w.replace(",", "."))) for w in words[:least]
    )


def _refuse_table(path: Path, head: list[str]) -> None:
    if names_planes([name for name in head if plain(name) not in NORMALS]):
        raise CaseError(
            f"{path}: is a table of measured joints ({', '.join(head)}); leave out --extract"
        )


def _columns(head: list[str]) -> list[int]:
    """Places of x, y, z: by their names, else the first three."""
    names = [plain(name) for name in head]
    found = [[i for i, name in enumerate(names) if name in NAMES[axis]] for axis in "xyz"]
    if all(len(places) == 1 for places in found):
        return [places[0] for places in found]
    return [0, 1, 2]


def _load(path: Path, line: str, skipped: int, at: list[int]) -> Floats:
    """The three columns below the skipped lines."""
    mark = next((m for m in MARKS if m in line), None)
    text: io.TextIOBase
    with path.open(encoding="latin-1") as text:
        if mark != "," and re.search(r"\d,\d", line):  # decimal commas
            text = io.StringIO(text.read().replace(",", "."))
        return np.loadtxt(
            text, delimiter=mark, usecols=at, skiprows=skipped, comments=COMMENTS, ndmin=2
        )
