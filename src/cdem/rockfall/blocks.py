"""The block of a run and its start, drawn from the seed and the number of the run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.primitives import outward_faces, polyhedron
from cdem.rockfall.fall import BLOCK, Boulder
from cdem.rockfall.ground import Ground
from cdem.rockfall.schema import Drawn, Shape
from cdem.rockfall.starts import Starts
from cdem.study.sampling import quantile
from cdem.units import to_number

Floats = NDArray[np.float64]
SPHERE = (10, 14)
"""Fewest and most corners of a rounded block."""
UNEVEN = 0.1
"""Random displacement of corners, in half sides."""
STREAMS = ("place", "height", "velocity", "volume", "shape", "corners", "attitude")
"""What is drawn: each from numbers of its own, so one distribution does not change the others."""
FINE = 6
"""Points along the edge of a face where the block is compared with the ground."""


@dataclass(frozen=True)
class Wish:
    """What the file says about blocks and starts.

    Attributes:
        seed: Of all runs.
        shapes: By name.
        volume: [m3].
        height: Of the lowest place above the ground [m].
        velocity: Horizontal, downslope [m/s].
        starts: Where blocks start.
    """

    seed: int
    shapes: dict[str, Shape]
    volume: Drawn
    height: Drawn
    velocity: Drawn
    starts: Starts


@dataclass(frozen=True)
class Start:
    """A block at its start.

    Attributes:
        boulder: The block.
        shape: Name of its shape.
        volume: [m3].
    """

    boulder: Boulder
    shape: str
    volume: float


def draw(wish: Wish, number: int, ground: Ground) -> Start:
    """The start of a run.

    Args:
        wish: What the file says.
        number: Of the run, from 0.
        ground: The ground.
    """
    random = {name: np.random.default_rng([wish.seed, number, k]) for k, name in enumerate(STREAMS)}
    names = list(wish.shapes)
    shares = np.cumsum([wish.shapes[name].share for name in names])
    pick = int(np.searchsorted(shares, random["shape"].random() * shares[-1], side="right"))
    name = names[min(pick, len(names) - 1)]
    volume = value(wish.volume, random["volume"].random(), "m3")
    corners, faces = body(wish.shapes[name], random["corners"], volume)
    corners = corners @ attitude(random["attitude"]).T
    xy = wish.starts.place(random["place"])
    height = value(wish.height, random["height"].random(), "m")
    speed = value(wish.velocity, random["velocity"].random(), "m/s")
    corners = above(corners, faces, xy, ground, height)
    slope = ground.plane(xy)[1]
    steep = float(np.linalg.norm(slope))
    way = -slope / steep if steep > 0 else np.zeros(2)
    return Start(Boulder(corners, np.array([*(speed * way), 0.0]), faces=faces), name, volume)


def value(drawn: Drawn, u: float, unit: str) -> float:
    """Quantile of a distribution, in a unit of SI."""
    if drawn.values is not None:
        at = min(int(u * len(drawn.values)), len(drawn.values) - 1)
        found = drawn.values[at]
        return to_number(found if drawn.unit is None else f"{found} {drawn.unit}", unit)
    number = quantile(drawn, u)
    return number if drawn.unit is None else to_number(f"{number!r} {drawn.unit}", unit)


def body(
    shape: Shape, random: np.random.Generator, volume: float
) -> tuple[Floats, list[list[int]]]:
    """A convex block around its centre of mass.

    Args:
        shape: Its sides and its kind.
        random: Displaces the corners.
        volume: [m3].

    Returns:
        Its corners [m], shape (corners, 3), and the corners of each face, outward.
    """
    if shape.corners == "box":
        signs = (-1.0, 1.0)
        points = np.array([(x, y, z) for x in signs for y in signs for z in signs])
        points += random.uniform(-UNEVEN, UNEVEN, points.shape)
    else:
        points = _sphere(int(random.integers(SPHERE[0], SPHERE[1] + 1)))
        points += random.uniform(-UNEVEN, UNEVEN, points.shape)
        points /= np.linalg.norm(points, axis=1)[:, None]
    points *= shape.sides
    faces = outward_faces(points, None)
    mesh = polyhedron(BLOCK, points, faces)
    scale = (volume / _volume(mesh.points, mesh.cells["tet4"])) ** (1 / 3)
    return (points - mesh.points[-1]) * scale, faces


def _volume(points: Floats, tets: NDArray) -> float:
    a, b, c = (points[tets[:, k]] - points[tets[:, 0]] for k in (1, 2, 3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def _sphere(count: int) -> Floats:
    """Points on the unit sphere at even distances: a spiral of the golden angle."""
    k = np.arange(count) + 0.5
    z = 1 - 2 * k / count
    turn = np.pi * (3 - np.sqrt(5)) * k
    flat = np.sqrt(1 - z**2)
    return np.column_stack([flat * np.cos(turn), flat * np.sin(turn), z])


def attitude(random: np.random.Generator) -> Floats:
    """A rotation matrix, each attitude equally likely (Shoemake 1992, Graphics Gems III)."""
    u, v, w = random.random(3)
    a, b = np.sqrt(1 - u), np.sqrt(u)
    x, y, z, s = (
        a * np.sin(2 * np.pi * v), a * np.cos(2 * np.pi * v),
        b * np.sin(2 * np.pi * w), b * np.cos(2 * np.pi * w),
    )  # fmt: skip
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * s), 2 * (x * z + y * s)],
            [2 * (x * y + z * s), 1 - 2 * (x * x + z * z), 2 * (y * z - x * s)],
            [2 * (x * z - y * s), 2 * (y * z + x * s), 1 - 2 * (x * x + y * y)],
        ]
    )


def above(
    corners: Floats, faces: list[list[int]], xy: Floats, ground: Ground, height: float
) -> Floats:
    """A block over a place in plan, with this least vertical distance from the ground [m].

    Args:
        corners: Of the block around its centre [m], shape (corners, 3).
        faces: Corners of each face.
        xy: Place of its centre [m].
        ground: The ground.
        height: [m].
    """
    triangles = [(f[0], f[k], f[k + 1]) for f in faces for k in range(1, len(f) - 1)]
    steps = [(i, j) for i in range(FINE + 1) for j in range(FINE + 1 - i)]
    weights = np.array([(i, j, FINE - i - j) for i, j in steps]) / FINE
    surface = np.einsum("wk,fki->fwi", weights, corners[np.array(triangles)]).reshape(-1, 3)
    there = ground.height(surface[:, :2] + xy)
    there = np.where(np.isfinite(there), there, -np.inf)
    lift = float((there - surface[:, 2]).max()) + height
    return corners + [*xy, lift]
