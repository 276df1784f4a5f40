"""Checkpoints: all data to continue a run bit for bit, with a checksum, in two generations."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import BinaryIO

from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.hdf5_links import refuse_links
from cdem.whole_files import replaced

CHECKPOINT = "checkpoint.h5"
CHECKPOINT_BEFORE = "checkpoint-before.h5"
"""The previous checkpoint; it is read if the last one is damaged."""
ATTRIBUTES = "attributes"
HEAD_BYTES = 512
"""Size of the head before the HDF5 part: a user block, which HDF5 skips."""
PIECE_BYTES = 1 << 20


class DamagedError(CdemError):
    """A checkpoint has changed since it was written, or is missing."""


def has_checkpoint(folder: Path) -> bool:
    """Whether a result folder holds a checkpoint."""
    return any((folder / name).is_file() for name in (CHECKPOINT, CHECKPOINT_BEFORE))


def write_checkpoint(folder: Path, arrays: Mapping[str, NDArray], attributes: str) -> None:
    """Write a checkpoint into a result folder; the previous one is kept.

    Args:
        folder: The result folder.
        arrays: Arrays by name, with dots.
        attributes: All other data, as JSON.

    Raises:
        DiskError: It cannot be written.
    """
    import h5py

    from cdem.run.datasets import put

    with replaced(folder / CHECKPOINT, keep=folder / CHECKPOINT_BEFORE) as file:
        with h5py.File(file, "w", userblock_size=HEAD_BYTES) as hdf5:
            for name, values in arrays.items():
                put(hdf5, name.replace(".", "/"), values)
            # as a dataset, because an HDF5 attribute may not exceed 64 kB
            hdf5[ATTRIBUTES] = attributes
        head = _head(file)
        file.seek(0)
        file.write(head)


def read_checkpoint(path: Path) -> tuple[dict[str, NDArray], bytes]:
    """Read the arrays and attributes of `write_checkpoint`, bit for bit.

    Raises:
        DamagedError: The file has changed since it was written.
    """
    import h5py

    from cdem.run.datasets import read_all

    try:
        with path.open("rb") as file:
            if file.read(HEAD_BYTES) != _head(file):
                raise DamagedError(f"{path}: is damaged (its checksum is wrong)")
            file.seek(0)
            with h5py.File(file, "r") as hdf5:
                refuse_links(hdf5, path)
                stored = read_all(hdf5, but=ATTRIBUTES)
                arrays = {name.replace("/", "."): values for name, values in stored}
                attributes = bytes(hdf5[ATTRIBUTES][()])
    except FileNotFoundError:
        raise DamagedError(f"{path}: is missing") from None
    except DamagedError:
        raise
    except Exception as error:  # correct checksum, but no checkpoint; h5py raises many kinds
        raise DamagedError(f"{path}: cannot be read as a checkpoint ({error})") from error
    return arrays, attributes


def _head(file: BinaryIO) -> bytes:
    """Head of a file: the checksum of everything after it."""
    checksum = hashlib.sha256()
    file.seek(HEAD_BYTES)
    while piece := file.read(PIECE_BYTES):
        checksum.update(piece)
    return f"cdem checkpoint, sha256 {checksum.hexdigest()}\n".encode().ljust(HEAD_BYTES, b"\0")
