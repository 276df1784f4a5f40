"""A line explosion at some depth under a plane that bears no shear: formula, mesh and run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cdem.case.schema import Material
from cdem.run.simulation import Simulation
from cdem.verification.hexahedra import extruded, outer_sides, simulate, walls
from cdem.verification.runner import Study

DEPTH, HOLE = 50.0, 1.0
"""Depth and radius of the hole [m]."""
RISE = 0.02
"""Time of the rise (1 - cos(pi t / RISE)) / 2 [s]."""


def motion(rock: Material, pressure: float, x: float, t: np.ndarray) -> np.ndarray:
    """Horizontal and upward displacement of a free surface, shape (2, times) [m].

    Garvin (1956, Proc. R. Soc. A 234, 528) by the method of Cagniard and de Hoop. A step of the source
    M moves the surface at t > r / c_p, p = (x t + i h q) / r², q² = t² - (r / c_p)², by

        u_x = 2 M / (pi rho c_p² c_s²) Re[p a b / R] / q,     u_up = M / (pi rho c_p² c_s²) Re[a G / R] / q

    with a, b = sqrt(1 / c² - p²) of P and S, G = 1 / c_s² - 2 p², R = G² + 4 p² a b. Gauss points in y
    of t = r / c_p cosh(y) take the root at the front.

    Args:
        rock: The rock.
        pressure: Last pressure in the hole [Pa]: M = pressure pi HOLE² (lambda + 2 mu) / mu.
        x: Distance along the surface [m].
        t: Times since the pressure begins to rise [s].
    """
    e, nu, density = rock.young_modulus, rock.poisson_ratio, rock.density
    shear = e / (2 * (1 + nu))
    moment = pressure * np.pi * HOLE**2 * 2 * (1 - nu) / (1 - 2 * nu)
    c_p, c_s = np.sqrt(shear / density * np.array([2 * (1 - nu) / (1 - 2 * nu), 1]))
    r = np.hypot(x, DEPTH)
    front = r / c_p
    point, weight = np.polynomial.legendre.leggauss(200)
    late = np.arccosh(np.maximum(t / front, 1))
    early = np.arccosh(np.maximum((t - RISE) / front, 1))
    y = early[:, None] + (late - early)[:, None] * (point + 1) / 2
    since, q = front * np.cosh(y), front * np.sinh(y)
    p = (x * since + 1j * DEPTH * q) / r**2
    a, b = np.sqrt(1 / c_p**2 - p * p), np.sqrt(1 / c_s**2 - p * p)
    g = 1 / c_s**2 - 2 * p * p
    whole = g * g + 4 * p * p * a * b
    steps = np.array([2 * np.real(p * a * b / whole), np.real(a * g / whole)])
    slope = np.pi / (2 * RISE) * np.sin(np.pi * (t[:, None] - since) / RISE)
    part = (steps * slope * weight).sum(axis=2) * (late - early) / 2
    return moment / (np.pi * density * c_p**2 * c_s**2) * part


class Plane(NamedTuple):
    """A plane mesh.

    Attributes:
        points: Positions [m], shape (points, 2).
        quads: Quadrilaterals, counter-clockwise, shape (cells, 4).
    """

    points: np.ndarray
    quads: np.ndarray


def half_plane(size: float, width: float, below: float) -> Plane:
    """Rock at x > 0 from the surface y = 0 to `below` the hole, cells of a size away from the hole."""
    half = 4 * size
    around = 16  # cells along half the hole, as many as along the square about it
    rows = 12
    corner = np.array([[0, -half], [half, -half], [half, half], [0, half]])
    side = np.concatenate([
        corner[k] + (corner[k + 1] - corner[k]) * np.arange(n)[:, None] / n
        for k, n in enumerate((4, 8, 4))
    ] + [corner[3:]])  # fmt: skip
    angle = np.linspace(-np.pi / 2, np.pi / 2, around + 1)
    circle = HOLE * np.column_stack([np.cos(angle), np.sin(angle)])
    part = ((half / HOLE) ** (np.arange(rows + 1) / rows) - 1) / (half / HOLE - 1)
    fan = circle + part[:, None, None] * (side - circle) - [0, DEPTH]
    i, k = (g.ravel() for g in np.meshgrid(range(rows), range(around), indexing="ij"))
    low = i * (around + 1) + k
    fan_quads = np.column_stack([low, low + around + 1, low + around + 2, low + 1])
    x = size * np.arange(round(width / size) + 1)
    y = -size * np.arange(round((DEPTH + below) / size) + 1)[::-1]
    around_it, quads = grid(x, y)
    middle = around_it[quads].mean(axis=1)
    kept = (middle[:, 0] > half) | (np.abs(middle[:, 1] + DEPTH) > half)
    points = np.concatenate([fan.reshape(-1, 2), around_it])
    every = np.concatenate([fan_quads, quads[kept] + fan.size // 2])
    _, first, same = np.unique(points.round(6), axis=0, return_index=True, return_inverse=True)
    return used(Plane(points[first], same.ravel()[every]))


def layer(size: float, width: float, height: float) -> Plane:
    """Rock at x > 0 from the surface y = 0 up to a height."""
    x = size * np.arange(round(width / size) + 1)
    y = size * np.arange(round(height / size) + 1)
    return grid(x, y)


def grid(x: np.ndarray, y: np.ndarray) -> Plane:
    """A grid of rectangles between these coordinates."""
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    number = np.arange(len(x) * len(y)).reshape(len(x), len(y))
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
    return Plane(points.reshape(-1, 2), quads.reshape(-1, 4))


def used(plane: Plane) -> Plane:
    """The mesh without points that no quadrilateral has."""
    have, place = np.unique(plane.quads, return_inverse=True)
    return Plane(plane.points[have], place.reshape(plane.quads.shape))


def shake(
    study: Study, bodies: dict[str, Plane], size: float, pressure: float, *settings: str
) -> Simulation:
    """A simulation of the problem's case in which the hole is pressed, with surfaces `wall` and `far`.

    Args:
        study: The study of the problem.
        bodies: Mesh of each group; their sides at x = 0 and y = 0 are in no surface.
        size: Of cells [m].
        pressure: Last pressure in the hole [Pa].
        settings: Further ones.
    """
    points, cells, sides = [], {}, []
    count = 0
    for name, body in bodies.items():
        at, cells[name] = extruded(body.points, body.quads, size)
        cells[name] = cells[name] + count
        outer = outer_sides(body.quads)
        sides.append((walls(outer, len(body.points)) + count, body.points[outer].mean(axis=1)))
        points.append(at)
        count += len(at)
    faces, middle = (np.concatenate(part) for part in zip(*sides, strict=True))
    hole = np.hypot(middle[:, 0], middle[:, 1] + DEPTH) < 1.01 * HOLE
    far = (middle[:, 0] > 1e-6) & (np.abs(middle[:, 1]) > 1e-6) & ~hole
    times = np.linspace(0, RISE, 201)
    rise = pressure * (1 - np.cos(np.pi * times / RISE)) / 2
    table = ", ".join(f"[{t:.9g}, {p:.9g}]" for t, p in zip(times, rise, strict=True))
    return simulate(
        study, np.concatenate(points), cells, {"wall": faces[hole], "far": faces[far]},
        f"loads.blasts.0.pressure={{table: [{table}]}}", *settings,
    )  # fmt: skip


def at_surface(simulation: Simulation, group: str, distances: Sequence[float]) -> np.ndarray:
    """Nodes of a group at y = 0 and these distances."""
    nodes = simulation.build.nodes_of(group)
    place = simulation.build.start_position[nodes]
    return np.array([nodes[np.abs(place - [x, 0, 0]).sum(axis=1).argmin()] for x in distances])


def compare(
    study: Study, what: str, times: np.ndarray, exact: np.ndarray, ours: np.ndarray, within: float
) -> None:
    """Check the peak of a curve, and its largest difference over this peak."""
    peak = exact.max()
    study.check(f"largest {what}", unit="m", theory=peak, ours=ours.max(), within=within)
    study.check(f"largest difference of {what}, over its peak", theory=0,
                ours=np.abs(ours - exact).max() / peak, within=within, absolute=True)  # fmt: skip
