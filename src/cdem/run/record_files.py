"""Processed records in a result folder: a resumed run goes on with those of its begin."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path

import numpy as np

from cdem.case.case import Case
from cdem.errors import CdemError
from cdem.seismic.processing import Processed
from cdem.whole_files import write_text

FOLDER = "records"
"""The folder of processed records in a result folder."""
HEAD = "time [s],acceleration [m/s2],velocity [m/s],displacement [m]"


def _path(folder: Path, name: str) -> Path:
    return folder / FOLDER / f"{name}.csv"


def write_records(folder: Path, case: Case) -> dict[str, str]:
    """Write the processed records of a case; returns the SHA-256 of each file.

    Args:
        folder: The result folder.
        case: The case.
    """
    if case.records:
        (folder / FOLDER).mkdir(exist_ok=True)
    digests = {}
    for name in case.records:
        text = as_text(case.processed(name))
        write_text(_path(folder, name), text)
        digests[name] = _digest(text.encode())
    return digests


def as_text(record: Processed) -> str:
    """A record as a table; it gives the same bits when it is read."""
    columns = (record.times, record.acceleration, record.velocity, record.displacement)
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return "\n".join([HEAD, *(",".join(map(repr, row)) for row in rows), ""])


def with_kept_records(folder: Path, case: Case) -> tuple[Case, dict[str, str]]:
    """A case with the processed records of its run, and the SHA-256 of their files.

    Raises:
        CdemError: One is missing or damaged.
    """
    found = {name: _read(_path(folder, name)) for name in case.records}
    case = case.model_copy(deep=True)
    case.keep_records({name: record for name, (record, _) in found.items()})
    return case, {name: digest for name, (_, digest) in found.items()}


def _read(path: Path) -> tuple[Processed, str]:
    """Read a processed record, and the SHA-256 of its file."""
    try:
        raw = path.read_bytes()
        head, *lines = raw.decode().splitlines()
        rows = np.array([line.split(",") for line in lines], float)
        if head != HEAD or rows.shape[1] != 4 or len(rows) < 2:
            raise _changed(path)
    except OSError as error:
        raise CdemError(
            f"{path}: cannot be read ({error.strerror}): a resumed run goes on with the record "
            "of its begin; put the file back, or run the case again with --overwrite"
        ) from None
    except (ValueError, IndexError):
        raise _changed(path) from None
    columns = [column.copy() for column in rows.T[1:]]
    return Processed(float(rows[1, 0]), *columns), _digest(raw)


def check_records(folder: Path, then: dict[str, str], now: dict[str, str]) -> None:
    """Refuse to continue with another record than the run was begun with.

    Args:
        folder: The result folder.
        then: SHA-256 of the records in the checkpoint.
        now: SHA-256 of the records in the folder.

    Raises:
        CdemError: A record has changed.
    """
    for name in sorted(now):
        if then.get(name) != now[name]:
            raise _changed(_path(folder, name))


def _changed(path: Path) -> CdemError:
    return CdemError(
        f"{path}: is not the record that the run was begun with; put the file back, or run the "
        "case again with --overwrite"
    )


def _digest(raw: bytes) -> str:
    return sha256(raw).hexdigest()
