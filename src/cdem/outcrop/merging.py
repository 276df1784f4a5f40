"""Regions that touch and lie in one plane become one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.arrays import components
from cdem.outcrop.growing import GROWTH_NEIGHBOURS, Ints, Plane, Rules
from cdem.outcrop.normals import Normals

Floats = NDArray[np.float64]


def merge(
    points: Floats, found: Normals, label: Ints, planes: list[Plane], rules: Rules
) -> tuple[Ints, list[Plane]]:
    """Merge regions that touch, whose normals differ by less than half the angle of the rules, and
    whose centres lie in each other's plane.

    Args:
        points: [m], shape (points, 3).
        found: Their neighbours.
        label: Number of each point's region, -1 for none.
        planes: The planes of the regions.
        rules: Angle and tolerance.

    Returns:
        The new numbers and planes.
    """
    if len(planes) < 2:
        return label, planes
    normals = np.array([plane.normal for plane in planes])
    centers = np.array([plane.center for plane in planes])
    beside = label[found.neighbours[:, 1:GROWTH_NEIGHBOURS]]
    own = np.repeat(label, beside.shape[1])
    other = beside.ravel()
    touching = np.unique(
        np.column_stack([own, other])[(own >= 0) & (other > own)].reshape(-1, 2), axis=0
    )
    a, b = touching.T
    apart = centers[b] - centers[a]
    one = np.abs((normals[a] * normals[b]).sum(axis=1)) >= np.cos(np.radians(rules.angle / 2))
    for side in (a, b):
        one &= np.abs((apart * normals[side]).sum(axis=1)) <= rules.tolerance
    kept, new = np.unique(components(len(planes), a[one], b[one]), return_inverse=True)
    if len(kept) == len(planes):
        return label, planes
    merged = np.where(label >= 0, new.ravel()[label], -1).astype(np.int32)
    out = []
    for k, first in enumerate(kept):
        plane = Plane(normals[first], centers[first])
        plane.add(points[merged == k])
        plane.fit()
        out.append(plane)
    return merged, out

