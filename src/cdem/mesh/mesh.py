"""Points and cells with named groups; meshes placed and merged."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.arrays import found_in, lengths, matrix_product
from cdem.mesh.element_shapes import NODES

if TYPE_CHECKING:
    from cdem.case.bodies_schema import Rotate

Floats = NDArray[np.float64]


@dataclass
class Mesh:
    """Points and cells with named groups.

    Attributes:
        points: Positions [m], shape (points, 3).
        cells: By shape ("tet4", "pyramid5", "wedge6", "hex8"), point ids (cells, nodes).
        cell_group: By shape, index into `group_names`.
        group_names: Names of the groups of cells.
        surfaces: By name, arrays of point ids of triangles (faces, 3) or quadrilaterals (faces, 4).
        notes: Warnings of the reader.
        discs: By set of joints of discs: number of discs, and number of discs that meet a block.
    """

    points: Floats
    cells: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    cell_group: dict[str, NDArray[np.int32]] = field(default_factory=dict)
    group_names: list[str] = field(default_factory=list)
    surfaces: dict[str, list[NDArray[np.int64]]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    discs: dict[str, tuple[int, int]] = field(default_factory=dict)


def drop_unused(mesh: Mesh) -> Mesh:
    """Remove points that no volume element uses."""
    used = found_in(mesh.cells.values(), len(mesh.points))
    number = np.full(len(mesh.points), -1)
    number[used] = np.arange(len(used))
    mesh.points = mesh.points[used]
    mesh.cells = {s: number[c] for s, c in mesh.cells.items()}
    kept: dict[str, list] = {}
    for name, parts in mesh.surfaces.items():
        moved = [number[p] for p in parts]
        kept[name] = [m[(m >= 0).all(axis=1)] for m in moved]
    mesh.surfaces = kept
    return mesh


def place(
    mesh: Mesh, rotate: Rotate | None = None, translate: Sequence[float] | None = None
) -> Mesh:
    """Rotate about an axis (right-hand, degrees) through its origin, then translate [m]."""
    if rotate is not None:
        axis = np.asarray(rotate.axis, float)
        x, y, z = axis / lengths(axis)
        angle = np.radians(rotate.angle)
        k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        turn = np.eye(3) + math.sin(angle) * k + (1 - math.cos(angle)) * matrix_product(k, k)
        origin = np.zeros(3) if rotate.origin is None else np.asarray(rotate.origin, float)
        mesh.points = matrix_product(mesh.points - origin, turn.T) + origin
    if translate is not None:
        mesh.points = mesh.points + np.asarray(translate, float)
    return mesh


def merge(pieces: Sequence[Mesh]) -> Mesh:
    """All pieces in one mesh; points are not merged, but groups of the same name are."""
    names = list(dict.fromkeys(name for piece in pieces for name in piece.group_names))
    out = Mesh(np.concatenate([p.points for p in pieces]), group_names=names)
    start = np.cumsum([0] + [len(p.points) for p in pieces])
    for shape in NODES:
        some = [(p, s) for p, s in zip(pieces, start, strict=False) if shape in p.cells]
        if some:
            out.cells[shape] = np.concatenate([p.cells[shape] + s for p, s in some])
            out.cell_group[shape] = np.concatenate([_renumbered(p, shape, names) for p, _ in some])
    for piece, s in zip(pieces, start, strict=False):
        for name, parts in piece.surfaces.items():
            out.surfaces.setdefault(name, []).extend(part + s for part in parts)
        out.notes += piece.notes
        out.discs |= piece.discs
    return out


def _renumbered(piece: Mesh, shape: str, names: list[str]) -> NDArray[np.int32]:
    """Groups of the cells of one shape by their numbers among all names."""
    numbers = np.array([names.index(name) for name in piece.group_names], np.int32)
    return numbers[piece.cell_group[shape]]
