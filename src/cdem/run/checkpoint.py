"""Checkpoints: all that a run needs to go on to the bit, with a checksum, in two generations."""

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
"""The one before, which is read if the last one is damaged."""
ATTRIBUTES = "attributes"
HEAD_BYTES = 512
"""Size of what stands before the HDF5 part: a user block, which HDF5 passes over."""
PIECE_BYTES = 1 << 20


class DamagedError(CdemError):
    """A checkpoint is not what was written, or not there."""


def has_checkpoint(folder: Path) -> bool:
    """Whether a result folder holds something to resume from."""
    return any((folder / name).is_file() for name in (CHECKPOINT, CHECKPOINT_BEFORE))


def write_checkpoint(folder: Path, arrays: Mapping[str, NDArray], attributes: str) -> None:
    """Write a checkpoint into a result folder; the one before is kept.

    Args:
        folder: The result folder.
        arrays: By name, with dots.
        attributes: Everything else, as JSON.

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
    """Read the arrays and attributes that `write_checkpoint` wrote, to the bit.

    Raises:
        DamagedError: The file is not what was written.
    """
    import h5py

    from cdem.run.datasets import read_all

    try:
        with path.open("rb") as file:
            if file.read(HEAD_BYTES) != _head(file):
                raise DamagedError(f"{path}: is damaged (its checksum is another)")
            file.seek(0)
            with h5py.File(file, "r") as hdf5:
                refuse_links(hdf5, path)
                stored = read_all(hdf5, but=ATTRIBUTES)
                arrays = {name.replace("/", "."): values for name, values in stored}
                attributes = bytes(hdf5[ATTRIBUTES][()])
    except FileNotFoundError:
        raise DamagedError(f"{path}: is not there") from None
    except DamagedError:
        raise
    except Exception as error:  # a right checksum, but not of a checkpoint; h5py raises many kinds
        raise DamagedError(f"{path}: not a checkpoint that can be read ({error})") from error
    return arrays, attributes


def _head(file: BinaryIO) -> bytes:
    """What stands at the start of a file: the checksum of all that comes after it."""
    checksum = hashlib.sha256()
    file.seek(HEAD_BYTES)
    while piece := file.read(PIECE_BYTES):
        checksum.update(piece)
    return f"cdem checkpoint, sha256 {checksum.hexdigest()}\n".encode().ljust(HEAD_BYTES, b"\0")
