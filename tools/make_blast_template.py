"""Make src/cdem/templates/blast.msh: a bench seen from above, with two holes and two sets of joints.

Run it after changing a number here: ``python tools/make_blast_template.py``. The mesh is the same on
every run: one layer of wedges, whose edges follow the joints. Neighbouring blocks are in different
ones of the groups `a`, `b`, `c`, `d`; surfaces `hole1`, `hole2` are the walls of the holes, `far` are
the sides where the rock goes on.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import meshio
import numpy as np

from cdem.verification.plane import delaunay

SIZE = (14.0, 9.0)  # along the bench, and from its face back [m]
HOLES = ((5.0, 3.0), (9.0, 3.0))
RADIUS, AROUND = 0.15, 16  # of a hole [m]; faces around it
FINE, COARSE, GROWTH = 0.07, 0.42, 0.25  # sizes of triangles [m]; their growth with the distance
ACROSS = (2.4, 6.4, 10.2)  # where joints of one set meet the face of the bench [m]
LEAN = 0.2  # of these joints, along the bench for each metre back
BACK = (3.0, 6.0)  # distances of the other joints from the face; the first meets the holes [m]
LAYER = 0.3  # thickness [m]
OUTPUT = Path(__file__).parents[1] / "src/cdem/templates/blast.msh"


def size_at(points: np.ndarray) -> np.ndarray:
    """Size of triangles at points [m]."""
    away = np.min([np.hypot(*(points - hole).T) for hole in HOLES], axis=0) - RADIUS
    return np.clip(FINE + GROWTH * away, FINE, COARSE)


def line(start, end) -> np.ndarray:
    """Points from start to end, as far apart as triangles are large there."""
    start, end = np.array(start), np.array(end)
    length = np.linalg.norm(end - start)
    fine = start + (end - start) * np.linspace(0, 1, 2001)[:, None]
    count = np.concatenate([[0], np.cumsum(length / 2000 / size_at(fine[1:]))])
    cells = max(1, round(count[-1]))
    part = np.interp(np.linspace(0, count[-1], cells + 1), count, np.linspace(0, 1, 2001))
    return start + (end - start) * part[:, None]


def fixed_points() -> np.ndarray:
    """Points of the rim, the joints and the holes."""
    width, depth = SIZE
    rows = [0.0, *BACK, depth]
    grid = np.array([[(0, y), *((x + LEAN * y, y) for x in ACROSS), (width, y)] for y in rows])
    lines = [line(a, b) for row in grid for a, b in itertools.pairwise(row)]
    lines += [
        line(a, b) for a, b in zip(grid[:-1].reshape(-1, 2), grid[1:].reshape(-1, 2), strict=True)
    ]
    points = np.concatenate(lines)
    points = points[
        np.min([np.hypot(*(points - hole).T) for hole in HOLES], axis=0) > RADIUS + 0.5 * FINE
    ]
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    circle = RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    return np.unique(
        np.concatenate([points, *(hole + circle for hole in np.array(HOLES))]).round(9), axis=0
    )


def filled(fixed: np.ndarray) -> np.ndarray:
    """The fixed points, and points at random between them, 0.8 of the local size apart."""
    random = np.random.default_rng(1)
    found = fixed
    for _ in range(40):
        for point in random.random((1500, 2)) * SIZE:
            if np.min([np.hypot(*(point - hole)) for hole in HOLES]) < RADIUS:
                continue
            if np.hypot(*(found - point).T).min() > 0.8 * size_at(point[None])[0]:
                found = np.vstack([found, point])
    return found


def main() -> None:
    """Write the mesh."""
    points = filled(fixed_points())
    triangles = delaunay(points)
    middle = points[triangles].mean(axis=1)
    inside = np.min([np.hypot(*(middle - hole).T) for hole in HOLES], axis=0) > RADIUS * 0.97
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    triangles = triangles[inside & (area > 1e-6)]
    middle = points[triangles].mean(axis=1)
    strip = np.sum([middle[:, 0] - LEAN * middle[:, 1] > foot for foot in ACROSS], axis=0)
    row = np.sum([middle[:, 1] > y for y in BACK], axis=0)
    group = 2 * (row % 2) + strip % 2
    sides = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    _, first, count = np.unique(
        np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True
    )
    rim = sides[first[count == 1]]
    at = points[rim].mean(axis=1)
    near = [np.hypot(*(at - hole).T) < 2 * RADIUS for hole in HOLES]
    far = (at[:, 0] < 1e-6) | (at[:, 0] > SIZE[0] - 1e-6) | (at[:, 1] > SIZE[1] - 1e-6)
    n = len(points)
    cells = [np.hstack([triangles, triangles + n])[group == k] for k in range(4)]
    faces = [
        np.hstack([some, some[:, ::-1] + n]) for some in (rim[near[0]], rim[near[1]], rim[far])
    ]
    names = ["a", "b", "c", "d", "hole1", "hole2", "far"]
    tags = [np.full(len(some), k + 1) for k, some in enumerate([*cells, *faces])]
    mesh = meshio.Mesh(
        np.vstack([np.column_stack([points, np.full(n, z)]) for z in (0.0, LAYER)]).round(6),
        [*(("wedge", some) for some in cells), *(("quad", some) for some in faces)],
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array([k + 1, 3 if k < 4 else 2]) for k, name in enumerate(names)},
    )
    meshio.write(OUTPUT, mesh, "gmsh22", binary=False, float_fmt=".6g")
    print(f"{OUTPUT}: {n} points in the plane, {len(triangles)} wedges")


if __name__ == "__main__":
    main()
