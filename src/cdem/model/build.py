"""From a case to a model that the core can run: meshes, blocks, interfaces, loads, supports."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.case.case import Case
from cdem.case.interface_schema import Interface
from cdem.case.laws import BLOCK_LAWS
from cdem.case.schema import Material
from cdem.case.softening import tables_of
from cdem.errors import CaseError
from cdem.mesh.blocks import build_topology, snap_mates
from cdem.mesh.extent import check_extent
from cdem.mesh.mesh import Mesh
from cdem.mesh.topology import Topology
from cdem.model.assemble import assemble
from cdem.model.bodies import check_groups, read_model
from cdem.model.bolts import BoltModel
from cdem.model.boundaries import Boundaries, boundaries_of
from cdem.model.compensation import (
    Compensation,
    compensate,
    compensated_groups,
    is_automatic,
    made_up_between,
)
from cdem.model.curves import Curves, constant, hand_over
from cdem.model.domain import check_domain
from cdem.model.flat_arrays import Assembly, Properties
from cdem.model.initial_stress import InitialState, set_initial_stress
from cdem.model.interfaces import (
    bonded_pairs,
    check_interfaces,
    interfaces_of,
    strength_factors_of,
    that_may_break,
)
from cdem.model.loads import drop_gravity, node_loads_of, set_velocities, start_on_supports
from cdem.model.memory import check_memory, pieces_of_boxes, pieces_of_mesh
from cdem.model.module import Module, Parts
from cdem.model.modules import modules_of
from cdem.model.options import options_of, pairs_loose_joints
from cdem.model.snap_back import check_fall, check_softening
from cdem.model.stiffness import bond_row, interface_entries
from cdem.model.supports import driven_nodes, held_components, supports_of
from cdem.rows import rows_of

if TYPE_CHECKING:
    from cdem._core import Core

Floats = NDArray[np.float64]


SHARED = {
    "node_block": "node.block", "node_place": "node.place", "face_nodes": "face.nodes",
    "face_edges": "face.edges", "face_kind": "face.interface_class", "face_block": "face.block",
    "face_element": "face.element", "edge_nodes": "edge.nodes", "edge_faces": "edge.faces",
    "node_ring_first": "edge_star.first", "node_ring": "edge_star.node",
}  # fmt: skip
"""Arrays of the topology that are also in the core, with their names there."""


@dataclass
class Build:
    """A model ready to run.

    Attributes:
        case: The case it was made from.
        mesh: The mesh, all pieces merged.
        topology: Blocks, faces and pairs.
        assembly: Counts and sums of the arrays given to the core, which owns them now.
        core: The compiled core, holding model and state.
        curves: Load and velocity histories; the first curve is constant.
        start_position: Positions at the start [m], shape (nodes, 3).
        born: Positions without stress [m]: initial ones, except for groups
            added since, shape (nodes, 3).
        compensation: Compensation for the compliance of bonds between elements, by group.
        bonded: Whether the interface of two kinds of faces (see `Topology.face_kind`) was bonded
            at the start, shape (kinds, kinds).
        paired: Whether such faces that touch are pairs: bonded faces, and all with
            `pairs_loose_joints`.
        initial: Initial stress of the rock, or None.
        modules: Modules by name.
        boundaries: Quiet and driven boundaries.
        moduli: Moduli of the rock over those of its materials in the present stage.
    """

    case: Case
    mesh: Mesh
    topology: Topology
    assembly: Assembly
    core: Core
    curves: Curves
    start_position: Floats
    compensation: dict[str, Compensation]
    bonded: NDArray[np.bool_]
    paired: NDArray[np.bool_]
    initial: InitialState | None
    modules: dict[str, Module]
    boundaries: Boundaries
    moduli: float = 1.0

    def __post_init__(self) -> None:
        self.born = self.start_position

    @property
    def arrays(self) -> dict[str, NDArray]:
        """Flat arrays of the model by name: views of the core's, until a stage changes them."""
        return self.core.model()

    @cached_property
    def fingerprint(self) -> str:
        """Equal for models with the same nodes, elements and groups in the same order, and with the
        same water from files."""
        digest = hashlib.sha256(self.start_position.tobytes())
        for shape, cells in sorted(self.mesh.cells.items()):
            digest.update(shape.encode() + cells.tobytes() + self.mesh.cell_group[shape].tobytes())
        digest.update(self.arrays["water.node_kept"].tobytes())  # from files; empty without water
        return digest.hexdigest()

    @property
    def bolts(self) -> BoltModel:
        """Bolts in the rock, with the stages that install and remove them."""
        bolts = self.modules[BoltModel.name]
        assert isinstance(bolts, BoltModel)
        return bolts

    @property
    def group_names(self) -> list[str]:
        """Names of the groups, by index."""
        return self.mesh.group_names

    def compensate_again(self, names: Iterable[str]) -> None:
        """Compensate again for the bonds of groups whose material a stage has changed."""
        groups = [self.group_names.index(name) for name in names if name in self.compensation]
        laws, interface_of = interfaces_of(self.case, self.group_names)
        made_up = [self.group_names.index(name) for name in self.compensation]
        between = made_up_between(laws, interface_of, self.bonded, made_up)
        self.compensation |= compensate(self.case, self.topology, self.group_names, groups, between)

    def node_groups(self) -> NDArray[np.int32]:
        """Group of each node's block, shape (nodes,)."""
        return self.topology.block_group[self.topology.node_block]

    def nodes_of(self, group: str) -> NDArray[np.intp]:
        """Nodes of a group, ascending."""
        return np.flatnonzero(self.node_groups() == self.group_names.index(group))


