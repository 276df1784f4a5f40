"""Columns of ground beside the sides of a model with a free field, for the core."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.boundaries_schema import BaseInput
from cdem.case.case import Case
from cdem.errors import CaseError
from cdem.mesh.element_shapes import lame_constants
from cdem.mesh.topology import Topology
from cdem.model.boundaries import Place, impedances, maxwell_at
from cdem.model.curves import add_record
from cdem.model.damping import branches_of
from cdem.model.faces import face_areas, face_normals
from cdem.model.flat_arrays import Floats
from cdem.model.module import Built, Module, Parts

SLANT = np.sin(np.radians(0.5))
"""Most sine of the angle between a face of a side and its plane, or of a base and the horizontal."""
LEAST_LAYER = 0.5
"""Least height of a layer, as a fraction of the lowest face beside it."""
STEP_OF_STRIPS = 0.5
"""Change of the height of ground along a side with which another column begins, in faces."""
SAME_HEIGHT = 1e-6
"""Distance from the foot of a layer that is none, as a fraction of its height."""
UNEVEN = 0.1
"""Relative difference of the heights of columns of one side that is told."""

Indices = NDArray[np.integer]


@dataclass
class Strip:
    """A part of a side with one column.

    Where two groups lie on each other there are two levels at one height, and a layer without
    height between them: the bond of both.

    Attributes:
        place: The boundary.
        base: The boundary below.
        faces: Its faces.
        heights: Different heights of the levels, ascending [m].
        groups: Group of the rock above each height but the last, by number.
        bonds: By index of a height, normal and shear stiffness of the bond there [Pa/m].
    """

    place: Place
    base: Place
    faces: Indices
    heights: Floats
    groups: Indices
    bonds: dict[int, tuple[float, float]] = field(default_factory=dict)

    @property
    def height(self) -> float:
        """Of the column [m]."""
        return float(self.heights[-1] - self.heights[0])

    @property
    def count(self) -> int:
        """Number of levels."""
        return len(self.heights) + len(self.changes)

    @property
    def changes(self) -> list[int]:
        """Indices of heights where the group changes."""
        return [i for i in range(1, len(self.groups)) if self.groups[i] != self.groups[i - 1]]

    @property
    def is_bond(self) -> NDArray[np.bool_]:
        """Whether the layer above a level is a bond, by number of the level."""
        bond = np.zeros(self.count, bool)
        bond[self.foot_of[self.changes] - 1] = True
        return bond

    @property
    def foot_of(self) -> Indices:
        """Number of the level at the foot of each layer of rock."""
        steps = np.zeros(len(self.groups), int)
        steps[self.changes] = 1
        return np.arange(len(self.groups)) + np.cumsum(steps)


@dataclass
class ColumnModel(Module):
    """Columns of a model.

    Attributes:
        strips: One for each column; found with the first arrays.
    """

    name = "columns"
    strips: list[Strip] | None = field(default=None)

    @classmethod
    def of(cls, case: Case, t: Topology, names: list[str]) -> ColumnModel:
        return cls()

    def add_arrays(self, parts: Parts) -> None:
        if not any(boundary.free_field for boundary in parts.case.boundaries):
            return
        case, t = parts.case, parts.topology
        if self.strips is None:
            self.strips = strips_of(case, t, parts.boundaries.places)
            for strip in self.strips:
                _find_bonds(parts, strip)
        levels = np.cumsum([0, *(strip.count for strip in self.strips)])
        sides = [_Sides(case, t, strip) for strip in self.strips]
        parts.assembly.counts |= {
            "columns.count": len(self.strips),
            "columns.side_count": sum(len(side.nodes) for side in sides),
        }
        parts.assembly.arrays |= {
            "columns.level_first": levels.astype(np.int32),
            **_arrays_of_layers(case, t, self.strips),
            **_arrays_of_feet(parts, self.strips),
            **_arrays_of_sides(sides, levels),
        }

    def report(self, build: Built) -> list[dict[str, Any]]:
        return [
            {
                "side": strip.place.boundary.name,
                "base": strip.base.boundary.name,
                "levels": strip.count,
                "height": strip.height,
                "groups": [build.group_names[g] for g in dict.fromkeys(strip.groups.tolist())],
            }
            for strip in self.strips or []
        ]

    def lines(self, report: list[dict[str, Any]]) -> list[str]:
        return [
            f"  free field beside {one['side']}: a column of {one['height']:.4g} m with "
            f"{one['levels']} levels, above {one['base']}"
            for one in report
        ]


def _arrays_of_layers(case: Case, t: Topology, strips: list[Strip]) -> dict[str, NDArray]:
    return {
        "columns.layer": np.concatenate([_layers(case, t, s) for s in strips]).ravel(),
        "columns.bond": np.concatenate([s.is_bond for s in strips]).astype(np.int8),
        "columns.mass": np.concatenate([_masses(case, t, s) for s in strips]),
    }


def _arrays_of_feet(parts: Parts, strips: list[Strip]) -> dict[str, NDArray]:
    inputs = [_inputs(parts, strip) for strip in strips]
    acting = parts.boundaries.begun if not parts.boundaries.held else set()
    curves, rows = ([pair[k] for some in inputs for pair in some] for k in (0, 1))
    feet = [_foot(parts.case, parts.topology, strip) for strip in strips]
    return {
        "columns.foot": np.array(feet).ravel(),
        "columns.input_first": np.cumsum([0, *map(len, inputs)]).astype(np.int32),
        "columns.input_curve": np.array(curves, np.int32),
        "columns.input": np.array(rows, float).reshape(-1, 4).ravel(),
        "columns.acts": np.array([s.place.boundary.name in acting for s in strips], np.int8),
    }


def _arrays_of_sides(sides: list[_Sides], levels: Indices) -> dict[str, NDArray]:
    """Arrays of the nodes of all sides; `levels` are the numbers of the lowest level of each strip."""
    layers = [[layer + first for layer in some] for side, first in zip(sides, levels, strict=False)
              for some in side.layers]  # fmt: skip
    areas = [area for side in sides for some in side.areas for area in some]
    return {
        "columns.node": np.concatenate([side.nodes for side in sides]).astype(np.int32),
        "columns.level": np.concatenate(
            [side.level + first for side, first in zip(sides, levels, strict=False)]
        ).astype(np.int32),
        "columns.part": np.concatenate([side.part for side in sides]),
        "columns.dashpot": np.concatenate([side.dashpots for side in sides]).ravel(),
        "columns.layer_first": np.cumsum([0, *map(len, layers)]).astype(np.int32),
        "columns.side_layer": np.array([layer for some in layers for layer in some], np.int32),
        "columns.area": np.array(areas).ravel(),
    }


def strips_of(case: Case, t: Topology, places: list[Place]) -> list[Strip]:
    """The strips of all sides with a free field.

    Raises:
        CaseError: A side is no vertical plane, has one level only, or has no base below it.
    """
    of_name = {place.boundary.name: place for place in places}
    strips = []
    for i, place in enumerate(places):
        free = place.boundary.free_field
        if free is None:
            continue
        where = f"{case.where(f'boundaries.{i}')}: boundaries.{i}: {place.boundary.name}"
        base = of_name[free.base]
        _check_plane(t, place, where)
        for faces in _parts(t, place):
            heights = _heights(t, faces)
            if len(heights) < 2:
                raise CaseError(f"{where} has nodes at one height only: a column needs two levels")
            strips.append(Strip(place, base, faces, heights, _groups(t, faces, heights)))
            _check_base(t, strips[-1], where)
    return strips


def uneven_sides(strips: list[Strip]) -> list[str]:
    """Sides whose columns differ in height, for warnings."""
    heights: dict[str, list[float]] = {}
    for strip in strips:
        heights.setdefault(strip.place.boundary.name, []).append(strip.height)
    return [
        f"boundary {name}: the ground along this side is {min(some):.4g} to {max(some):.4g} m high; "
        "ground that rises along a side is no ground in one dimension: move the side, or hold it as a "
        "plane of symmetry"
        for name, some in heights.items()
        if max(some) > (1 + UNEVEN) * min(some)
    ]


def _check_plane(t: Topology, place: Place, where: str) -> None:
    normal = face_normals(t.node_position, t.face_nodes[place.faces])
    mean = normal.mean(axis=0)
    mean /= max(float(np.linalg.norm(mean)), 1e-300)
    off = np.linalg.norm(np.cross(normal, mean), axis=1).max()
    x = t.node_position[place.nodes] @ mean
    size = np.sqrt(face_areas(t.node_position, t.face_nodes[place.faces]).max())
    if off > SLANT or abs(mean[2]) > SLANT or np.ptp(x) > SLANT * size:
        raise CaseError(
            f"{where} is no vertical plane; a free field needs one: write an entry for each plane "
            "side, or quiet: true alone"
        )


def _check_base(t: Topology, strip: Strip, where: str) -> None:
    base = strip.base
    normal = face_normals(t.node_position, t.face_nodes[base.faces])
    if normal[:, 2].max() > -np.sqrt(1 - SLANT**2):
        raise CaseError(
            f"{where}: its base {base.boundary.name} is not horizontal and below the rock; a free "
            "field needs such a base"
        )
    foot, size = strip.heights[0], strip.heights[1] - strip.heights[0]
    if abs(t.node_position[base.nodes, 2] - foot).min() > 0.5 * size:
        raise CaseError(
            f"{where}: its lowest nodes lie at {foot:.6g} m, its base {base.boundary.name} does not; "
            "a side reaches down to its base"
        )


def _vertices(t: Topology, faces: Indices) -> tuple[Indices, NDArray[np.bool_]]:
    """Vertices of faces, the first again in place of a missing fourth, and which are there."""
    vertex = t.face_nodes[faces]
    return np.where(vertex < 0, vertex[:, :1], vertex), vertex >= 0


def _parts(t: Topology, place: Place) -> list[Indices]:
    """Faces of a side, cut along it into strips of ground of nearly equal height."""
    vertex, _ = _vertices(t, place.faces)
    normal = face_normals(t.node_position, t.face_nodes[place.faces]).mean(axis=0)
    along = np.array([-normal[1], normal[0], 0.0])
    x, z = t.node_position[vertex] @ along, t.node_position[vertex][:, :, 2]
    width, tall = np.ptp(x, axis=1), float(np.median(np.ptp(z, axis=1)))
    middle = x.mean(axis=1)
    # the height of the ground, in bins of the width of a face
    step = max(float(np.median(width)), 1e-9 * float(np.ptp(x) + 1))
    number = np.floor((middle - x.min()) / step).astype(int)
    top = np.full(number.max() + 1, -np.inf)
    np.maximum.at(top, number, z.max(axis=1))
    strip, last = np.zeros(len(top), int), np.nan
    for k in range(len(top)):
        strip[k] = strip[k - 1] if k else 0
        if not np.isfinite(top[k]):
            continue
        if np.isfinite(last) and abs(top[k] - last) > STEP_OF_STRIPS * tall:
            strip[k] += 1
        if not np.isfinite(last) or strip[k] != strip[k - 1]:
            last = top[k]
    return [place.faces[strip[number] == k] for k in np.unique(strip[number])]


def _heights(t: Topology, faces: Indices) -> Floats:
    """Heights of the nodes of faces, without those that lie too near to the one below [m]."""
    vertex, _ = _vertices(t, faces)
    z = t.node_position[vertex][:, :, 2]
    tall = np.repeat(np.ptp(z, axis=1)[:, None], vertex.shape[1], axis=1)
    heights, lowest = z.ravel(), np.where(tall > 0, tall, np.inf).ravel()
    order = np.argsort(heights, kind="stable")
    levels: list[float] = []
    for height, face in zip(heights[order], lowest[order], strict=True):
        if not levels or height - levels[-1] > LEAST_LAYER * face:
            levels.append(float(height))
    top = float(heights.max())
    if len(levels) > 1:
        levels[-1] = top  # the ground ends where its nodes end
    return np.array(levels)


def _groups(t: Topology, faces: Indices, heights: Floats) -> Indices:
    """Group with the largest part of the faces between two heights, for each layer."""
    vertex, _ = _vertices(t, faces)
    z = t.node_position[vertex][:, :, 2]
    low, high = z.min(axis=1), z.max(axis=1)
    area, group = face_areas(t.node_position, t.face_nodes[faces]), t.face_group[faces]
    chosen = []
    for below, above in pairwise(heights):
        part = np.clip(np.minimum(high, above) - np.maximum(low, below), 0, None) / (high - low)
        chosen.append(np.bincount(group, part * area).argmax())
    return np.array(chosen)


def _layers(case: Case, t: Topology, strip: Strip) -> Floats:
    """Rows of layers, by the level at their foot: height, lambda + 2 mu, lambda, mu.

    A bond has a height of 1 and its stiffness; above the last level there is none.
    """
    rows = np.zeros((strip.count, 4))
    rows[:, :2] = 1.0
    young, poisson = _of_rock(case, t, strip, "young_modulus", "poisson_ratio")
    part = branches_of(maxwell_at(case, strip.place.boundary.stage)).part
    first, shear = lame_constants(part * young, poisson)
    rows[strip.foot_of] = np.stack(
        [np.diff(strip.heights), first + 2 * shear, first, shear], axis=1
    )
    for i, (normal, across) in strip.bonds.items():
        rows[strip.foot_of[i] - 1] = [1.0, normal, 0.0, across]
    return rows


def _find_bonds(parts: Parts, strip: Strip) -> None:
    """Set the stiffness of the bonds between the groups of a strip.

    Raises:
        CaseError: Two groups are not bonded.
    """
    t, out = parts.topology, parts.assembly
    vertex, _ = _vertices(t, strip.faces)
    beside = np.zeros(len(t.node_position), bool)
    beside[vertex] = True
    for i in strip.changes:
        pair_of = {int(g) for g in strip.groups[i - 1 : i + 1]}
        found = []
        for kind, faces in out.pair_faces.items():
            some = np.array([set(t.face_group[pair].tolist()) == pair_of for pair in faces], bool)
            nodes = t.face_nodes[faces.reshape(-1, 2)[:, 0]]
            some &= (beside[nodes] & (nodes >= 0)).any(axis=1)
            table = out.arrays[f"{kind}.stiffness"].reshape(2, -1)
            found.append(table[:, : len(faces)][:, some])
        both = np.concatenate(found, axis=1)
        if not both.size:
            below, above = (t.group_names[g] for g in strip.groups[i - 1 : i + 1])
            raise CaseError(
                f"{parts.case.where('boundaries')}: boundaries: {strip.place.boundary.name}: {above} "
                f"is not bonded to {below} below it; ground with a free field holds together: give "
                "their interface cohesion and tensile_strength"
            )
        strip.bonds[i] = (float(both[0].mean()), float(both[1].mean()))


def _masses(case: Case, t: Topology, strip: Strip) -> Floats:
    """Mass of each level [kg/m2]."""
    (density,) = _of_rock(case, t, strip, "density")
    half = 0.5 * density * np.diff(strip.heights)
    mass = np.zeros(strip.count)
    mass[strip.foot_of] += half
    mass[strip.foot_of + 1] += half
    return mass


def _of_rock(case: Case, t: Topology, strip: Strip, *keys: str) -> list[Floats]:
    rocks = [case.materials[case.groups[t.group_names[g]].material] for g in strip.groups]
    return [np.array([getattr(rock, key) for rock in rocks]) for key in keys]


def _foot(case: Case, t: Topology, strip: Strip) -> list[float]:
    """Dashpots of the foot x y z [kg/(m2 s)], and 1 where its motion is given."""
    if not strip.base.boundary.quiet:
        return [0.0, 0.0, 0.0, 1.0]
    p, s = impedances(case, t.group_names, strip.base.boundary.stage)[strip.groups[0]]
    return [s, s, p, 0.0]


def _inputs(parts: Parts, strip: Strip) -> list[tuple[int, list[float]]]:
    """Curve and row of each motion at the foot, for a record of 1 m/s."""
    base = strip.base.boundary
    foot = np.array(_foot(parts.case, parts.topology, strip))

    def row(given: BaseInput) -> list[float]:
        motion = np.array(given.motion_of_record)
        return [*(motion if given.kind == "rigid" else 2 * foot[:3] * motion), 0.0]

    return [
        (add_record(parts.case.processed(given.record), base.stage, parts.curves), row(given))
        for given in base.inputs
    ]


class _Sides:
    """Nodes of a strip: their levels, dashpots, and shares of the faces in each layer."""

    def __init__(self, case: Case, t: Topology, strip: Strip) -> None:
        vertex, there = _vertices(t, strip.faces)
        self.nodes, of = np.unique(vertex, return_inverse=True)
        of = of.reshape(vertex.shape)
        layer = self._layers(t, strip)
        below, above = strip.heights[layer], strip.heights[layer + 1]
        self.level = strip.foot_of[layer]
        self.part = np.clip((t.node_position[self.nodes, 2] - below) / (above - below), 0.0, 1.0)
        self.dashpots = self._dashpots(case, t, strip, of, there)
        shares = self._shares(t, strip, vertex, there, of)
        self.layers = [sorted(share) for share in shares]
        self.areas = [[share[k] for k in sorted(share)] for share in shares]

    def _layers(self, t: Topology, strip: Strip) -> Indices:
        """Layer of each node: the one above its height, or below where its own rock ends."""
        z, last = t.node_position[self.nodes, 2], len(strip.groups) - 1
        layer = np.clip(np.searchsorted(strip.heights, z, side="right") - 1, 0, last)
        own = t.block_group[t.node_block[self.nodes]]
        at_foot = z - strip.heights[layer] < SAME_HEIGHT * np.diff(strip.heights)[layer]
        ends = at_foot & (layer > 0) & (strip.groups[layer] != own)
        ends &= strip.groups[np.maximum(layer - 1, 0)] == own
        return np.where(ends, layer - 1, layer)

    def _dashpots(
        self, case: Case, t: Topology, strip: Strip, of: Indices, there: NDArray[np.bool_]
    ) -> Floats:
        """Rows of matrices, xx yy zz xy yz zx and two pads [kg/s], as `core/surface` has them."""
        faces = strip.faces
        normal = face_normals(t.node_position, t.face_nodes[faces])
        stage = strip.place.boundary.stage
        z = impedances(case, t.group_names, stage)[t.face_group[faces]]
        share = face_areas(t.node_position, t.face_nodes[faces]) / there.sum(axis=1)
        rows = np.zeros((len(faces), 8))
        rows[:, :3] = z[:, 1:]
        for k, (a, b) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))):
            rows[:, k] += (z[:, 0] - z[:, 1]) * normal[:, a] * normal[:, b]
        rows *= share[:, None]
        sums = np.zeros((len(self.nodes), 8))
        for k in range(of.shape[1]):
            np.add.at(sums, of[there[:, k], k], rows[there[:, k]])
        return sums

    def _shares(
        self, t: Topology, strip: Strip, vertex: Indices, there: NDArray[np.bool_], of: Indices
    ) -> list[dict[int, Floats]]:
        """For each node the area vector of its share in layers, by layer [m2]."""
        normal = face_normals(t.node_position, t.face_nodes[strip.faces])
        across = normal.mean(axis=0)
        along = np.array([-across[1], across[0], 0.0]) / np.hypot(across[0], across[1])
        out: list[dict[int, Floats]] = [{} for _ in self.nodes]
        for f in range(len(strip.faces)):
            corners = int(there[f].sum())
            x = t.node_position[vertex[f, :corners]]
            plane = np.stack([x @ along, x[:, 2]], axis=1)
            for number, weights in shape_integrals(plane, strip.heights).items():
                layer = int(strip.foot_of[number])
                for k in range(corners):
                    row = np.zeros(4)
                    row[:2] = weights[k] * normal[f, :2]
                    mine = out[of[f, k]]
                    mine[layer] = mine.get(layer, np.zeros(4)) + row
        return out


def shape_integrals(corners: Floats, levels: Floats) -> dict[int, Floats]:
    """Integrals of the shape functions of a face over its parts between levels.

    A quadrilateral counts as four triangles about its middle; the parts of it that lie in one layer
    have the integrals of its bilinear functions if it is a parallelogram.

    Args:
        corners: Corners in the plane of the face, the second number upward [m], shape (3 or 4, 2).
        levels: Heights of the levels, ascending [m]; the outermost layers take all beyond.

    Returns:
        By number of the layer, integral for each corner [m2], shape (3 or 4,).
    """
    count = len(corners)
    values = np.eye(count)
    triangles = [[0, 1, 2]]
    if count == 4:
        corners = np.vstack([corners, corners.mean(axis=0)])
        values = np.vstack([values, np.full(4, 0.25)])
        triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    points = np.hstack([corners, values])
    found: dict[int, Floats] = {}
    inner = levels[1:-1]
    for triangle in triangles:
        rest = points[triangle]
        first = int(np.searchsorted(inner, rest[:, 1].min(), side="right"))
        last = int(np.searchsorted(inner, rest[:, 1].max(), side="left"))
        for layer in range(first, last + 1):
            part = rest
            if layer < last:
                part, rest = _below(rest, inner[layer]), _below(rest, inner[layer], sign=-1)
            if len(part) > 2:
                found[layer] = found.get(layer, np.zeros(count)) + _integral(part)
    return found


def _below(polygon: Floats, height: float, sign: int = 1) -> Floats:
    """The part of a convex polygon below a height (or above it), with its values."""
    out = []
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        da, db = sign * (height - a[1]), sign * (height - b[1])
        if da >= 0:
            out.append(a)
        if (da > 0 > db) or (da < 0 < db):
            out.append(a + da / (da - db) * (b - a))
    return np.array(out).reshape(-1, polygon.shape[1])


def _integral(polygon: Floats) -> Floats:
    """Integral of values that are linear over a convex polygon."""
    total = np.zeros(polygon.shape[1] - 2)
    a = polygon[0]
    for b, c in pairwise(polygon[1:]):
        area = 0.5 * abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
        total += area / 3 * (a[2:] + b[2:] + c[2:])
    return total
