"""Sets of joints: where their planes lie, and a model cut by them into blocks."""

from __future__ import annotations

import math
import zlib
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from cdem.case.bodies_schema import Joint, Model
from cdem.errors import CaseError, MeshError
from cdem.joints.cell_mesh import close_short_edges, to_mesh
from cdem.joints.convex_cells import Cells, from_mesh, from_polyhedron, join
from cdem.joints.cutting import cut
from cdem.mesh.arrays import along
from cdem.mesh.blocks import block_labels
from cdem.mesh.element_shapes import NODES
from cdem.mesh.mesh import Mesh, drop_unused, merge

Floats = NDArray[np.float64]

THINNEST = 0.01
"""Least thickness of a part that a joint cuts off, over the smallest spacing."""
THINNEST_OF_ALL = 0.001
"""The same over the size of what is cut, where no set has a spacing."""
SHORTEST = 0.1
"""Edges shorter than this part of the least thickness are closed."""
MOST_PLANES = 100_000
"""More planes than this in one set are a slip of the spacing."""


def pole(dip: float, dip_direction: float) -> Floats:
    """Upward unit normal of a plane, x east, y north, z up.

    Args:
        dip: Steepest angle below the horizontal [deg].
        dip_direction: Where that steepest line points, clockwise from north [deg].

    Example:
        >>> pole(90, 90).round(12) + 0.0  # a wall that faces east
        array([1., 0., 0.])
    """
    dip, azimuth = np.radians(dip), np.radians(dip_direction)
    across = math.sin(dip)
    return np.array([across * math.sin(azimuth), across * math.cos(azimuth), math.cos(dip)])


def fisher(mean: Floats, concentration: float, random: np.random.Generator) -> Floats:
    """A unit vector of the Fisher distribution around a mean direction (Fisher 1953).

    Args:
        mean: Unit vector.
        concentration: kappa [1]; 63 % lie within 81 deg / sqrt(kappa) of the mean.
        random: Two numbers are drawn from it.
    """
    u, turn = random.random(), 2 * np.pi * random.random()
    cosine = 1 + math.log(u + (1 - u) * math.exp(-2 * concentration)) / concentration
    sine = np.sqrt(max(0.0, 1 - cosine**2))
    across = np.cross(mean, np.eye(3)[np.abs(mean).argmin()])
    across /= np.linalg.norm(across)
    return cosine * mean + sine * (
        math.cos(turn) * across + math.sin(turn) * np.cross(mean, across)
    )


def planes(joint: Joint, points: Floats) -> Iterator[tuple[Floats, float, np.random.Generator]]:
    """The planes of a set that may meet a body.

    Plane k goes through the point ``k * spacing`` along the mean normal from the set's origin, and is
    turned about it. What is random depends on the set's name and seed and on k alone, so a larger
    body has the same joints.

    Args:
        joint: The set.
        points: Corners of the body [m], shape (points, 3).

    Yields:
        Unit normal, offset ``normal . x`` [m], and a generator for what else is random.
    """
    if joint.dip is None or joint.dip_direction is None:
        mean = np.asarray(joint.normal, float)
    else:
        mean = pole(joint.dip, joint.dip_direction)
    mean = mean / np.linalg.norm(mean)
    reach = along(points - joint.origin, mean)
    low, high = reach.min(), reach.max()
    if joint.scatter is not None:  # planes turned by up to 60 deg reach the body from so far
        high = 2 * np.linalg.norm(points - joint.origin, axis=1).max()
        low = -high
    numbers: Sequence[int] = [0]
    if joint.spacing is not None:
        count = (high - low) / joint.spacing
        if count > MOST_PLANES:
            raise CaseError(
                f"{count:.3g} planes would have to be tried; give a wider spacing than "
                f"{joint.spacing:g} m, or with scatter an origin near the bodies"
            )
        numbers = range(int(np.ceil(low / joint.spacing)), int(np.floor(high / joint.spacing)) + 1)
    for k in numbers:
        random = np.random.default_rng(
            [joint.seed, zlib.crc32(joint.name.encode()), 2 * abs(k) + (k < 0)]
        )
        normal = mean if joint.scatter is None else fisher(mean, joint.scatter.fisher, random)
        through = joint.origin + k * (joint.spacing or 0.0) * mean
        yield normal, float((normal * through).sum()), random


def thinnest_of(model: Model, points: Floats) -> float:
    """Least thickness of what a joint cuts off [m]."""
    if model.thinnest is not None:
        return model.thinnest
    spacings = [joint.spacing for joint in model.joints if joint.spacing is not None]
    if spacings:
        return THINNEST * min(spacings)
    return THINNEST_OF_ALL * float(np.ptp(points, axis=0).max())


