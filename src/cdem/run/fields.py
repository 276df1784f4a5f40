"""Fields of a run as it is now: damage, pieces, stress, and the surface that carries them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.arrays import components
from cdem.model.interfaces import bonded_pairs, interfaces_of
from cdem.run.state import RunState


def surface_of(
    sim: RunState, points: dict[str, NDArray], elements: dict[str, NDArray]
) -> tuple[NDArray, NDArray, dict[str, NDArray], dict[str, NDArray]]:
    """Outer and broken faces now: positions, vertices of the faces (-1 after a triangle's), fields.

    Args:
        sim: The simulation.
        points: Fields on its nodes, to be carried over to the points of the surface.
        elements: Fields on its elements, to be carried over to their faces.
    """
    t = sim.build.topology
    faces, broken = visible_faces(sim)
    nodes = t.face_nodes[faces]
    used = np.unique(nodes[nodes >= 0])
    number = np.full(len(t.node_position) + 1, -1, np.int32)
    number[used] = np.arange(len(used))
    return (
        sim.fields["position"][used],
        number[nodes],
        {name: values[used] for name, values in points.items()},
        {
            "group": t.face_group[faces],
            "block": t.face_block[faces],
            **{name: values[t.face_element[faces]] for name, values in elements.items()},
            "broken": broken.astype(np.int8),
            "joint": (t.face_kind // len(t.group_names))[faces],  # 0: not made by a set of joints
        },
    )


def bonds_of(sim: RunState) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Bonded pairs of faces, shape (pairs, 2), and the part of each one's bond points that holds."""
    b = sim.build
    state = sim.core.fields()
    faces, intact = [], []
    for kind, points in (("triangles", 3), ("quads", 4)):
        pairs = b.assembly.counts[f"{kind}.count"]
        faces.append(b.assembly.pair_faces[kind])
        intact.append(state[f"{kind}.bond"].reshape(points, -1)[:, :pairs].mean(axis=0))
    if b.assembly.counts["overlaps.count"]:
        first = b.topology.overlap_first
        faces.append(b.topology.overlap_faces)
        intact.append(np.add.reduceat(state["overlaps.bond"], first[:-1]) / np.diff(first))
    return np.concatenate(faces), np.concatenate(intact)


def damage_of(sim: RunState) -> NDArray[np.float64]:
    """Broken part of the bonded faces of each element, 0 to 1, shapes one after the other."""
    t = sim.build.topology
    count = sum(len(e) for e in t.element_nodes.values())
    broken, total = np.zeros(count), np.zeros(count)
    faces, intact = bonds_of(sim)
    for side in range(2):
        element = t.face_element[faces[:, side]]
        np.add.at(broken, element, 1 - intact)
        np.add.at(total, element, 1.0)
    return broken / np.maximum(total, 1)


def pieces_of(sim: RunState) -> NDArray[np.int32]:
    """Piece of each element, shapes one after the other: the least block that it hangs together with.

    Blocks hang together through every pair of faces of which a bond point still holds, and whose
    interface has a strength: one whose cohesion and tension a stage has set to zero joins nothing.
    """
    t = sim.build.topology
    laws, interface = interfaces_of(sim.case, sim.build.group_names)
    faces, intact = bonds_of(sim)
    kinds = t.face_kind[faces]
    holds = (intact > 0) & bonded_pairs(laws, interface)[kinds[:, 0], kinds[:, 1]]
    a, b = t.face_block[faces[holds]].T
    piece = components(len(t.block_group), a, b)
    return piece[np.concatenate(list(t.element_block.values()))].astype(np.int32)


def stress_of(sim: RunState) -> NDArray[np.float64]:
    """Mean stress of each element [Pa], xx yy zz xy yz zx, shapes one after the other."""
    tables = sim.core.stress()
    counts = sim.build.assembly.counts
    rows = [tables[shape].reshape(6, -1)[:, : counts[f"{shape}.count"]].T for shape in tables]
    return np.concatenate(rows)


def visible_faces(sim: RunState) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Outer faces and those whose bonds are all broken; the second says which are the latter."""
    b = sim.build
    state = sim.core.fields()
    glued = np.zeros(len(b.topology.face_nodes), bool)
    bonded = glued.copy()
    for kind, points in (("triangles", 3), ("quads", 4)):
        pairs = b.assembly.counts[f"{kind}.count"]
        faces = b.assembly.pair_faces[kind]
        intact = state[f"{kind}.bond"].reshape(points, -1)[:, :pairs].any(axis=0)
        glued[faces[intact].ravel()] = True
        bonded[faces.ravel()] = True
    shown = np.flatnonzero(~glued)
    return shown, bonded[shown]
