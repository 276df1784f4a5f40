"""Sloping local base level: the surface of constant curvature below the ground in an outline.

Jaboyedoff et al. (2004, 2020) repeatedly lower a grid of heights to the mean of its neighbours
less a constant. In the limit this is an obstacle problem: the Laplacian of the surface is k where
the surface is free, and it touches the ground at the outline and wherever it would rise above the
ground. Here it is solved on the triangles of the plan, whose edge is the outline.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.terrain.heights import extra
from cdem.terrain.landslide import Landslide
from cdem.terrain.schema import SlblBy

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
PASSES = 100
NEAR = 1e-9  # tolerance of equal heights [m]
VOLUME_ERROR = 0.01  # relative tolerance of the volume
TOUCHES = 1e-6  # distance below which a surface touches the ground [m]


@dataclass
class Membrane:
    """Triangles of the surface.

    Attributes:
        points: Positions [m], shape (points, 2).
        triangles: Point ids, shape (triangles, 3).
        ground: Height of the ground at the points [m].
        edge: Whether a point is fixed at the ground.
        floor: Lower limit of the surface [m]; by default none.
    """

    points: Floats
    triangles: Ints
    ground: Floats
    edge: NDArray[np.bool_]
    floor: Floats = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        if not len(self.floor):
            self.floor = np.full(len(self.ground), -np.inf)
        sparse = extra("scipy.sparse")
        corners = self.points[self.triangles]
        # sides opposite the corners
        sides = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
        (ax, ay), (bx, by) = sides[:, 0].T, sides[:, 1].T
        self._area = np.abs(ax * by - ay * bx) / 2
        stiffness = np.einsum("eid,ejd->eij", sides, sides) / (4 * self._area)[:, None, None]
        rows, columns = np.repeat(self.triangles, 3, axis=1), np.tile(self.triangles, 3)
        count = len(self.points)
        self._stiffness = sparse.csr_matrix(
            (stiffness.ravel(), (rows.ravel(), columns.ravel())), (count, count)
        )
        thirds = np.repeat(self._area / 3, 3)
        self._weight = np.bincount(self.triangles.ravel(), thirds, count)

    def surface(self, curvature: float) -> Floats:
        """Heights [m] of the surface at the points, by active sets.

        Args:
            curvature: Its Laplacian in the free part [1/m].
        """
        solve: Callable[..., Any] = extra("scipy.sparse.linalg").spsolve
        load = -curvature * self._weight
        s, at = self.ground.copy(), np.where(self.edge, 1, 0)  # 1 at the ground, -1 at the floor
        for _ in range(PASSES):
            free = at == 0
            s = np.where(at > 0, self.ground, np.where(at < 0, self.floor, s))
            if free.any():
                rows = self._stiffness[free]
                s[free] = solve(rows[:, free].tocsc(), load[free] - rows[:, ~free] @ s[~free])
            pull = self._stiffness @ s - load  # above 0 it would move down
            new = at.copy()
            new[free & (s > self.ground + NEAR)] = 1
            new[free & (s < self.floor - NEAR)] = -1
            slack = NEAR * self._weight
            new[(at > 0) & ~self.edge & (pull > slack)] = 0
            new[(at < 0) & (pull < -slack)] = 0
            if (new == at).all():
                break
            at = new
        return s

    def thickened(self, surface: Floats, thin: float) -> Floats:
        """A surface at least this far below the ground [m], except where it touches the ground."""
        bare = self.ground - surface < TOUCHES
        lower = np.minimum(surface, self.ground - thin)
        return np.where(bare, self.ground, lower)

    def depth(self, surface: Floats) -> float:
        """Greatest depth below the ground [m]."""
        return float((self.ground - surface).max())

    def volume(self, surface: Floats) -> float:
        """Volume between surface and ground [m3]."""
        return float(((self.ground - surface)[self.triangles].mean(axis=1) * self._area).sum())


def curvature_for(
    measure: Callable[[float], float], wanted: float, first: float, what: str
) -> float:
    """The curvature [1/m] at which a measure that grows with it has a given value.

    A negative curvature (a bulge) is needed if the ground is so convex that a flat surface cuts off
    more.

    Args:
        measure: Function from the curvature to depth or volume.
        wanted: Its value.
        first: A curvature of the right order [1/m].
        what: Name of the measure, for the error.

    Raises:
        CaseError: No curvature gives the value.
    """
    optimize = extra("scipy.optimize")
    flat = measure(0.0)
    side = 1.0 if flat < wanted else -1.0
    end, reached = side * first, flat
    for _ in range(40):
        reached = measure(end)
        if (reached - wanted) * side >= 0:
            low, high = sorted((0.0, end))
            return float(optimize.brentq(lambda k: measure(k) - wanted, low, high, rtol=1e-10))
        end *= 2
    raise CaseError(
        f"no surface has a {what} of {wanted:.6g}; the outline gives {reached:.6g} at most"
    )


def base_level(landslide: Landslide, membrane: Membrane, thin: float) -> tuple[Floats, list[str]]:
    """The surface of a landslide file.

    Args:
        landslide: The landslide.
        membrane: Its triangles; receives the floor.
        thin: Least thickness of the body [m].

    Returns:
        Heights at the points [m], ground heights at its outcrop; and a note.

    Raises:
        CaseError: No surface has that depth or volume.
    """
    by = landslide.surface.slbl if landslide.surface else None
    assert by is not None
    z = membrane.ground
    for plane in landslide.planes(by.above):
        membrane.floor = np.minimum(z, np.maximum(membrane.floor, plane(membrane.points)))
    if by.deepest is not None:
        membrane.floor = np.maximum(membrane.floor, z - by.deepest)
    try:
        k = _curvature(by, membrane, thin)
    except CaseError as error:
        raise landslide.error("surface.slbl", str(error)) from None
    bed = membrane.thickened(membrane.surface(k), thin)
    if (bed == z).all():
        raise landslide.error("surface.slbl", "has no rock between itself and the ground")
    notes = [
        f"slbl: curvature {k:.4g} 1/m, depth {membrane.depth(bed):.2f} m, "
        f"{membrane.volume(bed):,.0f} m3"
    ]
    if k < 0:
        notes.append(
            "slbl: the surface bulges: on this convex ground a flat one would cut off more"
        )
    return bed, notes


def _curvature(by: SlblBy, membrane: Membrane, thin: float) -> float:
    """The curvature [1/m] for a landslide file.

    Raises:
        CaseError: No curvature fits, or the body would be thinner than its elements allow.
    """
    size = float(np.sqrt(np.ptp(membrane.points, axis=0)).prod())
    if by.curvature is not None:
        return by.curvature
    if by.depth is not None:
        first = by.depth / size**2
        return curvature_for(
            lambda k: membrane.depth(membrane.surface(k)), by.depth, first, "depth [m]"
        )
    assert by.volume is not None

    def volume(k: float) -> float:
        return membrane.volume(membrane.thickened(membrane.surface(k), thin))

    k = curvature_for(volume, by.volume, by.volume / size**4, "volume [m3]")
    if abs(volume(k) / by.volume - 1) > VOLUME_ERROR:
        raise CaseError(
            f"a volume of {by.volume:,.0f} m3 makes a body too thin for elements of this size; "
            "give a smaller sizes.body"
        )
    return k


class OnTriangles:
    """Heights on triangles, linear in between; beyond them as on the nearest triangle.

    Args:
        points: Positions [m], shape (points, 2).
        triangles: Point ids, shape (triangles, 3).
        heights: Heights at the points [m].
    """

    def __init__(self, points: Floats, triangles: Ints, heights: Floats) -> None:
        shapely = extra("shapely")
        self._corners = points[triangles]
        self._heights = heights[triangles]
        rings = np.concatenate([self._corners, self._corners[:, :1]], axis=1)
        self._tree = shapely.STRtree(shapely.polygons(rings))
        self.low, self.high = np.full(2, -np.inf), np.full(2, np.inf)

    def __call__(self, xy: Floats) -> Floats:
        at = extra("shapely").points(xy)
        inside, owner = self._tree.query(at, predicate="intersects")
        of = np.full(len(xy), -1)
        of[inside[::-1]] = owner[::-1]
        lost = np.flatnonzero(of < 0)
        of[lost] = self._tree.nearest(at[lost])
        a, b, c = np.moveaxis(self._corners[of], 1, 0)
        ab, ac, ap = b - a, c - a, xy - a
        whole = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
        v = (ap[:, 0] * ac[:, 1] - ap[:, 1] * ac[:, 0]) / whole
        w = (ab[:, 0] * ap[:, 1] - ab[:, 1] * ap[:, 0]) / whole
        z = self._heights[of]
        return z[:, 0] * (1 - v - w) + z[:, 1] * v + z[:, 2] * w
