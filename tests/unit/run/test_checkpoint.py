"""Checkpoints: every bit comes back, and what has been damaged is noticed."""

from __future__ import annotations

import os

import h5py
import numpy as np
import pytest

from cdem.errors import DiskError
from cdem.run.checkpoint import DamagedError, read_checkpoint, write_checkpoint


def test_a_checkpoint_keeps_every_bit(tmp_path):
    arrays = {
        "node.position": np.random.default_rng(1).random((5, 3)),
        "node.odd": np.array([np.nan, -0.0, np.inf, 5e-324]),
        "contact.bond": np.array([1, 0], np.uint8),
        "none": np.zeros((0, 3), np.int32),
    }
    attributes = '{"text": "' + "x" * 100_000 + '"}'
    write_checkpoint(tmp_path, arrays, attributes)
    got, got_attributes = read_checkpoint(tmp_path / "checkpoint.h5")
    assert got_attributes.decode() == attributes
    assert got.keys() == arrays.keys()
    for name, values in arrays.items():
        assert (got[name].dtype, got[name].shape) == (values.dtype, values.shape)
        assert got[name].tobytes() == values.tobytes()
    assert [p.name for p in tmp_path.iterdir()] == ["checkpoint.h5"]


def test_the_checkpoint_before_is_kept(tmp_path):
    for n in range(3):
        write_checkpoint(tmp_path, {"a": np.zeros(2)}, str(n))
    assert read_checkpoint(tmp_path / "checkpoint.h5")[1] == b"2"
    assert read_checkpoint(tmp_path / "checkpoint-before.h5")[1] == b"1"


def test_a_failed_checkpoint_leaves_both_before(tmp_path, monkeypatch):
    for n in range(2):
        write_checkpoint(tmp_path, {"a": np.zeros(2)}, str(n))

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(DiskError, match="No space left"):
        write_checkpoint(tmp_path, {"a": np.ones(2)}, "2")
    assert read_checkpoint(tmp_path / "checkpoint.h5")[1] == b"1"
    assert read_checkpoint(tmp_path / "checkpoint-before.h5")[1] == b"0"
    assert len(list(tmp_path.iterdir())) == 2


def test_what_is_no_checkpoint_is_said_so(tmp_path):
    (tmp_path / "junk.h5").write_bytes(b"junk")
    with h5py.File(tmp_path / "old.h5", "w") as file:  # without a checksum
        file["attributes"] = "{}"
    for name in ("junk.h5", "old.h5"):
        with pytest.raises(DamagedError, match="is damaged"):
            read_checkpoint(tmp_path / name)
    with pytest.raises(DamagedError, match="is missing"):
        read_checkpoint(tmp_path / "none.h5")


def test_every_flipped_bit_is_noticed(tmp_path):
    write_checkpoint(tmp_path, {"a": np.arange(20.0)}, "1")
    path = tmp_path / "checkpoint.h5"
    content = path.read_bytes()
    random = np.random.default_rng(1)
    for place in [*range(600), *random.integers(0, len(content), 400)]:
        damaged = bytearray(content)
        damaged[place] ^= 1 << random.integers(8)
        path.write_bytes(damaged)
        with pytest.raises(DamagedError):
            read_checkpoint(path)
    for size in (0, 100, 512, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:size])
        with pytest.raises(DamagedError):
            read_checkpoint(path)
