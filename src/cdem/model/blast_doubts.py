"""Holes of blasts: faces around them, quiet faces nearby, the rise of the pressure in their mesh."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cdem.case.blast_checks import begun_stages
from cdem.case.blasts_schema import Blast
from cdem.errors import CaseError
from cdem.mesh.arrays import lengths
from cdem.mesh.topology import Topology
from cdem.model.blasts import face_middles
from cdem.model.build import Build
from cdem.model.faces import face_normals
from cdem.model.selection import select_faces
from cdem.model.wave_mesh import moving_axes

LEAST_AROUND, FEW_AROUND = 8, 12
"""Faces around a hole below which a blast is refused, and below which the audit warns."""
FLAT = 1.0
"""Angle between two faces that are not around a hole [deg]."""
QUIET_RADII = 10.0
"""Distance of quiet faces from a hole, in its radii, below which the audit warns."""
PER_RISE = 10.0
"""Elements in the way of an S wave during the rise, below which the audit warns."""
UNLIKE = 0.2
"""Part by which the diameter of a hole may differ from that of its explosive in silence."""
COMPARED = 500
"""Most faces of a hole that are compared with quiet faces."""


def blast_doubts(build: Build) -> Iterator[str]:
    """Warnings of the audit about the holes of blasts.

    Raises:
        CaseError: A hole has too few faces around it.
    """
    t = build.topology
    quiet = [
        select_faces(build.case, t, build.group_names, item.surface, ".".join(map(str, keys)))
        for keys, item in build.case.surface_entries
        if item.law == "quiet"
    ]
    for number, blast in enumerate(build.case.loads.blasts):
        path = f"loads.blasts.{number}"
        faces = select_faces(build.case, t, build.group_names, blast.surface, path)
        where = f"{build.case.where(path)}: {path}"
        _refuse_absent(where, build, faces, blast)
        angle, radius = bend(t, faces)
        if angle:
            yield from _few_faces(where, 360 / angle)
            yield from _near_quiet(where, t, faces, radius, quiet)
            yield from _other_hole(where, blast, radius)
        yield from _far_begin(where, t, faces, blast)
        yield from _fast_rise(where, build, faces, blast)


def bend(t: Topology, faces: NDArray[np.intp]) -> tuple[float, float]:
    """Angle between neighbours around a hole [deg], and its radius [m]; zeros for plane faces.

    Of each face the smallest angle to a neighbour that is not flat with it, and of these the
    median: faces along the hole and at its end do not count.
    """
    place = t.node_place[t.face_nodes[faces]]
    place = np.where(t.face_nodes[faces] < 0, -1, place)
    sides = []
    for k in range(4):
        a, b = place[:, k], place[:, (k + 1) % 4]
        b = np.where(b < 0, place[:, 0], b)
        some = (a >= 0) & (a != b)
        sides.append(np.column_stack([a, b, np.arange(len(faces))])[some])
    edge = np.concatenate(sides)
    edge[:, :2].sort(axis=1)
    edge = edge[np.lexsort(edge.T[::-1])]
    twice = (edge[:-1, :2] == edge[1:, :2]).all(axis=1)
    one, other = edge[:-1][twice, 2], edge[1:][twice, 2]
    normal = face_normals(t.node_position, t.face_nodes[faces])
    cosine = np.clip((normal[one] * normal[other]).sum(axis=1), -1, 1)
    angle = np.degrees(np.arccos(cosine))
    middle = face_middles(t, faces)
    radius = (
        0.5 * lengths(middle[one] - middle[other]) / np.sin(np.radians(np.maximum(angle, FLAT)) / 2)
    )
    bent = angle > FLAT
    if not bent.any():
        return 0.0, 0.0
    one, other, angle, radius = (x[bent] for x in (one, other, angle, radius))
    least = np.full(len(faces), np.inf)
    for side in (one, other):
        np.minimum.at(least, side, angle)
    around = float(np.median(least[np.isfinite(least)]))
    return around, float(np.median(radius[angle <= 1.5 * around]))


def _refuse_absent(where: str, build: Build, faces: NDArray[np.intp], blast: Blast) -> None:
    begun = begun_stages(build.case, blast)
    present = {build.group_names[g] for g in np.unique(build.topology.face_group[faces])}
    if gone := sorted(present & set(build.case.absent(begun))):
        raise CaseError(
            f"{where}: the wall is of {', '.join(gone)}, not present in the stage "
            f"{build.case.stages[begun - 1].name}; give the blast a stage in which the rock is there"
        )


def _other_hole(where: str, blast: Blast, radius: float) -> Iterator[str]:
    if blast.explosive is None:
        return
    hole = blast.explosive.hole
    if abs(2 * radius / hole - 1) > UNLIKE:
        yield (
            f"{where}: explosive.hole is {hole:.3g} m, and the hole in the mesh has a diameter of about "
            f"{2 * radius:.3g} m; correct one of them, the peak and the waves depend on both"
        )


def _far_begin(where: str, t: Topology, faces: NDArray[np.intp], blast: Blast) -> Iterator[str]:
    if blast.detonation is None:
        return
    middle = face_middles(t, faces)
    away = lengths(middle - np.array(getattr(blast.detonation, "from")))
    size = float(np.linalg.norm(np.ptp(middle, axis=0)))
    if away.min() > size:
        yield (
            f"{where}: the detonation begins {away.min():.3g} m from the hole and reaches it "
            f"{away.min() / blast.detonation.speed:.3g} s after the delay; give detonation.from a point of "
            "the hole"
        )


def _few_faces(where: str, around: float) -> Iterator[str]:
    count = round(around)
    if count < LEAST_AROUND:
        raise CaseError(
            f"{where}: the hole has about {count} faces around it; a blast needs at least {LEAST_AROUND}, "
            f"better {FEW_AROUND}: mesh it finer there"
        )
    if count < FEW_AROUND:
        yield (
            f"{where}: the hole has about {count} faces around it; with fewer than {FEW_AROUND} its waves "
            "are uneven: mesh it finer there"
        )


def _near_quiet(
    where: str, t: Topology, faces: NDArray[np.intp], radius: float, quiet: list[NDArray[np.intp]]
) -> Iterator[str]:
    if not quiet:
        return
    far = face_middles(t, np.concatenate(quiet))
    some = face_middles(t, faces[:: max(1, len(faces) // COMPARED)])
    nearest = min(float(lengths(far - point).min()) for point in some) + radius
    if nearest < QUIET_RADII * radius:
        yield (
            f"{where}: a quiet surface is {nearest:.3g} m from the axis of the hole, "
            f"{nearest / radius:.2g} of its radii; move it to at least {QUIET_RADII:g} radii, "
            f"{QUIET_RADII * radius:.3g} m"
        )


def _fast_rise(where: str, build: Build, faces: NDArray[np.intp], blast: Blast) -> Iterator[str]:
    t = build.topology
    nodes = t.face_nodes[faces]
    last = np.where(nodes < 0, nodes[:, 2:3], nodes)
    group = build.case.groups[build.group_names[t.face_group[faces[0]]]]
    x = t.node_position[last] * moving_axes(group)
    edge = max(float(lengths(x[:, k] - x[:, (k + 1) % 4]).max()) for k in range(4))
    rock = build.case.materials[group.material]
    shear = rock.young_modulus / (2 * (1 + rock.poisson_ratio))
    rise = 1 / (np.pi * blast.highest_frequency)
    way = float(np.sqrt(shear / rock.density)) * rise
    if way < PER_RISE * edge:
        yield (
            f"{where}: while its pressure rises, in {rise:.3g} s, an S wave runs {way:.3g} m, "
            f"{way / edge:.2g} elements at the hole; {PER_RISE:g} are needed: mesh the hole with faces of "
            f"{way / PER_RISE:.2g} m, or let the pressure rise in {PER_RISE * edge / way * rise:.3g} s"
        )
