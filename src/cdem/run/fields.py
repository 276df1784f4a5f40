"""Present fields of a run: damage, pieces, stress, and the surface with its values."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cdem.case.laws import STATES
from cdem.case.output_fields import OUTPUT_FIELDS, OutputField
from cdem.mesh.arrays import components
from cdem.model.interfaces import bonded_pairs, interfaces_of
from cdem.model.wetted import face_pressures, signed_pressure
from cdem.rows import rows_of
from cdem.run.law_fields import state_of, yielded_of
from cdem.run.state import RunState

Values = Callable[[RunState], NDArray]
_VALUES: dict[str, Values] = {}


def output_field(name: str) -> Callable[[Values], Values]:
    """Register a function that computes this field on nodes or elements."""

    def keep(function: Values) -> Values:
        _VALUES[name] = function
        return function

    return keep


for state in STATES:
    output_field(state)(partial(state_of, name=state))
output_field("yielded")(yielded_of)


def values_of(sim: RunState, fields: Iterable[OutputField]) -> dict[str, NDArray]:
    """Values of fields by name; values of elements follow shape by shape."""
    return {field.name: _VALUES[field.name](sim) for field in fields}


def surface_of(
    sim: RunState, values: Mapping[str, NDArray]
) -> tuple[NDArray, NDArray, dict[str, NDArray], dict[str, NDArray]]:
    """Present outer and broken faces: positions, vertices of the faces (-1 after a triangle's),
    fields.

    Args:
        sim: The simulation.
        values: Fields on its nodes and elements, to be copied to points and faces.
    """
    t = sim.build.topology
    faces, broken = visible_faces(sim)
    nodes = t.face_nodes[faces]
    used = np.unique(nodes[nodes >= 0])
    number = np.full(len(t.node_position) + 1, -1, np.int32)
    number[used] = np.arange(len(used))
    on_nodes = {field.name for field in OUTPUT_FIELDS if field.on == "nodes"}
    element = t.face_element[faces]
    return (
        rows_of(sim.core, "node.motion").position[used],
        number[nodes],
        {name: of[used] for name, of in values.items() if name in on_nodes},
        {name: of[element] for name, of in values.items() if name not in on_nodes}
        | {
            "face": faces.astype(np.int32),
            "broken": broken.astype(np.int8),
            "joint": (t.face_kind // len(t.group_names))[faces],
        }
        | ({"water_pressure": _water_pressure(sim)[faces]} if sim.case.water else {}),
    )


def _water_pressure(sim: RunState) -> NDArray[np.float64]:
    """Pressure of water on each face, mean of its vertices [Pa]."""
    pressure = np.zeros(len(sim.build.topology.face_nodes))
    for face, at_vertices in face_pressures(sim.build, rows_of(sim.core, "node.motion").position):
        pressure[face] = at_vertices.mean(axis=0)
    return pressure


@output_field("displacement")
def displacement_of(sim: RunState) -> NDArray[np.float64]:
    """Displacement of each node since the last reset [m], shape (nodes, 3)."""
    return rows_of(sim.core, "node.motion").position - sim.reference


@output_field("velocity")
def velocity_of(sim: RunState) -> NDArray[np.float64]:
    """Velocity of each node [m/s], shape (nodes, 3)."""
    return rows_of(sim.core, "node.motion").velocity


@output_field("peak_velocity")
def peak_velocity_of(sim: RunState) -> NDArray[np.float64]:
    """Largest speed of each node since the last dynamic stage began [m/s]; 0 if not asked for."""
    squared = sim.core.array("node.peak")[0]
    return np.sqrt(squared) if len(squared) else np.zeros(len(sim.reference))


@output_field("node")
def node_of(sim: RunState) -> NDArray[np.int32]:
    """Number of each node."""
    return np.arange(len(sim.reference), dtype=np.int32)


@output_field("element")
def element_of(sim: RunState) -> NDArray[np.int32]:
    """Number of each element, shapes one after the other."""
    return np.arange(len(group_of(sim)), dtype=np.int32)


@output_field("group")
def group_of(sim: RunState) -> NDArray[np.int32]:
    """Group of each element."""
    return np.concatenate(list(sim.build.topology.element_group.values()))


@output_field("block")
def block_of(sim: RunState) -> NDArray[np.int32]:
    """Block of each element."""
    return np.concatenate(list(sim.build.topology.element_block.values()))


@output_field("out")
def out_of(sim: RunState) -> NDArray[np.int8]:
    """Whether the block of each element has left the domain, shape by shape."""
    return sim.out[block_of(sim)].astype(np.int8)


def bonds_of(sim: RunState) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Bonded pairs of faces, shape (pairs, 2), and the intact fraction of each pair's bond points."""
    b = sim.build
    faces, intact = [], []
    for kind in ("triangles", "quads"):
        faces.append(b.assembly.pair_faces[kind])
        intact.append(rows_of(sim.core, f"{kind}.bond").numbers.T.mean(axis=0))
    if b.assembly.counts["overlaps.count"]:
        first = b.topology.overlap_first
        faces.append(b.topology.overlap_faces)
        bond = sim.core.fields()["overlaps.bond"][: first[-1]]
        intact.append(np.add.reduceat(bond, first[:-1]) / np.diff(first))
    return np.concatenate(faces), np.concatenate(intact)


@output_field("damage")
def damage_of(sim: RunState) -> NDArray[np.float64]:
    """Broken fraction of the bonded faces of each element, 0 to 1, shape by shape."""
    t = sim.build.topology
    count = sum(len(e) for e in t.element_nodes.values())
    broken, total = np.zeros(count), np.zeros(count)
    faces, intact = bonds_of(sim)
    for side in range(2):
        element = t.face_element[faces[:, side]]
        np.add.at(broken, element, 1 - intact)
        np.add.at(total, element, 1.0)
    return broken / np.maximum(total, 1)


@output_field("slip")
def slip_of(sim: RunState) -> NDArray[np.float64]:
    """Slip between faces that met at the start [m], largest of each element."""
    return _largest_of_elements(sim, _apart(sim)[0])


@output_field("opening")
def opening_of(sim: RunState) -> NDArray[np.float64]:
    """Opening between faces that met at the start [m], largest of each element."""
    return _largest_of_elements(sim, _apart(sim)[1])


def _apart(sim: RunState) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Slip and opening of each pair of faces whose vertices met at the start [m]; largest values."""
    t, at = sim.build.topology, rows_of(sim.core, "node.motion").position
    first, second = t.face_nodes[t.pair_faces[:, 0]], t.face_nodes[t.pair_faces[:, 1]]
    corners = (first >= 0).sum(axis=1, keepdims=True)
    place = (t.pair_shift[:, None] - np.arange(first.shape[1])) % corners
    other = np.take_along_axis(second, place, axis=1)
    way = at[other] - at[first]
    normal = np.cross(at[first[:, 1]] - at[first[:, 0]], at[first[:, 2]] - at[first[:, 0]])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    across = np.einsum("pkx,px->pk", way, normal)
    along = np.linalg.norm(way - across[:, :, None] * normal[:, None], axis=2)
    real = first >= 0
    return np.where(real, along, 0.0).max(axis=1), np.where(real, across, 0.0).max(axis=1)


def _largest_of_elements(sim: RunState, of_pairs: NDArray[np.float64]) -> NDArray[np.float64]:
    """The largest value of the pairs of faces of each element, at least 0."""
    t, largest = sim.build.topology, np.zeros(len(group_of(sim)))
    for side in range(2):
        np.maximum.at(largest, t.face_element[t.pair_faces[:, side]], of_pairs)
    return largest


@output_field("piece")
def pieces_of(sim: RunState) -> NDArray[np.int32]:
    """Piece of each element, shape by shape: the lowest block number of the connected piece.

    Blocks are connected by every pair of faces with an intact bond point and a strength of the
    interface; a pair whose cohesion and tension a stage has set to zero does not connect.
    """
    t = sim.build.topology
    laws, interface = interfaces_of(sim.case, sim.build.group_names)
    faces, intact = bonds_of(sim)
    kinds = t.face_kind[faces]
    holds = (intact > 0) & ~sim.out[t.face_block[faces]].any(axis=1)
    holds &= bonded_pairs(laws, interface)[kinds[:, 0], kinds[:, 1]]
    a, b = t.face_block[faces[holds]].T
    piece = components(len(t.block_group), a, b)
    return piece[np.concatenate(list(t.element_block.values()))].astype(np.int32)


@output_field("stress")
def stress_of(sim: RunState) -> NDArray[np.float64]:
    """Mean stress of each element [Pa], xx yy zz xy yz zx, shapes one after the other."""
    stress = effective_stress_of(sim)
    if sim.case.water is not None:
        names, case = sim.build.group_names, sim.case
        biot = np.array([case.materials[case.groups[name].material].biot for name in names])
        stress[:, :3] -= (biot[group_of(sim)] * pore_pressure_of(sim))[:, None]
    return stress


@output_field("pore_pressure")
def pore_pressure_of(sim: RunState) -> NDArray[np.float64]:
    """Pore pressure [Pa], mean of the nodes of each element, ordered as `stress_of`."""
    if sim.case.water is None:
        return np.zeros(len(group_of(sim)))
    arrays, at = sim.build.arrays, rows_of(sim.core, "node.motion").position
    field, kept = arrays["water.node_field"], arrays["water.node_kept"]
    pressure = signed_pressure(sim.core, field, at, kept)
    elements = sim.build.topology.element_nodes.values()
    return np.concatenate([np.maximum(pressure, 0.0)[nodes].mean(axis=1) for nodes in elements])


@output_field("effective_stress")
def effective_stress_of(sim: RunState) -> NDArray[np.float64]:
    """Mean stress from the law of each element [Pa], ordered as `stress_of`."""
    shapes = sim.core.stress()
    return np.concatenate([rows_of(sim.core, f"{shape}.stress").numbers for shape in shapes])


def visible_faces(sim: RunState) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
    """Outer faces and faces with all bonds broken; the second array marks the latter.

    Faces of blocks that have left the domain are left out.
    """
    b = sim.build
    glued = np.zeros(len(b.topology.face_nodes), bool)
    bonded = glued.copy()
    for kind in ("triangles", "quads"):
        faces = b.assembly.pair_faces[kind]
        intact = rows_of(sim.core, f"{kind}.bond").numbers.any(axis=1)
        intact &= ~sim.out[b.topology.face_block[faces]].any(axis=1)
        glued[faces[intact].ravel()] = True
        bonded[faces.ravel()] = True
    shown = np.flatnonzero(~glued & ~sim.out[b.topology.face_block])
    return shown, bonded[shown]
