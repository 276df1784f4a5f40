"""Files that are replaced as a whole."""

from __future__ import annotations

import json
import math
import os

import numpy as np
import pytest

from cdem.errors import DiskError
from cdem.whole_files import replaced, write_json, write_text


def test_json_is_strict_and_whole(tmp_path):
    path = tmp_path / "summary.json"
    write_json(path, {"a": np.float64(1.5), "b": [math.nan, np.int32(2)], "c": {"d": "e"}})
    strict = json.loads(path.read_text(), parse_constant=lambda name: pytest.fail(name))
    assert strict == {"a": 1.5, "b": [None, 2], "c": {"d": "e"}}
    assert [p.name for p in tmp_path.iterdir()] == ["summary.json"]


@pytest.mark.parametrize("call", ["fsync", "replace"])
def test_what_cannot_be_written_leaves_the_old_file(tmp_path, monkeypatch, call):
    path = tmp_path / "a.txt"
    write_text(path, "old")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, call, full)
    with pytest.raises(DiskError, match=r"a\.txt: cannot be written \(No space left on device\)"):
        write_text(path, "new")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_any_other_error_inside_the_block_leaves_the_old_file(tmp_path):
    path = tmp_path / "a.txt"
    write_text(path, "old")
    with pytest.raises(KeyError), replaced(path) as file:
        file.write(b"half")
        raise KeyError
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_the_old_file_can_be_kept(tmp_path):
    path, before = tmp_path / "a", tmp_path / "before"
    for text in (b"1", b"2", b"3"):
        with replaced(path, keep=before) as file:
            file.write(text)
    assert (path.read_bytes(), before.read_bytes()) == (b"3", b"2")
