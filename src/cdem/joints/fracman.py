"""Fractures of FracMan files (.fab, ASCII), which 3DEC, PFC and FLAC3D write too."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.case.input_file import read_text
from cdem.errors import CaseError

Floats = NDArray[np.float64]

METRES = ("m", "meter", "meters", "metre", "metres")


def read_polygons(path: Path) -> list[Floats]:
    """Read the fractures of a file: their corners in turn [m], each of shape (corners, 3).

    The normals in the file are not read: some writers put a constant there.

    Raises:
        CaseError: It is binary, not in metres, tessellated, or broken off; says where.
    """
    lines = [words.split() for words in read_text(path, "file of fractures").splitlines()]
    _check_head(path, lines)
    start = _section(lines, "FRACTURE")
    if start is None:
        raise CaseError(f"{path}: not a FracMan file: it has no line BEGIN FRACTURE")
    polygons = list(_polygons(path, lines, start))
    if not polygons:
        raise CaseError(f"{path}: holds no fractures")
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
    raise CaseError(f"{path}: breaks off: it has no line END FRACTURE")
