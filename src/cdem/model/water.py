"""Water for the core: pressure fields, the faces that they may press on, and the pores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.formula import Formula
from cdem.case.interface_schema import Interface
from cdem.case.laws import INTERFACE_LAWS
from cdem.case.water_schema import Level, WaterField
from cdem.errors import CaseError
from cdem.mesh import element_shapes
from cdem.mesh.topology import Topology
from cdem.model.curves import Curves, add_curve
from cdem.model.faces import face_normals
from cdem.model.flat_arrays import Assembly, Floats, ragged, table
from cdem.model.overburden import weight_above

OPEN = 0.05
"""Joints keep their water up to this part of the length of a face."""
SIDE = 1e-5
"""Points are looked at so far aside, in parts of the model."""
FLUSH = 0.9
"""Cosine between the normals of faces that make one wall of a joint."""
KINDS = ("triangles", "quads", "overlaps")
"""Of pairs, in the order of the core."""
Pressure = Callable[[Floats], Floats]
Stride = Callable[[int], int]


@dataclass
class _Field:
    """A pressure field: the row that the core reads, and what it is at a place at the start.

    Attributes:
        row: See `WaterFields` in the core; 8 numbers, the sixth the pressure for each metre of lift.
        curves: Of lift and factor.
        at: Pressure [Pa] that points keep, shape (points,), or None where it follows from the row.
    """

    row: list[float]
    curves: tuple[int, int]
    at: Pressure | None = None

    def kept(self, points: Floats) -> Floats:
        """What points keep [Pa], shape (points,)."""
        return np.zeros(len(points)) if self.at is None else self.at(points)

    def pressure(self, points: Floats, curves: Curves) -> Floats:
        """Pressure [Pa] at points at time zero, shape (points,)."""
        lift, factor = (float(np.interp(0.0, *curves[c])) for c in self.curves)
        raw = self.row[0] + points @ self.row[1:4] + self.kept(points) + self.row[5] * lift
        return factor * np.maximum(raw, 0.0)


DRY = _Field([0.0] * 8, (0, 0))


class WaterTables:
    """The water of a case over a model.

    Attributes:
        fields: One for each entry, then that of the reservoir if there is one, then a dry one.
        reservoir: Number of its field, that of the dry one where there is none.
        density: Of the water [kg/m3].
        unit: Its weight [Pa/m].

    Args:
        case: With water.
        t: Blocks and faces.
        names: Of the groups.
        curves: Gets those of the histories.

    Raises:
        CaseError: An entry cannot be read.
    """

    def __init__(self, case: Case, t: Topology, names: list[str], curves: Curves) -> None:
        assert case.water is not None
        self._case, self._t, self._names, self._curves = case, t, names, curves
        self._water = case.water
        self.density = self._water.density
        self.unit = self.density * -case.loads.gravity[2]
        self.fields: list[_Field] = []
        for i, entry in enumerate(self._water.fields):
            with case.blame(f"water.fields.{i}"):
                self.fields.append(self._field(entry))
        self.reservoir = len(self.fields)
        if self._water.reservoir is not None:
            self.fields.append(self._at_level(self._water.reservoir.level, 0.0, 0))
        self.fields.append(DRY)

    def in_wet_joints(
        self, arrays: dict[str, NDArray], points: Floats, face: NDArray[np.integer]
    ) -> Floats:
        """Pressure [Pa] at points of joints that are wet at the start, shape (points,).

        Args:
            arrays: Of the core.
            points: [m], shape (points, 3).
            face: On which each lies.
        """
        field = np.full(len(arrays["face.area"]), self.dry, np.int32)
        for kind in ("triangles", "quads"):
            wet = arrays[f"wet_{kind}.bonded"].astype(bool)
            field[arrays[f"wet_{kind}.face"][wet]] = arrays[f"wet_{kind}.joint"][wet]
        return self.pressure(field[face], points)

    @property
    def dry(self) -> int:
        """Number of the dry field."""
        return len(self.fields) - 1

    def in_pores(self, points: Floats, group: NDArray[np.integer]) -> NDArray[np.int32]:
        """Field of the pores at points of groups, shape (points,)."""
        of_group = [self._in_group(name) for name in self._names]
        return self.near(np.array(of_group, np.int32)[group], points)

    def near(self, field: NDArray[np.int32], points: Floats) -> NDArray[np.int32]:
        """The fields, but dry where the reservoir does not reach points, shape (points,)."""
        water = self._water.reservoir
        if water is None or water.box is None:
            return field
        away = ((points < water.box.min) | (points > water.box.max)).any(axis=1)
        return np.where(away & (field == self.reservoir), np.int32(self.dry), field)

    def in_joint(self, groups: Sequence[str], interface: str | None) -> int:
        """Field of a joint between groups with a named interface."""
        return self._last(
            lambda e: e.interface == interface if e.interface is not None else _holds(e, groups)
        )

    def entry(self, field: int) -> WaterField | None:
        """The entry that a field comes from; None for reservoir and dry."""
        return self._water.fields[field] if field < len(self._water.fields) else None

    def pressure(self, field: NDArray[np.integer], points: Floats) -> Floats:
        """Pressure [Pa] of fields at points at time zero, shape (points,)."""
        found = np.zeros(len(points))
        for number in np.unique(field):
            some = field == number
            with self._case.blame(f"water.fields.{number}"):
                found[some] = self.fields[number].pressure(points[some], self._curves)
        return found

    def kept(self, field: NDArray[np.integer], points: Floats) -> Floats:
        """What points keep of fields [Pa], shape (points,)."""
        found = np.zeros(len(points))
        for number in np.unique(field):
            if self.fields[number].at is not None:
                some = field == number
                with self._case.blame(f"water.fields.{number}"):
                    found[some] = self.fields[number].kept(points[some])
        return found

    def rows(self) -> tuple[Floats, NDArray[np.int32]]:
        """Rows of the fields as the core reads them, and their curves."""
        return (
            np.array([f.row for f in self.fields], float).ravel(),
            np.array([f.curves for f in self.fields], np.int32).ravel(),
        )

    def _in_group(self, name: str) -> int:
        return self._last(lambda e: e.interface is None and _holds(e, [name]))

    def _last(self, holds: Callable[[WaterField], bool]) -> int:
        """The last entry that holds, else the reservoir, else dry."""
        found = [i for i, entry in enumerate(self._water.fields) if holds(entry)]
        return found[-1] if found else self.reservoir

    def _field(self, entry: WaterField) -> _Field:
        factor = add_curve(entry.history, self._curves)
        if entry.level is not None:
            return self._at_level(entry.level, entry.lift, factor)
        unit = self.unit
        if entry.plane is not None:
            dip, azimuth = np.radians([entry.plane.dip, entry.plane.dip_direction])
            if entry.seepage == "parallel":
                unit *= np.cos(dip) ** 2
            fall = np.tan(dip) * np.array([np.sin(azimuth), np.cos(azimuth)])
            x, y, z = entry.plane.point
            top = z + float(fall @ [x, y]) + entry.lift
            return _Field([unit * top, *(-unit * fall), -unit, 0, 0, 0, 0], (0, factor))
        kept: Pressure
        raised = 0.0
        if entry.surface is not None:
            heights, raised = self._heights(entry.surface), unit * entry.lift

            def kept(points: Floats) -> Floats:
                return unit * (heights(points[:, :2]) - points[:, 2])

        elif entry.formula is not None:
            kept = _by_formula(Formula(entry.formula))
        elif entry.table is not None:
            kept = _by_table(self._case, entry.table)
        else:
            kept = self._by_weight(float(entry.ru or 0.0))
        return _Field([raised, 0, 0, 0, 1, 0, 0, 0], (0, factor), kept)

    def _at_level(self, level: Level, lift: float, factor: int) -> _Field:
        first, curve = (level, 0) if not isinstance(level, list) else (level[0][1], -1)
        if curve < 0:
            curve = add_curve([(time, height - first) for time, height in level], self._curves)  # type: ignore[union-attr]
        per_lift = self.unit if curve else 0.0
        row = [self.unit * (first + lift), 0, 0, -self.unit, 0, per_lift, 0, 0]
        return _Field(row, (curve, factor))

    def _heights(self, file: str) -> Callable[[Floats], Floats]:
        from cdem.terrain.files import read_grid

        return read_grid(self._case.path_of(file))

    def _by_weight(self, ratio: float) -> Pressure:
        g = -self._case.loads.gravity[2]
        materials = [self._case.materials[self._case.groups[n].material] for n in self._names]
        density = np.array([m.density for m in materials])

        def kept(points: Floats) -> Floats:
            # vertices at the sides of the rock lie under it on one side at least
            size = np.ptp(self._t.node_position[:, :2], axis=0).max()
            masses = [
                weight_above(self._t, density, points + SIDE * size * np.array([x, y, 0]))[0]
                for x in (-1, 1)
                for y in (-1, 1)
            ]
            return ratio * g * np.maximum.reduce(masses)

        return kept


def _holds(entry: WaterField, groups: Sequence[str]) -> bool:
    return entry.groups is None or any(name in entry.groups for name in groups)


def _by_formula(formula: Formula) -> Pressure:
    def kept(points: Floats) -> Floats:
        values = [formula.value({"x": x, "y": y, "z": z}) for x, y, z in points.tolist()]
        bad = ~np.isfinite(values)
        if bad.any():
            x, y, z = points[int(np.argmax(bad))]
            raise ValueError(f"formula has no value at {x:g}, {y:g}, {z:g}")
        return np.array(values)

    return kept


def _by_table(case: Case, file: str) -> Pressure:
    from cdem.terrain.heights import extra

    path = case.path_of(file)
    try:
        rows = np.genfromtxt(path, delimiter=",", names=True, dtype=float, encoding="utf-8")
        points = np.stack([np.atleast_1d(rows[name]) for name in ("x", "y", "z")], axis=1)
        pressure = np.atleast_1d(rows["pressure"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise CaseError(
            f"{path}: a table needs columns x, y, z, pressure in its first line ({error})"
        ) from None
    if not (np.isfinite(points).all() and np.isfinite(pressure).all()):
        raise CaseError(f"{path}: a value of the table is missing or no number")
    interpolation = extra("scipy.interpolate")
    nearest = interpolation.NearestNDInterpolator(points, pressure)
    try:
        linear = interpolation.LinearNDInterpolator(points, pressure)
    except Exception as error:  # of Qhull: too few points, or all in a plane
        raise CaseError(
            f"{path}: the points of a table must span a volume ({type(error).__name__})"
        ) from None

    def kept(at: Floats) -> Floats:
        found = linear(at)
        return np.where(np.isnan(found), nearest(at), found)

    return kept


def water_of(
    case: Case,
    t: Topology,
    names: list[str],
    laws: list[Interface],
    interface_of: NDArray[np.integer],
    curves: Curves,
    stride: Stride,
    out: Assembly,
) -> None:
    """Put the arrays of water into an assembly; empty ones where the case has none.

    Raises:
        CaseError: An entry cannot be read.
    """
    if case.water is None:
        _no_water(out, stride)
        return
    tables = WaterTables(case, t, names, curves)
    biot = np.array([case.materials[case.groups[name].material].biot for name in names])
    faces = _joints(case, t, names, laws, interface_of, biot, tables, out)
    rows, field_curve = tables.rows()
    node_field = tables.in_pores(t.node_position, t.block_group[t.node_block])
    out.arrays |= {
        "water.fields": rows,
        "water.field_curve": field_curve,
        "water.biot": biot if biot.any() else np.zeros(0),
        "water.node_field": node_field,
        "water.node_kept": tables.kept(node_field, t.node_position),
    }
    owner, row = [], []
    first = 0
    for kind, corners in (("triangles", 3), ("quads", 4)):
        some = faces.of(t, corners)
        nodes = t.face_nodes[some.face][:, :corners]
        _wet_set(f"wet_{kind}", some, nodes, t, tables, stride(len(nodes)), out)
        out.counts[f"wet_{kind}.count"] = len(nodes)
        owner.append(nodes.ravel())
        row.append(first + np.arange(nodes.size))
        first += nodes.size
    for shape, nodes in t.element_nodes.items():
        out.arrays[f"{shape}.values"] = np.zeros(0)
        if biot.any():
            one = bool(len(out.arrays[f"{shape}.hourglass"]))
            out.arrays[f"{shape}.values"] = element_shapes.point_values(shape, one=one).ravel()
            owner.append(nodes.ravel())
            row.append(first + out.counts[f"{shape}.corner_first"] + np.arange(nodes.size))
    out.arrays["water.node_first"], out.arrays["water.row"] = ragged(
        np.concatenate(owner).astype(np.int64), np.concatenate(row).astype(np.int32),
        len(t.node_position),
    )  # fmt: skip
    _weigh(case, t, names, tables, node_field, out)


def _no_water(out: Assembly, stride: Stride) -> None:
    real, whole = np.zeros(0), np.zeros(0, np.int32)
    for name in ("fields", "biot", "node_kept"):
        out.arrays[f"water.{name}"] = real
    for name in ("field_curve", "node_field", "node_first", "row"):
        out.arrays[f"water.{name}"] = whole
    for kind in ("triangles", "quads"):
        out.counts[f"wet_{kind}.count"] = 0
        for name in ("kept", "aperture"):
            out.arrays[f"wet_{kind}.{name}"] = real
        for name in ("nodes", "face", "joint", "open", "pair", "mate"):
            out.arrays[f"wet_{kind}.{name}"] = whole
        out.arrays[f"wet_{kind}.bonded"] = np.zeros(0, np.int8)
        out.arrays[f"wet_{kind}.pair_first"] = np.zeros(1, np.int32)
    for shape in element_shapes.NODES:
        out.arrays[f"{shape}.values"] = real


@dataclass
class _Faces:
    """Faces that water may press on; each array has one value a face, but those of mates.

    Attributes:
        joint: Field where the face is in a joint.
        open: Field where it is free.
        bonded: Whether the joint is wet while bonds hold.
        aperture: Up to which an open joint keeps its water [m].
        mate_of: Place of the face of each mate, ascending.
        mate: Faces that lie on it at the start, then those beside them on the same wall.
        pair: Their pair: 3 times its number plus its kind; -1 where they are not paired.
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
        """Those with so many corners."""
        some = (t.face_nodes[self.face] >= 0).sum(axis=1) == corners
        return self.take(some)

    def take(self, some: NDArray[np.bool_]) -> _Faces:
        """Some of them."""
        place = np.cumsum(some) - 1
        mates = some[self.mate_of]
        return _Faces(
            self.face[some], self.joint[some], self.open[some], self.bonded[some],
            self.aperture[some], place[self.mate_of[mates]], self.mate[mates], self.pair[mates],
        )  # fmt: skip


