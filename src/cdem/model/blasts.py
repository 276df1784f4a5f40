"""Faces of blasts, and the time at which a detonation reaches them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.blasts_schema import RINGS, Ring
from cdem.case.case import Case
from cdem.mesh.arrays import lengths
from cdem.mesh.topology import Topology
from cdem.model.faces import Floats, face_areas
from cdem.model.selection import select_faces


def faces_of(
    case: Case, t: Topology, names: list[str], keys: tuple[str | int, ...], item: Any
) -> tuple[NDArray[np.intp], Any]:
    """Faces of an entry of surface laws, and its history: for a ring its own faces and time.

    Args:
        case: The case.
        t: Blocks and faces.
        names: Names of the groups, by index.
        keys: Place of the entry in the case.
        item: The entry.
    """
    faces = select_faces(case, t, names, item.surface, ".".join(map(str, keys)))
    if item.ring is None:
        return faces, item.history
    faces, late = ring_of(t, faces, item.ring)
    return faces, [(time + late, factor) for time, factor in item.history]


def ring_of(t: Topology, faces: NDArray[np.intp], ring: Ring) -> tuple[NDArray[np.intp], float]:
    """Faces of a hole in a ring, and the time that the detonation takes to their middle [s]."""
    away = lengths(face_middles(t, faces) - np.array(ring.begin))
    low, high = away.min(), away.max()
    width = (high - low) / RINGS or 1.0
    own = np.minimum(((away - low) / width).astype(int), RINGS - 1) == ring.number
    if not own.any():
        return faces[own], 0.0
    area = face_areas(t.node_position, t.face_nodes[faces[own]])
    return faces[own], float(np.average(away[own], weights=area)) / ring.speed


def face_middles(t: Topology, faces: NDArray[np.intp]) -> Floats:
    """Mean of the vertices of faces [m], shape (faces, 3)."""
    nodes = t.face_nodes[faces]
    used = (nodes >= 0)[..., None]
    return (t.node_position[nodes] * used).sum(axis=1) / used.sum(axis=1)
