"""Facets that lie in one plane are parts of one joint; joints of a set have a spacing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.outcrop.facets import Facets, axes

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

ERRORS = 3.0
"""Facets are in one plane within so many standard errors of their normals."""


@dataclass(frozen=True)
class Spacing:
    """Distances of the joints of a set along its mean normal.

    Attributes:
        planes: Number of different planes.
        persistent: Mean distance of neighbours, if each plane runs through the outcrop [m]; NaN
            for a single plane.
        exposed: Mean distance to the next facet along lines parallel to the mean normal, through
            the facets as they are seen [m]; NaN if no line meets two.
        pairs: Number of distances behind `exposed`.
    """

    planes: int
    persistent: float
    exposed: float
    pairs: int


def joint_planes(facets: Facets, tolerance: float) -> Ints:
    """Number of the joint to which each facet of a set belongs, shape (facets,).

    The largest free facet begins a joint. Facets join it if their centre lies in its plane, and its
    centre in theirs, within the tolerance and the errors of both normals at that distance.

    Args:
        facets: Of one set, the largest first.
        tolerance: [m].
    """
    joint = np.full(len(facets), -1)
    number = 0
    for k in range(len(facets)):
        if joint[k] >= 0:
            continue
        free = np.flatnonzero(joint < 0)
        apart = facets.centers[free] - facets.centers[k]
        allowed = tolerance + ERRORS * (facets.tilt[free] + facets.tilt[k]) * np.linalg.norm(
            apart, axis=1
        )
        off = np.abs(apart @ facets.normals[k])
        back = np.abs((apart * facets.normals[free]).sum(axis=1))
        joint[free[(off <= allowed) & (back <= allowed)]] = number
        joint[k] = number
        number += 1
    return joint


def spacing_of(facets: Facets, joint: Ints, mean: Floats, middle: Floats) -> Spacing:
    """Spacing of the joints of a set.

    Args:
        facets: Of the set.
        joint: Number of each facet's joint.
        mean: Unit normal of the set.
        middle: Centre of the cloud [m]: positions are those where the planes meet the line through
            it along `mean`.
    """
    count = int(joint.max()) + 1 if len(joint) else 0
    at = np.empty(count)
    for k in range(count):
        here = joint == k
        weight = facets.areas[here] / facets.areas[here].sum()
        normal = weight @ (facets.normals[here] * np.sign(facets.normals[here] @ mean)[:, None])
        normal /= np.linalg.norm(normal)
        at[k] = (weight @ facets.centers[here] - middle) @ normal / (normal @ mean)
    persistent = float(np.ptp(at)) / (count - 1) if count > 1 else float("nan")
    gaps = _gaps(facets, joint, mean)
    exposed = float(np.mean(gaps)) if gaps else float("nan")
    return Spacing(count, persistent, exposed, len(gaps))


def _gaps(facets: Facets, joint: Ints, mean: Floats) -> list[float]:
    """From each facet, the distance along `mean` to the next facet of another joint above it."""
    frame = axes(mean)
    gaps = []
    for k in range(len(facets)):
        apart = facets.centers - facets.centers[k]
        beside = np.abs(apart @ frame[:2].T) <= facets.lengths / 2
        slope = facets.normals @ frame[2]
        away = (apart * facets.normals).sum(axis=1) / np.where(np.abs(slope) < 0.1, np.nan, slope)
        met = beside.all(axis=1) & (joint != joint[k]) & (away > 0)
        if met.any():
            gaps.append(float(away[met].min()))
    return gaps
