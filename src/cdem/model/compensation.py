"""Rock with every element a block: stiffer elements compensate for the compliance of bonds.

Bonds add to the compliance of the elements. With one stiffness k = a E' / h for all bonds of a group,
normal and shear, and isotropic faces, the whole has

    1/E = (1 + q / (3 a)) / E',    nu / E = nu' / E',    q = S_v h,

S_v the area of faces per volume and h their mean distance from the middle of the elements behind: so
E' = e E and nu' = e nu with e = 1 + q / (3 a). Irregular tets are less compliant than this sum,
which assumes a uniform stress: their q is found numerically.

Bricks and other shapes, and tets without inner tets or with very different sizes, get a bond
stiffness
for each face: see `bond_shares`. The surface is then as compliant as the interior, and slices and
columns are correct along the directions in which they have bonds.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from cdem.case.case import Case
from cdem.case.interface_schema import Interface
from cdem.case.types import AUTO
from cdem.errors import CaseError
from cdem.mesh import element_shapes
from cdem.mesh.arrays import found_in, inverses, same_everywhere
from cdem.mesh.topology import Topology
from cdem.model.bond_shares import Shares, added, bonded_parts, longest, shares
from cdem.model.faces import face_areas, face_heights
from cdem.model.homogenize import (
    COLUMN,
    ROW,
    BondedTets,
    compliance,
    displacements,
    elasticity,
    jumps,
)

Floats = NDArray[np.float64]

FACTOR = 5.0
"""a, if Poisson's ratio allows it: softer bonds would not lengthen the step."""
MOST_POISSON = 0.42
"""Largest nu' of the elements: a larger one shortens the step, and 0.5 is out of reach."""
LARGEST_POISSON = 0.4
"""Largest nu of the case: a is 40 there, and grows without bound towards `MOST_POISSON`."""
MOST_TETS = 2000
"""Number of tets around the middle of a group that represent it."""
GRADED = 2.0
"""Ratio of the largest to the smallest tet sizes (without 5 % at either end) above which bond
stiffness depends on the size of tets."""
LAYERS = 2
"""Layers at the edge that are ignored."""


def _pulls() -> Floats:
    """Unit tensions along the axes and diagonals of space, in the order of `STATES`."""
    ways = [w for w in product((-1, 0, 1), repeat=3) if w > (0, 0, 0)]
    n = np.array(ways) / np.sqrt((np.array(ways) ** 2).sum(axis=1))[:, None]
    return n[:, ROW] * n[:, COLUMN]


DIRECTIONS = _pulls()


@dataclass(frozen=True)
class ElasticState:
    """Tets around the middle of a group under six uniform stresses of 1 Pa.

    Attributes:
        tets: The tets.
        tractions: Tractions of `homogenize.STATES` at the corners of the faces: tension along the
            outward
            normal of the first tet [1], shape (faces, 3, xyz, 6).
        counted: Tets that represent the rock, shape (tets,).
    """

    tets: BondedTets
    tractions: Floats
    counted: NDArray[np.bool_]


@dataclass(frozen=True)
class Compensation:
    """Properties of elements and bonds of a group with which the whole has the given elasticity.

    Attributes:
        q: Effective S_v h.
        area_per_volume: S_v, of the faces of inner elements [1/m].
        height: h [m].
        factor: The factor a.
        stiffening: e = E' / E = nu' / nu of the elements.
        stiffness: Stiffness of the bonds; an area mean if it varies [Pa/m].
        errors: Remaining errors: in E along the worst direction, and in the isotropic G and K,
            of the interior, or of the whole if there is no interior [1].
        along_xyz: Remaining error in E for tension of the whole along x, y, z, surfaces included
            [1].
        state: State that gave q; None if q is the sum over faces.
        of_faces: Stiffness of a bond between two faces like each of these, and their numbers; None
            if all are equal [Pa/m].
    """

    q: float
    area_per_volume: float
    height: float
    factor: float
    stiffening: float
    stiffness: float
    errors: tuple[float, float, float]
    along_xyz: tuple[float, float, float]
    state: ElasticState | None
    of_faces: tuple[NDArray[np.intp], Floats] | None


