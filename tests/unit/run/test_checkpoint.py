"""Files that are replaced as a whole: checkpoints and JSON."""

from __future__ import annotations

import json
import math
import os

import numpy as np
import pytest

from cdem.errors import CdemError
from cdem.run.checkpoint import read_checkpoint, write_checkpoint, write_json_atomic


def test_a_checkpoint_keeps_every_bit(tmp_path):
    path = tmp_path / "checkpoint.h5"
    arrays = {
        "node.position": np.random.default_rng(1).random((5, 3)),
        "node.odd": np.array([np.nan, -0.0, np.inf, 5e-324]),
        "contact.bond": np.array([1, 0], np.uint8),
        "none": np.zeros((0, 3), np.int32),
    }
    attributes = {"time": 0.1 + 0.2, "stage": None, "text": "x" * 100_000}
    write_checkpoint(path, arrays, attributes)
    got, got_attributes = read_checkpoint(path)
    assert got_attributes == attributes
    assert got.keys() == arrays.keys()
    for name, values in arrays.items():
        assert (got[name].dtype, got[name].shape) == (values.dtype, values.shape)
        assert got[name].tobytes() == values.tobytes()
    assert [p.name for p in tmp_path.iterdir()] == ["checkpoint.h5"]


def test_a_failed_checkpoint_leaves_the_one_before(tmp_path, monkeypatch):
    path = tmp_path / "checkpoint.h5"
    write_checkpoint(path, {"a": np.zeros(2)}, {"n": 1})

    def full(*_):
        raise OSError("No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(CdemError, match="No space left"):
        write_checkpoint(path, {"a": np.ones(2)}, {"n": 2})
    assert read_checkpoint(path)[1] == {"n": 1}
    assert [p.name for p in tmp_path.iterdir()] == ["checkpoint.h5"]


def test_what_is_no_checkpoint_is_said_so(tmp_path):
    (tmp_path / "junk.h5").write_bytes(b"junk")
    for name in ("junk.h5", "none.h5"):
        with pytest.raises(CdemError, match="not a checkpoint"):
            read_checkpoint(tmp_path / name)


def test_json_is_strict_and_whole(tmp_path):
    path = tmp_path / "summary.json"
    write_json_atomic(path, {"a": np.float64(1.5), "b": [math.nan, np.int32(2)], "c": {"d": "e"}})
    strict = json.loads(path.read_text(), parse_constant=lambda name: pytest.fail(name))
    assert strict == {"a": 1.5, "b": [None, 2], "c": {"d": "e"}}
    assert [p.name for p in tmp_path.iterdir()] == ["summary.json"]
