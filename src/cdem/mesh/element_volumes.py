"""Elements as closed surfaces: exact volumes, shares below a plane, cuts and columns over a grid.

Everything follows from the divergence theorem on outward triangles. A quadrilateral face is four
triangles around its centre, which enclose exactly the volume that its bilinear surface encloses.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.element_shapes import FACES, NODES

Floats = NDArray[np.float64]

CHUNK = 200_000
"""Cells under the boxes of triangles that are cut at once: some 100 MB."""

SLIGHT = 1e-9
"""Points within this fraction of a triangle beyond its edges count as on it."""


@dataclass
class Solids:
    """Elements at one moment.

    Attributes:
        triangles: Corners, counter-clockwise seen from outside [m], shape (triangles, 3, 3).
        owner: Element of each triangle.
        middle: Mean of each element's corners [m], shape (elements, 3).
    """

    triangles: Floats
    owner: NDArray[np.intp]
    middle: Floats

    @classmethod
    def of(cls, points: Floats, cells: Mapping[str, NDArray]) -> Solids:
        """Elements of a mesh, by shape, shapes one after the other.

        Args:
            points: Positions of the nodes [m], shape (nodes, 3).
            cells: By shape, node ids (elements, nodes of the shape).
        """
        triangles, owner, middle, first = [], [], [], 0
        for shape, nodes in cells.items():
            x = points[nodes]
            weights = _triangle_weights(shape)
            triangles.append(np.einsum("tvn,enx->etvx", weights, x).reshape(-1, 3, 3))
            owner.append(np.repeat(first + np.arange(len(nodes)), len(weights)))
            middle.append(x.mean(axis=1))
            first += len(nodes)
        return cls(np.concatenate(triangles), np.concatenate(owner), np.concatenate(middle))

    def only(self, chosen: NDArray[np.bool_]) -> Solids:
        """A selection of the elements, shape (elements,)."""
        if chosen.all():
            return self
        number, of = np.cumsum(chosen) - 1, chosen[self.owner]
        return Solids(self.triangles[of], number[self.owner[of]], self.middle[chosen])

    def _tets(self) -> tuple[Floats, Floats]:
        """Each triangle's tet with the middle of its element: corners from there, volume [m3]."""
        arms = self.triangles - self.middle[self.owner][:, None]
        cross = np.cross(arms[:, 1], arms[:, 2])
        return arms, np.einsum("ij,ij->i", arms[:, 0], cross) / 6

    def volumes(self) -> Floats:
        """Volume of each element [m3]."""
        return np.bincount(self.owner, self._tets()[1], len(self.middle)).astype(float)

    def centroids(self) -> Floats:
        """Centre of each element's volume [m], shape (elements, 3)."""
        arms, volume = self._tets()
        moment = volume[:, None] * arms.sum(axis=1) / 4
        sums = [np.bincount(self.owner, m, len(self.middle)) for m in moment.T]
        return self.middle + np.column_stack(sums) / self.volumes()[:, None]

    def level_below_which(self, share: float, along: Floats, density: Floats) -> float:
        """Distance along a direction below which a fraction of the mass lies [m].

        Args:
            share: 0 to 1.
            along: Unit vector, shape (3,); distances count from the origin.
            density: Density of each element [kg/m3].
        """
        knots = np.column_stack([self.triangles @ along, (self.middle @ along)[self.owner]])
        knots.sort(axis=1)
        mass = self._tets()[1] * density[self.owner]
        wanted = share * mass.sum()
        low, high = float(knots.min()), float(knots.max())
        near, below = 1e-12 * max(abs(low), abs(high), high - low), 0.0
        while high - low > near:
            level = 0.5 * (low + high)
            if below + mass @ _fraction_below(knots, level) < wanted:
                low = level
            else:
                high = level
            sure = knots[:, 3] <= low
            below += mass[sure].sum()
            open_ = ~sure & (knots[:, 0] < high)
            knots, mass = knots[open_], mass[open_]
        return 0.5 * (low + high)

    def shares_ahead(self, place: Floats, normal: Floats) -> Floats:
        """Fraction of each element's volume ahead of an upright plane, 0 to 1.

        Args:
            place: A point of the plane in plan [m], shape (2,).
            normal: Horizontal unit vector that points ahead, shape (2,).
        """
        ahead = (self.triangles[:, :, :2] - place) @ normal
        middle = (self.middle[:, :2] - place) @ normal
        knots = np.sort(np.column_stack([ahead, middle[self.owner]]), axis=1)
        volume = self._tets()[1]
        behind = np.bincount(self.owner, volume * _fraction_below(knots, 0.0), len(self.middle))
        return 1 - behind / self.volumes()

    def cut_areas(self, start: Floats, along: Floats, length: float) -> Floats:
        """Area of each element's cut with an upright rectangle of unlimited height [m2].

        Args:
            start: Where the rectangle begins in plan, shape (2,).
            along: Horizontal unit vector in which it runs, shape (2,).
            length: Its length [m].
        """
        normal = np.array([along[1], -along[0]])
        plan = self.triangles[:, :, :2] - start
        ahead = plan @ normal
        front = ahead >= 0
        crossed = front.any(axis=1) & ~front.all(axis=1)
        ahead, owner = ahead[crossed], self.owner[crossed]
        height = self.triangles[crossed][:, :, 2] - self.middle[owner][:, None, 2]
        place = np.stack([plan[crossed] @ along, height], axis=2)
        following, ahead_next = np.roll(place, -1, axis=1), np.roll(ahead, -1, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):  # sides that do not cross the plane
            t = (ahead / (ahead - ahead_next))[..., None]
            points = place + t * (following - place)
        rows = np.arange(len(owner))
        leaves = points[rows, ((ahead >= 0) & (ahead_next < 0)).argmax(axis=1)]
        enters = points[rows, ((ahead < 0) & (ahead_next >= 0)).argmax(axis=1)]
        # the cut's outline is made of these segments; its area is the integral of z dr round it
        run = enters[:, 0] - leaves[:, 0]
        slope = (enters[:, 1] - leaves[:, 1]) / np.where(run == 0, 1.0, run)
        ends = np.clip(np.column_stack([leaves[:, 0], enters[:, 0]]), 0.0, length)
        mean = leaves[:, 1] + slope * (ends.mean(axis=1) - leaves[:, 0])
        part = mean * (ends[:, 1] - ends[:, 0])
        return np.abs(np.bincount(owner, part, len(self.middle)))

    def columns(self, cell: float) -> tuple[tuple[int, int], Floats]:
        """Volume over each cell of a grid in plan, divided by the cell's area [m].

        The lines of the grid lie at multiples of `cell`. The rock above a cell is cut out exactly,
        so the sum over all cells is the elements' volume, to round-off.

        Returns:
            Column and row of the south-western cell, and the thickness, shape (rows, columns), rows
            from south to north.
        """
        low, shape = self.grid(cell)
        out = np.zeros(shape[0] * shape[1])
        for part in self.parts(cell, low, shape):
            out += np.bincount(part.place, part.thickness, len(out))
        return low, out.reshape(shape)

    def parts(self, cell: float, low: tuple[int, int], shape: tuple[int, int]) -> Iterator[Parts]:
        """The surface cut at the lines of a grid, some triangles at a time.

        Args:
            cell: Side of a cell [m].
            low: Column and row of the south-western cell, counted from the origin.
            shape: Rows and columns of the grid, which holds all elements.
        """
        polygons = self.triangles.copy()
        polygons[:, :, :2] = polygons[:, :, :2] / cell - low
        polygons[:, :, 2] -= self.middle[self.owner][:, None, 2]
        spans = np.ptp(polygons[:, :, :2], axis=1) + 2
        chunk = np.cumsum(spans.prod(axis=1)) // CHUNK
        ends = np.flatnonzero(np.diff(chunk)) + 1
        for some, owner in zip(np.split(polygons, ends), np.split(self.owner, ends), strict=True):
            strips, column, triangle = _slices(some, 0)
            pieces, row, strip = _slices(strips, 1)
            place = np.minimum(row, shape[0] - 1) * shape[1]
            place += np.minimum(column, shape[1] - 1)[strip]
            yield Parts(place, owner[triangle[strip]], *_integrals(pieces))

    def tops(self, x: Floats, y: Floats) -> Floats:
        """Height of the highest surface at the points of an even grid [m]; nan without a surface.

        Args:
            x: Coordinates of its columns [m], rising.
            y: Coordinates of its rows [m], rising.

        Returns:
            Shape (rows, columns).
        """
        origin, step = np.array([x[0], y[0]]), np.array([x[1] - x[0], y[1] - y[0]])
        corners = self.triangles.copy()
        corners[:, :, :2] = (corners[:, :, :2] - origin) / step
        u, v = (corners[:, k, :2] - corners[:, 0, :2] for k in (1, 2))
        area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
        corners, u, v, area = (each[area > 0] for each in (corners, u, v, area))  # upward ones
        low = np.maximum(np.ceil(corners[:, :, :2].min(axis=1) - SLIGHT), 0).astype(int)
        most = np.array([len(x), len(y)]) - 1
        high = np.minimum(np.floor(corners[:, :, :2].max(axis=1) + SLIGHT), most).astype(int)
        wide, count = np.maximum(high - low + 1, 0).T[0], np.maximum(high - low + 1, 0).prod(axis=1)
        top = np.full(len(x) * len(y), -np.inf)
        chunk = np.cumsum(count) // CHUNK
        for some in np.split(np.arange(len(count)), np.flatnonzero(np.diff(chunk)) + 1):
            of = np.repeat(some, count[some])
            number = np.arange(len(of)) - np.repeat(
                np.cumsum(count[some]) - count[some], count[some]
            )
            place = low[of] + np.column_stack([number % wide[of], number // wide[of]])
            arm = place - corners[of, 0, :2]
            a = (arm[:, 0] * v[of, 1] - arm[:, 1] * v[of, 0]) / area[of]
            b = (u[of, 0] * arm[:, 1] - u[of, 1] * arm[:, 0]) / area[of]
            inside = (a >= -SLIGHT) & (b >= -SLIGHT) & (a + b <= 1 + SLIGHT)
            z = corners[of, :, 2]
            height = z[:, 0] + a * (z[:, 1] - z[:, 0]) + b * (z[:, 2] - z[:, 0])
            np.maximum.at(top, (place[:, 1] * len(x) + place[:, 0])[inside], height[inside])
        return np.where(np.isfinite(top), top, np.nan).reshape(len(y), len(x))

    def grid(self, cell: float) -> tuple[tuple[int, int], tuple[int, int]]:
        """South-western cell, and rows and columns, of the grid that contains all elements."""
        plan = self.triangles[:, :, :2].reshape(-1, 2)
        low = np.floor(plan.min(axis=0) / cell)
        size = np.maximum(np.ceil(plan.max(axis=0) / cell) - low, 1)
        return (int(low[0]), int(low[1])), (int(size[1]), int(size[0]))


@dataclass
class Parts:
    """Parts of triangles, each above or below one cell of a grid.

    Attributes:
        place: Row times columns plus column of the cell.
        owner: Element of each.
        thickness: Integral of z over the plan of the part, positive if it faces up, over the area
            of
            a cell [m]; sums to the thickness of each element above each cell.
        share: Fraction of the cell that it covers, positive if it faces up [1].
    """

    place: NDArray[np.intp]
    owner: NDArray[np.intp]
    thickness: Floats
    share: Floats


def _triangle_weights(shape: str) -> Floats:
    """Weights of an element's nodes at the corners of its triangles, shape (triangles, 3, nodes)."""
    corner = np.eye(NODES[shape])
    out = []
    for face in FACES[shape]:
        if len(face) == 3:
            out.append(corner[list(face)])
            continue
        center = corner[list(face)].mean(axis=0)
        out += [
            np.array([corner[a], corner[b], center])
            for a, b in zip(face, face[1:] + face[:1], strict=True)
        ]
    return np.array(out)


def _fraction_below(knots: Floats, level: float) -> Floats:
    """Fraction of each tet's volume in which a linear function, given by sorted corner values, is
    below a level."""
    s = knots.T

    def part(a: int, b: int) -> Floats:
        """Fraction of the edge a - b that is below, 0 to 1."""
        length = s[b] - s[a]
        return np.clip((level - s[a]) / np.where(length > 0, length, 1.0), 0.0, 1.0)

    p02, p03, p12, p13 = part(0, 2), part(0, 3), part(1, 2), part(1, 3)
    tip = part(0, 1) * p02 * p03
    wedge = p12 * p13 + p02 * p03 * (1 - p13) + p02 * p13 * (1 - p12)
    rest = 1 - (1 - p03) * (1 - p13) * (1 - part(2, 3))
    return np.select([level <= s[0], level < s[1], level <= s[2], level < s[3]],
                     [0.0, tip, wedge, rest], 1.0)  # fmt: skip


def _slices(polygons: Floats, axis: int) -> tuple[Floats, NDArray[np.intp], NDArray[np.intp]]:
    """Cut convex polygons at every whole number along an axis: parts, slice and polygon of each."""
    value = np.ascontiguousarray(polygons[:, :, axis].T)  # rows of corners: the sums run along them
    low = np.floor(value.min(axis=0)).astype(np.intp)
    count = np.maximum(np.ceil(value.max(axis=0)).astype(np.intp) - low, 1)
    owner = np.repeat(np.arange(len(polygons)), count)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    index = low[owner] + number
    parts = _keep(polygons[owner], number > 0, lambda p, i: p[:, :, axis] - index[i, None])
    ends = number + 1 < count[owner]
    return _keep(parts, ends, lambda p, i: index[i, None] + 1 - p[:, :, axis]), index, owner


def _keep(
    polygons: Floats, chosen: NDArray[np.bool_], distance: Callable[[Floats, NDArray], Floats]
) -> Floats:
    """The parts of convex polygons (n, k, 3) where a linear function is not negative: (n, k + 1, 3).

    Unused places repeat the last corner, and an empty polygon is one point.

    Args:
        polygons: Corners in order.
        chosen: Polygons that reach where the function is negative; the others stay whole.
        distance: The function at the corners of given polygons, called with their numbers.
    """
    out = np.concatenate([polygons, polygons[:, -1:]], axis=1)
    some = np.flatnonzero(chosen)
    if len(some) == 0:
        return out
    polygons = polygons[some]
    d = distance(polygons, some)
    before, d_before = np.roll(polygons, 1, axis=1), np.roll(d, 1, axis=1)
    crossed = (d < 0) != (d_before < 0)
    t = np.where(crossed, d_before / np.where(crossed, d_before - d, 1.0), 0.0)
    points = np.stack([before + t[..., None] * (polygons - before), polygons], axis=2)
    n, k = d.shape
    kept = np.stack([crossed, d >= 0], axis=2).reshape(n, 2 * k)
    places = np.arange(2 * k)
    order = np.sort(np.where(kept, places, 2 * k), axis=1)[:, : k + 1]  # kept ones first, in order
    last = np.where(kept.any(axis=1), 2 * k - 1 - kept[:, ::-1].argmax(axis=1), 0)
    take = np.minimum(order, last[:, None])
    out[some] = points.reshape(n, 2 * k, 3)[np.arange(n)[:, None], take]
    return out


def _integrals(polygons: Floats) -> tuple[Floats, Floats]:
    """Integral of z over each polygon's plan, and the plan's area; positive if it faces up."""
    arms = polygons[:, 1:] - polygons[:, :1]
    a, b = arms[:, :-1], arms[:, 1:]
    area = 0.5 * (a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
    mean = polygons[:, :1, 2] + (a[..., 2] + b[..., 2]) / 3
    return (area * mean).sum(axis=1), area.sum(axis=1)