@dataclass(frozen=True)
class _Group:
    """A group of bonded elements, each a block.

    Attributes:
        t: The mesh.
        pairs: Its conforming bonds, inside the group.
        elements: Its elements, shape (elements,).
        bonded: Compensated fraction of each face.
        volume: Volume of all elements [m3].
        area: Area of all faces [m2].
        height: Height of the elements behind the faces [m].
        young: Young's modulus [Pa].
        poisson: Poisson's ratio.
    """

    t: Topology
    pairs: NDArray[np.intp]
    elements: NDArray[np.bool_]
    bonded: Floats
    volume: Floats
    area: Floats
    height: Floats
    young: float
    poisson: float

    def shares(self, height: Floats) -> Shares:
        """Shares of its faces, with these heights h of all faces [m]."""
        return shares(self.t, self.elements, self.volume, self.bonded, self.area, height)

    @property
    def has_tets_only(self) -> bool:
        """Whether all its elements are tets, and some of their faces conform."""
        tets = len(self.t.element_nodes["tet4"])
        return len(self.pairs) > 0 and not self.elements[tets:].any()

    @cached_property
    def sizes(self) -> Floats:
        """Sizes of all elements: edges of cubes of the same volume [m]."""
        return same_everywhere(np.cbrt(self.volume))

    @property
    def is_graded(self) -> bool:
        """Whether some of its elements are much smaller than others."""
        low, high = np.quantile(self.sizes[self.elements], (0.05, 0.95))
        return bool(high > GRADED * low)

    @property
    def has_an_inside(self) -> bool:
        """Whether a tet lies at least `LAYERS` layers inside."""
        inside = surrounded(self.t, self.pairs)
        across = self.t.face_element[self.t.pair_faces[self.pairs]]
        for _ in range(LAYERS - 1):
            edge = ~inside[across].all(axis=1)
            inside[across[edge].ravel()] = False
        return bool(inside.any())


def compensate(
    case: Case, t: Topology, names: list[str], groups: list[int], between: NDArray[np.bool_]
) -> dict[str, Compensation]:
    """Compensation for the bonds of groups, as listed by `compensated_groups`.

    Args:
        case: The case, with the rock of the groups.
        t: The mesh.
        names: Names of all groups.
        groups: Which groups.
        between: Result of `made_up_between`, for all groups of `compensated_groups`.

    Raises:
        CaseError: Poisson's ratio of one is too large for it, or its mesh cannot be solved.
    """
    out: dict[str, Compensation] = {}
    if not groups:
        return out
    shapes = t.element_nodes
    volume = np.concatenate(
        [element_shapes.volumes(s, t.node_position[n]).sum(axis=1) for s, n in shapes.items()]
    )
    group_of = np.concatenate([t.element_group[shape] for shape in shapes])
    area = face_areas(t.node_position, t.face_nodes)
    height = face_heights(t, volume, area)
    bonded = bonded_parts(t, between, area)
    for group in groups:
        pairs = np.flatnonzero((t.face_kind[t.pair_faces] == group).all(axis=1))
        material = case.groups[names[group]].material
        rock = case.materials[material]
        if rock.poisson_ratio > LARGEST_POISSON:
            place = f"materials.{material}.poisson_ratio"
            raise CaseError(
                f"{case.where(place)}: {place}: {rock.poisson_ratio:g} is too large to compensate "
                f"for bonds between the elements of group {names[group]!r} (at most "
                f"{LARGEST_POISSON:g}); give stiffness_n and stiffness_s of its interface"
            )
        of = _Group(
            t,
            pairs,
            group_of == group,
            bonded,
            volume,
            area,
            height,
            rock.young_modulus,
            rock.poisson_ratio,
        )
        with case.blame("model"):
            even = of.has_tets_only and of.has_an_inside and not of.is_graded
            out[names[group]] = _of_inside(of) if even else _of_faces(of)
    return out