def _joints(
    case: Case,
    t: Topology,
    names: list[str],
    laws: list[Interface],
    interface_of: NDArray[np.integer],
    biot: Floats,
    tables: WaterTables,
    out: Assembly,
) -> _Faces:
    """All faces on which one of the fields may press."""
    count = len(t.face_nodes)
    face, mate, pair = _mates(t, out)
    kinds = t.face_kind[face], t.face_kind[mate]
    interface = interface_of[kinds[0], kinds[1]]
    groups = t.face_group[face], t.face_group[mate]
    # of each mate: its joint's field, and whether bonds keep it dry
    rows = np.stack([interface, *groups], axis=1)
    unique, which = np.unique(rows, axis=0, return_inverse=True)
    found = [_of_joint(case, names, laws, biot, tables, row.tolist()) for row in unique]
    field = np.array([f for f, _ in found], np.int32)[which.ravel()] if found else face
    wet = np.array([w for _, w in found], bool)[which.ravel()] if found else face.astype(bool)
    # the first mate of a face decides; faces without have the field of their group's joints
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


def _of_joint(
    case: Case,
    names: list[str],
    laws: list[Interface],
    biot: Floats,
    tables: WaterTables,
    row: list[int],
) -> tuple[int, bool]:
    """Field of a joint with this interface between two groups, and whether it is wet while bonded."""
    interface, a, b = row
    name = (
        case.interfaces.pairs[interface].name
        if 0 <= interface < len(case.interfaces.pairs)
        else None
    )
    field = tables.in_joint([names[a], names[b]], name)
    entry = tables.entry(field)
    wet = "auto" if entry is None else entry.wet
    if wet == "auto":
        law = laws[interface] if interface >= 0 else None
        strong = law is not None and INTERFACE_LAWS[law.law].bonds(law)
        wet = "broken" if strong and not (biot[a] or biot[b]) else "always"
    return _unless_never(tables, field), wet == "always"


