"""Points with heights and, optionally, dips: from CSV or GIS files of any program."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import read_text, reading
from cdem.errors import CaseError
from cdem.terrain.features import read_features
from cdem.terrain.files import WHAT, Bring

Floats = NDArray[np.float64]
NAMES = {
    "x": ("x", "east", "easting", "x_m"),
    "y": ("y", "north", "northing", "y_m"),
    "z": ("z", "elev", "elevation", "height", "altitude", "z_m"),
    "dip": ("dip", "dip_angle", "angle", "slope", "slopeangle"),
    "dip_direction": (
        "dip_direction", "dipdir", "dip_dir", "dir", "direction", "azimut", "azimuth", "azi",
    ),
}  # fmt: skip
"""Known names of columns, in lower case, for each quantity."""
Rows = list[dict[str, object]]


def read_points(path: Path, columns: Mapping[str, str], bring: Bring) -> dict[str, Floats]:
    """Read points.

    Args:
        path: CSV with a first line of names, or a GIS file of points.
        columns: Names of columns for x, y, z, dip, dip_direction; others are detected.
        bring: Transforms the points to metres.

    Returns:
        x, y, z [m], and dip, dip_direction [deg] if the file has dips; each of shape (points,).

    Raises:
        CaseError: The file cannot be read, or lacks a column.
    """
    for key in columns:
        if key not in NAMES:
            raise CaseError(f"{path}: columns are {', '.join(NAMES)}, not '{key}'")
    label = None
    if path.suffix.lower() in (".csv", ".txt"):
        with reading(path, CaseError, "points are CSV or a GIS file"):
            rows = _of_csv(path)
    else:
        found = read_features(path)
        label, rows = found.label, _of_features(path, found.items)
    if not rows:
        raise CaseError(f"{path}: contains no points")
    named = _named(path, rows[0], columns)
    values = {key: _numbers(path, rows, name) for key, name in named.items()}
    values["x"], values["y"], values["z"] = bring(
        label, np.column_stack([values["x"], values["y"], values["z"]])
    ).T
    _check_dips(path, values)
    return values


def _of_csv(path: Path) -> Rows:
    lines = [line for line in read_text(path, WHAT).splitlines() if line.strip()]
    if not lines:
        return []
    head = [name.strip().lstrip("#").strip().lower() for name in next(csv.reader(lines[:1]))]
    rows: Rows = []
    for number, cells in enumerate(csv.reader(lines[1:], skipinitialspace=True), start=2):
        if len(cells) < len(head):
            raise CaseError(f"{path}: row {number} has {len(cells)} of {len(head)} columns")
        rows.append(dict(zip(head, cells, strict=False)))
    return rows


def _of_features(path: Path, items: list) -> Rows:
    rows: Rows = []
    for number, (geometry, properties) in enumerate(items):
        if geometry.get("type") != "Point":
            continue
        at = geometry.get("coordinates") or []
        if len(at) < 2:
            raise CaseError(f"{path}: feature {number} is not a point [x, y]")
        row: dict[str, object] = {str(k).lower(): v for k, v in properties.items()}
        rows.append(row | dict(zip(("x", "y", "z"), at, strict=False)))
    return rows


def _named(path: Path, row: Mapping[str, object], columns: Mapping[str, str]) -> dict[str, str]:
    """Column of each quantity."""
    # AvaFrame's scarp points call the azimuth dip, and count it from east
    if "slopeangle" in row and "dip" in row and "dip" not in columns:
        raise CaseError(
            f"{path}: has columns 'dip' and 'slopeangle'; give their meaning, e.g. columns: {{dip: "
            "slopeangle, dip_direction: ...}; AvaFrame's 'dip' is an azimuth counted from east"
        )
    found = {}
    for key, names in NAMES.items():
        wanted = [columns[key].lower()] if key in columns else names
        name = next((name for name in wanted if name in row), None)
        if name is not None:
            found[key] = name
        elif key in columns:
            raise CaseError(f"{path}: has no column '{columns[key]}'; it has: {', '.join(row)}")
    needed = ["x", "y", "z"] + (
        ["dip", "dip_direction"] if {"dip", "dip_direction"} & {*found} else []
    )
    missing = [key for key in needed if key not in found]
    if missing:
        raise CaseError(
            f"{path}: has no column for {', '.join(missing)}; name it with 'columns' (it has: "
            f"{', '.join(row)})"
        )
    return found


def _numbers(path: Path, rows: Rows, name: str) -> Floats:
    out = np.full(len(rows), np.nan)
    for number, row in enumerate(rows):
        with suppress(KeyError, TypeError, ValueError):
            out[number] = float(row[name])  # type: ignore[arg-type]
        if not np.isfinite(out[number]):
            raise CaseError(f"{path}: point {number + 1} has no number in column '{name}'")
    return out


def _check_dips(path: Path, values: Mapping[str, Floats]) -> None:
    if "dip" in values and not ((values["dip"] >= 0) & (values["dip"] < 90)).all():
        raise CaseError(
            f"{path}: dips must lie in [0, 90) deg, got {values['dip'].min():g} to "
            f"{values['dip'].max():g}; is another column the dip? Name it with 'columns'"
        )
