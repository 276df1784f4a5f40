"""From a case to a model that the core can run: meshes, blocks, interfaces, loads, supports."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem import assemble, bodies, joints, mesh
from cdem._native import core as native
from cdem.case import Case
from cdem.errors import CaseError
from cdem.mesh import Mesh
from cdem.parts import Interface
from cdem.topology import Topology, build_topology, group_touching

Floats = NDArray[np.float64]

BOND_INDENTATION = {"vertex": (0.0, 0.0), "quadrature": (0.5, 1 - 1 / np.sqrt(3))}
"""Where bond points sit, on triangles and on quadrilaterals: at the vertices, or where the points
integrate a linear stress exactly (method of the theory page on bonds)."""


SHARED = {
    "node_block": "node.block", "node_place": "node.place", "face_nodes": "face.nodes",
    "face_edges": "face.edges", "face_kind": "face.interface_class", "face_block": "face.block",
    "face_element": "face.element", "edge_nodes": "edge.nodes", "edge_faces": "edge.faces",
    "node_ring_first": "edge_star.first", "node_ring": "edge_star.node",
}  # fmt: skip
"""Arrays of the topology that the core has too, under its name."""
LOOKS_ALONG = 1e-3
"""Faces whose normal is within about 2.5 degrees of a wanted direction look along it."""


@dataclass
class Build:
    """A model ready to run.

    Attributes:
        case: The case it was made from.
        mesh: The mesh, all pieces merged.
        topology: Blocks, faces and pairs.
        assembly: Counts and sums of what the core was given, which holds the arrays now.
        core: The compiled core, holding model and state.
        curves: Times and factors of load and velocity histories; the first is constant.
        start_position: Positions at the start [m], shape (nodes, 3).
        bonded: Whether the interface of two kinds of faces (see `Topology.face_kind`) was bonded
            at the start, shape (kinds, kinds).
    """

    case: Case
    mesh: Mesh
    topology: Topology
    assembly: assemble.Assembly
    core: Any  # Core of the module for this machine's instruction set
    curves: list[tuple[list[float], list[float]]]
    start_position: Floats
    bonded: NDArray[np.bool_]

    @property
    def arrays(self) -> dict[str, NDArray]:
        """Flat arrays of the model by name: views of the core's, until a stage changes them."""
        return self.core.model()

    @cached_property
    def fingerprint(self) -> str:
        """The same for models with the same nodes, elements and groups, in the same order."""
        digest = hashlib.sha256(self.start_position.tobytes())
        for shape, cells in sorted(self.mesh.cells.items()):
            digest.update(shape.encode() + cells.tobytes() + self.mesh.cell_group[shape].tobytes())
        return digest.hexdigest()

    @property
    def group_names(self) -> list[str]:
        """Names of the groups, by index."""
        return self.mesh.group_names

    def node_groups(self) -> NDArray[np.int32]:
        """Group of each node's block, shape (nodes,)."""
        return self.topology.block_group[self.topology.node_block]

    def nodes_of(self, group: str) -> NDArray[np.intp]:
        """Nodes of a group, ascending."""
        return np.flatnonzero(self.node_groups() == self.group_names.index(group))


def read_model(case: Case) -> Mesh:
    """Read and place the mesh file and the blocks of a case, all in one mesh."""
    pieces = []
    model = case.model
    if model.mesh is not None:
        with case.blame("model.mesh"):
            pieces.append(mesh.read_mesh(case.path_of(model.mesh)))
    for index, block in enumerate(model.blocks):
        with case.blame(f"model.blocks.{index}"):
            pieces.append(_block(case, block))
    if not model.joints:
        return mesh.place(mesh.merge(pieces), model.rotate, model.translate)
    pieces = [mesh.place(piece, model.rotate, model.translate) for piece in pieces]
    hulls: list[list[list[int]] | None] = [None] * (model.mesh is not None)
    for block in model.blocks:
        body = block.polyhedron
        hulls.append(
            None if body is None else mesh.outward_faces(np.array(body.vertices), body.faces)
        )
    with case.blame("model.joints"):
        return joints.cut_model(list(zip(pieces, hulls, strict=True)), model)


