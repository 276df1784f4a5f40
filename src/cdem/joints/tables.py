"""Users' tables as rows of words: comments, separators, headings and encodings."""

from __future__ import annotations

import csv
import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import read_text
from cdem.errors import CaseError

Floats = NDArray[np.float64]
Line = tuple[int, str]  # its number in the file, its text
Split = Callable[[str], list[str]]

COMMENTS = ("#", "%", "!")

MARKS = ";\t,"
"""Separators of columns, besides spaces; the first that occurs in a line counts."""
SAME = str.maketrans("º˚−‐‑–，；、", "°°----,;,")
"""Signs of similar shape: degrees, minus, separators."""
LABELS = {"id", "no", "nr", "number", "#", "fid", "index", ""}
"""Names of columns that only number the rows."""
LENGTHS = {"": 1.0, "m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "ft": 0.3048}
LENGTHS |= {"metres": 1.0, "meters": 1.0, "feet": 0.3048, "in": 0.0254, "inch": 0.0254}
_UNIT = re.compile(r"[\[(]([^\])]*)[\])]?|[_\s](deg|degrees?|rad|gon|m|mm|cm|km|ft)$")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


@dataclass
class Table:
    """A table in words.

    Attributes:
        path: The file.
        head: Names of the columns in the file; empty without a heading.
        rows: Words of each row, equal in number to the columns.
        lines: Line number of each row in the file.
        notes: Messages for the user.
        at: Column of each quantity, by the names that its reader uses.
    """

    path: Path
    head: list[str]
    rows: list[list[str]]
    lines: list[int]
    notes: list[str] = field(default_factory=list)
    at: dict[str, int] = field(default_factory=dict)

    def column(self, key: str) -> list[str]:
        """The words of a column."""
        return [row[self.at[key]] for row in self.rows]

    def numbers(self, key: str) -> Floats:
        """A column as numbers; NaN for a word that is not a number."""
        return np.array([number(word) for word in self.column(key)])

    def lengths(self, key: str) -> Floats:
        """A column of lengths as numbers [m]; its heading may have a unit."""
        return self.numbers(key) * self.factor(key, LENGTHS)

    def factor(self, key: str, units: Mapping[str, float], not_these: Iterable[str] = ()) -> float:
        """Factor of the unit in a column's heading; other words in brackets are noted.

        Raises:
            CaseError: The unit is one of ``not_these``.
        """
        unit = self.unit(key)
        if unit in not_these:
            raise CaseError(
                f"{self.path}: column {self.name(key)!r} has the unit '{unit}'; use one of "
                f"{', '.join(name for name in units if name)}"
            )
        note = f"not used: '({unit})' in the heading of {self.name(key)!r}"
        if unit not in units and note not in self.notes:
            self.notes.append(note)
        return units.get(unit, 1.0)

    def unit(self, key: str) -> str:
        """The text in brackets in a column's heading, in lower case."""
        found = _UNIT.search(self.head[self.at[key]].lower()) if self.head else None
        return (found[1] or found[2] or "").strip(" .") if found else ""

    def name(self, key: str) -> str:
        """Name of a column in its file."""
        return self.head[self.at[key]] if self.head else f"column {self.at[key] + 1}"

    def find(self, names: Mapping[str, Iterable[str]]) -> None:
        """Find columns by their headings; columns already in `at` stay.

        Args:
            names: By quantity: its possible headings, in the form of `plain`.

        Raises:
            CaseError: Two columns may be the same.
        """
        heads, taken = [plain(name) for name in self.head], set(self.at.values())
        for key, known in names.items():
            found = [i for i, name in enumerate(heads) if name in known and i not in taken]
            if len(found) > 1:
                raise CaseError(
                    f"{self.path}: more than one column may be the {key.replace('_', ' ')}: "
                    f"{', '.join(self.head[i] for i in found)}; rename the others"
                )
            if found and key not in self.at:
                self.at[key] = found[0]

    def tell_unused(self, used: Iterable[str]) -> None:
        """Note the unused columns."""
        columns = {self.at[key] for key in used if key in self.at}
        idle = [
            name
            for i, name in enumerate(self.head)
            if i not in columns and (plain(name) not in LABELS or not name)
        ]
        if idle:
            self.notes.append(f"columns not used: {', '.join(idle)}")


def number(word: str) -> float:
    """A number, or NaN."""
    return float(word) if _NUMBER.fullmatch(word) else np.nan


def plain(name: str) -> str:
    """A column's name in lower case, without accents, unit and marks; words joined by `_`."""
    name = _UNIT.sub("", name.lower().split("[")[0].split("(")[0]).strip(" ._\"'°#")
    name = unicodedata.normalize("NFKD", name.replace("ß", "ss"))
    name = "".join(c for c in name if not unicodedata.combining(c))
    return re.sub(r"[\s\-'/]+", "_", name)


def read_table(path: Path, what: str, is_head: Callable[[list[str]], bool]) -> Table:
    """Read a table: UTF-8, UTF-16 or, with a note, another encoding; `#` begins comments.

    Args:
        path: The file; columns are separated by semicolons, tabs, commas or spaces. A comma is a
            decimal point if it does not separate columns.
        what: The kind of table, e.g. "table of joints".
        is_head: Whether some words are headings known to the reader.

    Returns:
        The table; without a heading if its first row begins with a number or a bearing.

    Raises:
        CaseError: It cannot be read, or a row has another number of columns; names the place.
    """
    try:
        return _read(path, what, is_head)
    except csv.Error as error:  # a word without end
        raise CaseError(f"{path}: is no {what} ({error})") from None


def _read(path: Path, what: str, is_head: Callable[[list[str]], bool]) -> Table:
    text, notes = _text(path, what, is_head)
    lines = [
        (k, words)
        for k, line in enumerate(text.translate(SAME).splitlines(), 1)
        if (words := unicodedata.normalize("NFKC", line).strip(" \xa0")).strip(MARKS + " ")
    ]
    remarks = [(k, line.lstrip("#%! ")) for k, line in lines if line.startswith(COMMENTS)]
    lines = [(k, line) for k, line in lines if not line.startswith(COMMENTS)]
    if lines:
        split = _splitter(next((m for m in MARKS if m in lines[0][1]), None))
        head, lines = _heading(lines, remarks, split, is_head)
    if not lines:
        raise CaseError(f"{path}: a {what} needs a line of names and rows of numbers")
    rows = _rows(path, head, lines, split)
    return Table(path, head, rows, [k for k, _ in lines], notes)


def _heading(
    lines: list[Line], remarks: list[Line], split: Split, is_head: Callable[[list[str]], bool]
) -> tuple[list[str], list[Line]]:
    """Names of the columns, and the lines below them."""
    first = split(lines[0][1])
    head: list[str] = []
    if not any(re.search(r"\d", word) for word in first) or is_head(first):
        head, lines = first, lines[1:]
    else:  # a heading may be a comment; the last known one counts
        above = [words for k, words in remarks if k < lines[0][0]]
        head = next((h for h in map(split, reversed(above)) if is_head(h)), [])
    while head and not head[-1]:  # separators at the end
        head.pop()
    return head, lines


def _rows(path: Path, head: list[str], lines: list[Line], split: Split) -> list[list[str]]:
    """Words of every row; separators at its end are ignored."""
    rows: list[list[str]] = []
    for k, line in lines:
        row = split(line)
        width = len(head) or len(rows[0] if rows else row)
        while len(row) > width and not row[-1]:
            row.pop()
        if len(row) != width:
            named = f"the first line names {width} columns" if head else f"others have {width}"
            raise CaseError(f"{path}:{k}: has {len(row)} values, but {named}")
        rows.append(row)
    return rows


def _splitter(mark: str | None) -> Split:
    """How lines are divided into words."""

    def words(line: str) -> list[str]:
        row = line.split() if mark is None else next(csv.reader([line], delimiter=mark))
        return [w.strip() if mark == "," else w.strip().replace(",", ".") for w in row]

    return words


def _text(path: Path, what: str, is_head: Callable[[list[str]], bool]) -> tuple[str, list[str]]:
    """The text, and a note if it is not in UTF-8."""
    try:
        return read_text(path, what), []
    except CaseError as error:
        if not isinstance(error.__context__, UnicodeDecodeError):
            raise
        raw = path.read_bytes()
        if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
            text = raw.decode("utf-16", "replace")
            return text.replace("\r\n", "\n").replace("\r", "\n"), []
        for encoding, name in (("gb18030", "GB18030"), ("cp1252", "Latin-1 (Windows-1252)")):
            try:
                text = raw.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")
            except UnicodeDecodeError:
                continue
            if any(unicodedata.category(c) == "Cc" and c not in "\t\n\f" for c in text):
                raise  # not text
            if encoding == "cp1252" or _understood(text, is_head):
                note = f"read as {name}: it is not in UTF-8; save it as UTF-8 if names look wrong"
                return text, [note]
        raise


def _understood(text: str, is_head: Callable[[list[str]], bool]) -> bool:
    """Whether a line of a text is a heading with letters beyond Latin."""
    for line in text.translate(SAME).splitlines():
        line = unicodedata.normalize("NFKC", line).lstrip("#%! ")
        mark = next((m for m in MARKS if m in line), None)
        if re.search(r"[\u4e00-\u9fff]", line) and is_head(_splitter(mark)(line)):
            return True
    return False
