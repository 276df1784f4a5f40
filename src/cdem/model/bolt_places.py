"""Positions of the bolts of a case: along points, in a pattern on a surface, in rings about a tunnel."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.case.bolts_schema import Pattern, Rings
from cdem.case.case import Case
from cdem.case.loads_schema import Region
from cdem.errors import CaseError
from cdem.mesh.arrays import along, lengths, matrix_product
from cdem.mesh.overlap import inner_part
from cdem.mesh.paths import passes, walk
from cdem.mesh.topology import Topology
from cdem.model.selection import select_faces

Floats = NDArray[np.float64]

MOST_BOLTS = 1_000_000
"""Most bolts of a pattern."""


@dataclass(frozen=True)
class Polyline:
    """A bolt from head to toe.

    Attributes:
        name: Name of the bolt.
        entry: Number of the entry of the case.
        points: Points along it [m], shape (points, 3).
    """

    name: str
    entry: int
    points: Floats

    @property
    def path(self) -> str:
        """The entry in the case."""
        return f"bolts.{self.entry}"

    @property
    def starts(self) -> Floats:
        """Length along the bolt at each point [m]."""
        return np.concatenate([[0], np.cumsum(lengths(np.diff(self.points, axis=0)))])

    @property
    def length(self) -> float:
        """[m]."""
        return float(self.starts[-1])

    def at(self, length: float) -> Floats:
        """The position at a length from the head [m]."""
        return np.array([np.interp(length, self.starts, x) for x in self.points.T])


def polylines(case: Case, t: Topology, names: list[str]) -> list[Polyline]:
    """All bolts of a case; bolts of a pattern are numbered from 1.

    Raises:
        CaseError: A pattern has no bolts, or too many.
    """
    lines: list[Polyline] = []
    for i, entry in enumerate(case.bolts):
        path = f"bolts.{i}"
        if entry.points is not None:
            lines.append(Polyline(entry.name, i, np.array(entry.points, float)))
            continue
        in_box = ""
        if entry.pattern is not None:
            in_box = " in its box" if entry.pattern.box is not None else ""
            found = list(_on_surface(case, t, names, entry.pattern, f"{path}.pattern"))
        else:
            assert entry.rings is not None
            found = list(_in_rings(case, t, names, entry.rings, f"{path}.rings"))
        if not found:
            raise CaseError(
                f"{case.where(path)}: {path}: the pattern has no bolts; its spacing is wider than "
                f"the surface{in_box}"
            )
        lines += [Polyline(f"{entry.name}.{k + 1}", i, ends) for k, ends in enumerate(found)]
    return lines


def _on_surface(
    case: Case, t: Topology, names: list[str], pattern: Pattern, path: str
) -> Iterator[Floats]:
    """Heads on a grid in the mean plane of a surface: horizontal rows, then up the dip."""
    faces = select_faces(case, t, names, pattern.surface, path)
    triangles = _triangles(t, faces)
    areas = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normal = areas.sum(axis=0)
    if lengths(normal) < 1e-3 * lengths(areas).sum():
        raise CaseError(
            f"{case.where(path)}: {path}.surface: its faces look in all directions; give one side, "
            "or rings"
        )
    normal /= lengths(normal)
    flat = np.hypot(normal[0], normal[1])
    u = np.array([1.0, 0, 0]) if flat < 1e-6 else np.array([-normal[1], normal[0], 0]) / flat
    v = np.cross(normal, u)
    plane = matrix_product(triangles, np.stack([u, v], axis=1))  # (triangles, 3, 2)
    way = -normal if pattern.direction is None else np.array(pattern.direction, float)
    way /= lengths(way)
    if along(way, normal) >= 0:
        raise CaseError(
            f"{case.where(path)}: {path}.direction: points out of the surface, whose outward "
            f"normal "
            f"is [{', '.join(f'{x:.3g}' for x in normal)}]; reverse it"
        )
    if (box := pattern.box) is not None:
        part = _corners_in_box(triangles, box)
        if len(part) == 0:
            ends = [_text(end(axis=(0, 1))) for end in (triangles.min, triangles.max)]
            raise CaseError(
                f"{case.where(path)}: {path}.box: the surface has no part in this box; it reaches "
                f"from {ends[0]} to {ends[1]}"
            )
        corners = matrix_product(part, np.stack([u, v], axis=1))
    else:
        corners = plane.reshape(-1, 2)
    low, high = corners.min(axis=0), corners.max(axis=0)
    counts = np.floor((high - low) / pattern.spacing + 1e-9).astype(int)
    if counts.prod() > MOST_BOLTS:
        raise CaseError(
            f"{case.where(path)}: {path}.spacing: gives {counts.prod():,} bolts, more than "
            f"{MOST_BOLTS:,}; give a wider spacing"
        )
    begin = 0.5 * (low + high - (counts - 1) * pattern.spacing)
    for row in range(counts[1]):
        for column in range(counts[0]):
            place = begin + np.array([column, row]) * pattern.spacing
            head = _in_triangles(place, plane, triangles)
            if head is not None and (box is None or _is_in(box, head)):
                yield np.stack([head, head + pattern.length * way])


def _is_in(box: Region, places: Floats) -> NDArray[np.bool_]:
    return np.asarray(((places >= box.min) & (places <= box.max)).all(axis=-1))


def _corners_in_box(triangles: Floats, box: Region) -> Floats:
    """Corners of the parts of triangles inside a box, shape (corners, 3) [m]."""
    whole = _is_in(box, triangles).all(axis=1)
    reached = (triangles.max(axis=1) >= box.min) & (triangles.min(axis=1) <= box.max)
    parts = [triangles[whole].reshape(-1, 3)]
    for part in triangles[reached.all(axis=1) & ~whole]:
        for axis in range(3):
            part = inner_part(part, part[:, axis] - box.min[axis])
            part = inner_part(part, box.max[axis] - part[:, axis])
        parts.append(part)
    return np.concatenate(parts)


def _triangles(t: Topology, faces: NDArray[np.intp]) -> Floats:
    """Faces as triangles, shape (triangles, 3, 3) [m]."""
    nodes = t.face_nodes[faces]
    quads = nodes[nodes[:, 3] >= 0]
    corners = np.concatenate([nodes[:, :3], quads[:, [0, 2, 3]]])
    return t.node_position[corners]


def _in_triangles(place: Floats, plane: Floats, triangles: Floats) -> Floats | None:
    """The point of the first triangle over a position in the plane."""
    a, b, c = plane[:, 0], plane[:, 1], plane[:, 2]
    twice = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        p = place - a
        s = (p[:, 0] * (c[:, 1] - a[:, 1]) - p[:, 1] * (c[:, 0] - a[:, 0])) / twice
        r = ((b[:, 0] - a[:, 0]) * p[:, 1] - (b[:, 1] - a[:, 1]) * p[:, 0]) / twice
    inside = np.flatnonzero((s >= -1e-9) & (r >= -1e-9) & (s + r <= 1 + 1e-9))
    if not len(inside):
        return None
    k = inside[0]
    return along(triangles[k].T, np.array([1 - s[k] - r[k], s[k], r[k]]))


def _in_rings(
    case: Case, t: Topology, names: list[str], rings: Rings, path: str
) -> Iterator[Floats]:
    """Heads where rays from the axis enter the rock."""
    start, end = np.array(rings.axis, float)
    length = float(lengths(end - start))
    axis = (end - start) / length
    up = np.array([0.0, 0, 1]) if abs(axis[2]) < 0.9 else np.array([0.0, 1, 0])
    up -= along(up, axis) * axis
    up /= lengths(up)
    side = np.cross(axis, up)
    if rings.inside is not None and rings.inside not in names:
        raise CaseError(
            f"{case.where(path)}: {path}.inside: no group {rings.inside!r} in the model; it has: "
            f"{', '.join(names)}"
        )
    inside = -1 if rings.inside is None else names.index(rings.inside)
    reach = float(np.ptp(t.node_position, axis=0).max())
    a, b = np.radians(rings.angles)
    turns = rings.count if b - a >= 2 * np.pi - 1e-9 else max(rings.count - 1, 1)
    for k in range(int(np.ceil(length / rings.spacing - 1e-9))):
        origin = start + k * rings.spacing * axis
        for n in range(rings.count):
            angle = a + (b - a) * n / turns
            way = np.cos(angle) * up + np.sin(angle) * side
            head = _enters(t, origin, origin + reach * way, inside)
            if head is None:
                raise CaseError(
                    f"{case.where(path)}: {path}: the ray from {_text(origin)} towards {_text(way)} "
                    "hits no rock; move the axis"
                )
            yield np.stack([origin + head * way, origin + (head + rings.length) * way])


def _enters(t: Topology, start: Floats, end: Floats, inside: int) -> float | None:
    """Distance from its start at which a ray enters the rock, behind the group in the opening [m]."""
    length = float(lengths(end - start))
    for p in walk(passes(t, start, end), length, 1e-9 * length):
        if p.group != inside:
            return p.first
    return None


def _text(x: Floats) -> str:
    return "[" + ", ".join(f"{c:.4g}" for c in x) + "]"