def _block(case: Case, block) -> Mesh:
    if block.file is not None:
        piece = bodies.read_bodies(case.path_of(block.file), block.group)
    elif block.box is not None:
        piece = mesh.box(block.group, block.box.size, block.box.divisions, shape=block.box.shape)
    else:
        piece = mesh.polyhedron(block.group, block.polyhedron.vertices, block.polyhedron.faces)
    return mesh.place(piece, block.rotate, block.translate)


def build(case: Case) -> Build:
    """Build the model of a case.

    Raises:
        CaseError: Something in the case file does not fit the model.
        MeshError: A mesh cannot be used.
    """
    merged = read_model(case)
    names = merged.group_names
    _check_groups(case, names)
    laws, interface_of = interfaces_of(case, names)
    bonds = bonded_pairs(laws, interface_of)
    sets = [joint.name for joint in case.model.joints]
    with case.blame("model"):
        topology = build_topology(merged, case.model.split, sets, bonds)
    _check_interfaces(case, topology, names, interface_of)
    _snap_mates(topology)

    core = native.Core()
    curves: list[tuple[list[float], list[float]]] = [([0.0], [1.0])]
    supports = _supports(case, topology, names, curves)
    properties = _properties(case, names, laws, interface_of, bonds, supports)
    parts = assemble.assemble(topology, properties, native.padded_stride)
    parts.arrays |= {f"support.{key}": value.ravel() for key, value in supports.items()}
    _drop_gravity(case, topology, names, parts)
    parts.arrays |= _loads(case, topology, names, curves)
    core.take_counts(parts.counts)
    core.take_model(parts.arrays)
    parts.arrays.clear()  # the core has its own
    _share(topology, core.model())
    core.set_curves([c[0] for c in curves], [c[1] for c in curves])
    core.set_interfaces([interface_entry(law) for law in laws])
    core.set_options(_options(case, [case.materials[case.groups[n].material] for n in names]))
    core.start(topology.node_position)
    built = Build(case, merged, topology, parts, core, curves, topology.node_position, bonds)
    _initial_velocities(built)
    return built


def _share(topology: Topology, arrays: dict[str, NDArray]) -> None:
    """Let the topology see the core's arrays where it has the same, so that they are kept once."""
    for name, column in SHARED.items():
        own = getattr(topology, name)
        setattr(topology, name, arrays[column][: own.size].reshape(own.shape))


def _properties(case: Case, names, laws, interface_of, bonds, supports) -> assemble.Properties:
    materials = [case.materials[case.groups[name].material] for name in names]
    scaling = case.time.mass_scaling
    return assemble.Properties(
        density=np.array([m.density for m in materials]),
        young_modulus=np.array([m.young_modulus for m in materials]),
        poisson_ratio=np.array([m.poisson_ratio for m in materials]),
        interface_of=np.maximum(interface_of, 0),
        bonded=bonds,
        stiffness=np.array([stiffness_row(law) for law in laws]).reshape(-1, 4),
        exact_mass=case.elements.mass == "exact",
        supported=supports["component"][np.maximum(supports["row"], 0)].astype(bool)
        & (supports["row"] >= 0)[:, None],
        target_step=0.0 if scaling is None else scaling.step,
        one_point=case.elements.hexahedra == "one-point",
    )


def change(built: Build) -> dict[str, NDArray]:
    """Arrays of the core that follow from the parts of a case that a stage may change.

    Supports change the inverse mass matrices of small blocks, so those are made anew too.
    """
    case, names, topology = built.case, built.group_names, built.topology
    laws, interface_of = interfaces_of(case, names)
    del built.curves[1:]
    supports = _supports(case, topology, names, built.curves)
    properties = _properties(case, names, laws, interface_of, built.bonded, supports)
    parts = assemble.assemble(topology, properties, native.padded_stride)
    parts.arrays |= {f"support.{key}": value.ravel() for key, value in supports.items()}
    _drop_gravity(case, topology, names, parts)
    parts.arrays |= _loads(case, topology, names, built.curves)
    kept = ("support.", "load.", "mass.", "node.", "triangles.s", "quads.s", "overlaps.s")
    return {key: value for key, value in parts.arrays.items() if key.startswith(kept)}


