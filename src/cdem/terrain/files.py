"""Readers of terrain: lines of known height (GIS files, CSV), outlines of bodies."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Callable, Iterator
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import read_text, reading
from cdem.errors import CaseError
from cdem.terrain.features import BY_GDAL, GEOJSON, Features, read_features
from cdem.terrain.heights import extra, refuse_degrees
from cdem.units import coordinates

Floats = NDArray[np.float64]
Bring = Callable[[str | None, Floats], Floats]  # from a label and points to points in metres
ELEVATION = re.compile(r"(elev|height|alt|contour|level|z$|h$|hoehe|quota)", re.IGNORECASE)
COLUMNS = {
    "x": re.compile(r"(x|east)", re.IGNORECASE),
    "y": re.compile(r"(y|north)", re.IGNORECASE),
    "z": ELEVATION,
}
WHAT = "terrain file"
LINE = re.compile(r"(line|id|contour_?id)", re.IGNORECASE)
OPEN = 0.05  # largest gap between the ends of a line over its length that is closed


def as_it_is(label: str | None, points: Floats) -> Floats:
    """Points of a file already in metres."""
    return points


def read_lines(path: Path, elevation: str | None = None, bring: Bring = as_it_is) -> list[Floats]:
    """Read lines of known height, each an array of points [m], shape (points, 3).

    Args:
        path: GIS file (`read_features`) of lines with a height among their properties or in
            their coordinates, or CSV (``.csv``, ``.txt``) with columns x, y, z and, for several
            lines in one file, a column with the number of the line.
        elevation: Name of the property or column of the height; None to detect it.
        bring: Transforms all points to metres.

    Raises:
        CaseError: The file is missing, of another kind, has no heights, or is in degrees.
    """
    kind = path.suffix.lower()
    label = None
    if kind in (".csv", ".txt"):
        with reading(path, CaseError, "contours are GIS files or CSV"):
            lines = list(_csv_lines(path, read_text(path, WHAT), elevation))
    elif kind in (*GEOJSON, *BY_GDAL):
        found = read_features(path)
        with reading(path, CaseError, "contours are GIS files or CSV"):
            label, lines = found.label, list(_lines(path, found, elevation))
    else:
        raise CaseError(
            f"{path}: contours are read from .geojson, .shp, .gpkg and their like, or .csv; a grid goes "
            "to 'grid'"
        )
    lines = [line for line in lines if len(line)]
    if not lines:
        raise CaseError(f"{path}: contains no lines")
    if len({float(z) for line in lines for z in line[:, 2]}) < 2:
        raise CaseError(
            f"{path}: all points have the same height {lines[0][0, 2]:g}; if the heights are in "
            "another property or column, name it with 'elevation'"
        )
    points = bring(label, np.concatenate(lines))
    refuse_degrees(path, points)
    return np.split(points, np.cumsum([len(line) for line in lines])[:-1])


def read_outline(
    path: Path,
    layer: str | None = None,
    where: dict[str, Any] | None = None,
    bring: Bring = as_it_is,
) -> tuple[Floats, list[str]]:
    """Read the outline of a body: the largest of all polygons and closed lines of a file.

    Args:
        path: GIS file, see `read_features`.
        layer: Its layer.
        where: Required values of properties.
        bring: Transforms the corners to metres.

    Returns:
        Its corners [m], shape (corners, 2), and notes on changes.

    Raises:
        CaseError: The file contains no polygon, or its outline is open.
    """
    found = read_features(path, layer, where)
    with reading(path, CaseError, "an outline is a polygon or a closed line"):
        rings, notes = _rings(path, found)
    if not rings:
        raise CaseError(f"{path}: contains no polygon")
    points = bring(found.label, np.concatenate(rings))
    rings = np.split(points, np.cumsum([len(ring) for ring in rings])[:-1])
    corners, more = _largest(path, rings)
    return corners, notes + more


def _rings(path: Path, found: Features) -> tuple[list[Floats], list[str]]:
    """Outer rings of all polygons and lines, closed."""
    rings, notes = [], []
    for geometry, _ in found.items:
        kind, parts = geometry.get("type"), geometry.get("coordinates", [])
        if kind in ("LineString", "Polygon"):
            parts = [parts]
        elif kind not in ("MultiLineString", "MultiPolygon"):
            continue
        for part in parts:
            if "Polygon" in str(kind):
                if len(part) > 1:
                    notes.append(f"{path.name}: holes in the outline are filled")
                part = part[0] if part else []
            ring = np.array([p[:2] for p in part], float)
            if ring.ndim != 2 or ring.shape[1] != 2 or not np.isfinite(ring).all():
                raise CaseError(f"{path}: its {kind} is not a list of points [x, y]")
            rings.append(_closed(path, ring, notes))
    return rings, notes


def _closed(path: Path, ring: Floats, notes: list[str]) -> Floats:
    gap = float(np.hypot(*(ring[-1] - ring[0])))
    length = float(np.hypot(*np.diff(ring, axis=0).T).sum())
    if len(ring) < 3 or gap > OPEN * length or (len(ring) == 3 and not gap):
        raise CaseError(
            f"{path}: the outline is open: it starts at ({coordinates(ring[0])}) and ends at "
            f"({coordinates(ring[-1])}); end it where it starts"
        )
    if gap:
        notes.append(f"{path.name}: an open line is closed, over {gap / length:.1%} of its length")
        return np.concatenate([ring, ring[:1]])
    return ring


def _largest(path: Path, rings: list[Floats]) -> tuple[Floats, list[str]]:
    """Corners of the largest part of all polygons together."""
    shapely = extra("shapely")
    polygons = [shapely.Polygon(ring) for ring in rings]
    notes: list[str] = []
    if len(rings) == 1 and polygons[0].is_valid:
        return rings[0][:-1], notes
    if not all(polygon.is_valid for polygon in polygons):
        notes.append(f"{path.name}: the outline crossed itself and was corrected")
    whole = shapely.union_all([shapely.make_valid(polygon) for polygon in polygons])
    parts = [part for part in shapely.get_parts(whole) if part.area > 0]
    if not parts:
        raise CaseError(f"{path}: the outline has no area")
    largest = max(parts, key=lambda part: part.area)
    if len(parts) > 1:
        lost = 1 - largest.area / sum(part.area for part in parts)
        notes.append(
            f"{path.name}: the largest of {len(parts)} parts is used; the others have {lost:.1%} "
            f"of "
            "the area"
        )
    return shapely.get_coordinates(largest.exterior)[:-1], notes


# ------------------------------------------------------------------ lines of known height


def _lines(path: Path, found: Features, elevation: str | None) -> Iterator[Floats]:
    for number, (geometry, properties) in enumerate(found.items):
        kind, points = geometry.get("type"), geometry.get("coordinates", [])
        if kind not in ("LineString", "MultiLineString"):
            continue
        for part in [points] if kind == "LineString" else points:
            try:
                line = np.array(part, float)
            except (TypeError, ValueError):
                line = np.zeros(0)
            if line.ndim != 2 or line.shape[1] not in (2, 3) or not np.isfinite(line).all():
                raise CaseError(f"{path}: feature {number} is not a list of points [x, y]")
            if line.shape[1] == 2 or elevation is not None:
                z = _property(path, number, properties, elevation)
                line = np.column_stack([line[:, :2], np.full(len(line), z)])
            yield line


def _property(path: Path, number: int, properties: dict, elevation: str | None) -> float:
    names = [elevation] if elevation else [n for n in properties if ELEVATION.match(n)]
    try:
        return float(properties[names[0]])
    except (KeyError, IndexError, TypeError, ValueError):
        has = ", ".join(properties) or "none"
        raise CaseError(
            f"{path}: feature {number} has no height; name its property with 'elevation' "
            f"(it has: {has})"
        ) from None


def _csv_lines(path: Path, text: str, elevation: str | None) -> Iterator[Floats]:
    rows = [r for r in csv.reader(text.splitlines(), skipinitialspace=True) if r and any(r)]
    if not rows:
        raise CaseError(f"{path}: is empty")
    head = [name.strip().lstrip("#").strip() for name in rows[0]]
    at = _columns(path, head, elevation)
    line_at = next((i for i, n in enumerate(head) if LINE.match(n) and i not in at.values()), None)
    labelled = []
    for number, row in enumerate(rows[1:], start=2):
        point = _point(path, number, row, at)
        if line_at is not None and line_at >= len(row):
            raise CaseError(f"{path}: row {number} has no {head[line_at]}: {','.join(row)}")
        # without a column of lines each point is on its own
        labelled.append((number if line_at is None else row[line_at], point))
    for _, line in groupby(labelled, key=itemgetter(0)):
        yield np.array([point for _, point in line])


def _columns(path: Path, head: list[str], elevation: str | None) -> dict[str, int]:
    """Columns of x, y and z; z is the elevation column, if one is named."""
    found = {}
    for key, pattern in COLUMNS.items():
        named = key == "z" and elevation
        for i, name in enumerate(head):
            if name == elevation if named else pattern.match(name):
                found[key] = i
                break
        else:
            raise CaseError(
                f"{path}: the first line must name the columns x, y and z (or elevation), e.g. "
                f"'line,x,y,z'; it has: {', '.join(head)}"
            )
    return found


def _point(path: Path, number: int, row: list[str], at: dict[str, int]) -> list[float]:
    try:
        point = [float(row[at[key]]) for key in "xyz"]
    except (ValueError, IndexError):
        point = [math.nan]
    if not all(map(math.isfinite, point)):
        raise CaseError(f"{path}: row {number} has no numbers x, y, z: {','.join(row)}")
    return point