def build(case: Case, more: Mesh | None = None) -> Build:
    """Build the model of a case.

    Args:
        case: The case; without joints if there are more bodies.
        more: Bodies that the caller has made, beside those of the case.

    Raises:
        CaseError: Something in the case file does not fit the model.
        MeshError: A mesh cannot be used.
        ModelError: It needs more memory than available.
    """
    with case.blame("model"):
        check_memory(case, pieces_of_boxes(case))
    merged = read_model(case, more)
    names = merged.group_names
    check_groups(case, names)
    laws, interface_of = interfaces_of(case, names)
    bonds = bonded_pairs(laws, interface_of)
    sets = case.model.joint_surfaces
    with case.blame("model"):
        check_memory(case, pieces_of_mesh(case, merged))
        check_extent(merged)
        paired = bonds | (pairs_loose_joints(case) & (interface_of >= 0))
        topology = build_topology(merged, case.model.split, sets, paired)
    check_domain(case, topology, names)
    check_interfaces(case, topology, names, interface_of)
    snap_mates(topology)

    curves = constant()
    groups = compensated_groups(case, topology, names, laws, interface_of, bonds)
    between = made_up_between(laws, interface_of, bonds, groups)
    made_up = compensate(case, topology, names, groups, between)
    modules = modules_of(case, topology, names)
    boundaries = boundaries_of(case, topology, names)
    at = topology.node_position
    parts = _assemble(
        case, topology, at, laws, interface_of, paired, made_up, curves, None, modules, boundaries
    )
    core = _started(case, topology, parts, curves)
    under = set_initial_stress(case, topology, names, laws, core)
    core.find_applied()
    built = Build(
        case,
        merged,
        topology,
        parts,
        core,
        curves,
        at,
        made_up,
        bonds,
        paired,
        under,
        modules,
        boundaries,
    )
    _set_motion(built)
    return built


def _started(case: Case, topology: Topology, parts: Assembly, curves: Curves) -> Core:
    """A core with the arrays of a model, at its start; the topology has views of them."""
    core = native.Core()
    core.take_counts(parts.counts)
    core.take_model(parts.arrays)
    parts.arrays.clear()  # the core has copies
    at = topology.node_position
    _share(topology, core.model())
    hand_over(core, curves, {})
    core.set_interfaces(parts.interfaces)
    names = topology.group_names
    core.set_options(options_of(case, [case.materials[case.groups[n].material] for n in names]))
    core.start(at)
    return core


