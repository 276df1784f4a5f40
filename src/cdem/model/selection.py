"""Nodes and faces of an entry of loads: by group, surface, point or box."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.errors import CaseError
from cdem.mesh.topology import Topology
from cdem.model.faces import face_normals

LOOKS_ALONG = 1e-3
"""A face has a given direction if its normal is within about 2.5 degrees."""


def select_nodes(
    case: Case, topology: Topology, names: list[str], item: Any, path: str
) -> NDArray[np.intp]:
    """Nodes of an entry of loads: by group, surface, point or box."""
    position = topology.node_position
    groups = topology.block_group[topology.node_block]
    among = np.ones(len(position), bool)
    if getattr(item, "group", None) is not None:
        if item.group not in names:
            raise CaseError(
                f"{case.where(path + '.group')}: {path}.group: no group {item.group!r} in the "
                f"model; it has: {', '.join(names)}"
            )
        among = groups == names.index(item.group)
    if getattr(item, "surface", None) is not None:
        faces = select_faces(case, topology, names, item.surface, path)
        inside = np.zeros(len(position), bool)
        nodes = topology.face_nodes[faces].ravel()
        inside[nodes[nodes >= 0]] = True
        among &= inside
    if getattr(item, "box", None) is not None:
        among &= ((position >= item.box.min) & (position <= item.box.max)).all(axis=1)
    if getattr(item, "point", None) is not None:
        candidates = np.flatnonzero(among)
        distance = np.linalg.norm(position[candidates] - item.point, axis=1)
        # all nodes at that point: each touching block has one
        among = np.zeros(len(position), bool)
        among[candidates[distance <= distance.min() * (1 + 1e-9) + 1e-12]] = True
    if not among.any():
        raise CaseError(f"{case.where(path)}: {path}: selects no nodes; check its coordinates")
    return np.flatnonzero(among)


def select_faces(
    case: Case, topology: Topology, names: list[str], surface: Any, path: str
) -> NDArray[np.intp]:
    """Exterior faces of a surface by name, or of a group with a given normal."""
    path += ".surface"
    if isinstance(surface, str):
        if surface not in topology.surfaces:
            known = ", ".join(sorted(topology.surfaces)) or "none"
            raise CaseError(
                f"{case.where(path)}: {path}: no surface {surface!r} in the model; it has: {known}"
            )
        return topology.surfaces[surface]
    for group in surface.groups:
        if group not in names:
            raise CaseError(
                f"{case.where(path)}: {path}.group: no group {group!r} in the model; it has: "
                f"{', '.join(names)}"
            )
    free = np.isin(topology.face_group, [names.index(group) for group in surface.groups])
    free[topology.pair_faces.ravel()] = False  # faces touching another block are inside the rock
    faces = np.flatnonzero(free)
    normal = face_normals(topology.node_position, topology.face_nodes[faces])
    wanted = np.asarray(surface.normal, float)
    faces = faces[normal @ (wanted / np.linalg.norm(wanted)) > 1 - LOOKS_ALONG]
    if len(faces) == 0:
        raise CaseError(f"{case.where(path)}: {path}: no free face of the group has this normal")
    return faces
