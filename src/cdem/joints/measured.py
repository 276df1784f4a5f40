"""Tables of measured joints: dip and dip direction, sets, and positions along scanlines."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.joints.attitudes import angles, azimuths, is_heading, read_attitudes
from cdem.joints.cloudcompare import families, prefer_normals
from cdem.joints.cluster_files import is_clusters, read_clusters
from cdem.joints.directions import dips, line, poles
from cdem.joints.tables import Table, number, plain, read_table

Floats = NDArray[np.float64]

NAMES: dict[str, tuple[str, ...]] = {
    "set": ("set", "joint_set", "kluftschar", "schar", "famille", "famiglia", "familia", "set_id")
    + ("family_ind", "family_id")
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
    if is_clusters(path):
        return _of_clusters(path, scanline)
    table = read_table(path, "table of joints", _is_heading)
    _refuse_cloud(table)
    prefer_normals(table)
    if {"slopeangle", "dip"} <= {plain(name) for name in table.head}:
        raise CaseError(
            f"{path}: has both dip and slopeangle, so dip is an azimuth; rename these columns to "
            "dip_direction and dip"
        )
    table.find(NAMES)
    dip, direction, used = read_attitudes(table)
    lines, at = _lines(table, used, len(dip), scanline), table.at
    position = _positions(table) if "position" in at else None
    table.tell_unused(used | NAMES.keys())
    names = table.column("scanline") if "scanline" in at else [""] * len(dip)
    return Measured(
        dip,
        direction,
        families(table) if "set" in at else None,
        names if lines is not None else None,
        lines,
        position,
        table.notes,
    )


def _lines(
    table: Table, used: set[str], count: int, scanline: tuple[float, float] | None
) -> Floats | None:
    """Unit vectors along the scanlines of a table, or along a given one."""
    if "trend" not in table.at or "trend" in used:
        if scanline is None:
            return None
        trend, plunge = (np.full(count, angle) for angle in scanline)
        return line(trend, plunge)
    if "plunge" not in table.at:
        raise CaseError(f"{table.path}: scanlines need both columns, trend and plunge")
    if scanline is not None:
        raise CaseError(f"{table.path}: has columns of scanlines; leave out the scanline")
    return line(azimuths(table, "trend"), angles(table, "plunge", -90, 90))


def _of_clusters(path: Path, scanline: tuple[float, float] | None) -> Measured:
    """Clusters of points as joints."""
    if scanline is not None:
        raise CaseError(f"{path}: has clusters of a cloud, no scanline; leave it out")
    normals, names, notes = read_clusters(path)
    return Measured(*dips(normals), names, notes=notes)


def _is_heading(words: list[str]) -> bool:
    return is_heading(words) or {"x", "y", "z"} <= {plain(word) for word in words}


def _refuse_cloud(table: Table) -> None:
    """Refuse a table without planes that looks like a point cloud."""
    if is_heading(table.head):
        return
    if {"x", "y", "z"} <= {plain(name) for name in table.head}:
        why = f"no planes, but x, y, z ({', '.join(table.head)})"
    elif (
        not table.head
        and len(row := table.rows[0]) > 2
        and np.isfinite(list(map(number, row))).all()
    ):
        why = f"no line of names, and {len(row)} numbers a line"
    else:
        return
    raise CaseError(f"{table.path}: has {why}; for a point cloud use --extract")


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
