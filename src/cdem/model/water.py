"""Water for the core: possibly wet faces, the pores, saturated weight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.laws import INTERFACE_LAWS
from cdem.case.schema import Material
from cdem.errors import CaseError
from cdem.mesh import element_shapes
from cdem.mesh.topology import Topology
from cdem.model.flat_arrays import Assembly, Floats, table
from cdem.model.flush import flush_beside
from cdem.model.module import Built, Module, Parts
from cdem.model.water_fields import WaterTables
from cdem.model.wetted import water_text, wetted

OPEN = 0.05
"""Joints keep their water up to this opening, relative to the length of a face."""
KINDS = ("triangles", "quads", "overlaps")
"""Kinds of pairs, in the order of the core."""


@dataclass
class WaterModel(Module):
    """Water of a model: its arrays follow from the case in each stage."""

    name = "water"

    @classmethod
    def of(cls, case: Case, t: Topology, names: list[str]) -> WaterModel:
        return cls()

    def add_arrays(self, parts: Parts) -> None:
        if parts.case.water is None:
            return
        t, out = parts.topology, parts.assembly
        tables = WaterTables(parts.case, t, parts.names, parts.curves)
        biot = np.array([m.biot for m in _materials(parts)])
        faces = _joints(parts, biot, tables)
        rows, field_curve = tables.rows()
        node_field = tables.in_pores(t.node_position, t.block_group[t.node_block])
        out.arrays |= {
            "water.fields": rows,
            "water.field_curve": field_curve,
            "water.biot": biot if biot.any() else np.zeros(0),
            "water.node_field": node_field,
            "water.node_kept": tables.kept(node_field, t.node_position),
        }
        for kind, corners in (("triangles", 3), ("quads", 4)):
            _wet_set(f"wet_{kind}", corners, faces.of(t, corners), tables, parts)
        if biot.any():
            for shape in t.element_nodes:
                one = bool(len(out.arrays[f"{shape}.hourglass"]))
                out.arrays[f"{shape}.values"] = element_shapes.point_values(shape, one=one).ravel()
        _weigh(parts, tables, node_field)

    def refuse_change(self, case: Case, was: dict[str, int], now: dict[str, int]) -> None:
        keys = ("wet_triangles.count", "wet_quads.count")
        if [was.get(key) for key in keys] != [now.get(key) for key in keys]:
            raise CaseError(
                f"{case.where('water')}: a stage cannot change the set of joints and faces that "
                f"may be wet; "
                "begin with wet: always or broken, and a low level"
            )

    def report(self, build: Built) -> dict[str, Any] | None:
        return wetted(build)

    def lines(self, report: dict[str, Any] | None) -> list[str]:
        return water_text(report)


def _materials(parts: Parts) -> list[Material]:
    """Names of the groups, by index."""
    return [parts.case.materials[parts.case.groups[name].material] for name in parts.names]


@dataclass
class _Faces:
    """Faces that may be wet; each array has one value per face, except arrays of mates.

    Attributes:
        joint: Field if the face is in a joint.
        open: Field if the face is free.
        bonded: Whether the joint is wet while bonds hold.
        aperture: Largest opening of a joint that keeps its water [m].
        mate_of: Index of the face of each mate, ascending.
        mate: Faces that lie on it at the start, then their neighbours on the same wall.
        pair: Their pair: 3 times its number plus its kind; -1 for unpaired faces.
    """

    face: NDArray[np.integer]
    joint: NDArray[np.integer]
    open: NDArray[np.integer]
    bonded: NDArray[np.bool_]
    aperture: Floats
    mate_of: NDArray[np.integer]
    mate: NDArray[np.integer]
    pair: NDArray[np.integer]

    def of(self, t: Topology, corners: int) -> _Faces:
        """The faces with this number of corners."""
        some = (t.face_nodes[self.face] >= 0).sum(axis=1) == corners
        return self.take(some)

    def take(self, some: NDArray[np.bool_]) -> _Faces:
        """A selection of the faces."""
        place = np.cumsum(some) - 1
        mates = some[self.mate_of]
        return _Faces(
            self.face[some], self.joint[some], self.open[some], self.bonded[some],
            self.aperture[some], place[self.mate_of[mates]], self.mate[mates], self.pair[mates],
        )  # fmt: skip


def _joints(parts: Parts, biot: Floats, tables: WaterTables) -> _Faces:
    """All faces on which one of the fields may press."""
    t, names, out = parts.topology, parts.names, parts.assembly
    count = len(t.face_nodes)
    face, mate, pair = _mates(t, out)
    kinds = t.face_kind[face], t.face_kind[mate]
    interface = parts.interface_of[kinds[0], kinds[1]]
    groups = t.face_group[face], t.face_group[mate]
    # for each mate: its joint's field, and whether bonds keep it dry
    named = (t.face_kind[face] >= len(names)).astype(interface.dtype)  # by a set of joints
    rows = np.stack([interface, *groups, named], axis=1)
    unique, which = np.unique(rows, axis=0, return_inverse=True)
    found = [_of_joint(parts, biot, tables, row.tolist()) for row in unique]
    field = np.array([f for f, _ in found], np.int32)[which.ravel()] if found else face
    wet = np.array([w for _, w in found], bool)[which.ravel()] if found else face.astype(bool)
    # the first mate of a face decides; faces without a mate have the field of their group's joints
    alone = [tables.in_joint([name], None) for name in names]
    joint = np.array([_unless_never(tables, f) for f in alone], np.int32)[t.face_group]
    bonded = np.ones(count, bool)
    first = np.unique(face, return_index=True)
    joint[first[0]], bonded[first[0]] = field[first[1]], wet[first[1]]
    opened = np.full(count, tables.reservoir, np.int32)
    middle = _middles(t)
    joint, opened = tables.near(joint, middle), tables.near(opened, middle)
    entries = [tables.entry(f) for f in range(len(tables.fields))]
    given = np.array([-1.0 if e is None or e.aperture is None else e.aperture for e in entries])
    aperture = np.where(given[joint] >= 0, given[joint], OPEN * out.arrays["face.length"])
    order = np.argsort(face, kind="stable")
    every = _Faces(
        np.arange(count), joint, opened, bonded, aperture, face[order], mate[order], pair[order]
    )
    return every.take((joint != tables.dry) | (opened != tables.dry))


def _middles(t: Topology) -> Floats:
    """Mean of the vertices of each face [m], shape (faces, 3)."""
    used = t.face_nodes >= 0
    x = t.node_position[np.where(used, t.face_nodes, t.face_nodes[:, :1])]
    return (x * used[:, :, None]).sum(axis=1) / used.sum(axis=1)[:, None]


def _of_joint(parts: Parts, biot: Floats, tables: WaterTables, row: list[int]) -> tuple[int, bool]:
    """Field of a joint, and whether it is wet while bonded.

    Args:
        parts, biot, tables: Of the model.
        row: Its interface, the groups of its sides, and whether a set of joints made it.
    """
    interface, a, b, of_set = row
    pairs = parts.case.interfaces.pairs
    name = pairs[interface].name if 0 <= interface < len(pairs) else None
    field = tables.in_joint([parts.names[a], parts.names[b]], name)
    entry = tables.entry(field)
    wet = "auto" if entry is None else entry.wet
    if wet == "auto":
        law = parts.laws[interface] if interface >= 0 else None
        strong = law is not None and INTERFACE_LAWS[law.law].bonds(law)
        known = of_set or name is not None or biot[a] or biot[b]
        wet = "broken" if strong and not known else "always"
    return _unless_never(tables, field), wet == "always"


def _unless_never(tables: WaterTables, field: int) -> int:
    entry = tables.entry(field)
    return tables.dry if entry is not None and entry.wet == "never" else field


def _mates(
    t: Topology, out: Assembly
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Faces that lie on one another at the start, in both directions: face, mate, code of the pair or -1."""
    pairs = [out.pair_faces[kind].reshape(-1, 2) for kind in KINDS]
    codes = [3 * np.arange(len(faces)) + kind for kind, faces in enumerate(pairs)]
    paired = np.zeros(len(t.face_nodes), bool)
    for faces in pairs[:2]:
        paired[faces.ravel()] = True
    touching = t.pair_faces.reshape(-1, 2)
    touching = touching[~paired[touching[:, 0]]] if len(touching) else touching
    both = np.concatenate([*pairs, touching]).astype(np.intp)
    code = np.concatenate([*codes, np.full(len(touching), -1)]).astype(np.intp)
    face, mate, code = both.T.ravel(), both[:, ::-1].T.ravel(), np.tile(code, 2)
    beside = flush_beside(t, face, mate)
    return (
        np.concatenate([face, beside[0]]),
        np.concatenate([mate, beside[1]]),
        np.concatenate([code, np.full(len(beside[0]), -1)]),
    )