def _check_groups(case: Case, names: list[str]) -> None:
    listed = ", ".join(names)
    for name in names:
        if name not in case.groups:
            raise CaseError(
                f"{case.where('groups')}: groups: group {name!r} of the model is missing; "
                f"give it a material (the model has: {listed})"
            )
    for name in case.groups:
        if name not in names:
            raise CaseError(
                f"{case.where(f'groups.{name}')}: groups.{name}: no such group in the model; "
                f"it has: {listed}"
            )
    for name in case.model.split:
        if name not in names:
            raise CaseError(
                f"{case.where(f'model.split.{name}')}: model.split.{name}: no such group in the "
                f"model; it has: {listed}"
            )


def interfaces_of(case: Case, names: list[str]):
    """Interface laws in use, and the index for each pair of kinds of faces (-1: none was given).

    Kinds of faces are those of `Topology.face_kind`. What touches a face made by a set of joints has
    the law of that set, if there is one and the toucher (first index) is of the same set or group:
    a corner that rests on a joint may touch it as a corner of any face of its block. All else has the
    law of its groups.
    """
    laws: list[Interface] = list(case.interfaces.pairs)
    table = np.full((len(names), len(names)), -1, np.int32)
    if case.interfaces.default is not None:
        laws.append(case.interfaces.default)
        table[:] = len(laws) - 1
    for index, pair in enumerate(case.interfaces.pairs):
        for name in pair.between or []:
            if name not in names:
                raise CaseError(
                    f"{case.where(f'interfaces.pairs.{index}.between')}: interfaces.pairs.{index}."
                    f"between: no group {name!r} in the model; it has: {', '.join(names)}"
                )
        if pair.between is not None:
            a, b = (names.index(name) for name in pair.between)
            table[a, b] = table[b, a] = index
    sets = [joint.name for joint in case.model.joints]
    table = np.tile(table, (1 + len(sets), 1 + len(sets)))
    for index, pair in enumerate(case.interfaces.pairs):
        if pair.joint is not None:
            start = len(names) * (1 + sets.index(pair.joint))
            table[start : start + len(names), start : start + len(names)] = index
            for group in range(len(names)):
                table[group :: len(names), start + group] = index
    return laws, table


def _check_interfaces(case: Case, topology: Topology, names: list[str], table) -> None:
    for a, b in sorted(group_touching(topology)):
        if table[names.index(a), names.index(b)] < 0:
            raise CaseError(
                f"{case.where('interfaces')}: interfaces: groups {a!r} and {b!r} touch but have no "
                f"interface; add a pair 'between: [{a}, {b}]' or interfaces.default"
            )
    missing = table[: len(names), : len(names)] < 0
    for index in range(len(names)):  # a block does not touch itself
        if (topology.block_group == index).sum() < 2:
            missing[index, index] = False
    if missing.any():
        first = np.argwhere(missing)[0]
        a, b = names[first[0]], names[first[1]]
        raise CaseError(
            f"{case.where('interfaces')}: interfaces: groups {a!r} and {b!r} may come to touch but "
            f"have no interface; add a pair 'between: [{a}, {b}]' or interfaces.default"
        )


