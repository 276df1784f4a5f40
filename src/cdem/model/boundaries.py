"""Boundaries of a model: their faces, the supports that they end, and the forces that stay."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cdem.case.boundaries_schema import BaseInput, Boundary
from cdem.case.case import Case
from cdem.case.damping_schema import Maxwell
from cdem.errors import CaseError
from cdem.mesh.element_shapes import lame_constants
from cdem.mesh.topology import Topology
from cdem.model.damping import stiffer_in_waves
from cdem.model.faces import face_areas, face_normals
from cdem.model.flat_arrays import Floats
from cdem.model.selection import select_faces


@dataclass
class Place:
    """A boundary in the model.

    Attributes:
        boundary: Its entry of the case.
        faces: Its faces, ascending.
        nodes: Their nodes, ascending.
        ends: Entries of loads.supports that end where it begins, by number.
    """

    boundary: Boundary
    faces: NDArray[np.integer]
    nodes: NDArray[np.integer]
    ends: list[int]


@dataclass
class Boundaries:
    """All boundaries of a model, and how far a run has come with them.

    Attributes:
        places: In the order of the case.
        kept: Forces of supports that have ended, which stay on the nodes [N], shape (nodes, 3).
        begun: Names of the boundaries that have begun.
        held: Whether the present stage is static, so that their nodes are held where they are.
    """

    places: list[Place]
    kept: Floats
    begun: set[str] = field(default_factory=set)
    held: bool = False

    @property
    def acting(self) -> list[Place]:
        """Boundaries that have begun."""
        return [place for place in self.places if place.boundary.name in self.begun]

    @property
    def ended(self) -> set[int]:
        """Entries of loads.supports that have ended, by number."""
        return {number for place in self.acting for number in place.ends}

    @property
    def nodes(self) -> NDArray[np.integer]:
        """Nodes of all boundaries, ascending."""
        return np.unique(np.concatenate([np.zeros(0, np.intp), *(p.nodes for p in self.places)]))

    def follow(self, case: Case, begun: int) -> None:
        """Note the boundaries that act once this many stages of a case have begun."""
        names = case.begun_names(begun)
        self.begun = {p.boundary.name for p in self.places if p.boundary.stage in names}
        self.held = begun > 0 and case.stages[begun - 1].mode == "static"


def boundaries_of(case: Case, topology: Topology, names: list[str]) -> Boundaries:
    """Find the boundaries of a case.

    Raises:
        CaseError: Its faces are inside the model, or in two boundaries; or a support holds only some
            of them.
    """
    found = Boundaries([], np.zeros((len(topology.node_position), 3)))
    supports = [
        (i, item.surface, select_faces(case, topology, names, item.surface, f"loads.supports.{i}"))
        for i, item in enumerate(case.loads.supports if case.boundaries else [])
        if item.surface is not None
    ]
    owner = np.full(len(topology.face_nodes), -1)
    for i, boundary in enumerate(case.boundaries):
        path = f"boundaries.{i}"
        faces = np.unique(select_faces(case, topology, names, boundary.surface, path))
        _check_faces(case, topology, path, faces, owner)
        owner[faces] = i
        nodes = topology.face_nodes[faces]
        place = Place(boundary, faces, np.unique(nodes[nodes >= 0]), [])
        for number, _, held in supports:
            inside = np.isin(held, faces)
            if inside.all():
                place.ends.append(number)
            elif inside.any():
                raise CaseError(
                    f"{case.where(path)}: {path}: {boundary.name} has {inside.sum():,} of the "
                    f"{len(held):,} faces of loads.supports.{number}; give the support the same "
                    "surface, so that it can end where the boundary begins"
                )
        found.places.append(place)
    found.follow(case, 0)
    return found


def _check_faces(
    case: Case,
    topology: Topology,
    path: str,
    faces: NDArray[np.integer],
    owner: NDArray[np.integer],
) -> None:
    where, name = case.where(path), case.boundaries[int(path.rsplit(".", 1)[1])].name
    if not len(faces):
        raise CaseError(f"{where}: {path}.surface: the surface of {name} has no faces")
    inner = np.isin(faces, topology.pair_faces.ravel())
    if inner.any():
        raise CaseError(
            f"{where}: {path}.surface: {inner.sum():,} of the {len(faces):,} faces of {name} touch "
            "another block; a boundary needs outer faces"
        )
    twice = owner[faces]
    if (twice >= 0).any():
        other = case.boundaries[int(twice.max())].name
        raise CaseError(
            f"{where}: {path}.surface: {(twice >= 0).sum():,} faces of {name} are also in {other}; "
            "give each face one boundary"
        )


def maxwell_at(case: Case, stage: str | None) -> Maxwell | None:
    """Branches of the first dynamic stage from one on, without a name from the first on."""
    later = case.stages_from(stage)
    return next((item.damping.maxwell for item in later if item.mode == "dynamic"), None)


def impedances(case: Case, names: list[str], stage: str | None) -> Floats:
    """Density times speed of P and S waves of the rock of each group, from a stage on.

    Waves in rock with Maxwell branches have the speed of the middle of the band.

    Args:
        case: The case.
        names: Names of the groups, by number.
        stage: Name of the stage; None is the first.

    Returns:
        Impedances [kg/(m2 s)], shape (groups, 2).
    """
    rocks = [case.materials[case.groups[name].material] for name in names]
    density = np.array([rock.density for rock in rocks])
    young, poisson = (
        np.array([getattr(r, k) for r in rocks]) for k in ("young_modulus", "poisson_ratio")
    )
    first, shear = lame_constants(young, poisson)
    stiffer = stiffer_in_waves(maxwell_at(case, stage))
    return np.sqrt(stiffer * density * np.stack([first + 2 * shear, shear])).T


def wave_forces(
    case: Case, topology: Topology, place: Place, given: BaseInput
) -> tuple[NDArray[np.integer], Floats]:
    """Nodal forces of an up-going wave through quiet faces: 2 z v on their vertices.

    Args:
        case: The case.
        topology: The model at its start.
        place: Boundary that it comes in through.
        given: The wave.

    Returns:
        Nodes, ascending, and their forces for a record of 1 m/s [N], shape (nodes, 3).
    """
    direction = np.array(given.motion_of_record)
    faces = place.faces
    vertex = topology.face_nodes[faces]
    used = vertex >= 0
    normal = face_normals(topology.node_position, vertex)
    z = impedances(case, topology.group_names, place.boundary.stage)[topology.face_group[faces]]
    along = (normal @ direction)[:, None] * normal
    traction = 2 * (z[:, 1:] * (direction - along) + z[:, :1] * along)
    area = face_areas(topology.node_position, vertex) / used.sum(axis=1)
    rows = np.broadcast_to((area[:, None] * traction)[:, None], (*vertex.shape, 3))[used]
    nodes, of = np.unique(vertex[used], return_inverse=True)
    force = np.zeros((len(nodes), 3))
    np.add.at(force, of, rows)
    return nodes, force
