"""Tables of measured joints: dip and dip direction, sets, and where a scanline meets them."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import read_text
from cdem.errors import CaseError
from cdem.joints.directions import line, poles

Floats = NDArray[np.float64]

NAMES: dict[str, tuple[str, ...]] = {
    "dip": ("dip", "dip_angle", "angle", "slope", "slopeangle"),
    "dip_direction": (
        "dip_direction",
        "dipdirection",
        "dipdir",
        "dip_dir",
        "dir",
        "direction",
        "azimuth",
        "azimut",
        "azi",
        "dd",
    ),
    "strike": ("strike",),
    "set": ("set", "joint_set"),
    "scanline": ("scanline", "borehole", "hole"),
    "trend": ("trend",),
    "plunge": ("plunge",),
    "position": ("position", "distance", "chainage", "depth"),
}
"""Columns of a table, and how they may be called: lower case, spaces as underscores, without units."""
RANGES = {
    "dip": (0.0, 90.0),
    "dip_direction": (0.0, 360.0),
    "strike": (0.0, 360.0),
    "trend": (0.0, 360.0),
    "plunge": (-90.0, 90.0),
    "position": (-np.inf, np.inf),
}


@dataclass
class Measured:
    """Joints of a table.

    Attributes:
        dip: Below the horizontal [deg], shape (joints,).
        dip_direction: Clockwise from north [deg], shape (joints,).
        set_of: Name of each joint's set, empty for none; None if the table has no sets.
        scanline: Name of each joint's scanline; None if there is none.
        lines: Unit vectors along those scanlines, shape (joints, 3); None if there are none.
        position: Along the scanline [m], shape (joints,); None if there is none.
        notes: What a user should know.
    """

    dip: Floats
    dip_direction: Floats
    set_of: list[str] | None = None
    scanline: list[str] | None = None
    lines: Floats | None = None
    position: Floats | None = None
    notes: list[str] = field(default_factory=list)

    @property
    def normals(self) -> Floats:
        """Upward unit normals, shape (joints, 3); x east, y north, z up."""
        return poles(self.dip, self.dip_direction)


def read_measured(path: Path, scanline: tuple[float, float] | None = None) -> Measured:
    """Read a table of joints; its first line names the columns, see `NAMES`.

    Args:
        path: CSV file; columns are parted by commas, semicolons, tabs or spaces.
        scanline: Trend and plunge [deg] of the one line along which all were measured, if the table
            has no columns of them.

    Raises:
        CaseError: It cannot be read, a column is missing or in doubt, or a value out of range.
    """
    head, rows, start = _rows(path)
    at = _columns(path, head)
    values = {key: _numbers(path, start, rows, at, key, head) for key in RANGES if key in at}
    notes = []
    if "dip_direction" in values:
        direction = values["dip_direction"]
    else:
        direction = (values["strike"] + 90) % 360
        notes.append("strike is taken by the right-hand rule: dip direction = strike + 90")
    trend, plunge = values.get("trend"), values.get("plunge")
    if scanline is not None:
        if trend is not None:
            raise CaseError(f"{path}: has columns of scanlines; give no other scanline")
        trend, plunge = (np.full(len(rows), angle) for angle in scanline)
    names = [row[at["scanline"]] for row in rows] if "scanline" in at else [""] * len(rows)
    return Measured(
        values["dip"],
        direction,
        [row[at["set"]] for row in rows] if "set" in at else None,
        names if trend is not None else None,
        None if trend is None or plunge is None else line(trend, plunge),
        values.get("position"),
        notes,
    )


def _rows(path: Path) -> tuple[list[str], list[list[str]], list[int]]:
    """Names of the columns, the rows, and the line of the file that each row stands in."""
    text = read_text(path, "table of joints")
    lines = [(k, words) for k, words in enumerate(text.splitlines(), 1) if words.strip()]
    if len(lines) < 2:
        raise CaseError(f"{path}: a table of joints needs a line of names and rows of numbers")
    first = lines[0][1].lstrip("# ")
    mark = next((m for m in ";\t," if m in first), None)
    split: Callable[[str], list[str]] = (
        str.split
        if mark is None
        else lambda words: [w.strip() for w in next(csv.reader([words], delimiter=mark))]
    )
    head, rows = split(first), []
    for number, words in lines[1:]:
        row = split(words)
        if len(row) != len(head):
            raise CaseError(
                f"{path}:{number}: has {len(row)} values, but the first line names {len(head)} columns"
            )
        # where semicolons or tabs part the columns a comma is a decimal point
        rows.append(row if mark in (None, ",") else [word.replace(",", ".") for word in row])
    return head, rows, [number for number, _ in lines[1:]]


def _plain(name: str) -> str:
    """A column's name in lower case, without unit and marks."""
    return re.sub(r"[\s-]+", "_", re.sub(r"[\[(].*", "", name.lower()).strip(" ._\"'"))


def _columns(path: Path, head: list[str]) -> dict[str, int]:
    """Where the columns that are there stand."""
    plain = [_plain(name) for name in head]
    if "slopeangle" in plain and "dip" in plain:
        raise CaseError(
            f"{path}: has both dip and slopeangle: there dip is an azimuth; rename these columns to "
            "dip_direction and dip"
        )
    at: dict[str, int] = {}
    for key, names in NAMES.items():
        found = [i for i, name in enumerate(plain) if name in names]
        if len(found) > 1:
            raise CaseError(
                f"{path}: more than one column may be the {key.replace('_', ' ')}: "
                f"{', '.join(head[i] for i in found)}; rename the others"
            )
        if found:
            at[key] = found[0]
    if "dip" not in at or not {"dip_direction", "strike"} & at.keys():
        raise CaseError(
            f"{path}: the first line must name the columns dip and dip_direction (or strike); it "
            f"says: {', '.join(head)}"
        )
    if ("trend" in at) != ("plunge" in at):
        raise CaseError(f"{path}: scanlines need both columns, trend and plunge")
    return at


def _numbers(
    path: Path,
    start: list[int],
    rows: list[list[str]],
    at: dict[str, int],
    key: str,
    head: list[str],
) -> Floats:
    low, high = RANGES[key]
    out = np.empty(len(rows))
    for k, row in enumerate(rows):
        word = row[at[key]]
        try:
            out[k] = float(word)
        except ValueError:
            out[k] = np.nan
        if not (np.isfinite(out[k]) and low <= out[k] <= high):
            allowed = "a number" if low == -np.inf else f"a number from {low:g} to {high:g}"
            raise CaseError(f"{path}:{start[k]}: {head[at[key]]} must be {allowed}, got '{word}'")
    return out
