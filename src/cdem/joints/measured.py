"""Tables of measured joints: dip and dip direction, sets, and positions along scanlines."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.joints.attitudes import angles, azimuths, is_heading, read_attitudes
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
FACETS = {"horiz_ext", "vert_ext", "normalx", "normaly", "normalz"}
"""Headings by which a table is one of facets of CloudCompare."""


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
        normals, names, notes = read_clusters(path)
        if scanline is not None:
            raise CaseError(f"{path}: has clusters of a cloud, no scanline; leave it out")
        return Measured(*dips(normals), names, notes=notes)
    table = read_table(path, "table of joints", _is_heading)
    if not is_heading(table.head) and (cloud := _like_a_cloud(table)):
        raise CaseError(f"{path}: {cloud}; for a point cloud use --extract")
    _prefer_normals(table)
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
    sets = table.column("set") if "set" in at else None
    if sets and FACETS <= {plain(name) for name in table.head}:
        sets = _families(sets)
    return Measured(
        dip,
        direction,
        sets,
        names if trend is not None else None,
        None if trend is None or plunge is None else line(trend, plunge),
        position,
        table.notes,
    )


def _is_heading(words: list[str]) -> bool:
    return is_heading(words) or {"x", "y", "z"} <= {plain(word) for word in words}


def _like_a_cloud(table: Table) -> str:
    """In words, why a table without planes looks like a point cloud; empty if it does not."""
    if {"x", "y", "z"} <= {plain(name) for name in table.head}:
        return f"has no planes, but x, y, z ({', '.join(table.head)})"
    width = len(table.rows[0])
    if not table.head and width > 2 and np.isfinite([number(w) for w in table.rows[0]]).all():
        return f"has no line of names, and {width} numbers a line"
    return ""


def _prefer_normals(table: Table) -> None:
    """Leave out dips in whole degrees beside normals: CloudCompare's facets have both."""
    names = [plain(name) for name in table.head]
    if not FACETS <= set(names):
        return
    dips_of = [i for i, name in enumerate(names) if name in ("dip", "dip_dir")]
    if not all(number(row[i]).is_integer() for row in table.rows for i in dips_of):
        return
    table.notes.append("facets of CloudCompare: planes by their normals, as dips are whole degrees")
    kept = [i for i in range(len(names)) if i not in dips_of]
    table.head = [table.head[i] for i in kept]
    table.rows = [[row[i] for i in kept] for row in table.rows]


def _families(sets: list[str]) -> list[str] | None:
    """Families of CloudCompare's facets as sets; 0 and -1 are none; None if there are none."""
    named = ["" if word in ("0", "-1") else f"family{word}" for word in sets]
    return named if any(named) else None


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
