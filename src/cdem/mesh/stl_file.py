"""Triangles of an STL file, text or binary.

meshio takes any four lines of numbers of a damaged text file for a triangle.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cdem.errors import MeshError

HEAD, FACET = 84, 50
"""Bytes before the triangles of a binary file, and of each of them."""
SINGLE = 2.0**-24
"""Relative rounding of its numbers, of seven digits."""

Floats = NDArray[np.float64]


def read_stl(path: Path) -> tuple[Floats, float]:
    """Read a file; call it inside `reading`.

    Returns:
        Corners of the triangles in the order of the file, shape (3 triangles, 3), in units of the
        file; and their largest rounding.

    Raises:
        MeshError: It is neither complete nor sound.
    """
    raw = path.read_bytes()
    count = int.from_bytes(raw[HEAD - 4 : HEAD], "little")
    if len(raw) == HEAD + FACET * count and count:
        facets = np.frombuffer(raw, np.uint8, offset=HEAD).reshape(count, FACET)
        points = facets[:, 12:48].copy().view("<f4").astype(float).reshape(-1, 3)
    elif raw.lstrip()[:5].lower() == b"solid" and b"\0" not in raw:
        points = _of_text(path, raw.decode("utf-8", errors="replace"))
    else:
        raise MeshError(
            f"{path}: is no complete STL: text begins with 'solid', and {count} triangles of a binary "
            f"file take {HEAD + FACET * count} bytes, but it has {len(raw)}"
        )
    return points, SINGLE * float(np.abs(points).max(initial=0.0))


def _of_text(path: Path, text: str) -> Floats:
    """Corners in the order of the file, shape (3 triangles, 3)."""
    corners: list[list[float]] = []
    facets = 0
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        kind = words[0].lower() if words else ""
        if kind == "vertex":
            try:
                x, y, z = map(float, words[1:])
            except ValueError:
                raise MeshError(f"{path}:{number}: cannot be read: {line.strip()[:80]}") from None
            corners.append([x, y, z])
        elif kind == "endfacet":
            facets += 1
            if len(corners) != 3 * facets:
                raise MeshError(f"{path}:{number}: a facet has three vertices")
    if len(corners) != 3 * facets:
        raise MeshError(f"{path}: ends within a facet; is it complete?")
    return np.array(corners, float).reshape(-1, 3)
