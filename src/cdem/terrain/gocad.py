"""Triangulated surfaces of GOCAD (TSurf, ``.ts``), as geological modellers export them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from cdem.errors import CaseError
from cdem.terrain.facets import Facets
from cdem.terrain.resample import OTHER_NAMES, UNITS

VERTICES = ("VRTX", "PVRTX")
ATOMS = ("ATOM", "PATOM")
DATA = ("PROPERTIES", "PROPERTY_CLASSES", "PROPERTY_CLASS_HEADER", "ESIZES", "UNITS",
        "NO_DATA_VALUES", "PROP_LEGAL_RANGES", "PROPERTY_KINDS", "PROPERTY_SUBCLASSES")  # fmt: skip
"""Words about properties of vertices."""
KNOWN = ("GOCAD", "HEADER", "NAME", "AXIS_NAME", "TFACE", "BSTONE", "BORDER", "END",
         "GOCAD_ORIGINAL_COORDINATE_SYSTEM", "END_ORIGINAL_COORDINATE_SYSTEM",
         "GEOLOGICAL_FEATURE", "GEOLOGICAL_TYPE", "STRATIGRAPHIC_POSITION")  # fmt: skip
"""Words without effect on the shape."""
SIGNS = {"elevation": 1.0, "depth": -1.0}
"""Sign of a height, by ZPOSITIVE."""
CLAIMS = ("PROJECTION", "DATUM")
"""Words that name a map projection, in no list that other programs know."""


@dataclass
class _Object:
    """One surface of a file, while it is read."""

    number: dict[str, int] = field(default_factory=dict)
    units: list[str] = field(default_factory=lambda: ["", "", ""])
    sign: float = 1.0
    first: int = 0


@dataclass
class _File:
    points: list[list[float]] = field(default_factory=list)
    triangles: list[list[int]] = field(default_factory=list)
    objects: list[_Object] = field(default_factory=list)
    others: Counter[str] = field(default_factory=Counter)
    claims: list[str] = field(default_factory=list)
    data: bool = False


def read_gocad(path: Path) -> Facets:
    """Read all surfaces of a file as one; call it inside `reading`.

    Coordinates are brought to elevations above zero: ``ZPOSITIVE Depth`` turns the sign of z. x and y
    are brought to metres by their ``AXIS_UNIT``.

    Raises:
        CaseError: It is another kind of GOCAD object, a line cannot be read, a triangle names a missing
            vertex, a unit is no length, or the surfaces differ in the unit of z.
    """
    text = path.read_text(encoding="utf-8", errors="replace")
    lines = text.splitlines()
    if not lines or not lines[0].lstrip("\ufeff").startswith("GOCAD"):
        raise CaseError(f"{path}: is no GOCAD file: its first line is not 'GOCAD TSurf 1'")
    file = _File()
    block = False  # in braces, or in the header of a property
    for number, line in enumerate(lines, start=1):
        words = line.lstrip("\ufeff").split()
        if not words:
            continue
        if block or words[-1].endswith("{"):
            block = words[0] != "}"
            file.data |= words[0] == "PROPERTY_CLASS_HEADER"
            continue
        try:
            _take(path, file, words)
        except (ValueError, IndexError):
            raise CaseError(f"{path}:{number}: cannot be read: {line.strip()[:80]}") from None
        except KeyError as missing:
            raise CaseError(
                f"{path}:{number}: names vertex {missing.args[0]}, which is not above it"
            ) from None
    return _finished(path, file)


def _take(path: Path, file: _File, words: list[str]) -> None:
    """Take a line: a new surface, a vertex or a triangle."""
    word = words[0]
    if word == "GOCAD":
        if words[1].lower() != "tsurf":
            raise CaseError(
                f"{path}: is a GOCAD {words[1]}; a surface of triangles is a TSurf: export that"
            )
        file.objects.append(_Object(first=len(file.points)))
        return
    here = file.objects[-1]
    if word in VERTICES:
        here.number[words[1]] = len(file.points)
        x, y, z = map(float, words[2:5])
        file.points.append([x, y, z])
    elif word in ATOMS:
        here.number[words[1]] = here.number[words[2]]
    elif word == "TRGL":
        a, b, c = words[1:4]
        file.triangles.append([here.number[a], here.number[b], here.number[c]])
    else:
        _take_other(file, here, words)


def _take_other(file: _File, here: _Object, words: list[str]) -> None:
    """Take a line on the axes, or one without effect."""
    word = words[0]
    if word == "ZPOSITIVE":
        if words[1].lower() not in SIGNS:
            raise ValueError(words[1])
        here.sign = SIGNS[words[1].lower()]
    elif word == "AXIS_UNIT":
        a, b, c = (name.strip("\"'") for name in words[1:4])
        here.units = [a, b, c]
    elif word in CLAIMS:
        if words[1:] and words[1].lower() not in ("unknown", "none"):
            file.claims.append(" ".join(words))
    elif word in DATA:
        file.data = True
    elif word not in KNOWN and not word.startswith("#"):
        file.others[word] += 1


def _finished(path: Path, file: _File) -> Facets:
    points = np.array(file.points, float).reshape(-1, 3)
    notes: list[str] = []
    ends = [one.first for one in file.objects[1:]] + [len(points)]
    heights = {OTHER_NAMES.get(one.units[2].lower(), one.units[2].lower()) for one in file.objects}
    if len(heights) > 1:
        raise CaseError(f"{path}: its surfaces have different units of z: {sorted(heights)}")
    for one, end in zip(file.objects, ends, strict=True):
        factor = [_metres(path, name) for name in one.units]
        points[one.first : end] *= [factor[0], factor[1], one.sign]
        if factor[:2] != [1.0, 1.0]:
            notes.append(
                f"{path.name}: its x and y are in {one.units[0]} and {one.units[1]}, and are "
                f"multiplied by {factor[0]:.10g} and {factor[1]:.10g}"
            )
        if one.sign < 0:
            notes.append(f"{path.name}: its z is a depth (ZPOSITIVE Depth); heights are -z")
    if len(file.objects) > 1:
        notes.append(f"{path.name}: its {len(file.objects)} surfaces are taken as one")
    if file.data:
        notes.append(f"{path.name}: properties of its vertices are not used")
    notes += [
        f"{path.name}: '{claim}' is not used; give crs beside the file" for claim in file.claims
    ]
    triangles = np.array(file.triangles, np.int64).reshape(-1, 3)
    return Facets(points, triangles, notes, file.others, heights.pop())


def _metres(path: Path, name: str) -> float:
    """Metres per unit of an axis."""
    named = OTHER_NAMES.get(name.lower(), name.lower())
    if named in ("", "none", "unknown", "unitless"):
        return 1.0
    if named == "km":
        return 1000.0
    if named not in UNITS:
        raise CaseError(
            f"{path}: an axis is in '{name}', which is no length known here: {', '.join(UNITS)}, km"
        )
    return UNITS[named]
