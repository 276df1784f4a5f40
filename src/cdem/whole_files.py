"""Files replaced as a whole, so that the old or the new one is there at any moment."""

from __future__ import annotations

import contextlib
import json
import math
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from cdem.errors import CdemError, DiskError

ASIDE = ".tmp"
"""Ending of an unfinished file."""


@contextmanager
def replaced(path: Path, keep: Path | None = None) -> Iterator[BinaryIO]:
    """Write a temporary file; at the end of the block it replaces the file at once.

    It is then on the disk, even if the power fails. After an error the old file stays.

    Args:
        path: The file.
        keep: New place of the old file; None to remove it.

    Raises:
        DiskError: It cannot be written.
    """
    aside = path.with_name(path.name + ASIDE)
    try:
        # a link in this place is not followed
        number = os.open(aside, os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW, 0o666)
        with os.fdopen(number, "w+b") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        if keep is not None and path.exists():
            os.replace(path, keep)
        os.replace(aside, path)
        _sync_folder(path.parent)
    except BaseException as error:
        with contextlib.suppress(OSError):
            aside.unlink()
        if isinstance(error, OSError):
            raise disk_error(path, error) from error
        raise


def refuse_link(path: Path) -> None:
    """Refuse a link in place of a file or folder to write.

    Raises:
        CdemError: There is a link.
    """
    if path.is_symlink():
        raise CdemError(
            f"{path}: is a link; nothing is read, written or removed through links in results: "
            "remove it"
        )


def sync(path: Path) -> None:
    """Make sure that a file is on the disk, even if the power fails.

    Raises:
        DiskError: The disk refuses it.
    """
    try:
        with path.open("rb") as file:
            os.fsync(file.fileno())
    except OSError as error:
        raise disk_error(path, error) from error


def disk_error(path: Path, error: OSError) -> DiskError:
    """The error for a file that could not be written, with the cause."""
    return DiskError(f"{path}: cannot be written ({error.strerror or error})")


def write_text(path: Path, text: str) -> None:
    """Write a text file as a whole, in UTF-8."""
    with replaced(path) as file:
        file.write(text.encode())


def write_json(path: Path, content: dict[str, Any]) -> None:
    """Write JSON as a whole; a number that is not finite is null."""
    write_text(path, json.dumps(_finite(content), indent=2, default=_plain, allow_nan=False) + "\n")


def _plain(value: Any) -> Any:
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"cannot write {type(value).__name__} as JSON")


def _sync_folder(folder: Path) -> None:
    number = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(number)
    finally:
        os.close(number)


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_finite(item) for item in value]
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value
