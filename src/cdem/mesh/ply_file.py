"""PLY by meshio, which passes a file that is cut off without a word."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from cdem.errors import MeshError
from cdem.mesh.mesh_files import read_raw

LONGEST_HEAD = 100_000
"""Bytes in which the header ends."""


def read_ply(path: Path) -> Any:
    """Read a file as a mesh of meshio; call it inside `reading`.

    Raises:
        MeshError: It has no header, or has not as many vertices or faces as it names.
    """
    with path.open("rb") as file:
        head, end, _ = file.read(LONGEST_HEAD).partition(b"end_header")
    told = {kind: int(count) for kind, count in re.findall(rb"element\s+(\w+)\s+(\d+)", head)}
    if not head.startswith(b"ply") or not end or b"vertex" not in told:
        raise MeshError(f"{path}: has no header of a PLY file with vertices; is it complete?")
    raw = read_raw(path)
    faces = sum(len(block.data) for block in raw.cells)
    pairs = (("points", b"vertex", len(raw.points)), ("faces", b"face", faces))
    for words, kind, found in pairs:
        if found != told.get(kind, 0):
            raise MeshError(
                f"{path}: names {told.get(kind, 0):,} {words} and has {found:,}: it is cut off"
            )
    return raw
