"""Fractures as polygons: FracMan (.fab, ASCII), also written by 3DEC, PFC and FLAC3D; dfnWorks (.dat)."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import read_text
from cdem.errors import CaseError

Floats = NDArray[np.float64]

METRES = ("m", "meter", "meters", "metre", "metres")


def read_polygons(path: Path, notes: list[str]) -> list[Floats]:
    """Read the fractures of a file: their corners in order [m], each of shape (corners, 3).

    The normals in the file are ignored: some programs write a constant there.

    Args:
        path: The file.
        notes: Receives notes on unused sections.

    Raises:
        CaseError: It is binary, not in metres, tessellated, or truncated; names the place.
    """
    lines = [words.split() for words in read_text(path, "file of fractures").splitlines()]
    _check_head(path, lines)
    start = _section(lines, "FRACTURE")
    if start is None:
        raise CaseError(f"{path}: not a FracMan file: it has no line BEGIN FRACTURE")
    polygons = list(_polygons(path, lines, start))
    if not polygons:
        raise CaseError(f"{path}: contains no fractures")
    begun = [words[1] for words in lines if len(words) == 2 and words[0].upper() == "BEGIN"]
    if idle := [name for name in begun if name.upper() not in ("FORMAT", "FRACTURE")]:
        notes.append(f"{path.name}: sections not used: {', '.join(idle)}")
    return polygons


def read_braced_polygons(path: Path) -> list[Floats]:
    """Read the polygons of a dfnWorks file: a row for each, `corners {x, y, z} {x, y, z} ...` [m].

    Raises:
        CaseError: A row is not a polygon, or their number differs from the first line; names the
            place.
    """
    polygons, wanted = [], None
    for k, words in enumerate(read_text(path, "file of polygons").splitlines(), 1):
        if not words.strip() or words.lstrip().startswith(("#", "//")):
            continue
        if (head := re.fullmatch(r"\s*nPolygons:?\s*(\d+)\s*", words)) is not None:
            wanted = int(head[1])
            continue
        try:
            count = int(words.split("{")[0])
            corners = np.array(
                [[float(x) for x in row.split(",")] for row in re.findall(r"{([^}]*)}", words)]
            )
            if corners.shape != (count, 3) or count < 3 or not np.isfinite(corners).all():
                raise ValueError
        except ValueError:
            raise CaseError(
                f"{path}:{k}: a polygon is a row 'corners {{x, y, z}} {{x, y, z}} ...', three or more"
            ) from None
        polygons.append(corners)
    if not polygons or wanted not in (None, len(polygons)):
        raise CaseError(
            f"{path}: contains {len(polygons)} polygons, but its first line says {wanted}"
        )
    return polygons


def _section(lines: list[list[str]], name: str) -> int | None:
    """Number of the first line of a section, from 0."""
    for k, words in enumerate(lines):
        if [word.upper() for word in words] == ["BEGIN", name]:
            return k + 1
    return None


def _check_head(path: Path, lines: list[list[str]]) -> None:
    head = {}
    for k, words in enumerate(lines):
        name, equals, value = " ".join(words).partition("=")
        if words and words[0].upper() == "END":
            break
        if equals:
            head[name.strip().lower()] = (value.strip().lower(), k + 1)
    for key, allowed, why in (
        ("format", ("ascii",), "save it as ASCII"),
        ("length_unit", METRES, "export it in metres"),
        ("xaxis", ("east",), "export it with x to the east"),
        ("no_tessfractures", ("0",), "tessellated fractures are not read; export polygons"),
    ):
        value, number = head.get(key, (allowed[0], 0))
        if value not in allowed:
            raise CaseError(f"{path}:{number}: {key} = {value}: {why}")


def _polygons(path: Path, lines: list[list[str]], at: int) -> Iterator[Floats]:
    """Rows `id n set ...`, n rows `i x y z`, one row of the normal."""
    while at < len(lines):
        words = lines[at]
        if words and words[0].upper() == "END":
            return
        if not words:
            at += 1
            continue
        try:
            count = int(words[1])
            rows = [list(map(float, row[1:4])) for row in lines[at + 1 : at + 1 + count]]
            corners = np.array(rows)
            if corners.shape != (count, 3) or count < 3 or not np.isfinite(corners).all():
                raise ValueError
        except (ValueError, IndexError):
            raise CaseError(
                f"{path}:{at + 1}: a fracture is a row 'id corners set ...', its corners 'i x y z' "
                "(three or more), and its normal"
            ) from None
        yield corners
        at += count + 2
    raise CaseError(f"{path}: is truncated: it has no line END FRACTURE")
