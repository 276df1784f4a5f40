"""Triangulated surfaces from files: OBJ, STL, PLY, GOCAD TSurf, DXF."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass
class Facets:
    """Triangles of a file.

    Attributes:
        points: Corners in units of the file, z up, shape (points, 3).
        triangles: Numbers of their corners, shape (triangles, 3).
        notes: Messages for the user.
        others: Number of items of each kind that is not used.
        unit: Unit of the heights named in the file, or empty.
        rounding: Largest error of a coordinate from the format.
    """

    points: Floats
    triangles: Ints
    notes: list[str] = field(default_factory=list)
    others: Counter[str] = field(default_factory=Counter)
    unit: str = ""
    rounding: float = 0.0


def fanned(loops: list[list[int]]) -> Ints:
    """Triangles of polygons, each fanned from its first corner."""
    if all(len(loop) == 3 for loop in loops):
        return np.array(loops, np.int64).reshape(-1, 3)
    fans = [(loop[0], loop[k], loop[k + 1]) for loop in loops for k in range(1, len(loop) - 1)]
    return np.array(fans, np.int64).reshape(-1, 3)
