"""Histories: rows read back to the bit, and a broken file goes on."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from cdem.errors import DiskError
from cdem.run.history_file import SUM_DIGITS, HistoryFile

COLUMNS = ["time [s]", "step", "block.velocity_x [m/s]"]


def steps_of(path: Path) -> list[str]:
    return [line.split(",")[1] for line in path.read_text().splitlines()]


def test_history_rows_read_back_to_the_same_bits(tmp_path):
    path = tmp_path / "h.csv"
    rows = [[0.1 + 0.2, 7, math.pi], [1e-300, np.int64(8), np.float64(-0.0)]]
    history = HistoryFile(path, COLUMNS)
    for row in rows:
        history.append(row)
    lines = path.read_text().splitlines()
    assert lines[0] == "time [s],step,block.velocity_x [m/s]"
    assert [float(v) for line in lines[1:] for v in line.split(",")] == [v for r in rows for v in r]
    assert lines[2].split(",")[1] == "8"


def test_a_resumed_history_drops_the_rows_after_the_checkpoint(tmp_path):
    path = tmp_path / "h.csv"
    history = HistoryFile(path, COLUMNS)
    for step in range(4):
        history.append([0.1 * step, step, 1.0])
    with path.open("a") as file:
        file.write("0.4,")  # killed here
    resumed = HistoryFile(path, COLUMNS, keep=history.sums[: 2 * SUM_DIGITS])
    resumed.append([0.2, 2, 5.0])
    assert steps_of(path) == ["step", "0", "1", "2"]
    assert (resumed.rows, resumed.lost) == (3, 0)


@pytest.mark.parametrize(
    ("content", "lost"),
    [
        (None, 3),
        (b"", 3),
        (b"time [s],step,block.velocity_x [m/s]\n0.0,0,1.0\n0.1,1", 2),
        (b"\xff\x00junk\n0.0,0,1.0\n\xff\xfe,1,1.0\n0.2,2,1.0\n", 1),
    ],
)
def test_a_damaged_history_is_mended_and_lost_rows_are_counted(tmp_path, content, lost):
    path = tmp_path / "h.csv"
    whole = HistoryFile(path, COLUMNS)
    for step in range(3):
        whole.append([0.1 * step, step, 1.0])
    path.unlink()
    if content is not None:
        path.write_bytes(content)
    history = HistoryFile(path, COLUMNS, keep=whole.sums)
    history.append([0.3, 3, 1.0])
    assert (history.rows, history.lost) == (4 - lost, lost)
    assert steps_of(path)[0] == "step" and steps_of(path)[-1] == "3"
    assert len(steps_of(path)) == 5 - lost


def test_a_row_that_could_not_be_written_leaves_no_trace(tmp_path, monkeypatch):
    path = tmp_path / "h.csv"
    history = HistoryFile(path, COLUMNS)
    history.append([0.0, 0, 1.0])
    with path.open("a") as file:
        file.write("0.1,")  # as of a full disk
    path.chmod(0o400)
    monkeypatch.setattr(history, "path", tmp_path)  # a folder: cannot be written
    with pytest.raises(DiskError, match="cannot be written"):
        history.append([0.1, 1, 1.0])
    monkeypatch.undo()
    path.chmod(0o600)
    history.append([0.1, 1, 1.0])
    assert steps_of(path) == ["step", "0", "1"]


def test_a_flipped_bit_anywhere_loses_the_rows_that_it_touches(tmp_path):
    path = tmp_path / "h.csv"
    history = HistoryFile(path, COLUMNS)
    for step in range(4):
        history.append([0.1 * step, step, 1.0])
    whole = path.read_bytes()
    rows = whole.splitlines(keepends=True)[1:]
    for place in range(len(whole) - sum(map(len, rows)), len(whole)):
        for bit in range(8):
            content = bytearray(whole)
            content[place] ^= 1 << bit
            path.write_bytes(content)
            resumed = HistoryFile(path, COLUMNS, keep=history.sums)
            kept = path.read_bytes().splitlines(keepends=True)[1:]
            assert resumed.lost in (1, 2) and len(kept) == resumed.rows == 4 - resumed.lost
            assert set(kept) < set(rows)


def test_rows_that_are_the_same_are_all_kept(tmp_path):
    path = tmp_path / "h.csv"
    history = HistoryFile(path, COLUMNS)
    for step in (0, 1, 1, 2):
        history.append([0.1 * step, step, 1.0])
    assert HistoryFile(path, COLUMNS, keep=history.sums).lost == 0
