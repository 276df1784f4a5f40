"""Straight paths through the elements of a mesh: elements on the path, with the start and end in each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.mesh import element_shapes
from cdem.mesh.arrays import along, lengths, matrix_product
from cdem.mesh.topology import Topology

Floats = NDArray[np.float64]

NEWTON_STEPS = 30


@dataclass(frozen=True)
class Pass:
    """A part of a path in one element.

    Attributes:
        first: Its start along the path [m].
        last: Its end [m].
        shape: Shape of the element.
        element: Number of the element within its shape.
        block: Block of the element.
        group: The group of the block.
    """

    first: float
    last: float
    shape: str
    element: int
    block: int
    group: int


def passes(t: Topology, start: Floats, end: Floats, from_: float = 0.0) -> list[Pass]:
    """Elements on a straight path, unordered; faces are taken as planes.

    Args:
        t: Blocks and elements.
        start: Start of the path [m].
        end: End of the path [m].
        from_: Length of the path before `start`, added to the results [m].
    """
    length = float(lengths(end - start))
    way = (end - start) / length
    found = []
    for shape, faces in element_shapes.FACES.items():
        nodes = t.element_nodes[shape]
        if not len(nodes):
            continue
        near = _near(t.node_position[nodes], start, end)
        corners = t.node_position[nodes[near]]
        low, high = np.zeros(len(near)), np.full(len(near), length)
        for face in faces:
            x = corners[:, face]
            normal = np.cross(x[:, 2] - x[:, 0], x[:, -1] - x[:, 1])
            outside = np.einsum("ex,ex->e", normal, start - x.mean(axis=1))
            rate = along(normal, way)
            with np.errstate(divide="ignore", invalid="ignore"):
                at = -outside / rate
            leaves, enters = rate > 0, rate < 0
            high = np.where(leaves, np.minimum(high, at), high)
            low = np.where(enters, np.maximum(low, at), low)
            size = np.linalg.norm(normal, axis=1)
            high = np.where((rate == 0) & (outside > 1e-9 * size * length), -1.0, high)
        for k in np.flatnonzero(high > low):
            e = int(near[k])
            block = int(t.element_block[shape][e])
            group = int(t.element_group[shape][e])
            found.append(Pass(from_ + low[k], from_ + high[k], shape, e, block, group))
    return found


def _near(corners: Floats, start: Floats, end: Floats) -> NDArray[np.intp]:
    """Elements whose box meets that of the path."""
    low, high = np.minimum(start, end), np.maximum(start, end)
    slack = 1e-6 * np.linalg.norm(end - start)
    meets = (corners.min(axis=1) <= high + slack) & (corners.max(axis=1) >= low - slack)
    return np.flatnonzero(meets.all(axis=1))


def walk(found: list[Pass], length: float, slack: float) -> Iterator[Pass]:
    """Order the parts of a path so that each begins at the end of the one before, or after a gap.

    If several elements share a part, the path stays in its block, and in the element that leads
    farthest.
    """
    at, block = 0.0, -1
    left = sorted(found, key=lambda p: (p.first, p.shape, p.element))
    while at < length - slack:
        here = [p for p in left if p.first <= at + slack and p.last > at + slack]
        if not here:
            later = [p.first for p in left if p.first > at]
            if not later:
                return
            at = min(later)
            continue
        stays = [p for p in here if p.block == block] or here
        best = max(stays, key=lambda p: (p.last, -p.element))
        yield Pass(at, min(best.last, length), best.shape, best.element, best.block, best.group)
        at, block = best.last, best.block


def weights_in(t: Topology, shape: str, element: int, place: Floats) -> tuple[Floats, Floats]:
    """Nodes of an element, and the weights that give a position in it [m]."""
    nodes = t.element_nodes[shape][element]
    corners = t.node_position[nodes]
    local = np.full(3, 0.25) if shape in ("tet4", "pyramid5") else np.full(3, 0.0)
    if shape == "wedge6":
        local = np.array([1 / 3, 1 / 3, 0.0])
    values = np.zeros(len(nodes))
    for _ in range(NEWTON_STEPS):
        values, slopes = (a[0] for a in element_shapes.shape_functions(shape, local[None]))
        off = place - along(corners.T, values)
        change = _solved(matrix_product(slopes.T, corners), off)
        local = local + change
        if shape == "pyramid5":
            local[2] = min(local[2], 1 - 1e-9)
        if np.abs(change).max() < 1e-14:
            break
    return nodes, values


def _solved(rows: Floats, off: Floats) -> Floats:
    """Coordinates of a position in terms of three vectors; LAPACK's bits depend on the CPU."""
    across = np.cross(rows[[1, 2, 0]], rows[[2, 0, 1]])
    return along(across, off) / along(rows[0], across[0])
