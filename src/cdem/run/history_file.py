"""The histories of a run as CSV: one row per sample, units in the header."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from numbers import Integral
from pathlib import Path

from cdem.whole_files import disk_error, replaced, sync


class HistoryFile:
    """Histories that are being written.

    Args:
        path: The .csv file.
        columns: Names with units.
        keep_rows: Rows to keep of an existing file; None for a new one.

    Attributes:
        rows: Rows that it holds.
        lost: Rows that were to be kept and are damaged or not there.
    """

    def __init__(self, path: Path, columns: Sequence[str], keep_rows: int | None = None) -> None:
        self.path = path
        rows = [] if keep_rows is None else self._read(len(columns), keep_rows)
        self.rows, self.lost = len(rows), (keep_rows or 0) - len(rows)
        content = "".join([_line(columns), *rows]).encode()
        if keep_rows is None or not path.is_file() or path.read_bytes() != content:
            with replaced(path) as file:
                file.write(content)
        self._size = len(content)

    def append(self, row: Sequence[float]) -> None:
        """Add a row; numbers are written so that they read back to the same bits.

        Raises:
            DiskError: It cannot be written; another try begins where this one began.
        """
        line = _line([int(v) if isinstance(v, Integral) else repr(float(v)) for v in row]).encode()
        try:
            with self.path.open("r+b") as file:
                file.seek(self._size)
                file.write(line)
                file.truncate()
        except OSError as error:
            raise disk_error(self.path, error) from error
        self.rows, self._size = self.rows + 1, self._size + len(line)

    def sync(self) -> None:
        """Make sure that all rows are on the disk."""
        sync(self.path)

    def _read(self, width: int, keep_rows: int) -> list[str]:
        """The first rows of the file, without those that are damaged."""
        if not self.path.is_file():
            return []
        lines = self.path.read_bytes().decode(errors="replace").split("\n")
        # the text after the last line end was being written when the run was killed
        return [f"{line}\n" for line in lines[1:-1][:keep_rows] if _is_row(line, width)]


def _line(cells: Sequence[object]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue()


def _is_row(line: str, width: int) -> bool:
    try:
        return len([float(cell) for cell in line.split(",")]) == width
    except ValueError:
        return False
