"""Normals of a point cloud by principal components of neighbours, and the noise beside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.terrain.heights import extra

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

NEIGHBOURS = 24
"""Points of a neighbourhood, with the point itself."""
CHUNK = 50_000
"""Points at a time: bounds the memory."""


@dataclass(frozen=True)
class Normals:
    """What the neighbours of each point say.

    Attributes:
        normals: Unit normals, of either sign, shape (points, 3).
        deviation: Of the neighbours from their plane [m], shape (points,).
        neighbours: Numbers of the nearest points, the point itself first, shape (points, 24).
        noise: Median of the smaller half of the deviations [m]: that of flat parts.
    """

    normals: Floats
    deviation: Floats
    neighbours: Ints
    noise: float


def scipy_spatial() -> Any:
    """SciPy's spatial searches.

    Raises:
        BackendError: SciPy is not installed.
    """
    return extra("scipy.spatial", "a point cloud of an outcrop")


def normals_of(points: Floats, every: int = 1) -> Normals:
    """Normals by principal components (Hoppe et al. 1992).

    Args:
        points: [m], shape (points, 3), more than 24.
        every: Only every so-many-th point gets a normal.
    """
    tree = scipy_spatial().cKDTree(points)
    places = points[::every]
    count = min(NEIGHBOURS, len(points))
    normals, deviation = np.empty((len(places), 3)), np.empty(len(places))
    neighbours = np.empty((len(places), count), np.int32)
    for start in range(0, len(places), CHUNK):
        part = slice(start, start + CHUNK)
        near = tree.query(places[part], count, workers=-1)[1]
        neighbours[part] = near
        away = points[near]
        away -= away.mean(axis=1, keepdims=True)
        values, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", away, away) / (count - 3))
        normals[part] = vectors[:, :, 0]
        deviation[part] = np.sqrt(np.maximum(values[:, 0], 0))
    noise = float(np.percentile(deviation, 25))
    return Normals(normals, deviation, neighbours, noise)