def cut_by_sets(
    c: Cells, sets: Sequence[Joint], group_names: Sequence[str], thinnest: float
) -> tuple[Cells, list[str], int]:
    """Cut cells by all sets, one after the other.

    Args:
        c: The cells.
        sets: The sets, in order.
        group_names: Names of the groups that the cells number.
        thinnest: Least thickness of what is cut off [m].

    Returns:
        The cells; the set of each plane, by name; and how often a block was left whole because
        a part would be too thin.
    """
    of_plane: list[str] = []
    thin = 0
    corners = c.points
    for joint in sets:
        among = np.array([joint.group in (None, name) for name in group_names])
        for normal, offset, random in planes(joint, corners):
            c, count = cut(
                c,
                normal,
                offset,
                len(of_plane),
                among=among,
                thinnest=thinnest,
                chance=random.random,
                persistence=joint.persistence,
            )
            of_plane.append(joint.name)
            thin += count
    return c, of_plane, thin


def cut_model(
    pieces: Sequence[tuple[Mesh, Sequence[Sequence[int]] | None]],
    model: Model,
) -> Mesh:
    """Cut a model by its joints and mesh the blocks.

    Args:
        pieces: Every mesh of the model in its place; with the faces of its hull if it is a
            polyhedron, which is then cut as one cell.
        model: Its joints.

    Returns:
        One mesh: what no set may cut as it was, all else as tets. Faces made by a set form a
        surface of its name.
    """
    names = list(dict.fromkeys(name for piece, _ in pieces for name in piece.group_names))
    jointed = set(names)
    if all(joint.group is not None for joint in model.joints):
        jointed = {str(joint.group) for joint in model.joints}
    surfaces = sorted({name for piece, _ in pieces for name in piece.surfaces})
    for joint in model.joints:
        if joint.name in surfaces:
            raise CaseError(f"joint set {joint.name!r} has the name of a surface of the mesh")
    parts, rest = [], []
    for piece, faces in pieces:
        inside, outside = _divide(piece, jointed)
        if outside.cells:
            rest.append(outside)
        if inside.cells:
            inside.surfaces = {name: piece.surfaces.get(name, []) for name in surfaces}
            parts.append(_cells_of(inside, faces, names, model))
    whole = merge([*rest, _cut_and_mesh(join(parts), model, names, surfaces)])
    _refuse_lost(whole, names)
    return whole


def _refuse_lost(whole: Mesh, names: list[str]) -> None:
    """Stop if nothing is left of a group."""
    left = {whole.group_names[k] for groups in whole.cell_group.values() for k in np.unique(groups)}
    for name in names:
        if name not in left:
            raise MeshError(
                f"nothing is left of group {name!r}: its bodies are thinner than what joints leave "
                "(model.thinnest)"
            )


def _cells_of(
    piece: Mesh, faces: Sequence[Sequence[int]] | None, names: list[str], model: Model
) -> Cells:
    """Cells of a mesh, or the one of a polyhedron with these faces."""
    if faces is None:
        return from_mesh(piece, names, block_labels(piece, model.split))
    (group,) = piece.group_names
    used = 1 + max(max(face) for face in faces)
    return from_polyhedron(piece.points[:used], faces, names.index(group))


def _cut_and_mesh(c: Cells, model: Model, names: list[str], surfaces: list[str]) -> Mesh:
    """Cut cells by all sets and mesh what that leaves; notes say what was not as the sets want it."""
    thinnest = thinnest_of(model, c.points)
    c, of_plane, thin = cut_by_sets(c, model.joints, names, thinnest)
    whole = c.volumes().sum()
    c, closed = close_short_edges(c, SHORTEST * thinnest)
    made = to_mesh(c, names, surfaces, of_plane)
    made.notes = _notes(thin, closed, c.volumes().sum() / whole - 1, thinnest)
    for joint in model.joints:
        made.surfaces.setdefault(joint.name, [])
        if not any(len(part) for part in made.surfaces[joint.name]):
            made.notes.append(f"joint set {joint.name} cuts nothing; look at its origin and group")
    return made


def _divide(piece: Mesh, jointed: set[str]) -> tuple[Mesh, Mesh]:
    """The cells of a mesh in jointed groups, and the others."""
    is_jointed = np.array([name in jointed for name in piece.group_names], bool)
    out = []
    for wanted in (True, False):
        some = {s: is_jointed[piece.cell_group[s]] == wanted for s in NODES if s in piece.cells}
        part = Mesh(
            piece.points,
            {s: piece.cells[s][rows] for s, rows in some.items() if rows.any()},
            {s: piece.cell_group[s][rows] for s, rows in some.items() if rows.any()},
            piece.group_names,
            dict(piece.surfaces),
            [] if wanted else piece.notes,
        )
        if not wanted and part.cells:
            part = drop_unused(part)
        out.append(part)
    return out[0], out[1]


def _notes(thin: int, closed: int, change: float, thinnest: float) -> list[str]:
    out = []
    if thin:
        out.append(
            f"joints: {thin} cuts left out, for they would make a part thinner than {thinnest:.3g} m "
            "(model.thinnest)"
        )
    if closed:
        out.append(
            f"joints: {closed} edges shorter than {SHORTEST * thinnest:.3g} m were closed; the volume "
            f"changed by {change:.1e} of it"
        )
    return out
