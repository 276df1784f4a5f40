"""Faces that lie flush with those of other blocks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.overlap import flush_faces
from cdem.mesh.topology import Ints, Topology
from cdem.model.faces import face_normals
from cdem.model.flat_arrays import ragged

FLUSH = 0.9
"""Cosine between the normals of faces of one wall of a joint."""


def flush_rows(t: Topology, kinds: NDArray[np.bool_]) -> tuple[Ints, Ints]:
    """Faces of other blocks that lie flush with each face, and their neighbours in the same wall.

    Args:
        t: Blocks and faces.
        kinds: Pairs of kinds of faces to include, (kinds, kinds).

    Returns:
        First row of each face, (faces + 1,), and the faces in the rows, ascending.
    """
    first, mate = flush_faces(t, kinds)
    face = np.repeat(np.arange(len(t.face_nodes)), np.diff(first))
    beside = flush_beside(t, face, mate.astype(np.intp))
    face, mate = np.concatenate([face, beside[0]]), np.concatenate([mate, beside[1]])
    order = np.lexsort((mate, face))
    return ragged(face[order], mate[order].astype(np.int32), len(t.face_nodes))


def flush_beside(
    t: Topology, face: NDArray[np.intp], mate: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Faces with the flush neighbours of their mates, which they reach when the joint slips.

    Args:
        t: Blocks and faces.
        face: Faces of the walls of joints, shape (pairs,).
        mate: The face that each lies on, the same shape.

    Returns:
        Faces and neighbours of their mates that are not mates of theirs.
    """
    if len(face) == 0:
        return face, mate
    walls = np.unique(face)
    nodes = t.face_nodes[walls]
    used = nodes >= 0
    owner = np.repeat(walls, used.sum(axis=1))
    first, at_node = ragged(nodes[used].astype(np.int64), owner, len(t.node_position))
    ends = t.face_nodes[mate]
    of, corner = np.nonzero(ends >= 0)
    node = ends[of, corner]
    count = np.diff(first)[node]
    place = np.repeat(np.cumsum(count) - count, count)
    beside = at_node[np.repeat(first[:-1][node], count) + np.arange(count.sum()) - place]
    of = np.repeat(of, count)
    normal = face_normals(t.node_position, t.face_nodes)
    flush = (normal[beside] * normal[mate[of]]).sum(axis=1) > FLUSH
    found = np.unique(np.stack([face[of[flush]], beside[flush]], axis=1), axis=0)
    faces = len(t.face_nodes)
    new = ~np.isin(found @ [faces, 1], face * faces + mate)
    return found[new, 0], found[new, 1]
