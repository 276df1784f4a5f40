"""Plane meshes of triangles, for problems that need one without structure: scattered, extruded."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import meshio
import numpy as np
from numpy.typing import ArrayLike

from cdem.run.simulation import Simulation
from cdem.verification.runner import Study

ROUNDS = 15
"""Of throwing points; the last hardly find room."""


def delaunay(points: np.ndarray) -> np.ndarray:
    """Delaunay triangles of points in a plane, counter-clockwise, shape (triangles, 3).

    Points go in one by one; each replaces the triangles whose circumcircle it is in by a fan around
    itself (Bowyer 1981, Watson 1981, The Computer Journal 24, 162 and 167).
    """
    order = np.random.default_rng(0).permutation(len(points))  # else points on a circle go wrong
    points = points[order]
    n, middle = len(points), points.mean(axis=0)
    size = np.abs(points - middle).max()
    around = np.array([[-1.0, -1.0], [1.0, -1.0], [0.0, 1.5]])
    x = np.vstack([points, middle + 1e3 * size * around])
    triangles = np.array([[n, n + 1, n + 2]])
    circles = _circles(x, triangles)
    for i in range(n):
        hit = ((circles[:, :2] - x[i]) ** 2).sum(axis=1) < circles[:, 2]
        sides = np.concatenate([triangles[hit][:, [a, (a + 1) % 3]] for a in range(3)])
        inner = {(int(b), int(a)) for a, b in sides}
        rim = np.array([s for s in sides if (int(s[0]), int(s[1])) not in inner])
        fan = np.column_stack([rim, np.full(len(rim), i)])
        triangles = np.concatenate([triangles[~hit], fan])
        circles = np.concatenate([circles[~hit], _circles(x, fan)])
    return order[triangles[(triangles < n).all(axis=1)]]


def _circles(x: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Centres and squared radii of circumcircles, shape (triangles, 3)."""
    a, b, c = (x[triangles[:, k]] for k in range(3))
    b, c = b - a, c - a
    bb, cc = (b * b).sum(axis=1), (c * c).sum(axis=1)
    twice = 2 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    u = np.column_stack([c[:, 1] * bb - b[:, 1] * cc, b[:, 0] * cc - c[:, 0] * bb]) / twice[:, None]
    return np.column_stack([a + u, (u * u).sum(axis=1)])


def scatter(
    fixed: np.ndarray,
    spacing: float,
    seed: int,
    inside: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """Fill a region at random: `fixed` points first, then the scattered ones.

    Points are thrown until no more find room at 0.8 of the spacing, so that triangles have no
    preferred direction; the fixed ones should be a spacing apart.

    Args:
        fixed: On the rim and on lines that must stay, shape (points, 2).
        spacing: Of the points [m].
        seed: Of the random numbers.
        inside: Which of some points, shape (points, 2), are in the region.
    """
    random = np.random.default_rng(seed)
    low, high = fixed.min(axis=0), fixed.max(axis=0)
    found, near = fixed, (0.8 * spacing) ** 2
    for _ in range(ROUNDS):
        thrown = low + (high - low) * random.random((int(np.prod(high - low) / spacing**2), 2))
        thrown = thrown[inside(thrown)]
        thrown = thrown[_squares(thrown, found).min(axis=1) > near]
        clash = np.tril(_squares(thrown, thrown) <= near, -1)
        kept = np.zeros(len(thrown), bool)
        for i, row in enumerate(clash):
            kept[i] = not (row & kept).any()
        found = np.concatenate([found, thrown[kept]])
    return found


def _squares(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Squares of distances, shape (a, b)."""
    return ((a[:, None] - b) ** 2).sum(axis=2)


def simulate(
    study: Study,
    points: np.ndarray,
    triangles: np.ndarray,
    *settings: str,
    depth: float,
    groups: Sequence[str] | None = None,
    sides: Mapping[str, ArrayLike] | None = None,
) -> Simulation:
    """A simulation of a plane mesh, extruded along y to wedges; the plane has axes x and z.

    Args:
        study: Of the problem; the mesh takes the place of the blocks of its case.
        points: [m], shape (points, 2).
        triangles: Counter-clockwise, shape (triangles, 3).
        settings: As for `Study.simulate`.
        depth: Along y, from 0 [m].
        groups: Name of each triangle's group; by default "rock".
        sides: By name of a surface, its edges, shape (edges, 2).
    """
    count, names = len(points), np.array(groups or ["rock"] * len(triangles))
    x = np.concatenate([np.insert(points, 1, y, axis=1) for y in (depth, 0.0)])
    cells = [("wedge", np.hstack([triangles, triangles + count]))]
    volumes, number_of = np.unique(names, return_inverse=True)
    tags = [number_of + 1]
    field_data = {str(name): np.array([number, 3]) for number, name in enumerate(volumes, 1)}
    for number, (name, edges) in enumerate((sides or {}).items(), 1):
        edges = np.asarray(edges)
        cells.append(("quad", np.hstack([edges, edges[:, ::-1] + count])))
        tags.append(np.full(len(edges), number))
        field_data[name] = np.array([number, 2])
    mesh = meshio.Mesh(x, cells, field_data=field_data,
                       cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags})  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plane.msh"
        meshio.write(path, mesh, "gmsh22", binary=False)
        return study.simulate("model.blocks=[]", f"model.mesh={path}", *settings)
