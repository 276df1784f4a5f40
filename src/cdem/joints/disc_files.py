"""Discs from files: tables in any convention for planes, and polygons converted to discs."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.joints.attitudes import UNDERSTOOD, read_attitudes
from cdem.joints.attitudes import is_heading as names_planes
from cdem.joints.directions import poles
from cdem.joints.fracman import read_braced_polygons, read_polygons
from cdem.joints.tables import Table, plain, read_table
from cdem.mesh.arrays import along

Floats = NDArray[np.float64]
Row = tuple[Floats, Floats, float]

COLUMNS = ("x", "y", "z", "dip", "dip_direction", "radius")
"""Standard columns of a table of discs; `NAMES` and `attitudes.NAMES` have all known ones."""
NAMES: dict[str, tuple[str, ...]] = {
    "x": ("x", "xc", "x_c", "x_center", "x_centre", "center_x", "centre_x", "east", "easting"),
    "y": ("y", "yc", "y_c", "y_center", "y_centre", "center_y", "centre_y", "north", "northing"),
    "z": ("z", "zc", "z_c", "z_center", "z_centre", "center_z", "centre_z", "elevation"),
    "radius": ("radius", "r", "radio", "rayon", "raggio", "半径"),
    "diameter": ("diameter", "durchmesser", "diametre", "diametro", "直径"),
    "set": ("set", "joint_set"),
}


def read_rows(path: Path, notes: list[str]) -> list[Row]:
    """Read discs from a table, or from polygons: FracMan (`.fab`) or dfnWorks (`.dat`).

    A polygon becomes a disc of equal area about its centre.

    Args:
        path: The file.
        notes: Receives notes on assumptions and unused data.

    Returns:
        Centre [m], upward unit normal and radius [m] of each.

    Raises:
        CaseError: It cannot be read, or a value is missing or out of range.
    """
    polygons = None
    if path.suffix.lower() == ".fab":
        polygons = read_polygons(path, notes)
    elif path.suffix.lower() == ".dat" and _has_braces(path):
        polygons = read_braced_polygons(path)
    if polygons is not None:
        return [_disc_like(path, k, x) for k, x in enumerate(polygons, 1)]
    return _table_rows(path, notes)


def _table_rows(path: Path, notes: list[str]) -> list[Row]:
    """Discs of a table."""
    table = read_table(path, "file of discs", _is_heading)
    table.find(NAMES)
    at = table.at
    size = "radius" if "radius" in at else "diameter"
    if not {"x", "y", "z", size} <= at.keys() or not names_planes(table.head):
        raise CaseError(
            f"{path}: a file of discs needs columns {', '.join(COLUMNS)} in its first line; planes "
            f"may be {UNDERSTOOD}, the radius a diameter; it says: "
            f"{', '.join(table.head) or ', '.join(table.rows[0])}"
        )
    if "dip" in map(plain, table.head):
        table.at["dip"] = [plain(name) for name in table.head].index("dip")
        _refuse(table, "dip", table.numbers("dip"), 0, 90, "0 to 90")
    center = np.column_stack([table.lengths(axis) for axis in "xyz"])
    radius = table.lengths(size) * (0.5 if size == "diameter" else 1.0)
    for axis, values in zip("xyz", center.T, strict=True):
        _refuse(table, axis, values, -math.inf, math.inf, "a number")
    _refuse(table, size, radius, np.finfo(float).tiny, math.inf, "above 0")
    dip, direction, used = read_attitudes(table)
    table.tell_unused({"x", "y", "z", size, *used})
    notes += [f"{path.name}: {note}" for note in table.notes]
    normals = poles(dip, direction)
    return [(c, n, float(r)) for c, n, r in zip(center, normals, radius, strict=True)]


def _is_heading(words: list[str]) -> bool:
    names = {plain(word) for word in words}
    return names_planes(words) or all(names & set(NAMES[axis]) for axis in "xyz")


def _has_braces(path: Path) -> bool:
    with path.open("rb") as file:
        return b"{" in file.read(10_000)


def _refuse(table: Table, key: str, values: Floats, low: float, high: float, allowed: str) -> None:
    """Refuse the first disc with a number out of range."""
    with_side = key == "dip"  # words such as 40SE are parsed with the planes
    wrong = ~((values >= low) & (values <= high)) & ~(np.isnan(values) & with_side)
    wrong |= np.isinf(values)
    if wrong.any():
        row = int(wrong.argmax())
        raise CaseError(
            f"{table.path}: disc {row + 1}: {key} is {values[row]:g}; it must be {allowed} (line "
            f"{table.lines[row]} has '{table.column(key)[row]}')"
        )


def _disc_like(path: Path, number: int, x: Floats) -> Row:
    """The disc with the area, centre and plane of a polygon."""
    a, b = x[1:-1] - x[0], x[2:] - x[0]
    halves = np.cross(a, b) / 2
    area = float(np.linalg.norm(halves.sum(axis=0)))
    if area <= 1e-12 * float(np.ptp(x, axis=0).max()) ** 2:
        raise CaseError(f"{path}: fracture {number} has no area")
    normal = halves.sum(axis=0) / area
    part = along(halves, normal) / area
    center = x[0] + (part[:, None] * (a + b)).sum(axis=0) / 3
    upward = normal if normal[2] >= 0 else -normal
    return center, upward, math.sqrt(area / math.pi)
