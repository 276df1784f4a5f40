"""Charges of blasts: places of their holes, lengths, and masses of explosive."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.topology import Topology
from cdem.model.blasts import face_middles
from cdem.model.build import Build
from cdem.model.faces import Floats, face_areas, face_normals
from cdem.model.selection import select_faces

FLAT = 1e-6
"""Largest difference of normals of a flat wall, along any axis."""
ACROSS, ALONG = 0.3, 0.9
"""Cosine between a normal and the axis of a hole: below the first for its wall, above the second for
its ends."""
ROUND = 0.9
"""Part of the area that must be wall or end of a hole, else the faces are a chamber."""


@dataclass(frozen=True)
class Charge:
    """The charge of one hole of a blast.

    Attributes:
        hole: Name of the surface, or place of the blast in the case.
        stage: Stage in which it goes off.
        ends: Ends of the axis of the hole [m]; both are the middle of a chamber or of a flat wall.
        mass: Mass of the explosive [kg]; None for a chamber, a flat wall, or an unknown explosive.
    """

    hole: str
    stage: str
    ends: tuple[list[float], list[float]]
    mass: float | None

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def charges(build: Build) -> list[Charge]:
    """Charges of all blasts, those of one surface apart."""
    t, case = build.topology, build.case
    found = []
    for i, blast in enumerate(case.loads.blasts):
        path = f"loads.blasts.{i}"
        faces = select_faces(case, t, build.group_names, blast.surface, path)
        name = blast.surface if isinstance(blast.surface, str) else path
        for one in apart(t, faces):
            low, high = axis_of(t, one)
            length = math.dist(low, high)
            mass = blast.explosive.mass(length) if blast.explosive and length > 0 else None
            stage = blast.stage or case.stages[0].name
            found.append(Charge(name, stage, (low.tolist(), high.tolist()), mass))
    return found


def apart(t: Topology, faces: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Faces that share no vertex with others, each set alone."""
    places = t.node_place[t.face_nodes[faces]]
    places = np.where(t.face_nodes[faces] < 0, places[:, :1], places)
    nodes = np.unique(places, return_inverse=True)[1].reshape(places.shape)
    least = np.arange(nodes.max() + 1)  # number of the set of each vertex
    while True:
        before = least.copy()
        np.minimum.at(least, nodes, least[nodes].min(axis=1)[:, None])
        least = least[least]
        if (least == before).all():
            break
    mine = least[nodes[:, 0]]
    return [faces[mine == number] for number in np.unique(mine)]


def axis_of(t: Topology, faces: NDArray[np.intp]) -> tuple[Floats, Floats]:
    """Ends of the axis of a hole [m]; twice the middle of a chamber or of a flat wall.

    Normals of the wall meet the axis at one distance, which follows from all faces by least squares.
    So a half or a quarter of a hole in planes of symmetry has the axis of the whole.
    """
    normal = face_normals(t.node_position, t.face_nodes[faces])
    area = face_areas(t.node_position, t.face_nodes[faces])
    middle = face_middles(t, faces)
    if np.ptp(normal, axis=0).max() < FLAT:
        place = np.average(middle, axis=0, weights=area)
        return place, place
    axis = np.linalg.svd(normal * np.sqrt(area)[:, None])[2][2]
    cosine = np.abs(normal @ axis)
    wall = cosine < ACROSS
    if area[wall | (cosine > ALONG)].sum() < ROUND * area.sum():
        place = _meeting_place(normal, middle, area)
        return place, place
    flat = np.eye(3) - np.outer(axis, axis)
    place = _meeting_place(normal[wall] @ flat, middle[wall] @ flat, area[wall])
    nodes = t.face_nodes[faces[wall]]
    along = t.node_position[nodes[nodes >= 0]] @ axis
    return place + along.min() * axis, place + along.max() * axis


def _meeting_place(normal: Floats, middle: Floats, area: Floats) -> Floats:
    """Point that lies on the normals of all faces at one distance from them, by least squares [m]."""
    mean_normal, mean_middle = (np.average(x, axis=0, weights=area) for x in (normal, middle))
    bent, moved = normal - mean_normal, middle - mean_middle
    square = np.average((bent * bent).sum(axis=1), weights=area)
    radius = -np.average((bent * moved).sum(axis=1), weights=area) / square
    return mean_middle + radius * mean_normal


def charge_lines(found: Sequence[Charge]) -> list[str]:
    """Lines of the audit."""
    lines = [""] * bool(found)
    for one in found:
        low, high = (", ".join(f"{x:.4g}" for x in end) for end in one.ends)
        length = math.dist(*one.ends)
        place = f"hole {length:.4g} m long, from {low} to {high}" if length else f"charge at {low}"
        mass = "" if one.mass is None else f", {one.mass:.4g} kg of explosive"
        lines.append(f"  {one.hole}: {place}{mass}")
    return lines
