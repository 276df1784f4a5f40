"""Triangles of an STL file, text or binary.

meshio takes any four lines of numbers of a damaged text file for a triangle.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cdem.errors import CaseError
from cdem.terrain.facets import Facets

HEAD, FACET = 84, 50
"""Bytes before the triangles of a binary file, and of each of them."""
SINGLE = 2.0**-24
"""Relative rounding of its numbers, of seven digits."""
VISIBLE = 1e-3
"""Rounding from which a note tells of it [m]."""


def read_stl(path: Path) -> Facets:
    """Read a file; call it inside `reading`.

    Raises:
        CaseError: It is neither complete nor sound.
    """
    raw = path.read_bytes()
    count = int.from_bytes(raw[HEAD - 4 : HEAD], "little")
    if len(raw) == HEAD + FACET * count and count:
        facets = np.frombuffer(raw, np.uint8, offset=HEAD).reshape(count, FACET)
        points = facets[:, 12:48].copy().view("<f4").astype(float).reshape(-1, 3)
    elif raw.lstrip()[:5].lower() == b"solid" and b"\0" not in raw:
        points = _of_text(path, raw.decode("utf-8", errors="replace"))
    else:
        raise CaseError(
            f"{path}: is no complete STL: text begins with 'solid', and {count} triangles of a binary "
            f"file take {HEAD + FACET * count} bytes, but it has {len(raw)}"
        )
    found = Facets(points, np.arange(len(points)).reshape(-1, 3))
    largest = float(np.abs(points).max(initial=0.0))
    found.rounding = SINGLE * largest
    if found.rounding > VISIBLE:
        found.notes.append(
            f"{path.name}: STL keeps seven digits, so coordinates of {largest:.3g} are right to "
            f"{found.rounding:.2g} only; export another format, or subtract an offset"
        )
    return found


def _of_text(path: Path, text: str) -> np.ndarray:
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
                raise CaseError(f"{path}:{number}: cannot be read: {line.strip()[:80]}") from None
            corners.append([x, y, z])
        elif kind == "endfacet":
            facets += 1
            if len(corners) != 3 * facets:
                raise CaseError(f"{path}:{number}: a facet has three vertices")
    if len(corners) != 3 * facets:
        raise CaseError(f"{path}: ends within a facet; is it complete?")
    return np.array(corners, float).reshape(-1, 3)
