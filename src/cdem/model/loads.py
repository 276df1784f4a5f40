"""Forces on nodes in fixed directions, gravity and initial velocities."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.mesh.topology import Topology
from cdem.model.boundaries import Boundaries, wave_forces
from cdem.model.curves import Curves, add_curve, add_record
from cdem.model.faces import face_areas
from cdem.model.flat_arrays import Assembly, Floats, ragged
from cdem.model.selection import select_faces
from cdem.rows import rows_of

if TYPE_CHECKING:
    from cdem._core import Core


def drop_gravity(case: Case, topology: Topology, names: list[str], parts: Assembly) -> None:
    """Remove the weight of groups without gravity."""
    groups = topology.block_group[topology.node_block]
    for name, group in case.groups.items():
        if not group.gravity:
            parts.arrays["node.gravity_mass"][groups == names.index(name)] = 0


def node_loads_of(
    case: Case, topology: Topology, names: list[str], curves: Curves, boundaries: Boundaries
) -> dict[str, NDArray]:
    """Nodal forces in fixed directions: tractions, forces of ended supports, and incoming waves.

    A traction gives each vertex of a loaded face its share of the area times the traction.
    """
    nodes: list[NDArray[np.integer]] = []
    forces, of_curve = [], []
    for index, item in enumerate(case.loads.tractions):
        faces = select_faces(case, topology, names, item.surface, f"loads.tractions.{index}")
        vertex = topology.face_nodes[faces]
        used = vertex >= 0
        area = face_areas(topology.node_position, vertex)
        share = np.broadcast_to((area / used.sum(axis=1))[:, None], vertex.shape)[used]
        nodes.append(vertex[used])
        forces.append(share[:, None] * np.asarray(item.traction, float))
        of_curve.append(np.full(used.sum(), add_curve(item.history, item.stage, curves), np.int32))
    count = len(topology.node_position)
    if boundaries.places:
        nodes.append(boundaries.nodes)
        forces.append(boundaries.kept[boundaries.nodes])
        of_curve.append(np.zeros(len(boundaries.nodes), np.int32))
    for place in boundaries.places:
        for given in place.boundary.inputs:
            if given.kind == "compliant":
                shaken, force = wave_forces(case, topology, place, given)
                nodes.append(shaken)
                forces.append(force)
                number = add_record(case.processed(given.record), place.boundary.stage, curves)
                of_curve.append(np.full(len(shaken), number, np.int32))
    if not nodes:
        return {
            "load.first": np.zeros(count + 1, np.int32),
            "load.curve": np.zeros(0, np.int32),
            "load.force": np.zeros(0),
        }
    owner, force = np.concatenate(nodes), np.concatenate(forces)
    first, curve = ragged(owner, np.concatenate(of_curve), count)
    _, force = ragged(owner, force, count)
    rows = np.zeros((len(force), 4))
    rows[:, :3] = force
    return {"load.first": first, "load.curve": curve, "load.force": rows.ravel()}


def set_velocities(
    case: Case, topology: Topology, names: list[str], mass: Floats, velocity: Floats
) -> None:
    """Write the initial velocities of the groups.

    Args:
        case: The case.
        topology: The model, at its start.
        names: Names of the groups, by index.
        mass: Mass of each node [kg].
        velocity: Velocity of each node [m/s], shape (nodes, 3); is changed.
    """
    groups = topology.block_group[topology.node_block]
    for name, group in case.groups.items():
        nodes = np.flatnonzero(groups == names.index(name))
        x = topology.node_position[nodes]
        center = (mass[nodes, None] * x).sum(axis=0) / mass[nodes].sum()
        spin = np.cross(np.asarray(group.angular_velocity, float), x - center)
        velocity[nodes] = np.asarray(group.velocity, float) + spin


def start_on_supports(core: Core, curves: Curves, velocity: Floats) -> NDArray[np.bool_]:
    """Let supported components start with the velocity of their support, without a jolt.

    Args:
        core: The compiled core.
        curves: Curves of the model.
        velocity: Velocity of each node [m/s], shape (nodes, 3); is changed.

    Returns:
        Nodes that had another nonzero velocity of their own, shape (nodes,).
    """
    support = core.model()["support.row"]
    nodes = np.flatnonzero(support >= 0)
    component, speed, curve = (
        rows_of(core, f"support.{key}").numbers[support[nodes]]
        for key in ("component", "velocity", "curve")
    )
    given = component.astype(bool)
    driven = speed * np.array([one.at_start for one in curves])[curve]
    own = velocity[nodes]
    lost = np.zeros(len(velocity), bool)
    lost[nodes] = (given & (own != 0) & (own != driven)).any(axis=1)
    velocity[nodes] = np.where(given, driven, own)
    return lost
