"""Point clouds thinned to one point a voxel, with a size of voxels that suits cloud and noise."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.outcrop.normals import normals_of, scipy_spatial

Floats = NDArray[np.float64]

MOST_POINTS = 1_000_000
"""Most points that are kept."""
PER_NEIGHBOUR = 2.0
"""Voxel size, as a multiple of the median distance to the nearest neighbour: the mean spacing of
points drawn at random."""
PER_NOISE = 2.5
"""Smallest voxel size, as a multiple of the noise: the normals of 24 neighbours keep 4 deg."""
COARSER = 1.25
"""Factor of a step to larger voxels."""
SAMPLE = 20_000
"""Most points whose distances and noise are looked at."""
COPIES = 16
"""Most points at one place that do not hide its neighbours."""
LEAST_POINTS = 100


@dataclass(frozen=True)
class Thinned:
    """A cloud with one point a voxel.

    Attributes:
        points: Means of the points of each voxel [m], shape (points, 3).
        resolution: Size of the voxels [m].
        notes: Messages for the user.
    """

    points: Floats
    resolution: float
    notes: list[str]


def thin(points: Floats, resolution: float | None = None) -> Thinned:
    """Thin a cloud to one point a voxel.

    Args:
        points: The cloud about its centre [m], shape (points, 3).
        resolution: Size of the voxels [m]; by default twice the median distance to the nearest
            neighbour, more if the noise or a million points ask for it.

    Raises:
        CaseError: It has too few points, also after thinning.
        BackendError: SciPy is not installed.
    """
    if len(points) < LEAST_POINTS:
        raise CaseError(f"{len(points)} points are no outcrop; it needs {LEAST_POINTS} at least")
    told = resolution is not None
    size = resolution if resolution is not None else _mean_spacing(points)
    kept, why = voxels(points, size), ""
    while not told and _too_noisy(kept, size):
        size *= COARSER
        kept, why = voxels(points, size), ", because of the noise"
    while len(kept) > MOST_POINTS:
        size *= max(1.02, float(np.sqrt(len(kept) / MOST_POINTS)))
        kept, why = voxels(points, size), f", for at most {MOST_POINTS:,} points"
    if len(kept) < LEAST_POINTS:
        raise CaseError(
            f"{len(kept)} points are left at a resolution of {size:.4g} m; give a smaller one"
        )
    note = f"{len(points):,} points thinned to {len(kept):,}, one in each {size:.3g} m{why}"
    return Thinned(kept, size, [note])


def voxels(points: Floats, size: float) -> Floats:
    """Means of the points in each voxel of a size [m]; a point at a place counts once."""
    cell = np.floor((points - points.min(axis=0)) / size).astype(np.int64)
    shape = cell.max(axis=0) + 1
    if float(np.prod(shape.astype(float))) > 2.0**62:
        raise CaseError(f"a resolution of {size:.4g} m is too small for a cloud of this extent")
    number = (cell[:, 0] * shape[1] + cell[:, 1]) * shape[2] + cell[:, 2]
    _, at, count = np.unique(number, return_inverse=True, return_counts=True)
    at = at.ravel()
    return np.column_stack([np.bincount(at, x) / count for x in points.T])


def _mean_spacing(points: Floats) -> float:
    """Distance of neighbours in a cloud without its duplicates [m]."""
    tree = scipy_spatial().cKDTree(points)
    some = points[:: max(1, len(points) // SAMPLE)]
    away = tree.query(some, min(COPIES, len(points)), workers=-1)[0]
    nearest = np.where(away > 0, away, np.inf).min(
        axis=1
    )  # a copy at the same place does not count
    if not np.isfinite(median := float(np.median(nearest))):
        raise CaseError("most points of the cloud lie at one place; give --resolution")
    return PER_NEIGHBOUR * median


def _too_noisy(points: Floats, size: float) -> bool:
    """Whether the noise of some points is large for the voxels."""
    if len(points) <= LEAST_POINTS:
        return False
    return normals_of(points, every=max(1, len(points) // SAMPLE)).noise * PER_NOISE > size