def _set_motion(built: Build) -> None:
    """Set initial velocities of groups, and of driven nodes from their supports."""
    velocity = rows_of(built.core, "node.motion").velocity
    set_velocities(
        built.case, built.topology, built.group_names, built.arrays["node.mass"], velocity
    )
    lost = start_on_supports(built.core, built.curves, velocity)
    groups = built.node_groups()
    for group in np.unique(groups[lost]):
        count, of = (lost & (groups == group)).sum(), (groups == group).sum()
        built.mesh.notes.append(
            f"group {built.group_names[group]}: {count:,} of its {of:,} nodes are supported; they "
            f"start with "
            "the velocity of their support, not of the group"
        )


def _share(topology: Topology, arrays: dict[str, NDArray]) -> None:
    """Replace equal arrays of the topology by views of the core's, to store them once."""
    for name, column in SHARED.items():
        own = getattr(topology, name)
        setattr(topology, name, arrays[column][: own.size].reshape(own.shape))


def _assemble(
    case: Case,
    topology: Topology,
    born: Floats,
    laws: list[Interface],
    interface_of: NDArray[np.int32],
    paired: NDArray[np.bool_],
    made_up: dict[str, Compensation],
    curves: Curves,
    added_mass: Floats | None,
    modules: dict[str, Module],
    boundaries: Boundaries,
    moduli: float = 1.0,
) -> Assembly:
    """Arrays of the core for the present case; elements at `born` have no stress, and mass scaling
    is as given or follows from the case."""
    names = topology.group_names
    entries = interface_entries(case, laws, names, topology.node_position)
    materials = [case.materials[case.groups[name].material] for name in names]
    stiffening, bond_stiffness = _made_up(topology, made_up)
    supports = supports_of(case, topology, names, curves, boundaries)
    properties = Properties(
        density=np.array([m.density for m in materials]),
        young_modulus=np.array([m.young_modulus for m in materials]),
        poisson_ratio=np.array([m.poisson_ratio for m in materials]),
        law=np.array([list(BLOCK_LAWS).index(m.law) for m in materials], np.int32),
        law_parameters=np.array([_law_row(m) for m in materials]),
        interface_of=np.maximum(interface_of, 0),
        paired=paired,
        flush=~_beside_cells(case, names, paired),
        strength_factors=[strength_factors_of(law) for law in laws],
        breaks=that_may_break(case),
        stiffness=np.array([bond_row(law) for law in laws]).reshape(-1, 4),
        automatic=np.array([is_automatic(law) for law in laws], bool),
        stiffening=stiffening,
        bond_stiffness=bond_stiffness,
        contact_stiffness=np.array([_unloading_row(e) for e in entries]).reshape(-1, 4),
        in_series=np.array([e["in_series"] for e in entries], bool),
        exact_mass=case.moved_masses != "lumped",
        lumped_while_bonded=case.moved_masses == "lumped-while-bonded",
        supported=held_components(supports),
        driven=driven_nodes(supports),
        nodal_mean=_averages(case, materials),
        mass_scaling=case.time.mass_scaling,
        safety=case.time.safety,
        added_mass=added_mass,
        one_point=case.elements.hexahedra == "one-point",
        moduli=moduli,
    )
    at_birth = replace(topology, node_position=born)
    parts = assemble(at_birth, properties, native.padded_stride, modules.values())
    parts.interfaces = entries
    _check(case, topology, laws, parts)
    parts.arrays |= {f"support.{key}": value.ravel() for key, value in supports.items()}
    drop_gravity(case, topology, names, parts)
    parts.arrays |= node_loads_of(case, topology, names, curves, boundaries)
    stride = native.padded_stride
    given = Parts(case, topology, laws, interface_of, curves, boundaries, stride, parts)
    _add_modules(modules, given)
    return parts


def _add_modules(modules: dict[str, Module], given: Parts) -> None:
    for module in modules.values():
        module.add_arrays(given)


