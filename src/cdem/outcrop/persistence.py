"""The share of their planes on which joints are seen: a rough measure of persistence."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.outcrop.facets import Facets, axes
from cdem.outcrop.normals import scipy_spatial

Floats = NDArray[np.float64]

MOST_POINTS = 100_000
"""Most points of the cloud that are looked at; of more, evenly chosen ones."""


def areal_persistence(
    points: Floats, facets: Facets, joint: NDArray[np.int64], spacing: float
) -> float:
    """Area of the facets of a set over the area in which they could be seen.

    A joint could be seen on the part of the cloud that lies within half a spacing of its plane: the
    area of the convex hull of these points, in the plane. At most 1.

    Args:
        points: The cloud [m], shape (points, 3).
        facets: Of the set.
        joint: Number of each facet's joint.
        spacing: Of the set [m]; NaN for a single joint, which has the persistence NaN.
    """
    if not np.isfinite(spacing):
        return float("nan")
    spatial = scipy_spatial()
    some = points[:: max(1, len(points) // MOST_POINTS)]
    window = 0.0
    for k in range(int(joint.max()) + 1):
        first = int((joint == k).argmax())  # the largest
        flat = (some - facets.centers[first]) @ axes(facets.normals[first]).T
        near = flat[np.abs(flat[:, 2]) <= spacing / 2][:, :2]
        if len(near) > 3 and np.linalg.matrix_rank(near - near[0]) == 2:
            window += float(spatial.ConvexHull(near).volume)  # of a plane figure: its area
    return min(1.0, float(facets.areas.sum()) / window) if window else float("nan")
