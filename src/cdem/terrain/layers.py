"""Layers between surfaces: columns of tets from the base of the extent to the ground, one group a layer."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cdem.terrain.landslide import Landslide
from cdem.terrain.plan import THIN, Plan, check_base, known
from cdem.terrain.solid import Columns, Solid, check_conforming, sides_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
TOLD = 1e-3
"""Least share of a layer's volume that is told when thin parts of it are left out."""


@dataclass
class _Horizons:
    """Surfaces over the points of the plan, from the ground downwards.

    Attributes:
        z: Heights [m], shape (layers + 2, points): the ground, the bases of the layers, the base.
        ids: Number of the mesh point on each, of the same shape; equal where a layer has no thickness.
        columns: Of each part between two of them.
    """

    z: Floats
    ids: Ints
    columns: list[Columns]


def make_layers(landslide: Landslide, plan: Plan) -> Solid:
    """Fill the space between base and ground with tets, in columns over the triangles of the plan.

    Args:
        landslide: With layers.
        plan: Triangles and ground.

    Raises:
        CaseError: A base has no data at a point of the plan, or a layer is absent everywhere.
        MeshError: The tets do not conform.
    """
    z, notes = _heights(landslide, plan)
    points = [np.column_stack([plan.points, plan.ground])]
    horizons = _divided(landslide, plan.points, z, points)
    groups = [*(layer.group for layer in landslide.layers), landslide.bedrock]
    tets, group = [], []
    for part, columns in enumerate(horizons.columns):
        stacked = [
            [*stand, to]
            for triangle in plan.triangles.tolist()
            for stand, _, to in columns.climb(triangle)
        ]
        tets.append(np.array(stacked, np.int64).reshape(-1, 4))
        group.append(np.full(len(stacked), part))
    plan.notes += [n for n in landslide.projection.notes if n not in plan.notes] + notes
    solid = Solid(
        np.concatenate(points),
        np.concatenate(tets),
        np.concatenate(group),
        groups,
        _outside(plan, horizons),
        list(plan.notes),
        landslide.system,
        _facts(landslide, plan, z),
    )
    outside = [faces for name, faces in solid.surfaces.items() if name.startswith("fix_")]
    check_conforming(solid, np.concatenate([plan.triangles, *outside]))
    _name_layers(solid, plan, horizons)
    return solid


def _heights(landslide: Landslide, plan: Plan) -> tuple[Floats, list[str]]:
    """Heights of all surfaces, each at or below the one above it, and notes.

    A thickness below `THIN` of an element becomes none: the rock goes to the layer below.
    """
    thin = THIN * landslide.sizes.body
    area = _areas(plan)
    z, notes = [plan.ground], list[str]()
    for index, layer in enumerate(landslide.layers):
        key = f"layers.{index}.base"
        raw = known(landslide, key, landslide.base_of(index), plan.points)
        full = np.maximum(z[-1] - raw, 0.0)
        thickness = np.where(full < thin, 0.0, full)
        if not thickness.any():
            above = f"the base of {landslide.layers[index - 1].group}" if index else "the ground"
            raise landslide.error(
                key,
                f"lies above {above} everywhere, so the layer is absent; list layers from the ground "
                "downwards, and check heights (z is up) and units",
            )
        volume, lost = _volume(plan, area, full), _volume(plan, area, full - thickness)
        if lost > TOLD * volume:
            notes.append(
                f"{layer.group}: {lost / volume:.1%} of its volume, thinner than {thin:.3g} m, goes to "
                "the layer below"
            )
        z.append(np.where(thickness > 0, raw, z[-1]))
    check_base(landslide, plan.points, z[-1], "the lowest layer")
    return np.array([*z, np.full(len(plan.points), landslide.extent.base)]), notes