def bonded_pairs(laws: list[Interface], table: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Which pairs of groups have strength, shape (groups, groups); those without a law have none."""
    strong = [law.cohesion > 0 or law.tensile_strength > 0 for law in laws]
    return np.array([*strong, False])[table]


def interface_entry(law) -> dict[str, Any]:
    """An interface as the core takes it."""
    parameters = {
        "friction_angle": float(np.tan(np.radians(law.friction_angle))),
        "cohesion": law.cohesion,
        "tensile_strength": law.tensile_strength,
        "dilation_angle": float(np.tan(np.radians(law.dilation_angle))),
        "dilation_slip": law.dilation_slip,
    }
    n, s = law.stiffness_n.as_pair(), law.stiffness_s.as_pair()
    return {"law": "brittle", "stiffness_n": n, "stiffness_s": s, "parameters": parameters}


def stiffness_row(law) -> list[float]:
    """Value and factor of k_n, then of k_s; a value of 0 means factor times E / h."""
    numbers: list[float] = []
    for k in (law.stiffness_n, law.stiffness_s):
        numbers += [0.0, k.value] if k.relative else [k.value, 0.0]
    return numbers


def _snap_mates(topology: Topology) -> None:
    """Put the vertices of conforming faces at exactly the same place (they differ by round-off)."""
    faces, shift = topology.pair_faces, topology.pair_shift
    if len(faces) == 0:
        return
    for n in (3, 4):
        some = (topology.face_nodes[faces[:, 0]] >= 0).sum(axis=1) == n
        k = np.arange(n)
        a = topology.face_nodes[faces[some, 0]][:, :n]
        mates = (shift[some][:, None] - k) % n
        b = np.take_along_axis(topology.face_nodes[faces[some, 1]], mates, axis=1)
        topology.node_position[b] = topology.node_position[a]


def _curve(history, curves: list) -> int:
    """Index of a history's curve; without one, the constant."""
    if history is None:
        return 0
    curves.append(([float(t) for t, _ in history], [float(f) for _, f in history]))
    return len(curves) - 1


def _select(case: Case, topology: Topology, names: list[str], item, path: str):
    """Nodes that an entry of loads means: by group, surface, point or box."""
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
        faces = _surface(case, topology, names, item.surface, path)
        inside = np.zeros(len(position), bool)
        nodes = topology.face_nodes[faces].ravel()
        inside[nodes[nodes >= 0]] = True
        among &= inside
    if getattr(item, "box", None) is not None:
        among &= ((position >= item.box.min) & (position <= item.box.max)).all(axis=1)
    if getattr(item, "point", None) is not None:
        candidates = np.flatnonzero(among)
        distance = np.linalg.norm(position[candidates] - item.point, axis=1)
        # every node at that point: blocks that touch there have one each
        among = np.zeros(len(position), bool)
        among[candidates[distance <= distance.min() * (1 + 1e-9) + 1e-12]] = True
    if not among.any():
        raise CaseError(f"{case.where(path)}: {path}: selects no nodes; check where it points")
    return np.flatnonzero(among)


def _surface(case: Case, topology: Topology, names: list[str], surface, path: str):
    """Exterior faces of a surface by name, or those of a group that look along a normal."""
    path += ".surface"
    if isinstance(surface, str):
        if surface not in topology.surfaces:
            known = ", ".join(sorted(topology.surfaces)) or "none"
            raise CaseError(
                f"{case.where(path)}: {path}: no surface {surface!r} in the model; it has: {known}"
            )
        return topology.surfaces[surface]
    if surface.group not in names:
        raise CaseError(
            f"{case.where(path)}: {path}.group: no group {surface.group!r} in the model; it has: "
            f"{', '.join(names)}"
        )
    free = topology.face_group == names.index(surface.group)
    free[topology.pair_faces.ravel()] = False  # what touches another block is inside the rock
    faces = np.flatnonzero(free)
    nodes = topology.face_nodes[faces]
    x = topology.node_position[np.where(nodes < 0, nodes[:, 2:3], nodes)]
    normal = np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    wanted = np.asarray(surface.normal, float)
    faces = faces[normal @ (wanted / np.linalg.norm(wanted)) > 1 - LOOKS_ALONG]
    if len(faces) == 0:
        raise CaseError(f"{case.where(path)}: {path}: no free face of the group looks that way")
    return faces


def _supports(case: Case, topology: Topology, names: list[str], curves: list) -> dict:
    """Rows of supported nodes: which components, at which velocity, on which curve."""
    count = len(topology.node_position)
    component = np.zeros((count, 3), np.int8)
    velocity = np.zeros((count, 3))
    curve = np.zeros((count, 3), np.int32)

    def hold(nodes, axes, speeds, index) -> None:
        for axis, speed in zip(axes, speeds, strict=True):
            component[nodes, axis] = 1
            velocity[nodes, axis] = speed
            curve[nodes, axis] = index

    groups = topology.block_group[topology.node_block]
    for name, group in case.groups.items():
        axes = ["xyz".index(c) for c in group.fix]
        hold(groups == names.index(name), axes, [0.0] * len(axes), 0)
    for index, item in enumerate(case.loads.supports):
        nodes = _select(case, topology, names, item, f"loads.supports.{index}")
        axes = ["xyz".index(c) for c in item.fix]
        hold(nodes, axes, [0.0] * len(axes), 0)
    for index, driven in enumerate(case.loads.velocities):
        nodes = _select(case, topology, names, driven, f"loads.velocities.{index}")
        axes = ["xyz".index(c) for c in driven.components]
        hold(nodes, axes, [driven.velocity[a] for a in axes], _curve(driven.history, curves))

    held = np.asarray(component.any(axis=1))
    row = np.full(count, -1, np.int32)
    row[held] = np.arange(held.sum())
    if not held.any():  # the core looks rows up; an empty table still needs one
        held[:1] = True
    return {
        "row": row,
        "component": component[held],
        "velocity": velocity[held],
        "curve": curve[held],
    }


def _drop_gravity(case: Case, topology: Topology, names: list[str], parts) -> None:
    groups = topology.block_group[topology.node_block]
    for name, group in case.groups.items():
        if not group.gravity:
            parts.arrays["node.gravity_mass"][groups == names.index(name)] = 0


def _loads(case: Case, topology: Topology, names: list[str], curves: list) -> dict:
    """Nodal forces of tractions: the area of each vertex of the loaded faces times the traction."""
    nodes, forces, of_curve = [], [], []
    for index, item in enumerate(case.loads.tractions):
        faces = _surface(case, topology, names, item.surface, f"loads.tractions.{index}")
        vertex = topology.face_nodes[faces]
        used = vertex >= 0
        area = assemble.face_areas(topology.node_position, vertex)
        share = np.broadcast_to((area / used.sum(axis=1))[:, None], vertex.shape)[used]
        nodes.append(vertex[used])
        forces.append(share[:, None] * np.asarray(item.traction, float))
        of_curve.append(np.full(used.sum(), _curve(item.history, curves), np.int32))
    count = len(topology.node_position)
    if not nodes:
        empty = {"load.curve": np.zeros(0, np.int32), "load.force": np.zeros(0)}
        return {"load.first": np.zeros(count + 1, np.int32), **empty}
    owner, force = np.concatenate(nodes), np.concatenate(forces)
    first, curve = assemble.ragged(owner, np.concatenate(of_curve), count)
    _, force = assemble.ragged(owner, force, count)
    rows = np.zeros((len(force), 4))
    rows[:, :3] = force
    return {"load.first": first, "load.curve": curve, "load.force": rows.ravel()}


def _options(case: Case, materials) -> dict:
    contact = case.contact
    nu = [m.poisson_ratio for m in materials]
    wave = max(
        np.sqrt(m.young_modulus * (1 - n) / (m.density * (1 + n) * (1 - 2 * n)))
        for m, n in zip(materials, nu, strict=True)
    )
    triangle, quad = BOND_INDENTATION[contact.bond_points]
    automatic = contact.tolerance == "auto"
    return {
        "formulation": case.elements.formulation,
        "indentation": contact.indentation,
        "action": 0.0 if contact.action == "vertex" else contact.indentation,
        "tolerance": 0.1 * contact.indentation if automatic else contact.tolerance,
        "bond_indentation_triangle": triangle,
        "bond_indentation_quad": quad,
        "semi_edges": contact.edges,
        "check_search": contact.check,
        "rebuild_interval": 0 if contact.refresh == "displacement" else int(contact.refresh),
        "step_safety": case.time.safety,
        "step_given": 0.0 if case.time.step == "auto" else case.time.step,
        "speed_limit": float(wave),  # nothing in rock moves faster than its P wave
        "gravity": [float(g) for g in case.loads.gravity],
    }


def _initial_velocities(built: Build) -> None:
    motion = built.core.fields()["node.motion"].reshape(-1, 8)
    mass = built.arrays["node.mass"]
    for name, group in built.case.groups.items():
        nodes = built.nodes_of(name)
        x = built.start_position[nodes]
        center = (mass[nodes, None] * x).sum(axis=0) / mass[nodes].sum()
        spin = np.cross(np.asarray(group.angular_velocity, float), x - center)
        motion[nodes, 4:7] = np.asarray(group.velocity, float) + spin
