"""Files that are replaced as a whole, so that at any moment the old or the new one is there."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError

ATTRIBUTES = "attributes"


def replace_file(temporary: Path, path: Path) -> None:
    """Put a file that was written aside into its place, in one go that survives a power cut."""
    os.replace(temporary, path)
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def write_checkpoint(path: Path, arrays: Mapping[str, NDArray], attributes: dict[str, Any]) -> None:
    """Write a checkpoint so that either the old or the new one is there, whole, at any moment."""
    temporary = path.with_name(path.name + ".tmp")
    try:
        with h5py.File(temporary, "w", locking=False) as file:
            for name, values in arrays.items():
                file.create_dataset(name.replace(".", "/"), data=values)
            # as a dataset, because an HDF5 attribute may not exceed 64 kB
            file[ATTRIBUTES] = json.dumps(attributes, default=_plain)
        with temporary.open("rb") as raw:
            os.fsync(raw.fileno())
    except OSError as error:  # a full disk, most often; the checkpoint before this one is kept
        temporary.unlink(missing_ok=True)
        raise CdemError(f"{path}: cannot write the checkpoint ({error})") from error
    replace_file(temporary, path)


def read_checkpoint(path: Path) -> tuple[dict[str, NDArray], dict[str, Any]]:
    """Read what `write_checkpoint` wrote, to the bit.

    Raises:
        CdemError: The file is not a checkpoint.
    """
    arrays: dict[str, NDArray] = {}

    def keep(name: str, item: h5py.Group | h5py.Dataset) -> None:
        if isinstance(item, h5py.Dataset) and name != ATTRIBUTES:
            arrays[name.replace("/", ".")] = np.asarray(item[()])

    try:
        with h5py.File(path, "r", locking=False) as file:
            file.visititems(keep)
            attributes = json.loads(file[ATTRIBUTES][()])
    except (OSError, KeyError, ValueError) as error:
        raise CdemError(f"{path}: not a checkpoint that can be read ({error})") from error
    return arrays, attributes


def write_json_atomic(path: Path, content: dict[str, Any]) -> None:
    """Write JSON so that a reader never sees half a file; a number that is not finite is null."""
    temporary = path.with_name(path.name + ".tmp")
    with temporary.open("w") as file:
        file.write(json.dumps(_finite(content), indent=2, default=_plain, allow_nan=False) + "\n")
        file.flush()
        os.fsync(file.fileno())
    replace_file(temporary, path)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_finite(item) for item in value]
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"cannot write {type(value).__name__} as JSON")
