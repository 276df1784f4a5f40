"""Heights of a triangulated surface: linear in each triangle, exact at its corners."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CaseError
from cdem.units import coordinates

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
NEAR = 1e-6
"""Distance over the size of the surface that counts as none: gaps and folds below it are rounding."""
UPRIGHT = 1e-6
"""Area in plan over area of triangles that count as vertical."""
CROWDED = 16
"""Most cells of the search per triangle, on average."""
AT_ONCE = 1_000_000
"""Pairs of points and triangles that are looked at together."""
MOST = 400_000_000
"""Pairs in one look-up: more means triangles too thin for a search by cells."""
SAMPLES = np.array(
    [[1, 1, 1], [28, 1, 1], [1, 28, 1], [1, 1, 28], [1, 14, 15], [15, 1, 14], [14, 15, 1]]
) / np.array([3, 30, 30, 30, 30, 30, 30]).reshape(-1, 1)
"""Places in a triangle where no other may have another height, as weights of its corners."""


@dataclass
class _Pairs:
    """Points and triangles whose cells are the same.

    Attributes:
        point, triangle: Numbers, in the order of the points.
        weights: Of the corners of the triangle at the point.
        inside: Distance to the closest edge [m]; negative outside.
    """

    point: Ints
    triangle: Ints
    weights: Floats
    inside: Floats


class Triangles:
    """A surface of triangles over a plan; NaN where it has none.

    Vertical triangles are left out. Holes narrower than `NEAR` of the size of the surface are closed.

    Args:
        points: Corners [m], shape (points, 3).
        triangles: Numbers of their corners, shape (triangles, 3).
        rounding: Largest error of a coordinate [m].

    Attributes:
        notes: Messages on triangles that are left out.

    Raises:
        CaseError: All triangles are vertical, or a place has two heights.
    """

    def __init__(self, points: Floats, triangles: Ints, rounding: float = 0.0) -> None:
        self._middle = (points.min(axis=0) + points.max(axis=0)) / 2
        corners = (points - self._middle)[triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(normal, axis=1)
        size = float(np.ptp(points, axis=0).max())
        lies = np.abs(normal[:, 2]) > np.maximum(UPRIGHT * area, (1e-9 * size) ** 2)
        self.notes = _left_out(area, lies)
        corners, normal = corners[lies], normal[lies]
        turned = normal[:, 2] < 0
        corners[turned] = corners[turned][:, [0, 2, 1]]
        self._corners = corners
        self._slope = np.hypot(normal[:, 0], normal[:, 1]) / np.abs(normal[:, 2])
        edges = np.roll(corners, -1, axis=1)[:, :, :2] - corners[:, :, :2]  # from each corner
        length = np.hypot(edges[..., 0], edges[..., 1])
        # inward normals of unit length: the edge opposite to a corner is that after it
        self._inward = np.stack([-edges[..., 1], edges[..., 0]], axis=-1) / length[..., None]
        self._height = np.abs(normal[:, 2])[:, None] / length
        self._near = NEAR * size + 4 * rounding
        self.low, self.high = (
            corners[..., :2].min(axis=(0, 1)) + self._middle[:2],
            corners[..., :2].max(axis=(0, 1)) + self._middle[:2],
        )
        self._sort()
        self._refuse_folds()

    def __call__(self, xy: Floats) -> Floats:
        return self._heights(np.asarray(xy, float) - self._middle[:2]) + self._middle[2]

    def _heights(self, xy: Floats) -> Floats:
        """Heights over the middle at places from the middle."""
        out = np.full(len(xy), np.nan)
        for pairs in self._pairs(xy):
            kept = pairs.inside >= -self._near
            point, triangle = pairs.point[kept], pairs.triangle[kept]
            inside = pairs.inside[kept]
            z = (self._corners[triangle, :, 2] * pairs.weights[kept]).sum(axis=1)
            order = np.lexsort((inside, point))
            out[point[order]] = z[order]  # the last one of a point counts: it lies deepest inside
            slope = np.zeros(len(xy))
            slope[point[order]] = self._slope[triangle[order]]
            allowed = self._near * (2 + self._slope[triangle] + slope[point])
            apart = (inside > self._near) & (np.abs(z - out[point]) > allowed)
            if apart.any():
                self._refuse(xy[point], z, out[point], apart)
        return out

    def _refuse(self, xy: Floats, z: Floats, other: Floats, apart: NDArray[np.bool_]) -> None:
        worst = int(np.argmax(np.where(apart, np.abs(z - other), 0)))
        low, high = sorted((z[worst] + self._middle[2], other[worst] + self._middle[2]))
        raise CaseError(
            f"has two heights at ({coordinates(xy[worst] + self._middle[:2])}): {low:.6g} m and "
            f"{high:.6g} m; it folds over, or is a closed body: keep one height for each place (z is up)"
        )

    # ------------------------------------------------------------------ search

    def _sort(self) -> None:
        """Sort the triangles into square cells."""
        flat = self._corners[..., :2]
        low, high = flat.min(axis=1) - self._near, flat.max(axis=1) + self._near
        self._origin, span = low.min(axis=0), high.max(axis=0) - low.min(axis=0)
        self._cell = max(float(np.sqrt(span.prod() / len(flat))), float(span.max()) / 30_000)
        while True:
            first = ((low - self._origin) / self._cell).astype(np.int64)
            count = ((high - self._origin) / self._cell).astype(np.int64) - first + 1
            if count.prod(axis=1).sum() <= CROWDED * len(flat):
                break
            self._cell *= 1.5
        self._shape = (span / self._cell).astype(np.int64) + 1
        many = count.prod(axis=1)
        triangle = np.repeat(np.arange(len(flat)), many)
        step = np.arange(many.sum()) - np.repeat(np.cumsum(many) - many, many)
        across = count[triangle, 0]
        column = first[triangle, 0] + step % across
        cell = (first[triangle, 1] + step // across) * self._shape[0] + column
        order = np.argsort(cell, kind="stable")
        self._listed = triangle[order]
        self._starts = np.searchsorted(cell[order], np.arange(self._shape.prod() + 1))

    def _pairs(self, xy: Floats) -> Iterator[_Pairs]:
        """Each point with all triangles of its cell."""
        if not len(xy):
            return
        at = np.floor((xy - self._origin) / self._cell)
        there = ((at >= 0) & (at < self._shape)).all(axis=1)
        cell = np.zeros(len(xy), np.int64)
        cell[there] = at[there].astype(np.int64) @ [1, self._shape[0]]
        count = np.where(there, self._starts[cell + 1] - self._starts[cell], 0)
        upto = np.cumsum(count)
        if upto[-1] > MOST:
            raise CaseError(
                f"its triangles are too long and thin to be searched: {upto[-1]:,} pairs of points and "
                "triangles; remesh the surface"
            )
        begin = 0
        while begin < len(xy):
            before = upto[begin] - count[begin]
            end = max(begin + 1, int(np.searchsorted(upto, before + AT_ONCE, side="right")))
            some = np.arange(begin, end)
            point = np.repeat(some, count[begin:end])
            step = np.arange(len(point)) - np.repeat(upto[some] - count[some] - before, count[some])
            triangle = self._listed[self._starts[cell[point]] + step]
            yield self._measured(xy, point, triangle)
            begin = end

    def _measured(self, xy: Floats, point: Ints, triangle: Ints) -> _Pairs:
        off = xy[point][:, None] - self._corners[triangle, :, :2]
        distance = (off * self._inward[triangle]).sum(axis=2)  # from the edge after each corner
        weights = (distance / self._height[triangle])[:, [1, 2, 0]]
        return _Pairs(point, triangle, weights, distance.min(axis=1))

    def _refuse_folds(self) -> None:
        """Refuse a second height at places spread over every triangle."""
        flat = self._corners[..., :2]
        self._heights(np.einsum("sc,tcx->tsx", SAMPLES, flat).reshape(-1, 2))


def _left_out(area: Floats, lies: NDArray[np.bool_]) -> list[str]:
    """Note on vertical triangles."""
    if lies.all():
        return []
    if not lies.any():
        raise CaseError("all its triangles are vertical or without area; z must be up")
    share = float(area[~lies].sum() / area.sum())
    return [f"{int((~lies).sum())} vertical triangles, {share:.2%} of its area, are left out"]
