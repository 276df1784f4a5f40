"""Initial stress of the rock: of elements, as a subtracted strain; of bonds and joints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.case.case import Case
from cdem.case.interface_schema import Interface
from cdem.case.laws import INTERFACE_LAWS
from cdem.case.schema import Material
from cdem.case.stress_schema import InitialStress, PrincipalStress
from cdem.errors import CaseError
from cdem.mesh import element_shapes
from cdem.mesh.arrays import matrix_product
from cdem.mesh.topology import Topology
from cdem.model.curves import constant
from cdem.model.options import pairs_loose_joints
from cdem.model.overburden import weight_above
from cdem.model.water_fields import WaterTables

if TYPE_CHECKING:
    from cdem._core import Core

Floats = NDArray[np.float64]

PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
"""Rows and columns of xx yy zz xy yz zx."""


@dataclass(frozen=True)
class InitialState:
    """The initial stress of the rock.

    Attributes:
        lowest: Lowest xx, yy, zz of an element [Pa]: the largest pressures.
        highest: Highest xx, yy, zz [Pa].
        cut: Bond points whose joint could not carry the traction.
        most_cut: Largest traction that was cut [Pa].
        cut_at: Place of that traction [m], or None.
        pulled: Numbers of the entries with tension in all directions everywhere.
    """

    lowest: list[float]
    highest: list[float]
    cut: int
    most_cut: float
    cut_at: list[float] | None
    pulled: list[int]

    def as_dict(self) -> dict[str, Any]:
        """Ready for JSON."""
        return {
            "lowest_normal_stress": self.lowest,
            "highest_normal_stress": self.highest,
            "cut_bond_points": self.cut,
            "largest_cut_traction": self.most_cut,
        }


def set_initial_stress(
    case: Case, t: Topology, names: list[str], laws: list[Interface], core: Core
) -> InitialState | None:
    """Give the rock of a started core the initial stress of its case.

    Paired joints without strength begin broken, even without initial stress.

    Returns:
        The initial stress; None if the case gives none.

    Raises:
        CaseError: An entry does not fit the model.
    """
    if not pairs_loose_joints(case):
        return None
    bonded = np.array([INTERFACE_LAWS[law.law].bonds(law) for law in laws], np.int8)
    position, faces = core.bond_places()
    points, faces = np.reshape(position, (-1, 3)), np.reshape(faces, (-1, 2)).astype(np.intp)
    if not case.initial_stress:
        core.set_initial_tractions(np.zeros((len(points), 6)), bonded)
        return None
    field = _Field(case, t, names)
    lowest, highest = _set_elements(t, field, core)
    group = t.face_group[faces]
    stress = field.at(points, group[:, 0])
    differ = np.flatnonzero(group[:, 0] != group[:, 1])  # the mean of both sides
    stress[differ] = 0.5 * (stress[differ] + field.at(points[differ], group[differ, 1]))
    if field.water is not None:  # joints carry the rest of the total stress of the rock
        joint = field.water.in_wet_joints(core.model(), points, faces[:, 0])
        pores = 0.5 * sum(field.in_pores(points, group[:, side]) for side in (0, 1))
        stress[:, :3] += (joint - pores)[:, None]
    stress[field.absent[group].any(axis=1)] = 0
    cut, most, face = core.set_initial_tractions(stress, bonded)
    nodes = t.face_nodes[face] if face >= 0 else None
    at = None if nodes is None else t.node_position[nodes[nodes >= 0]].mean(axis=0).tolist()
    return InitialState(lowest, highest, cut, most, at, field.pulled())


def _set_elements(t: Topology, field: _Field, core: Core) -> tuple[list[float], list[float]]:
    """Write inelastic strains -C^-1 : S0; returns lowest and highest normal stresses."""
    arrays, state = core.model(), core.fields()
    lame, shear = arrays["material.lambda"], arrays["material.mu"]
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for shape in element_shapes.NODES:
        group = t.element_group[shape]
        if not len(group):
            continue
        corners = t.node_position[t.element_nodes[shape]]
        places = element_shapes.gauss_positions(shape, corners)
        if len(arrays[f"{shape}.hourglass"]):  # one point in the middle
            volume = element_shapes.volumes(shape, corners)
            places = (np.einsum("ep,epx->ex", volume, places) / volume.sum(axis=1)[:, None])[
                :, None
            ]
        count = places.shape[1]
        stress = field.at(places.reshape(-1, 3), np.repeat(group, count))
        there = stress[~field.absent[np.repeat(group, count)], :3]
        low = np.minimum(low, there.min(axis=0, initial=np.inf))
        high = np.maximum(high, there.max(axis=0, initial=-np.inf))
        first, mu = np.repeat(lame[group], count), np.repeat(shear[group], count)
        strain = stress / (2 * mu)[:, None]
        strain[:, :3] -= (first / (2 * mu * (3 * first + 2 * mu)) * stress[:, :3].sum(axis=1))[
            :, None
        ]
        rows = state[f"{shape}.history"].reshape(count, native.point_history, -1)
        rows[:, :6, : len(group)] = -strain.reshape(len(group), count, 6).transpose(1, 2, 0)
    return low.tolist(), high.tolist()


class _Field:
    """The initial stress given by a case.

    Args:
        case: Case with entries of `initial_stress`.
        t: Blocks and faces.
        names: Names of the groups.

    Attributes:
        absent: Groups added by a later stage, which have no stress, shape (groups,).
    """

    def __init__(self, case: Case, t: Topology, names: list[str]) -> None:
        self._case, self._t, self._names = case, t, names
        self.water = None if case.water is None else WaterTables(case, t, names, constant())
        self.absent = np.isin(names, case.absent(0))
        self._pulls: dict[int, bool] = {}
        for i, entry in enumerate(case.initial_stress):
            if entry.vertical:
                self._check_gravity(i)
                self._check_surface(i, entry)

    def at(self, points: Floats, group: NDArray[np.integer]) -> Floats:
        """Stress xx yy zz xy yz zx of points of these groups [Pa], shape (points, 6)."""
        found = np.zeros((len(points), 6))
        for i, entry in enumerate(self._case.initial_stress):
            some = ~self.absent[group]
            if entry.groups is not None:
                some &= np.isin(group, [self._names.index(name) for name in entry.groups])
            if entry.box is not None:
                low, high = np.array(entry.box.min), np.array(entry.box.max)
                some &= ((points >= low) & (points <= high)).all(axis=1)
            if some.any():
                found[some] = self._of(entry, points[some], group[some])
                pulls = bool((found[some, :3] > 0).all())
                self._pulls[i] = self._pulls.get(i, True) and pulls
        return found

    def in_pores(self, points: Floats, group: NDArray[np.integer]) -> Floats:
        """Part of the pore pressure that reduces the stress [Pa], shape (points,)."""
        if self.water is None:
            return np.zeros(len(points))
        biot = np.array([m.biot for m in self._materials])
        return biot[group] * self.water.pressure(self.water.in_pores(points, group), points)

    @property
    def _materials(self) -> list[Material]:
        return [self._case.materials[self._case.groups[name].material] for name in self._names]

    def pulled(self) -> list[int]:
        """Entries with tension in all directions everywhere."""
        return [i for i, pulls in self._pulls.items() if pulls]

    def _of(self, entry: InitialStress, points: Floats, group: NDArray[np.integer]) -> Floats:
        if entry.vertical:
            return self._overburden(entry, points, group)
        middle = entry.stress or _of_principal(entry.principal)
        slope = np.array([entry.gradient.x, entry.gradient.y, entry.gradient.z])
        away = points - np.array(entry.origin)
        change = sum(away[:, axis, None] * slope[axis] for axis in range(3))
        return np.asarray(middle, float) + change

    def _overburden(
        self, entry: InitialStress, points: Floats, group: NDArray[np.integer]
    ) -> Floats:
        density = np.where(self.absent, 0.0, [m.density for m in self._materials])
        mass, top = weight_above(self._t, density, points)
        if entry.surface != "top":
            ends = np.where(np.isfinite(top), np.maximum(top, points[:, 2]), points[:, 2])
            mass += density[group] * np.maximum(0.0, entry.surface - ends)
        if self.water is not None:
            mass += self._water_above(points, group, top)
        pressure = mass * -self._case.loads.gravity[2] - self.in_pores(points, group)
        trend = np.radians(entry.azimuth)
        first = np.array([np.sin(trend), np.cos(trend), 0.0])
        second = np.array([-first[1], first[0], 0.0])
        ratio = (
            entry.k0[0] * np.outer(first, first)
            + entry.k0[-1] * np.outer(second, second)
            + np.diag([0.0, 0.0, 1.0])
        )
        return -pressure[:, None] * np.array([ratio[i, j] for i, j in PLACES])

    def _water_above(self, points: Floats, group: NDArray[np.integer], top: Floats) -> Floats:
        """Mass of water above the ground, and of the water that saturates the rock above [kg/m2].

        The rock between a point and the water table gets the density at the point.
        """
        assert self.water is not None
        unit = self.water.unit
        deep = self.water.pressure(self.water.in_pores(points, group), points) / unit
        more = np.array([(m.saturated_density or m.density) - m.density for m in self._materials])
        covered = np.isfinite(top)
        ground = np.where(covered, top, points[:, 2])
        over = np.stack([points[:, 0], points[:, 1], ground], axis=1)
        open_water = self.water.near(np.full(len(points), self.water.reservoir, np.int32), over)
        depth = self.water.pressure(open_water, over) / unit
        return more[group] * np.minimum(deep, ground - points[:, 2]) + depth * self.water.density

    def _check_gravity(self, entry: int) -> None:
        g = self._case.loads.gravity
        if g[0] or g[1] or not g[2] < 0:
            raise CaseError(
                f"{self._case.where(f'initial_stress.{entry}.vertical')}: overburden needs gravity along -z, "
                f"got {list(g)}; give stress with a gradient"
            )

    def _check_surface(self, number: int, entry: InitialStress) -> None:
        top = self._t.node_position[:, 2].max()
        if entry.surface != "top" and entry.surface < top:
            raise CaseError(
                f"{self._case.where(f'initial_stress.{number}.surface')}: {entry.surface:g} m lies below the top "
                f"of the model, {top:g} m; leave it out if the model ends at the ground"
            )


def _of_principal(principal: PrincipalStress | None) -> list[float]:
    assert principal is not None  # the schema requires one of three
    d = principal.directions()
    for _ in range(6):  # to the nearest orthogonal directions; LAPACK's bits depend on the CPU
        d = 1.5 * d - 0.5 * matrix_product(d, matrix_product(d.T, d))
    tensor = np.einsum("k,ki,kj->ij", principal.values, d, d)
    return [float(tensor[i, j]) for i, j in PLACES]