def compensated_groups(
    case: Case,
    t: Topology,
    names: list[str],
    laws: list[Interface],
    interface_of: NDArray[np.int32],
    bonds: NDArray[np.bool_],
) -> list[int]:
    """Groups of elements that are all blocks, bonded with a stiffness chosen by the program."""
    elements = elements_of_blocks(t)
    kind = t.face_kind[t.pair_faces]
    bonded = np.unique(kind[(kind[:, 0] == kind[:, 1]) & bonds[kind[:, 0], kind[:, 1]], 0])
    return [
        int(group)
        for group in bonded[bonded < len(names)]
        if is_automatic(laws[interface_of[group, group]])
        and (elements[t.block_group == group] == 1).all()
    ]


def made_up_between(
    laws: list[Interface],
    interface_of: NDArray[np.int32],
    bonds: NDArray[np.bool_],
    groups: list[int],
) -> NDArray[np.bool_]:
    """Kinds of faces between which groups compensate for bonds, shape (kinds, kinds)."""
    automatic = np.array([*map(is_automatic, laws), False])  # the last is for no interface
    made_up = np.isin(np.arange(len(bonds)), groups)
    return bonds & automatic[interface_of] & made_up & made_up[:, None]


def elements_of_blocks(t: Topology) -> NDArray[np.int64]:
    """Number of elements of each block, shape (blocks,)."""
    elements = np.zeros(len(t.block_group), np.int64)
    for block in t.element_block.values():
        elements += np.bincount(block, minlength=len(elements))
    return elements


def is_automatic(law: Interface) -> bool:
    """Whether the program chooses the stiffness of an interface's bonds."""
    return law.stiffness_n == AUTO and law.stiffness_s == AUTO


def _of_inside(g: _Group) -> Compensation:
    """Compensation of tets with an interior: one stiffness for all bonds, exact in the interior."""
    faces = g.t.pair_faces[g.pairs]
    elements = g.t.face_element[faces]
    count = np.bincount(elements.ravel(), minlength=len(g.volume))
    inner = surrounded(g.t, g.pairs)
    share = 0.5 * inner[elements].sum(axis=1) * g.area[faces[:, 0]]
    whole = g.volume[inner & (count > 0)].sum()
    area_per_volume = share.sum() / whole
    q = (share * g.height[faces].min(axis=1)).sum() / whole
    h = _rounded(q / area_per_volume)
    a = _factor(q, g.poisson)
    near = bonded_tets(g.t, g.pairs, around_the_middle(g.t, g.pairs, inner))
    e = 1 + q / (3 * a)
    c, state = _found(near, counted_tets(near), e, a * e / h, g.poisson)
    found = _rounded(3 * a * (e * _isotropic(c)[0] - 1))
    e_new = 1 + found / (3 * a)
    bonds = g.shares(np.full(len(g.area), h)).fabric(0.5) * found / q
    return Compensation(
        q=found,
        area_per_volume=float(area_per_volume),
        height=h,
        factor=a,
        stiffening=e_new,
        stiffness=a * e_new * g.young / h,
        errors=_errors(_renewed(c, e, e_new, g.poisson), g.poisson, DIRECTIONS),
        along_xyz=_along_xyz(_own(e_new, g.poisson) + added(bonds) / (a * e_new)),
        state=state,
        of_faces=None,
    )


