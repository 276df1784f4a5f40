"""Files of records: `records: {kobe: {file: kobe.at2}}` gets the samples of that file."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from cdem.case.explain import explain
from cdem.case.input_file import read_text, reading
from cdem.case.reader import read_settings
from cdem.case.source import Source
from cdem.case.waves_schema import Record
from cdem.errors import CaseError
from cdem.seismic.files import Series, of_array, read_at2, read_columns
from cdem.units import to_number

MEND = (
    "a record is a PEER file (.at2), a text (.csv, .txt) of one column or of two with the times "
    "first, or an array of NumPy (.npy)"
)
PEER = (".at2", ".vt2", ".dt2")
TEXT = (".csv", ".txt")


def with_records(data: dict[str, Any], source: Source) -> dict[str, Any]:
    """Add to records the samples of their files.

    Args:
        data: Plain data of a case; stays unchanged.
        source: Origin of the data; relative names start at its folder.

    Raises:
        CaseError: A file cannot be read; names the file and the problem.
    """
    records = data.get("records")
    if not isinstance(records, dict):
        return data
    return data | {"records": {name: _read(name, one, source) for name, one in records.items()}}


def _read(name: str, record: Any, source: Source) -> Any:
    """A record with the samples of its file."""
    if not isinstance(record, dict) or not isinstance(record.get("file"), str):
        return record
    if record.get("samples") is not None:
        return record  # the file has been read
    with source.blame(f"records.{name}.file"):
        series = read_series(source.folder / record["file"])
        told = {"unit": series.unit, "step": series.step}
        for key, value in told.items():
            given = record.get(key)
            if value is not None and given is not None and not _same(given, value):
                raise CaseError(f"the file has the {key} {value}, the case {given}; remove {key}")
    return (
        record
        | {key: value for key, value in told.items() if value is not None}
        | {"samples": " ".join(map(repr, series.samples.tolist()))}
    )


def _same(given: Any, value: str | float) -> bool:
    if isinstance(value, str):
        return bool(given == value)
    try:
        return abs(to_number(given, "s") - value) <= 1e-6 * value
    except ValueError:
        return False


def read_series(path: Path) -> Series:
    """Read a file of samples.

    Raises:
        CaseError: It cannot be read, or is no record; with its line.
    """
    ending = path.suffix.lower()
    with reading(path, CaseError, MEND):
        if ending == ".npy":
            with path.open("rb") as file:
                return of_array(np.load(file, allow_pickle=False), str(path))
        if ending not in PEER + TEXT:
            raise CaseError(f"{path}: has the ending {ending or 'of no file'}; {MEND}")
        text = read_text(path, "record")
        read = read_at2 if ending in PEER else read_columns
        return read(text, str(path))


def load_record(path: Path, settings: Iterable[str]) -> Record:
    """A record of a file, with keys as texts such as ``"unit=g"``.

    Raises:
        CaseError: The file cannot be read, or a key is wrong or missing.
    """
    source = Source(file=str(path))
    given = {"file": path.name} | read_settings(settings)
    data = with_records({"records": {path.stem: given}}, source)["records"][path.stem]
    try:
        record = Record(**data)
    except ValidationError as error:
        raise explain(error, source, Record) from None
    if record.band_fault:
        raise source.error([(("band",), record.band_fault)])
    return record