def _unless_never(tables: WaterTables, field: int) -> int:
    entry = tables.entry(field)
    return tables.dry if entry is not None and entry.wet == "never" else field


def _mates(
    t: Topology, out: Assembly
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """Faces that lie on one another at the start, both ways: face, mate, code of the pair or -1."""
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
    beside = _beside(t, face, mate)
    return (
        np.concatenate([face, beside[0]]),
        np.concatenate([mate, beside[1]]),
        np.concatenate([code, np.full(len(beside[0]), -1)]),
    )


def _beside(
    t: Topology, face: NDArray[np.intp], mate: NDArray[np.intp]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Faces with the flush neighbours of their mates, over which they come when the joint slips."""
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


def _wet_set(
    name: str,
    faces: _Faces,
    nodes: NDArray[np.integer],
    t: Topology,
    tables: WaterTables,
    stride: int,
    out: Assembly,
) -> None:
    count = len(nodes)
    points = t.node_position[nodes.ravel()]
    kept = tables.kept(np.repeat(faces.joint, nodes.shape[1]), points).reshape(nodes.shape)
    first = np.searchsorted(faces.mate_of, np.arange(count + 1))
    out.arrays |= {
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


def _weigh(
    case: Case,
    t: Topology,
    names: list[str],
    tables: WaterTables,
    node_field: NDArray[np.integer],
    out: Assembly,
) -> None:
    """Give elements with water in the middle their saturated weight."""
    materials = [case.materials[case.groups[name].material] for name in names]
    more = np.array([(m.saturated_density or m.density) - m.density for m in materials])
    more *= [case.groups[name].gravity for name in names]
    for shape, nodes in t.element_nodes.items():
        extra = more[t.element_group[shape]]
        if not extra.any():
            continue
        corners = t.node_position[nodes]
        wet = tables.pressure(node_field[nodes[:, 0]], corners.mean(axis=1)) > 0
        masses = element_shapes.mass_matrices(shape, corners, extra * wet).sum(axis=2)
        np.add.at(out.arrays["node.gravity_mass"], nodes, masses)