def _of_faces(g: _Group) -> Compensation:
    """Compensation of other groups: each face has a stiffness of its own, and free faces count."""
    bonds, height = g.shares(g.height), g.height
    bonded = g.area[bonds.faces] * bonds.bonded * bonds.share
    h = _rounded((bonded * height[bonds.faces]).sum() / bonded.sum())
    if not g.elements[len(g.t.element_nodes["tet4"]) :].any():
        size = g.sizes[g.t.face_element]  # tets use the same size for all faces
        height = size * h * bonded.sum() / (bonded * size[bonds.faces]).sum()
        bonds = g.shares(height)
    fabric, far = bonds.fabric(), longest(g.t, g.elements, g.volume)
    # partly bonded groups are to be correct in their bonded parts
    q = 3 * max(float((far * m).sum()) for m in (fabric, bonds.surrounded()))
    a = _factor(q, g.poisson)
    e = 1 + q / (3 * a)
    c, state = _own(e, g.poisson) + added(fabric) / (a * e), None
    soft = np.zeros(len(g.area))
    soft[bonds.faces] = bonds.share * height[bonds.faces]
    if g.has_tets_only:
        near = around_the_middle(g.t, g.pairs, surrounded(g.t, g.pairs))
        tets = bonded_tets(g.t, g.pairs, near)
        stiffness = a * e / soft[g.t.pair_faces[tets.pair]].sum(axis=1)
        even = e * _isotropic(c)[0] - 1
        c, state = _found(tets, _uncut(g, near, tets), e, stiffness, g.poisson)
        q *= (e * _isotropic(c)[0] - 1) / even
    q = _rounded(q)
    e_new = 1 + q / (3 * a)
    left = _renewed(c, e, e_new, g.poisson)
    own = same_everywhere(a * e_new * g.young / (2 * soft[bonds.faces]))
    axes = np.linalg.eigh(fabric)[1].T
    pulls = np.concatenate([DIRECTIONS, axes[:, ROW] * axes[:, COLUMN]])
    return Compensation(
        q=q,
        area_per_volume=float(bonded.sum() / g.volume[g.elements].sum()),
        height=h,
        factor=a,
        stiffening=e_new,
        stiffness=float((bonded * own).sum() / bonded.sum()),
        errors=_errors(left, g.poisson, pulls),
        along_xyz=_along_xyz(left),
        state=state,
        of_faces=(bonds.faces, own),
    )


def _factor(q: float, poisson: float) -> float:
    """a of bonds with this q, limited by Poisson's ratio."""
    return max(FACTOR, _rounded(q * poisson / (3 * (MOST_POISSON - poisson))))


def _rounded(value: float) -> float:
    return float(same_everywhere(np.array(value)))


def _uncut(g: _Group, some: NDArray[np.integer], tets: BondedTets) -> NDArray[np.bool_]:
    """Tets `LAYERS` layers away from the ignored tets of the group, or all."""
    bonds = np.bincount(g.t.face_element[g.t.pair_faces[g.pairs]].ravel(), minlength=len(g.volume))
    away = np.bincount(tets.tet.ravel(), minlength=len(some)) == bonds[some]
    for _ in range(LAYERS - 1):
        edge = ~away[tets.tet].all(axis=1)
        away[tets.tet[edge].ravel()] = False
    return away if away.any() else np.ones(len(some), bool)


def _found(
    tets: BondedTets,
    counted: NDArray[np.bool_],
    e: float,
    stiffness: float | Floats,
    poisson: float,
) -> tuple[Floats, ElasticState]:
    """Compliance of tets and their state, for Young's modulus 1 of the rock.

    Args:
        tets: The tets.
        counted: Tets that represent the rock.
        e: Stiffening of the tets.
        stiffness: Stiffness of their bonds.
        poisson: Poisson's ratio of the rock.
    """
    u = displacements(tets, e, poisson * e, stiffness)
    pulls = np.reshape(stiffness, (-1, 1, 1, 1)) * jumps(tets, u)
    return compliance(tets, u, e, poisson * e, counted), ElasticState(tets, pulls, counted)


def _own(e: float, poisson: float) -> Floats:
    """Compliance of elements alone, for Young's modulus 1 of the rock."""
    return inverses(elasticity(e, e * poisson)[None])[0]


def _renewed(c: Floats, e: float, e_new: float, poisson: float) -> Floats:
    """A compliance for another e of its elements: the part of bonds is proportional to 1 / e."""
    return (c - _own(e, poisson)) * e / e_new + _own(e_new, poisson)


