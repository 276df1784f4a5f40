"""Regions that touch and lie in one plane become one."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.arrays import components
from cdem.outcrop.growing import GROWTH_NEIGHBOURS, Ints, Plane, Rules
from cdem.outcrop.normals import Normals


def merged(found: Normals, label: Ints, planes: list[Plane], rules: Rules) -> NDArray[np.int64]:
    """New numbers of regions: of those that touch, whose normals differ by less than half the angle
    of the rules, and whose points deviate from one plane by half the tolerance at most.

    Args:
        found: Neighbours of the points.
        label: Number of each point's region, -1 for none.
        planes: The planes of the regions.
        rules: Angle and tolerance.

    Returns:
        The new number of each region, shape (regions,).
    """
    beside = label[found.neighbours[:, 1:GROWTH_NEIGHBOURS]]
    own, other = np.repeat(label, beside.shape[1]), beside.ravel()
    pairs = np.unique(np.column_stack([own, other])[(own >= 0) & (other > own)], axis=0)
    cosine = np.cos(np.radians(rules.angle / 2))
    one = [
        (a, b)
        for a, b in pairs.tolist()
        if abs(planes[a].normal @ planes[b].normal) >= cosine
        and planes[a].deviation_with(planes[b]) <= rules.tolerance / 2
    ]
    joined = np.array(one, np.int64).reshape(-1, 2)
    first = components(len(planes), joined[:, 0], joined[:, 1])
    return np.unique(first, return_inverse=True)[1].ravel()