def _check(case: Case, topology: Topology, laws: list[Interface], parts: Assembly) -> None:
    """Refuse joints that fall open, and strengths that cannot soften."""
    check_fall(case, topology, laws, parts)
    check_softening(case, topology, topology.group_names, parts)


def _beside_cells(case: Case, names: Sequence[str], paired: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Whether pairs of these kinds of faces have cells of a split group on a side, (kinds, kinds).

    Blocks hide the faces that they share from others, whether a bond holds them or not. Cells of a
    group do not: they have one surface while they are bonded, and rubble would ask at each contact
    and lose the bed where the cells are in one another.
    """
    split = np.array([case.model.split.get(name) == "elements" for name in names])
    cells = np.resize(split, len(paired))  # faces of joints follow, by group
    return paired & (cells[:, None] | cells)


def _made_up(t: Topology, made_up: dict[str, Compensation]) -> tuple[Floats, Floats]:
    """Stiffening of the elements of each group, (groups,), and bond stiffness of each face, or 0."""
    found = [made_up.get(name) for name in t.group_names]
    of_groups = np.array([0.0 if c is None else c.stiffness for c in found])
    kind = t.face_kind
    of_faces = np.where(kind < len(found), of_groups[np.minimum(kind, len(found) - 1)], 0.0)
    for c in found:
        if c is not None and c.of_faces is not None:
            faces, stiffness = c.of_faces
            of_faces[faces] = np.where(kind[faces] < len(found), stiffness, 0.0)
    return np.array([1.0 if c is None else c.stiffening for c in found]), of_faces


def _unloading_row(entry: dict[str, Any]) -> list[float]:
    """(value, factor) of k_n / e_n^2, then of k_s / e_t^2: stiffness of unloading contacts."""
    sides = zip(("stiffness_n", "stiffness_s"), entry["restitution"], strict=True)
    return [k / e**2 for key, e in sides for k in entry[key]]


def _averages(case: Case, materials: list[Material]) -> NDArray[np.bool_]:
    """Whether tets of these materials average their dilatation, shape (groups,)."""
    flows = np.array([BLOCK_LAWS[m.law].flows for m in materials], bool)
    return flows & (case.elements.tetrahedra == "nodal-mean")


def _law_row(material: Material) -> list[float]:
    """Numbers of a material's law and of its softening."""
    numbers = BLOCK_LAWS[material.law].numbers(material)
    return native.material_numbers(material.law, numbers, tables_of(material))


def change(built: Build, *, places: bool = False) -> dict[str, NDArray]:
    """Arrays of the core that depend on parts of the case that a stage may change.

    Their descriptions name them (`ColumnInfo::changes`). The assembly of the model gets the present
    interfaces of the case. Supports change the inverse mass matrices of small blocks, so these are
    made again too.

    Args:
        built: The model; with its present case.
        places: Include arrays that depend on the positions of added groups.
    """
    case, names = built.case, built.group_names
    laws, interface_of = interfaces_of(case, names)
    del built.curves[1:]
    groups = compensated_groups(case, built.topology, names, laws, interface_of, built.bonded)
    for name in built.compensation.keys() - {names[group] for group in groups}:
        raise CaseError(
            f"{case.where('interfaces')}: stiffness_n and stiffness_s of the interface of group {name!r} cannot change: its "
            "elements compensate for its initial bonds"
        )
    parts = _assemble(
        case,
        built.topology,
        built.born,
        laws,
        interface_of,
        built.paired,
        built.compensation,
        built.curves,
        built.assembly.added_mass,
        built.modules,
        built.boundaries,
        built.moduli,
    )
    for module in built.modules.values():
        module.refuse_change(case, built.assembly.counts, parts.counts)
    built.assembly.interfaces = parts.interfaces
    when = {"with_stage", "with_places"} if places else {"with_stage"}
    changing = {info["name"] for info in built.core.describe() if info["changes"] in when}
    return {key: value for key, value in parts.arrays.items() if key in changing}