def _errors(left: Floats, poisson: float, pulls: Floats) -> tuple[float, float, float]:
    """Errors of E in the worst direction, and of the isotropic G and K, of a compliance for unit E."""
    along = 1 / np.einsum("di,ij,dj->d", pulls, left, pulls) - 1
    worst = float(along[np.argmax(abs(along))])
    young, bulk = (1 / part for part in _isotropic(left))
    shear = 3 * bulk * young / (9 * bulk - young)
    return worst, shear * 2 * (1 + poisson) - 1, bulk * 3 * (1 - 2 * poisson) - 1


def _along_xyz(c: Floats) -> tuple[float, float, float]:
    """Errors of E along x, y, z of a compliance for Young's modulus 1."""
    x, y, z = (float(1 / c[axis, axis] - 1) for axis in range(3))
    return x, y, z


def _isotropic(c: Floats) -> tuple[float, float]:
    """1/E and 1/K of the isotropic part of a compliance."""
    normal, cross, shear = np.trace(c[:3, :3]), c[0, 1] + c[1, 2] + c[2, 0], np.trace(c[3:, 3:])
    return float(3 * normal + 2 * cross + shear) / 15, float(c[:3, :3].sum())


def surrounded(t: Topology, pairs: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Elements with all faces in these pairs, shape (elements,)."""
    count = sum(len(nodes) for nodes in t.element_nodes.values())
    faces = np.bincount(t.face_element, minlength=count)
    bonded = np.bincount(t.face_element[t.pair_faces[pairs]].ravel(), minlength=count)
    return (bonded == faces) & (faces > 0)


def around_the_middle(
    t: Topology, pairs: NDArray[np.intp], inner: NDArray[np.bool_]
) -> NDArray[np.integer]:
    """Tets of pairs around the middle of the interior ones, or of all, at most `MOST_TETS`."""
    used = found_in([t.face_element[t.pair_faces[pairs]]], len(inner))
    center = t.node_position[t.element_nodes["tet4"][used]].mean(axis=1)
    inside = center[inner[used]] if inner[used].any() else center
    start = inside[np.argmin(((inside - inside.mean(axis=0)) ** 2).sum(axis=1))]
    near = np.argsort(((center - start) ** 2).sum(axis=1), kind="stable")[:MOST_TETS]
    return used[near]


def counted_tets(tets: BondedTets) -> NDArray[np.bool_]:
    """Tets far enough inside to represent the rock, or all if there are none."""
    layers = [tets.inner(n) for n in range(LAYERS, 0, -1)]
    return next((inside for inside in layers if inside.any()), np.ones(len(tets.x), bool))


def bonded_tets(t: Topology, pairs: NDArray[np.intp], some: NDArray[np.integer]) -> BondedTets:
    """Some tets, by number, with the faces of pairs between two of them."""
    number = np.full(len(t.element_nodes["tet4"]), -1)
    number[some] = np.arange(len(some))
    tet = number[t.face_element[t.pair_faces[pairs]]]
    both = (tet >= 0).all(axis=1)
    tet, pairs = tet[both], pairs[both]
    nodes = t.element_nodes["tet4"][some]
    a, b = t.pair_faces[pairs].T
    order = (t.pair_shift[pairs, None] - np.arange(3)) % 3
    corner_a = _corner_of(nodes[tet[:, 0]], t.face_nodes[a, :3])
    corner_b = _corner_of(nodes[tet[:, 1]], np.take_along_axis(t.face_nodes[b, :3], order, axis=1))
    return BondedTets(t.node_position[nodes], tet, np.stack([corner_a, corner_b], axis=1), pairs)


def _corner_of(nodes: NDArray, some: NDArray) -> NDArray[np.intp]:
    """Corner numbers in tets, (n, 4), of some of their nodes, (n, 3)."""
    return (nodes[:, None, :] == some[:, :, None]).argmax(axis=2)