def _areas(plan: Plan) -> Floats:
    """Areas of the triangles of the plan [m2]."""
    a, b, c = plan.points[plan.triangles].transpose(1, 0, 2)
    return np.asarray(((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2)


def _volume(plan: Plan, area: Floats, thickness: Floats) -> float:
    """Volume [m3] of a thickness at the points [m]."""
    return float(area @ thickness[plan.triangles].mean(axis=1))


def _facts(landslide: Landslide, plan: Plan, z: Floats) -> dict[str, dict[str, float]]:
    """Thickness [m] and share of each layer."""
    area, facts = _areas(plan), {}
    for layer, above, below in zip(landslide.layers, z[:-2], z[1:-1], strict=True):
        thickness = above - below
        covered = _volume(plan, area, (thickness > 0).astype(float))  # a third for each corner
        facts[layer.group] = {
            "least": float(thickness[thickness > 0].min()),
            "mean": _volume(plan, area, thickness) / covered,
            "most": float(thickness.max()),
            "share": covered / float(area.sum()),
        }
    return facts


def _divided(landslide: Landslide, plan: Floats, z: Floats, points: list[Floats]) -> _Horizons:
    """Points of all surfaces and between them; adds them to those of the ground."""
    sizes = landslide.sizes
    count = len(plan)
    ids = [np.arange(count)]
    columns = []
    for part, (above, below) in enumerate(pairwise(z)):
        far = sizes.far if part == len(z) - 2 else sizes.body
        own, feet = Columns(), ids[-1].copy()
        for at, (top, height) in enumerate(zip(ids[-1].tolist(), above - below, strict=True)):
            if height == 0:
                own.add(at, [top])
                continue
            parts = graded(height, sizes.body, far, sizes.growth)
            low = np.array(parts[:-1])
            heights = below[at] + height * low
            points.append(np.column_stack([np.tile(plan[at], (len(low), 1)), heights]))
            own.add(at, [*range(count, count + len(low)), top], parts)
            feet[at] = count
            count += len(low)
        ids.append(feet)
        columns.append(own)
    return _Horizons(z, np.array(ids), columns)


def graded(height: float, first: float, far: float, growth: float) -> list[float]:
    """Fractions of a height, from 0 at its bottom to 1, whose parts grow downwards.

    Args:
        height: [m].
        first: About the uppermost part [m].
        far: About the largest part [m].
        growth: Growth of the parts per distance [1].
    """
    sizes = [first]
    while sum(sizes) < height:
        sizes.append(min(far, sizes[-1] * (1 + growth)))
    over = sum(sizes) - height
    if len(sizes) > 1 and over > sizes[-1] / 2:
        sizes.pop()
    depth = np.concatenate([[0.0], np.cumsum(sizes)])
    fractions = 1 - depth[::-1] / depth[-1]
    fractions[0], fractions[-1] = 0.0, 1.0
    return [float(part) for part in fractions]


def _outside(plan: Plan, horizons: _Horizons) -> dict[str, Ints]:
    """The base and the four sides, outward."""
    sides: dict[str, list[list[int]]] = {"S": [], "E": [], "N": [], "W": []}
    rim = plan.rim.tolist()
    for k, name in enumerate(sides_of(plan.points[plan.rim])):
        for columns in horizons.columns:
            for stand, _, to in columns.climb([rim[k], rim[(k + 1) % len(rim)]]):
                sides[name].append([*stand, to])
    return {"fix_base": horizons.ids[-1][plan.triangles][:, ::-1]} | {
        f"fix_side_{name}": np.array(faces) for name, faces in sides.items()
    }


def _name_layers(solid: Solid, plan: Plan, horizons: _Horizons) -> None:
    """Name the base of each layer where it is present, and the ground by the group below it."""
    free = np.ones(len(plan.triangles), bool)  # ground of no layer yet
    for part, name in enumerate(solid.groups[:-1]):
        there = (horizons.z[part] > horizons.z[part + 1])[plan.triangles].any(axis=1)
        solid.surfaces[f"base_{name}"] = horizons.ids[part + 1][plan.triangles[there]]
        if (there & free).any():
            solid.surfaces[f"ground_{name}"] = plan.triangles[there & free]
        free &= ~there
    if free.any():
        solid.surfaces[f"ground_{solid.groups[-1]}"] = plan.triangles[free]
