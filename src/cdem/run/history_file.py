"""The histories of a run as CSV: one row per sample, units in the header."""

from __future__ import annotations

import csv
import io
import zlib
from collections.abc import Sequence
from contextlib import suppress
from numbers import Integral
from pathlib import Path

from cdem.whole_files import disk_error, replaced, sync

SUM_DIGITS = 8
"""Hexadecimal digits of a CRC-32."""


class HistoryFile:
    """Histories under construction.

    Args:
        path: The .csv file.
        columns: Names with units.
        keep: Checksums of rows to keep of an existing file, as in `sums`; None for a new file.

    Attributes:
        rows: Number of its rows.
        lost: Number of rows to keep that are damaged or missing.
        sums: CRC-32 of each row, `SUM_DIGITS` hexadecimal digits each.
    """

    def __init__(self, path: Path, columns: Sequence[str], keep: str | None = None) -> None:
        self.path = path
        rows = [] if keep is None else self._read(len(columns), keep)
        self._sums = [_sum(row) for row in rows]
        self.lost = len(keep or "") // SUM_DIGITS - len(rows)
        content = b"".join([_line(columns).encode(), *rows])
        if keep is None or not path.is_file() or path.read_bytes() != content:
            with replaced(path) as file:
                file.write(content)
        self._size = len(content)

    @property
    def rows(self) -> int:
        return len(self._sums)

    @property
    def sums(self) -> str:
        return "".join(self._sums)

    def append(self, row: Sequence[float]) -> None:
        """Add a row; numbers read back to the same bits.

        Raises:
            DiskError: It cannot be written; another try starts at the same place.
        """
        line = _line([int(v) if isinstance(v, Integral) else repr(float(v)) for v in row]).encode()
        try:
            with self.path.open("r+b") as file:
                file.seek(self._size)
                file.write(line)
                file.truncate()
        except OSError as error:
            raise disk_error(self.path, error) from error
        self._sums.append(_sum(line))
        self._size += len(line)

    def sync(self) -> None:
        """Make sure that all rows are on the disk."""
        sync(self.path)

    def _read(self, width: int, keep: str) -> list[bytes]:
        """The rows of the file with these checksums, in order."""
        if not self.path.is_file():
            return []
        sums = [keep[k : k + SUM_DIGITS] for k in range(0, len(keep), SUM_DIGITS)]
        rows: list[bytes] = []
        at = 0  # index of the next row; rows at the end and start of stages may be equal
        # a kill may have left an incomplete last line
        for line in self.path.read_bytes().split(b"\n")[1:-1]:
            if at == len(sums):
                break
            row = line + b"\n"
            with suppress(ValueError):  # none of these rows
                place = sums.index(_sum(row), at)
                if row.count(b",") == width - 1:
                    rows.append(row)
                    at = place + 1
        return rows


def _sum(row: bytes) -> str:
    return f"{zlib.crc32(row):0{SUM_DIGITS}x}"


def _line(cells: Sequence[object]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(cells)
    return text.getvalue()
