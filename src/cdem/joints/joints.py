"""Sets of joints: positions of their planes, and a model cut by them into blocks."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cdem.case.bodies_schema import Joint, Model
from cdem.errors import CaseError, MeshError
from cdem.joints.cell_mesh import close_short_edges, to_mesh
from cdem.joints.convex_cells import Cells, from_mesh, from_polyhedron, join
from cdem.joints.cutting import cut
from cdem.joints.directions import fisher, mean_normal
from cdem.joints.discs import Disc, cut_by_disc, draw_discs
from cdem.joints.snapping import onto_plane
from cdem.mesh.arrays import along
from cdem.mesh.blocks import block_labels
from cdem.mesh.element_shapes import NODES
from cdem.mesh.mesh import Mesh, drop_unused, merge

Floats = NDArray[np.float64]

THINNEST = 0.01
"""Least thickness of a part that a joint cuts off, over the smallest spacing."""
THINNEST_OF_ALL = 0.001
"""The same over the size of the body, if no set has a spacing."""
SHORTEST = 0.1
"""Edges shorter than this fraction of the least thickness are closed."""
MOST_BLOCKS = 3_000_000
"""More blocks than this, from sets with spacings, mean a mistake in the spacing."""
MOST_PLANES = 100_000
"""More planes than this in one set mean a mistake in the spacing."""


def planes(joint: Joint, points: Floats) -> Iterator[tuple[Floats, float, np.random.Generator]]:
    """The planes of a set that may meet a body.

    Plane k goes through the point ``k * spacing`` along the mean normal from the set's origin, and is
    rotated about it. Random values depend only on the set's name and seed and on k, so a larger
    body has the same joints.

    Args:
        joint: The set.
        points: Corners of the body [m], shape (points, 3).

    Yields:
        Unit normal, offset ``normal . x`` [m], and a generator for further random values.
    """
    mean = mean_normal(joint)
    reach = along(points - joint.origin, mean)
    low, high = reach.min(), reach.max()
    if joint.scatter is not None:  # planes rotated by up to 60 deg reach the body from this far
        high = 2 * np.linalg.norm(points - joint.origin, axis=1).max()
        low = -high
    numbers: Sequence[int] = [0]
    if joint.spacing is not None:
        count = (high - low) / joint.spacing
        if count > MOST_PLANES:
            raise CaseError(
                f"{count:.3g} planes may meet the bodies, which is too many; give a wider spacing "
                f"than "
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
    """Least thickness of parts cut off by joints [m]."""
    if model.thinnest is not None:
        return model.thinnest
    spacings = [joint.spacing for joint in model.joints if joint.spacing is not None]
    if spacings:
        return THINNEST * min(spacings)
    return THINNEST_OF_ALL * float(np.ptp(points, axis=0).max())


@dataclass
class Cutting:
    """State of cells being cut by sets.

    Attributes:
        c: The cells.
        of_plane: Name of the surface of each source of faces.
        bridges: Sources that are rock bridges.
        thin: Number of blocks left whole because a part would be too thin.
        discs: For each set with discs: number of discs, and number that meet a block.
        moved: Number of points of tets that moved onto a plane.
        way: How far at most [m].
    """

    c: Cells
    of_plane: list[str] = field(default_factory=list)
    bridges: list[int] = field(default_factory=list)
    thin: int = 0
    discs: dict[str, tuple[int, int]] = field(default_factory=dict)
    moved: int = 0
    way: float = 0.0


def cut_by_sets(
    c: Cells,
    sets: Sequence[Joint],
    group_names: Sequence[str],
    thinnest: float,
    files: Mapping[str, list[Disc]],
) -> Cutting:
    """Cut cells by all sets, one after the other.

    Args:
        c: The cells.
        sets: The sets, in order.
        group_names: Names by group number of the cells.
        thinnest: Least thickness of parts cut off [m].
        files: Discs of sets with a file, by name of the set.
    """
    done = Cutting(c)
    corners = c.points
    for joint in sets:
        among = np.array([joint.group in (None, name) for name in group_names])
        if joint.discs is not None:
            of_set = np.isin(c.cell[c.owner()], np.flatnonzero(among[c.group]))
            points = c.points[c.corner[of_set]]
            discs = files.get(joint.name) or draw_discs(joint, joint.discs, points)
            _cut_by_discs(done, joint, discs, among, thinnest)
            continue
        for normal, offset, random in planes(joint, corners):
            done.c, moved, way = onto_plane(done.c, normal, offset, among)
            done.moved, done.way = done.moved + moved, max(done.way, way)
            done.c, count = cut(
                done.c,
                normal,
                offset,
                len(done.of_plane),
                among=among,
                thinnest=thinnest,
                chance=random.random,
                persistence=joint.persistence,
            )
            done.of_plane.append(joint.name)
            done.thin += count
    return done


def _cut_by_discs(
    done: Cutting, joint: Joint, discs: list[Disc], among: NDArray[np.bool_], thinnest: float
) -> None:
    """Cut by the discs of a set: their faces have one source, rock bridges another."""
    of_joint = len(done.of_plane)
    done.of_plane += [joint.name, str(joint.bridges)]
    done.bridges.append(of_joint + 1)
    bridges, met = np.array(done.bridges), 0
    for disc in discs:
        done.c, meets, thin = cut_by_disc(
            done.c, disc, of_joint, bridges, among=among, thinnest=thinnest
        )
        met += meets
        done.thin += thin
    done.discs[joint.name] = (len(discs), met)


def cut_model(
    pieces: Sequence[tuple[Mesh, Sequence[Sequence[int]] | None]],
    model: Model,
    files: Mapping[str, list[Disc]] | None = None,
) -> Mesh:
    """Cut a model by its joints and mesh the blocks.

    Args:
        pieces: All meshes of the model in place; a polyhedron with the faces of its hull, which
            is then cut as one cell.
        model: Its joints.
        files: Discs of sets with a file, by name of the set.

    Returns:
        One mesh: groups without joints unchanged, all others as tets. Faces made by a set form a
        surface of its name.
    """
    names = list(dict.fromkeys(name for piece, _ in pieces for name in piece.group_names))
    jointed = set(names)
    if all(joint.group is not None for joint in model.joints):
        jointed = {str(joint.group) for joint in model.joints}
    surfaces = sorted({name for piece, _ in pieces for name in piece.surfaces})
    for name in model.joint_surfaces:
        if name in surfaces:
            raise CaseError(f"joint set {name!r} has the name of a surface of the mesh")
    parts, rest = [], []
    for piece, faces in pieces:
        inside, outside = _divide(piece, jointed)
        if outside.cells:
            rest.append(outside)
        if inside.cells:
            inside.surfaces = {name: piece.surfaces.get(name, []) for name in surfaces}
            parts.append(_cells_of(inside, faces, names, model))
    _refuse_too_many(model, parts)
    whole = merge([*rest, _cut_and_mesh(join(parts), model, names, surfaces, files or {})])
    _refuse_lost(whole, names)
    return whole


def _refuse_too_many(model: Model, parts: list[Cells]) -> None:
    """Refuse sets that would make too many blocks, before cutting.

    Raises:
        CaseError: Too many, judged by the volumes between the planes of the three densest sets.
    """
    points = np.concatenate([c.points for c in parts]) if parts else np.zeros((1, 3))
    counts = []
    for joint in model.joints:
        if joint.spacing is not None and joint.discs is None:
            reach = along(points, mean_normal(joint))
            counts.append((1 + joint.persistence * float(np.ptp(reach)) / joint.spacing, joint))
    densest = sorted(counts, key=lambda pair: -pair[0])[:3]
    blocks = float(np.prod([count for count, _ in densest]))
    if blocks > MOST_BLOCKS:
        spacings = ", ".join(f"{joint.name} {joint.spacing:g} m" for _, joint in densest)
        raise CaseError(
            f"these sets would cut the model into about {blocks:.2g} blocks (spacing of "
            f"{spacings}); the "
            f"limit is {MOST_BLOCKS:.0e}; give wider spacings, or a group to cut"
        )


def _refuse_lost(whole: Mesh, names: list[str]) -> None:
    """Refuse a model in which a group has vanished."""
    left = {whole.group_names[k] for groups in whole.cell_group.values() for k in np.unique(groups)}
    for name in names:
        if name not in left:
            raise MeshError(
                f"group {name!r} has vanished: its bodies are thinner than the least thickness of "
                f"parts "
                "(model.thinnest)"
            )


def _cells_of(
    piece: Mesh, faces: Sequence[Sequence[int]] | None, names: list[str], model: Model
) -> Cells:
    """Cells of a mesh, or the single cell of a polyhedron with these faces."""
    if faces is None:
        return from_mesh(piece, names, block_labels(piece, model.split))
    (group,) = piece.group_names
    used = 1 + max(max(face) for face in faces)
    return from_polyhedron(piece.points[:used], faces, names.index(group))


def _cut_and_mesh(
    c: Cells,
    model: Model,
    names: list[str],
    surfaces: list[str],
    files: Mapping[str, list[Disc]],
) -> Mesh:
    """Cut cells by all sets and mesh the result; notes report deviations from the sets."""
    thinnest = thinnest_of(model, c.points)
    done = cut_by_sets(c, model.joints, names, thinnest, files)
    whole = done.c.volumes().sum()
    c, closed = close_short_edges(done.c, SHORTEST * thinnest)
    made = to_mesh(c, names, surfaces, done.of_plane)
    made.discs = done.discs
    made.notes = _notes(done, closed, c.volumes().sum() / whole - 1, thinnest)
    for name in model.joint_surfaces:
        made.surfaces.setdefault(name, [])
    for joint in model.joints:
        if not any(len(part) for part in made.surfaces[joint.name]):
            made.notes.append(f"joint set {joint.name} makes no cut; {_look(joint)}")
    return made


def _look(joint: Joint) -> str:
    """Advice for a set that makes no cut."""
    if joint.discs is None:
        return "check its origin and group"
    return (
        "no centre of a face is in a disc: check its centres, radii and group, or use a finer mesh"
    )


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


def _notes(done: Cutting, closed: int, change: float, thinnest: float) -> list[str]:
    out = []
    if done.moved:
        out.append(
            f"joints: {done.moved:,} points of tets moved onto the planes that cut them, by up to "
            f"{done.way:.2g} m, so that the planes cut no slivers"
        )
    if done.thin:
        out.append(
            f"joints: {done.thin} cuts left out, since a part would be thinner than {thinnest:.3g} m "
            "(model.thinnest)"
        )
    if closed:
        out.append(
            f"joints: {closed} edges shorter than {SHORTEST * thinnest:.3g} m were closed; the volume "
            f"changed by a fraction of {change:.1e}"
        )
    return out
