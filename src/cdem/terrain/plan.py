"""The plan: bodies limited by the outcrop of the sliding surface, and triangles along their outlines."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError, MeshError
from cdem.terrain.heights import Heights, extra
from cdem.terrain.landslide import Landslide
from cdem.terrain.slbl import Membrane, OnTriangles, base_level
from cdem.units import coordinates

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
CORNER = 20.0  # smallest turn of an outline [deg] at a kept corner
THIN = 0.1  # least thickness in element sizes: less becomes zero on an outline and this inside


@dataclass
class Plan:
    """Triangles in plan.

    points: Positions [m], shape (points, 2).
        points: [m], shape (points, 2).
        triangles: Counter-clockwise point ids, shape (triangles, 3).
        body: Number of each triangle's body, -1 for bedrock.
        ground: Height of the ground at the points [m].
        bed: Height of the sliding surface [m]; NaN outside bodies.
        rim: Points of the extent's edge in order, counter-clockwise from its south-west corner.
        notes: Messages for the user.
    """

    points: Floats
    triangles: Ints
    body: Ints
    ground: Floats
    bed: Floats
    rim: Ints
    notes: list[str]


def make_plan(landslide: Landslide) -> Plan:
    """Triangulate the extent with the outlines of the bodies as constraints.

    Raises:
        CaseError: An outline crosses itself, leaves the extent, or contains no rock above the
            surface.
        MeshError: The plan cannot be triangulated.
    """
    projection = landslide.projection
    ground, surface = landslide.ground(), landslide.sliding_surface()
    _check_extent(landslide, ground)
    notes: list[str] = []
    outlines = _outlines(landslide)
    bodies = _cut_at_outcrop(landslide, outlines, ground, surface, notes)
    pieces = pieces_of(bodies, outlines, landslide.sizes.body) if bodies else []
    points, triangles, body, outcrop = _triangulate(landslide, pieces)
    unknown = np.full(len(points), np.nan)
    plan = Plan(points, triangles, body, unknown, unknown, _rim(points), notes)
    if surface is None and bodies:
        surface, outcrop = _base_level(landslide, plan, ground)
    if surface is None:
        plan.ground = known(landslide, "terrain", ground, plan.points)
    else:
        _lift(landslide, plan, ground, surface, outcrop)
    check_base(landslide, plan.points, np.fmin(plan.ground, plan.bed))
    plan.notes = projection.notes + plan.notes
    return plan


def _base_level(landslide: Landslide, plan: Plan, ground: Heights) -> tuple[Heights, Ints]:
    """The sloping local base level under the bodies, and its points at ground level."""
    used, local = np.unique(plan.triangles[plan.body >= 0], return_inverse=True)
    points, triangles = plan.points[used], local.reshape(-1, 3)
    z = known(landslide, "terrain", ground, points)
    around = np.zeros(len(plan.points), bool)
    around[plan.triangles[plan.body < 0]] = True
    thin = THIN * landslide.sizes.body
    bed, notes = base_level(landslide, Membrane(points, triangles, z, around[used]), thin)
    plan.notes += notes
    return OnTriangles(points, triangles, bed), used[bed == z]


def check_base(
    landslide: Landslide, points: Floats, lowest: Floats, what: str = "the sliding surface"
) -> None:
    """Check that the base lies below everything else.

    Args:
        landslide: With the height of the base.
        points: Positions in plan [m], shape (points, 2).
        lowest: Height of the lowest surface there [m].
        what: Its name, beside that of the ground.

    Raises:
        CaseError: It does not, by an element.
    """
    at = int(lowest.argmin())
    if lowest[at] < landslide.extent.base + landslide.sizes.body:
        raise landslide.error(
            "extent.base",
            f"must lie at least an element below the ground and {what}, whose lowest point is "
            f"{lowest[at]:.5g} m at {_at(points[at])}",
        )


def _at(point: Floats) -> str:
    return f"({coordinates(point)})"


def known(landslide: Landslide, key: str, heights: Heights, points: Floats) -> Floats:
    """Heights at points, which must lie within the data.

    Args:
        landslide: For its errors and sizes.
        key: Place of the heights in its file.
        heights: The heights.
        points: Positions [m], shape (points, 2).

    Raises:
        CaseError: There are no data at a point.
    """
    try:
        z = heights(points)
    except CaseError as error:  # two heights at one place
        raise landslide.error(key, str(error)) from None
    reach = landslide.sizes.body * 1e-6
    outside = np.any((points < heights.low - reach) | (points > heights.high + reach), axis=1)
    bad = np.flatnonzero(outside | ~np.isfinite(z))
    if len(bad):
        raise landslide.error(
            key,
            f"has no data at {_at(points[bad[0]])}; it reaches from {_at(heights.low)} to "
            f"{_at(heights.high)}"
            + (" with gaps" if not outside[bad[0]] else "")
            + "; make the extent smaller, or give data that reach further",
        )
    return z


def _check_extent(landslide: Landslide, ground: Heights) -> None:
    x, y = landslide.extent.x, landslide.extent.y
    low, high = np.array([x[0], y[0]]), np.array([x[1], y[1]])
    slack = 1e-6 * (high - low)
    if bool((low < ground.low - slack).any() or (high > ground.high + slack).any()):
        raise landslide.error(
            "extent",
            f"{_at(low)} to {_at(high)} reaches beyond the terrain, which extends from "
            f"{_at(ground.low)} to {_at(ground.high)}; are the units the same?",
        )
    if landslide.sizes.far > (high - low).min():
        raise landslide.error("sizes.far", "is larger than the extent")


# ------------------------------------------------------------------ outlines


def _outlines(landslide: Landslide) -> list[Any]:
    shapely = extra("shapely")
    x, y = landslide.extent.x, landslide.extent.y
    frame = shapely.box(x[0], y[0], x[1], y[1])
    out = []
    for index in range(len(landslide.bodies)):
        polygon = shapely.Polygon(landslide.outline(index))
        path = f"bodies.{index}.outline"
        if not polygon.is_valid:
            raise landslide.error(path, f"crosses itself: {shapely.is_valid_reason(polygon)}")
        if not frame.covers(polygon):
            low, high = np.reshape(polygon.bounds, (2, 2))
            raise landslide.error(
                path,
                f"leaves the extent: it spans {_at(low)} to {_at(high)}; are the units the same?",
            )
        out.append(polygon)
    return out


def _cut_at_outcrop(
    landslide: Landslide,
    outlines: list[Any],
    ground: Heights,
    surface: Heights | None,
    notes: list[str],
) -> list[Any]:
    """Polygons of the bodies: inside their outline, not in an earlier one, rock above the surface."""
    shapely = extra("shapely")
    size = landslide.sizes.body
    above = shapely.union_all(outlines)
    if surface is not None:
        above = _above(landslide, above, ground, surface)
    taken = shapely.Polygon()
    bodies = []
    for index, outline in enumerate(outlines):
        own = outline.difference(taken)
        taken = taken.union(outline)
        parts = shapely.get_parts(shapely.set_precision(own.intersection(above), 1e-9 * size))
        kept = [p for p in parts if p.geom_type == "Polygon" and p.area >= size**2]
        area = sum(p.area for p in kept)
        path = f"bodies.{index}.outline"
        if not kept:
            raise landslide.error(
                path,
                "contains no rock: the sliding surface lies above the ground everywhere in it, or "
                "it "
                "is smaller than one element; check surface, its units and sizes.body",
            )
        if area < 0.999 * own.area:
            notes.append(
                f"{landslide.bodies[index].group}: ends at the outcrop of the sliding surface, "
                f"{area:,.0f} of {own.area:,.0f} m2 of its outline"
            )
        bodies.append(shapely.MultiPolygon(kept))
    x, y = landslide.extent.x, landslide.extent.y
    inside = shapely.box(x[0] + size, y[0] + size, x[1] - size, y[1] - size)
    for index, body in enumerate(bodies):
        if not inside.covers(body):
            raise landslide.error(
                f"bodies.{index}.outline",
                "the body reaches the edge of the extent; leave at least an element between them",
            )
    return bodies


def _above(landslide: Landslide, outline: Any, ground: Heights, surface: Heights) -> Any:
    """Polygon where the ground lies above the sliding surface, from a grid four times as fine."""
    contourpy, shapely = extra("contourpy"), extra("shapely")
    step = landslide.sizes.body / 4
    west, south, east, north = outline.bounds
    x = np.arange(west - step, east + 2 * step, step)
    y = np.arange(south - step, north + 2 * step, step)
    xy = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    inside = shapely.contains_xy(outline, xy)
    z = known(landslide, "terrain", ground, xy[inside])
    bed = known(landslide, "surface", surface, xy[inside])
    thickness = np.zeros(len(xy))
    thickness[inside] = z - bed
    # just outside the outline the sources may lack data: they are extrapolated, or stay at zero
    beyond = ground(xy[~inside]) - surface(xy[~inside])
    thickness[~inside] = np.where(np.isfinite(beyond), beyond, 0.0)
    highest = thickness.max()
    if highest <= 0:
        return shapely.Polygon()
    lines = contourpy.contour_generator(
        x, y, thickness.reshape(len(y), len(x)), fill_type=contourpy.FillType.OuterOffset
    )
    filled = zip(*lines.filled(0.0, highest + 1.0), strict=True)
    polygons = []
    for points, starts in filled:
        rings = [points[a:b] for a, b in pairwise(starts)]
        polygons.append(shapely.Polygon(rings[0], rings[1:]).buffer(0))
    return shapely.union_all(polygons)


@dataclass
class Piece:
    """A part of the bodies' boundaries between two corners or junctions, divided into edges.

    Attributes:
        points: Ends of its edges [m], shape (edges + 1, 2).
        left, right: Number of the body on either side, -1 for bedrock.
        outcrop: Whether it follows the outcrop instead of an outline.
    """

    points: Floats
    left: int
    right: int
    outcrop: bool


def pieces_of(bodies: list[Any], outlines: list[Any], size: float) -> list[Piece]:
    """Divide the boundaries of the bodies into edges of about one size."""
    shapely = extra("shapely")
    near = 1e-3 * size
    net = shapely.union_all([body.boundary for body in bodies], grid_size=1e-9 * size)
    drawn = shapely.union_all([outline.boundary for outline in outlines])
    shapely.prepare(drawn)
    pieces = []
    for chain in shapely.get_parts(shapely.line_merge(net)):
        xy = shapely.get_coordinates(chain)
        middle = (xy[:-1] + xy[1:]) / 2
        outcrop = shapely.distance(shapely.points(middle), drawn) > near
        along = xy[1] - xy[0]
        normal = np.array([-along[1], along[0]]) / np.hypot(*along)
        sides = [middle[0] + near * normal, middle[0] - near * normal]
        left, right = (
            next((i for i, b in enumerate(bodies) if shapely.contains_xy(b, *side)), -1)
            for side in sides
        )
        cuts = _cuts(xy, outcrop)
        for a, b in pairwise(cuts):
            points = _resampled(xy[a : b + 1], size)
            pieces.append(Piece(points, left, right, bool(outcrop[a])))
    return _without_short(pieces, 0.4 * size)


def _cuts(xy: Floats, outcrop: NDArray[np.bool_]) -> list[int]:
    """Kept points of a chain: its ends, its corners, and the start of the outcrop."""
    step = np.diff(xy, axis=0)
    azimuth = np.arctan2(step[:, 1], step[:, 0])
    turn = np.abs((np.diff(azimuth) + np.pi) % (2 * np.pi) - np.pi)
    sharp = (turn > np.radians(CORNER)) & ~(outcrop[:-1] & outcrop[1:])
    kept = np.flatnonzero(sharp | (outcrop[:-1] != outcrop[1:])) + 1
    return [0, *kept.tolist(), len(xy) - 1]


def _resampled(xy: Floats, size: float) -> Floats:
    """A line divided into equal edges of about one size; a ring into three or more."""
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(xy, axis=0).T))])
    least = 3 if (xy[0] == xy[-1]).all() else 1
    count = max(least, round(length[-1] / size))
    at = np.linspace(0, length[-1], count + 1)
    points = np.column_stack([np.interp(at, length, xy[:, k]) for k in (0, 1)])
    points[0], points[-1] = xy[0], xy[-1]
    return points


def _without_short(pieces: list[Piece], shortest: float) -> list[Piece]:
    """Contract pieces much shorter than an element to a point."""
    kept = list(pieces)
    for piece in pieces:
        a, b = piece.points[0].copy(), piece.points[-1].copy()
        if len(piece.points) > 2 or np.hypot(*(b - a)) >= shortest:
            continue
        kept = [other for other in kept if other is not piece]
        for other in kept:
            ends = (other.points == b).all(axis=1)
            other.points[ends] = a
    return kept


# ------------------------------------------------------------------ triangles


def _triangulate(landslide: Landslide, pieces: list[Piece]) -> tuple[Floats, Ints, Ints, Ints]:
    """Points, triangles, their bodies (-1 for bedrock), and the points of the outcrop."""
    sizes = landslide.sizes
    (west, east), (south, north) = landslide.extent.x, landslide.extent.y
    frame = np.array([[west, south], [east, south], [east, north], [west, north], [west, south]])
    lines = [(frame[k : k + 2], 1, 0) for k in range(4)]
    for piece in pieces:
        for ends in zip(piece.points[:-1], piece.points[1:], strict=True):
            lines.append((np.array(ends), piece.left + 2, piece.right + 2))
    # bare ground, for falling blocks, is fine, above rock that grows coarser
    around = sizes.far if landslide.bodies else sizes.body
    domain_size = [around] + [sizes.body] * len(landslide.bodies)
    points, triangles, domain = flat_mesh(lines, domain_size, sizes.growth)
    bare = {tuple(p) for piece in pieces if piece.outcrop for p in piece.points.tolist()}
    outcrop = np.array([i for i, p in enumerate(points.tolist()) if tuple(p) in bare], np.int64)
    return points, triangles, domain - 2, outcrop


def flat_mesh(
    lines: list[tuple[Floats, int, int]], sizes: list[float], growth: float
) -> tuple[Floats, Ints, Ints]:
    """Triangulate plane domains.

    Args:
        lines: Ends [m], shape (2, 2), and the domain to the left and to the right, from 1; 0 is
            outside.
        sizes: Edge length in each domain [m].
        growth: Growth of the edge length per distance [1].

    Returns:
        Points, shape (points, 2), first the points of the lines; counter-clockwise triangles; their
        domains.

    Raises:
        MeshError: The lines cross, or leave a domain open.
    """
    netgen = extra("netgen.meshing")
    geometry = extra("netgen.geom2d").SplineGeometry()
    netgen.SetMessageImportance(0)
    number: dict[tuple[float, float], int] = {}
    for ends, left, right in lines:
        ids = []
        for x, y in ends.tolist():
            if (x, y) not in number:
                number[x, y] = geometry.AppendPoint(x, y)
            ids.append(number[x, y])
        geometry.Append(["line", *ids], leftdomain=left, rightdomain=right)
    for domain, size in enumerate(sizes, start=1):
        geometry.SetDomainMaxH(domain, size)
    try:
        mesh = geometry.GenerateMesh(maxh=max(sizes), grading=growth)
    except Exception as error:
        raise MeshError(f"the plan cannot be triangulated: {error}") from None
    faces = mesh.Elements2D().NumPy()
    triangles = faces["nodes"][:, :3].astype(np.int64) - 1
    return np.array(mesh.Coordinates())[:, :2], triangles, faces["index"].astype(np.int64)


def _rim(points: Floats) -> Ints:
    """Points on the edge of the extent in order, counter-clockwise from the south-west corner."""
    low, high = points.min(axis=0), points.max(axis=0)
    x, y = points.T
    sides = [
        (y == low[1], x),
        (x == high[0], y),
        (y == high[1], -x),
        (x == low[0], -y),
    ]
    order = [np.flatnonzero(on)[np.argsort(along[on])][:-1] for on, along in sides]
    return np.concatenate(order)


# ------------------------------------------------------------------ thickness


def _lift(
    landslide: Landslide, plan: Plan, ground: Heights, surface: Heights, outcrop: Ints
) -> None:
    """Give the plan its heights; the thickness is zero at the outcrop and nowhere inside a body."""
    thin = THIN * landslide.sizes.body
    _look_up(landslide, plan, ground, surface)
    zero = np.zeros(len(plan.points), bool)
    zero[outcrop] = True
    in_body = np.isfinite(plan.bed)
    edge = np.zeros(len(zero), bool)
    edge[plan.triangles[plan.body < 0]] = True
    zero |= in_body & edge & ~(plan.ground - plan.bed >= thin)
    plan.body[zero[plan.triangles].all(axis=1)] = -1  # without volume
    split_pinched(plan, zero)
    _look_up(landslide, plan, ground, surface)
    zero = np.concatenate([zero, np.zeros(len(plan.points) - len(zero), bool)])
    in_body = np.isfinite(plan.bed)
    least = np.where(zero, plan.bed, plan.bed + thin)
    raised = in_body & (zero | (plan.ground < least))
    plan.ground[raised] = least[raised]


def _look_up(landslide: Landslide, plan: Plan, ground: Heights, surface: Heights) -> None:
    of_body = np.unique(plan.triangles[plan.body >= 0])
    plan.ground = known(landslide, "terrain", ground, plan.points)
    plan.bed = np.full(len(plan.points), np.nan)
    plan.bed[of_body] = known(landslide, "surface", surface, plan.points[of_body])


def split_pinched(plan: Plan, zero: NDArray[np.bool_]) -> None:
    """Divide edges inside a body whose ends have no thickness: ground and bed would coincide there.

    A triangle has at most one such edge, since three ends without thickness make it bedrock.
    """
    of_edge: dict[tuple[int, int], list[int]] = {}
    for t in np.flatnonzero(plan.body >= 0).tolist():
        ends = [int(v) for v in plan.triangles[t] if zero[v]]
        if len(ends) == 2:
            of_edge.setdefault((min(ends), max(ends)), []).append(t)
    points, triangles, body = [plan.points], [plan.triangles], [plan.body]
    count = len(plan.points)
    for (a, b), pair in of_edge.items():
        if len(pair) < 2:
            continue
        points.append((plan.points[[a]] + plan.points[[b]]) / 2)
        for k in pair:
            triangle = plan.triangles[k].copy()
            plan.triangles[k] = np.where(triangle == a, count, triangle)
            triangles.append(np.where(triangle == b, count, triangle)[None])
            body.append(plan.body[[k]])
        count += 1
    plan.points = np.concatenate(points)
    plan.triangles = np.concatenate(triangles)
    plan.body = np.concatenate(body)
