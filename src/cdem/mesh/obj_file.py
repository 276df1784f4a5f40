"""Wavefront OBJ: vertices, faces, and the names of their parts; no other file is opened."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import MeshError

NO_SHAPE = ("vt", "vn", "s", "usemtl", "mtllib")
"""Words for the looks of faces; the files that they name are not opened."""


@dataclass
class ObjFile:
    """Contents of an OBJ file.

    Attributes:
        points: Vertices, in units of the file, shape (points, 3).
        loops: Vertex numbers of each face, from 0; three or more.
        parts: Name of the object or group of each face, or empty.
        others: Number of lines of each other kind.
    """

    points: NDArray[np.float64]
    loops: list[list[int]] = field(default_factory=list)
    parts: list[str] = field(default_factory=list)
    others: Counter[str] = field(default_factory=Counter)


def read_obj(path: Path) -> ObjFile:
    """Read a file; call it inside `reading`.

    Raises:
        MeshError: A line cannot be read, a face has too few or missing vertices, or there is none.
    """
    points: list[list[float]] = []
    found, part = ObjFile(np.zeros((0, 3))), ""
    text = path.read_text(encoding="utf-8", errors="replace")
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        try:
            if words[:1] == ["v"]:
                x, y, z = map(float, words[1:4])
                points.append([x, y, z])
            elif words[:1] in (["o"], ["g"]):
                part = " ".join(words[1:])
            elif words[:1] == ["f"]:
                found.parts.append(part)
                corners = [int(word.split("/")[0]) for word in words[1:]]
                found.loops.append([c - 1 if c > 0 else len(points) + c for c in corners])
            elif words and not line.startswith("#"):
                found.others[words[0]] += 1
        except ValueError:
            raise MeshError(f"{path}:{number}: cannot be read: {line.strip()}") from None
        if words[:1] == ["f"] and not within(found.loops[-1], len(points)):
            raise MeshError(f"{path}:{number}: a face needs three or more vertices from above it")
    if not found.loops:
        raise MeshError(f"{path}: contains no faces")
    found.points = np.array(points)
    return found


def within(loop: list[int], count: int) -> bool:
    """Whether a face has three or more vertices, all of which are there."""
    return len(loop) >= 3 and min(loop) >= 0 and max(loop) < count