def _wet_set(name: str, corners: int, faces: _Faces, tables: WaterTables, parts: Parts) -> None:
    """Add the faces with this number of corners that may be wet."""
    t = parts.topology
    nodes = t.face_nodes[faces.face][:, :corners]
    count, stride = len(nodes), parts.stride(len(nodes))
    parts.assembly.counts[f"{name}.count"] = count
    points = t.node_position[nodes.ravel()]
    kept = tables.kept(np.repeat(faces.joint, nodes.shape[1]), points).reshape(nodes.shape)
    first = np.searchsorted(faces.mate_of, np.arange(count + 1))
    parts.assembly.arrays |= {
        f"{name}.nodes": table(nodes.T.astype(np.int32), stride),
        f"{name}.kept": table(kept.T, stride),
        f"{name}.face": faces.face.astype(np.int32),
        f"{name}.joint": faces.joint.astype(np.int32),
        f"{name}.open": faces.open.astype(np.int32),
        f"{name}.bonded": faces.bonded.astype(np.int8),
        f"{name}.aperture": faces.aperture.astype(float),
        f"{name}.pair_first": first.astype(np.int32),
        f"{name}.pair": faces.pair.astype(np.int32),
        f"{name}.mate": faces.mate.astype(np.int32),
    }


def _weigh(parts: Parts, tables: WaterTables, node_field: NDArray[np.integer]) -> None:
    """Give elements with water at their middle their saturated weight."""
    t, materials = parts.topology, _materials(parts)
    more = np.array([(m.saturated_density or m.density) - m.density for m in materials])
    more *= [parts.case.groups[name].gravity for name in parts.names]
    for shape, nodes in t.element_nodes.items():
        extra = more[t.element_group[shape]]
        if not extra.any():
            continue
        corners = t.node_position[nodes]
        wet = tables.pressure(node_field[nodes[:, 0]], corners.mean(axis=1)) > 0
        masses = element_shapes.mass_matrices(shape, corners, extra * wet).sum(axis=2)
        np.add.at(parts.assembly.arrays["node.gravity_mass"], nodes, masses)
