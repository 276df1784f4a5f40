"""From a cloud to facets: thinning, normals, regions, rims, measures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.outcrop.facets import Facets, measure
from cdem.outcrop.growing import Rules, grow, take_rims
from cdem.outcrop.merging import merged
from cdem.outcrop.normals import normals_of
from cdem.outcrop.thinning import thin

Floats = NDArray[np.float64]

ANGLE = 12.0
"""Default of the largest angle between a point's normal and that of its facet [deg]."""
FEWEST = 50
"""Fewest points of a facet."""
FEWEST_INNER = 12
"""Fewest points of a facet without its rim."""
NOISES = 3.0
"""Largest distance of a point from its facet, as a multiple of the noise."""
LEAST_TOLERANCE = 0.5
"""Smallest such distance, as a multiple of the resolution."""


@dataclass(frozen=True)
class Extraction:
    """Facets of a cloud.

    Attributes:
        points: The thinned cloud [m], shape (points, 3).
        facets: Its facets, the largest first.
        resolution: Size of the voxels of the thinning [m].
        noise: Deviation of points from the plane of their neighbours [m].
        tolerance: Largest distance of points from the plane of their facet [m].
        angle: Largest angle between their normals [deg].
        smallest: Smallest area of a facet [m2].
        notes: Messages for the user.
    """

    points: Floats
    facets: Facets
    resolution: float
    noise: float
    tolerance: float
    angle: float
    smallest: float
    notes: list[str]


def extract(
    points: Floats,
    resolution: float | None = None,
    angle: float = ANGLE,
    smallest: float | None = None,
    tell: Callable[[str, float], None] | None = None,
) -> Extraction:
    """Find the facets of a cloud.

    Args:
        points: The cloud about its centre [m], shape (points, 3).
        resolution: See `cdem.outcrop.thinning.thin`.
        angle: Largest angle between the normal of a point and that of its facet [deg].
        smallest: Smallest area of a facet [m2]; by default that of 50 points.
        tell: Called with words and the part done.

    Raises:
        CaseError: The cloud has too few points, or no facets.
        BackendError: SciPy is not installed.
    """
    tell = tell or (lambda words, part: None)
    tell("thinning", 0.0)
    thinned = thin(points, resolution)
    x, size = thinned.points, thinned.resolution
    tell("normals", 0.2)
    found = normals_of(x)
    tolerance = max(NOISES * found.noise, LEAST_TOLERANCE * size)
    rules = Rules(angle, tolerance, FEWEST_INNER)
    tell("facets", 0.5)
    core, planes = grow(x, found, rules)
    if not planes:
        raise CaseError(
            f"no flat part of {FEWEST} points at a resolution of {size:.3g} m; give a smaller "
            "--resolution or a larger --angle"
        )
    tell("areas", 0.8)
    label = take_rims(x, found, core, planes, tolerance)
    new = merged(found, label, planes, rules)
    facets = measure(x, *(np.where(kind >= 0, new[kind], -1) for kind in (core, label)))
    least = FEWEST * size**2 if smallest is None else smallest
    counts = np.array([len(members) for members in facets.members])
    large = np.flatnonzero((facets.areas >= least) & (counts >= FEWEST))
    if not len(large):
        raise CaseError(
            f"no facet has {least:.3g} m2 and {FEWEST} points; the largest has "
            f"{facets.areas[0]:.3g} m2 and {counts[0]}: give a smaller --smallest or --resolution"
        )
    return Extraction(
        x, facets.some(large), size, found.noise, tolerance, angle, least, thinned.notes
    )
