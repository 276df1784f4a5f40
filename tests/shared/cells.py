"""Cells for tests of the cutter, and what holds for all that it leaves."""

import numpy as np

from cdem.joints import convex_cells, cutting
from cdem.mesh import primitives
from cdem.mesh.blocks import block_labels

ALL = np.array([True])


def cube(size=2.0, divisions=(1, 1, 1), shape="hex8"):
    piece = primitives.box("rock", (size, size, size), divisions, shape=shape)
    return convex_cells.from_mesh(piece, ["rock"], block_labels(piece, {}))


def cut(c, planes, **more):
    for number, (normal, offset) in enumerate(planes):
        size = np.linalg.norm(normal)
        c, _ = cutting.cut(c, np.array(normal) / size, offset / size, number, among=ALL, **more)
    return c


def polygons(c):
    """Corner positions of every face."""
    return [c.points[c.corner[a:b]] for a, b in zip(c.first[:-1], c.first[1:], strict=True)]


def area_vector(x):
    return 0.5 * np.cross(x - x[0], np.roll(x, -1, axis=0) - x[0]).sum(axis=0)


def sides_that_are_single(c):
    """Directed edges of a cell whose reverse is not in the same cell exactly once."""
    a, b = c.corner, c.corner[c.following()]
    sides = list(zip(c.cell[c.owner()].tolist(), a.tolist(), b.tolist(), strict=True))
    reverse = {(k, v, u) for k, u, v in sides}
    return len(sides) - len(set(sides)), set(sides) ^ reverse
