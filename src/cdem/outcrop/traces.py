"""Lengths of joints on an outcrop, whose ends may lie beyond it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.outcrop.facets import Facets
from cdem.outcrop.normals import scipy_spatial

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

STRIP = 1.5
"""Width of the strip at the end of a facet, as a multiple of the resolution."""
BEYOND = 4.0
"""How far the cloud must go on beyond an end that is seen, as a multiple of the resolution."""
BOX = np.array([BEYOND + STRIP / 2, BEYOND])
SIDES = 2.5
"""Width of the rim of a facet, which may belong to other faces, as a multiple of the resolution."""
LEAST_BEYOND = 3
"""Points of the cloud beyond an end that is seen."""


@dataclass(frozen=True)
class Length:
    """Mean length of the traces of a set.

    Attributes:
        mean: Twice the length of all traces over the number of ends seen [m]; infinite without any.
        naive: Mean of the lengths as they are seen [m].
        traces: Number of traces.
        seen: Number of their ends, of two each, that are seen.
    """

    mean: float
    naive: float
    traces: int
    seen: int


def mean_length(lengths: Floats, seen: Bools) -> Length:
    """Mean length of traces in a window, by their ends.

    In a window of area A with N traces per area of mean length m lie traces of the length N m A,
    and 2 N A ends: so m is twice the length over the ends, for any distribution of lengths (the
    end points of Mauldon 1998). With exponential lengths it is the most likely mean.

    Args:
        lengths: Lengths in the window [m], shape (traces,).
        seen: Whether the first and the second end lies in the window, shape (traces, 2).

    Example:
        >>> mean_length(np.array([3.0, 1.0]), np.array([[True, False], [True, True]])).mean
        2.6666666666666665
    """
    ends, total = int(seen.sum()), float(lengths.sum())
    return Length(
        2 * total / ends if ends else float("inf"),
        total / max(len(lengths), 1),
        len(lengths),
        ends,
    )


def ends_seen(points: Floats, facets: Facets, resolution: float) -> Bools:
    """Whether the cloud goes on beyond both ends of the length of facets.

    An end is seen if, beside the strip of the outermost points of the facet, other points of the
    cloud lie farther along, or stand on the middle of that strip: a step. Else the facet
    ends where the cloud ends, or at a shadow.

    Args:
        points: The cloud [m], shape (points, 3).
        facets: Its facets.
        resolution: Distance of neighbours [m].

    Returns:
        Shape (facets, 2): at the end against the first vector of its frame, at the end along it.
    """
    tree = scipy_spatial().cKDTree(points)
    out = np.zeros((len(facets), 2), bool)
    for k, members in enumerate(facets.members):
        frame = facets.frames[k]
        flat = (points[members] - facets.centers[k]) @ frame.T
        for side, sign in enumerate((-1.0, 1.0)):
            turned = frame * [[sign], [sign], [1]]
            strip = flat[flat[:, 0] * sign >= (flat[:, 0] * sign).max() - STRIP * resolution]
            strip = strip * [sign, sign, 1]
            middle = (strip.max(axis=0) + strip.min(axis=0)) / 2
            half = np.ptp(strip[:, 1]) / 2 + SIDES * resolution
            reach = float(np.linalg.norm([half, *BOX * resolution]))
            place = facets.centers[k] + middle @ turned
            beside = np.setdiff1d(tree.query_ball_point(place, reach), members)
            away = (points[beside] - facets.centers[k]) @ turned.T
            out[k, side] = _goes_on(away, strip, resolution)
    return out


def _goes_on(away: Floats, strip: Floats, resolution: float) -> bool:
    """Whether some points lie beyond a strip of points or stand on its middle; along the first axis."""
    end = strip[:, 0].max()
    low, high = strip[:, 1].min(), strip[:, 1].max()
    u, v, w = away.T
    close = np.abs(w) <= BEYOND * resolution
    ahead = close & (u > end + resolution / 2) & (u <= end + BEYOND * resolution)
    ahead &= (v >= low - SIDES * resolution) & (v <= high + SIDES * resolution)
    step = close & (np.abs(u - end) <= resolution)
    step &= (v >= low + SIDES * resolution) & (v <= high - SIDES * resolution)
    return bool(ahead.sum() >= LEAST_BEYOND or step.sum() >= LEAST_BEYOND)
