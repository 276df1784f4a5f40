"""Facets of an outcrop: centre, plane, area and extents of the points of a flat region."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cdem.joints.directions import dips, line
from cdem.outcrop.normals import scipy_spatial

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

LONGEST_EDGE = 3.5
"""Longest edge of the triangles that cover a facet, as a multiple of the mean spacing of its
points: larger gaps are holes."""
RIM = 0.4
"""Strip between the outermost points of a facet and its edge, as a multiple of that spacing."""
LEVEL = float(np.cos(np.radians(10)))
"""Upward part of the normal above which a facet has no clear strike."""
OUTLIER = 3.0
"""Points farther from the plane than this multiple of their deviation do not count in its fit."""


@dataclass(frozen=True)
class Facets:
    """Facets, as rows.

    Attributes:
        centers: Means of their points [m], shape (facets, 3).
        frames: Unit vectors along the length and the width, and the upward normal, as rows; shape
            (facets, 3, 3). Length is along strike, width along dip; of facets that dip less than
            10 deg, which have no clear strike, length is the longest direction.
        areas: [m2], shape (facets,).
        lengths: Length and width [m], shape (facets, 2).
        rms: Deviation of the points from the plane [m], shape (facets,).
        tilt: Standard error of the normal [rad], shape (facets,).
        members: Numbers of the points of each.
    """

    centers: Floats
    frames: Floats
    areas: Floats
    lengths: Floats
    rms: Floats
    tilt: Floats
    members: list[Indices]

    def __len__(self) -> int:
        return len(self.areas)

    @property
    def normals(self) -> Floats:
        """Upward unit normals, shape (facets, 3)."""
        return self.frames[:, 2]

    def some(self, chosen: Indices) -> Facets:
        """Some of the facets, by their numbers."""
        return Facets(
            self.centers[chosen],
            self.frames[chosen],
            self.areas[chosen],
            self.lengths[chosen],
            self.rms[chosen],
            self.tilt[chosen],
            [self.members[k] for k in chosen.tolist()],
        )


def axes(normal: Floats) -> Floats:
    """Unit vectors along strike, up the dip and along the normal, as rows; right-handed.

    Strike is 90 deg left of the dip direction; of a level plane it points north.
    """
    strike = line(np.asarray(dips(normal)[1]) - 90, np.asarray(0.0))
    up = normal if normal[2] >= 0 else -normal
    return np.array([strike, np.cross(up, strike), up])


def measure(points: Floats, core: NDArray[np.int32], label: NDArray[np.int32]) -> Facets:
    """Measure the flat regions of a cloud.

    Args:
        points: [m], shape (points, 3).
        core: Number of the region of each point that counts in the fit of planes, -1 for none.
        label: Number of each point's region, with its rim, -1 for none.

    Returns:
        The facets, the largest first.
    """
    order = np.argsort(label, kind="stable")
    starts = np.searchsorted(label[order], np.arange(label.max() + 2))
    members = [order[a:b] for a, b in pairwise(starts.tolist())]
    rows = [_fit(points[m[core[m] >= 0]]) for m in members]
    sizes = [_extent(points[m], row[1]) for m, row in zip(members, rows, strict=True)]
    facets = Facets(
        np.array([row[0] for row in rows]).reshape(-1, 3),
        np.array([size[2] for size in sizes]).reshape(-1, 3, 3),
        np.array([size[0] for size in sizes]),
        np.array([size[1] for size in sizes]).reshape(-1, 2),
        np.array([row[2] for row in rows]),
        np.array([row[3] for row in rows]),
        members,
    )
    return facets.some(np.argsort(-facets.areas, kind="stable"))


def _fit(x: Floats) -> tuple[Floats, Floats, float, float]:
    """Centre, upward unit normal, deviation and its error of the plane through points.

    Least squares, twice more without the points beyond three deviations.
    """
    kept = x
    for _ in range(3):
        center = kept.mean(axis=0)
        values, vectors = np.linalg.eigh(np.cov((kept - center).T))
        away = (x - center) @ vectors[:, 0]
        rms = float(np.sqrt(max(values[0], 0.0)))
        kept = x[np.abs(away) <= max(OUTLIER * rms, 1e-12)]
        if len(kept) < 4:
            break
    normal = vectors[:, 0] * (1.0 if vectors[2, 0] >= 0 else -1.0)
    tilt = rms / float(np.sqrt(len(x) * max(values[1], 1e-300)))
    return center, normal, rms, tilt


def _extent(x: Floats, normal: Floats) -> tuple[float, Floats, Floats]:
    """Area [m2], length and width [m], and frame of points near a plane; see `Facets`."""
    frame = axes(normal)
    flat = (x - x.mean(axis=0)) @ frame[:2].T
    if normal[2] > LEVEL:
        longest = np.linalg.eigh(flat.T @ flat)[1][:, 1]
        turn = np.array([longest, [-longest[1], longest[0]]])
        flat, frame = flat @ turn.T, np.concatenate([turn @ frame[:2], frame[2:]])
    return area_of(flat), np.ptp(flat, axis=0), frame


def area_of(flat: Floats) -> float:
    """Area of a patch of a plane, by points drawn on it [m2].

    Delaunay triangles without long edges (an alpha shape), and the strip between the outermost
    points and the edge of the patch, which is 0.4 spacings of the points wide.

    Args:
        flat: Points in the plane [m], shape (points, 2).
    """
    spatial = scipy_spatial()
    try:
        corners = spatial.Delaunay(flat).simplices
    except (spatial.QhullError, ValueError):
        return 0.0  # on one line
    a, b, c = (flat[corners[:, k]] for k in range(3))
    doubled = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    edges = np.stack([b - a, c - b, a - c], axis=1)
    length = np.sqrt((edges**2).sum(axis=2))
    # the densest half of the triangles gives the spacing, also of a patch with large holes
    spacing = float(np.sqrt(np.median(doubled)))
    kept = length.max(axis=1) <= LONGEST_EDGE * spacing
    if not kept.any():
        return float(doubled.sum() / 2)
    pairs = np.sort(corners[kept][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, first, count = np.unique(pairs, axis=0, return_index=True, return_counts=True)
    rim = float(length[kept].reshape(-1)[first[count == 1]].sum())
    area = float(doubled[kept].sum() / 2)
    return area + RIM * spacing * rim
