"""Pressure fields of water, in the core's format and at any point at the start."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.formula import Formula
from cdem.case.water_schema import Reservoir, WaterField
from cdem.errors import CaseError
from cdem.mesh.arrays import along
from cdem.mesh.topology import Topology
from cdem.model.curves import Curves, add_curve
from cdem.model.flat_arrays import Floats
from cdem.model.overburden import weight_above

SIDE = 1e-5
"""Lateral shift of points, relative to the model's size."""
Pressure = Callable[[Floats], Floats]


@dataclass
class _Field:
    """A pressure field: its row in the core, and its initial pressure at points.

    Attributes:
        row: See `WaterFields` in the core; 8 numbers, the sixth the pressure per metre of lift.
        curves: Curves of lift and factor.
        at: Function for the stored pressure of points [Pa], shape (points,), or None if the row
            gives it.
    """

    row: list[float]
    curves: tuple[int, int]
    at: Pressure | None = None

    def kept(self, points: Floats) -> Floats:
        """Stored pressure of points [Pa], shape (points,)."""
        return np.zeros(len(points)) if self.at is None else self.at(points)

    def pressure(self, points: Floats, curves: Curves) -> Floats:
        """Pressure [Pa] at points at time zero, shape (points,)."""
        factor = curves[self.curves[1]].at_start
        return factor * np.maximum(self.signed(points, curves), 0.0)

    def signed(self, points: Floats, curves: Curves) -> Floats:
        """The same without its history, negative above a water table [Pa], shape (points,)."""
        lift = curves[self.curves[0]].at_start
        return (
            self.row[0]
            + along(points, np.array(self.row[1:4]))
            + self.kept(points)
            + self.row[5] * lift
        )


DRY = _Field([0.0] * 8, (0, 0))


class WaterTables:
    """The water of a case over a model.

    Attributes:
        fields: One for each entry, then the reservoir's if there is one, then a dry one.
        reservoir: Number of the reservoir's field, or of the dry one.
        density: Density of the water [kg/m3].
        unit: Unit weight of the water [Pa/m].

    Args:
        case: Case with water.
        t: Blocks and faces.
        names: Names of the groups.
        curves: Receives the curves of the histories.

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
            self.fields.append(self._at_level(self._water.reservoir, 0.0, 0))
        self.fields.append(DRY)

    def in_wet_joints(
        self, arrays: dict[str, NDArray], points: Floats, face: NDArray[np.integer]
    ) -> Floats:
        """Pressure [Pa] at points of joints that are wet at the start, shape (points,).

        Args:
            arrays: Arrays of the core.
            points: Points [m], shape (points, 3).
            face: Face of each point.
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
        """The fields, but dry at points that the reservoir does not reach, shape (points,)."""
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
        """The entry of a field; None for reservoir and dry."""
        return self._water.fields[field] if field < len(self._water.fields) else None

    def pressure(self, field: NDArray[np.integer], points: Floats) -> Floats:
        """Pressure [Pa] of fields at points at time zero, shape (points,)."""
        found = np.zeros(len(points))
        for number in np.unique(field):
            some = field == number
            with self._case.blame(f"water.fields.{number}"):
                found[some] = self.fields[number].pressure(points[some], self._curves)
        return found

    def signed(self, number: int, points: Floats) -> Floats:
        """Pressure [Pa] of a field at points at time zero, negative above its table.

        Args:
            number: Number of the field.
            points: Points [m], shape (points, 3).
        """
        with self._case.blame(f"water.fields.{number}"):
            return self.fields[number].signed(points, self._curves)

    def kept(self, field: NDArray[np.integer], points: Floats) -> Floats:
        """Stored pressure of fields at points [Pa], shape (points,)."""
        found = np.zeros(len(points))
        for number in np.unique(field):
            if self.fields[number].at is not None:
                some = field == number
                with self._case.blame(f"water.fields.{number}"):
                    found[some] = self.fields[number].kept(points[some])
        return found

    def rows(self) -> tuple[Floats, NDArray[np.int32]]:
        """Rows of the fields in the core's format, and their curves."""
        return (
            np.array([f.row for f in self.fields], float).ravel(),
            np.array([f.curves for f in self.fields], np.int32).ravel(),
        )

    def _in_group(self, name: str) -> int:
        return self._last(lambda e: e.interface is None and _holds(e, [name]))

    def _last(self, holds: Callable[[WaterField], bool]) -> int:
        """The last entry that applies, else the reservoir, else dry."""
        found = [i for i, entry in enumerate(self._water.fields) if holds(entry)]
        return found[-1] if found else self.reservoir

    def _field(self, entry: WaterField) -> _Field:
        factor = add_curve(entry.history, entry.stage, self._curves)
        if entry.level is not None:
            return self._at_level(entry, entry.lift, factor)
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

    def _at_level(self, entry: WaterField | Reservoir, lift: float, factor: int) -> _Field:
        level = entry.level
        assert level is not None
        first, curve = (level[0][1], -1) if isinstance(level, list) else (level, 0)
        if isinstance(level, list):
            rise = [(time, height - first) for time, height in level]
            curve = add_curve(rise, entry.stage, self._curves)
        per_lift = self.unit if curve else 0.0
        row = [self.unit * (first + lift), 0, 0, -self.unit, 0, per_lift, 0, 0]
        return _Field(row, (curve, factor))

    def _heights(self, file: str) -> Callable[[Floats], Floats]:
        from cdem.terrain.rasters import read_grid

        return read_grid(self._case.path_of(file))

    def _by_weight(self, ratio: float) -> Pressure:
        g = -self._case.loads.gravity[2]
        materials = [self._case.materials[self._case.groups[n].material] for n in self._names]
        density = np.array([m.density for m in materials])

        def kept(points: Floats) -> Floats:
            # vertices at the sides of the rock lie under it on at least one side
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
            raise ValueError(f"the formula has no value at {x:g}, {y:g}, {z:g}")
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
        raise CaseError(f"{path}: a value of the table is missing or not a number")
    interpolation = extra("scipy.interpolate")
    nearest = interpolation.NearestNDInterpolator(points, pressure)
    try:
        linear = interpolation.LinearNDInterpolator(points, pressure)
    except Exception as error:  # from Qhull: too few points, or all in a plane
        raise CaseError(
            f"{path}: the points of a table must span a volume ({type(error).__name__})"
        ) from None

    def kept(at: Floats) -> Floats:
        found = linear(at)
        return np.where(np.isnan(found), nearest(at), found)

    return kept
