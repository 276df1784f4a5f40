"""Tables of measured joints: dip and dip direction, sets, and positions along scanlines."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.joints.attitudes import angles, azimuths, is_heading, read_attitudes
from cdem.joints.directions import line, poles
from cdem.joints.tables import Table, plain, read_table

Floats = NDArray[np.float64]

NAMES: dict[str, tuple[str, ...]] = {
    "set": ("set", "joint_set", "kluftschar", "schar", "famille", "famiglia", "familia", "set_id")
    + ("节理组", "组", "组别"),
    "scanline": (
        "scanline",
        "borehole",
        "hole",
        "bohrung",
        "sondage",
        "sondaggio",
        "sondeo",
        "测线",
    )
    + ("钻孔",),
    "trend": ("trend",),
    "plunge": ("plunge",),
    "position": ("position", "distance", "chainage", "depth", "tiefe", "profondeur", "profondita")
    + ("profundidad", "深度", "位置"),
}
"""Columns beside the columns of planes, and their possible headings, in the form of `plain`."""


@dataclass
class Measured:
    """Joints of a table.

    Attributes:
        dip: Dip below the horizontal [deg], shape (joints,).
        dip_direction: Azimuth clockwise from north [deg], shape (joints,).
        set_of: Name of each joint's set, empty for none; None if the table has no sets.
        scanline: Name of each joint's scanline, or None.
        lines: Unit vectors along those scanlines, shape (joints, 3), or None.
        position: Position along the scanline [m], shape (joints,), or None.
        notes: Messages for the user.
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
    """Read a table of joints in any convention of `attitudes`; notes report assumptions and unused
    data.

    Args:
        path: Text file; columns are separated by commas, semicolons, tabs or spaces.
        scanline: Trend and plunge [deg] of the single scanline of all joints, if the table
            has no columns for it.

    Raises:
        CaseError: It cannot be read, a column is missing or ambiguous, or a value is out of range.
    """
    table = read_table(path, "table of joints", is_heading)
    if {"slopeangle", "dip"} <= {plain(name) for name in table.head}:
        raise CaseError(
            f"{path}: has both dip and slopeangle, so dip is an azimuth; rename these columns to "
            "dip_direction and dip"
        )
    table.find(NAMES)
    dip, direction, used = read_attitudes(table)
    at = table.at
    trend, plunge, position = None, None, None
    if "trend" in at and "trend" not in used:
        if "plunge" not in at:
            raise CaseError(f"{path}: scanlines need both columns, trend and plunge")
        trend, plunge = azimuths(table, "trend"), angles(table, "plunge", -90, 90)
    if scanline is not None:
        if trend is not None:
            raise CaseError(f"{path}: has columns of scanlines; leave out the scanline")
        trend, plunge = (np.full(len(dip), angle) for angle in scanline)
    if "position" in at:
        position = _positions(table)
    table.tell_unused(used | NAMES.keys())
    names = table.column("scanline") if "scanline" in at else [""] * len(dip)
    return Measured(
        dip,
        direction,
        table.column("set") if "set" in at else None,
        names if trend is not None else None,
        None if trend is None or plunge is None else line(trend, plunge),
        position,
        table.notes,
    )


def _positions(table: Table) -> Floats:
    """Positions along scanlines [m]."""
    values = table.lengths("position")
    if not np.isfinite(values).all():
        row = int(np.isfinite(values).argmin())
        raise CaseError(
            f"{table.path}:{table.lines[row]}: {table.name('position')} must be a number, got "
            f"'{table.column('position')[row]}'"
        )
    return values
