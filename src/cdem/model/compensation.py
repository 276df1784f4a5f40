"""Rock whose every element is a block: its elements are made so stiff that the whole is as given.

Bonds add to the compliance of the elements. With one stiffness k = a E' / h for all bonds of a group,
normal and shear, and isotropic faces, the whole has

    1/E = (1 + q / (3 a)) / E',    nu / E = nu' / E',    q = S_v h,

S_v the area of faces per volume and h their mean distance from the middle of the elements behind: so
E' = e E and nu' = e nu with e = 1 + q / (3 a). Irregular tets are less compliant than that sum says,
which takes their stress for uniform: their q is found numerically.

Bricks and other shapes, and tets that are nowhere surrounded by others or of sizes that differ much,
have a bond stiffness of each face: see `bond_shares`. So what lies at the surface is as compliant as what lies inside, and slices
and columns are right along the directions in which they have bonds at all.
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
from cdem.mesh.arrays import found_in, in_pieces, inverses, same_everywhere
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
"""a, where Poisson's ratio allows it: softer bonds no longer lengthen the step."""
MOST_POISSON = 0.42
"""nu' of the elements, at most: a larger one shortens the step, and 0.5 is out of reach."""
LARGEST_POISSON = 0.4
"""nu of the case, at most: a is 40 there, and grows without bound towards `MOST_POISSON`."""
MOST_TETS = 2000
"""So many tets around the middle of a group stand for all of them."""
GRADED = 2.0
"""So much larger than the smallest tets are the largest, but for 5 % of either, where bonds go with
the size of tets."""
LAYERS = 2
"""Layers at the edge of those that do not count."""


def _pulls() -> Floats:
    """Unit pulls along the axes and diagonals of space, in the order of `STATES`."""
    ways = [w for w in product((-1, 0, 1), repeat=3) if w > (0, 0, 0)]
    n = np.array(ways) / np.sqrt((np.array(ways) ** 2).sum(axis=1))[:, None]
    return n[:, ROW] * n[:, COLUMN]


DIRECTIONS = _pulls()


@dataclass(frozen=True)
class ElasticState:
    """Tets around the middle of a group under six uniform stresses of 1 Pa.

    Attributes:
        tets: The tets.
        tractions: On the faces, at their corners, of `homogenize.STATES`: pulling along the outward
            normal of the first tet [1], shape (faces, 3, xyz, 6).
        counted: Tets that stand for the rock, shape (tets,).
    """

    tets: BondedTets
    tractions: Floats
    counted: NDArray[np.bool_]


@dataclass(frozen=True)
class Compensation:
    """What the elements and bonds of a group have, so that the whole is as the case says.

    Attributes:
        q: S_v h, as it acts.
        area_per_volume: S_v, of the faces of inner elements [1/m].
        height: h [m].
        factor: a.
        stiffening: e = E' / E = nu' / nu, of the elements.
        stiffness: Of the bonds; the mean by area where it varies [Pa/m].
        errors: What is left: in E along the direction where it is worst, and in the isotropic G and K,
            of what lies inside, or of the whole where nothing does [1].
        along_xyz: What is left in E if the whole is pulled along x, y, z, surfaces included [1].
        state: From which q was found; None where it is the sum over faces.
        of_faces: Stiffness of a bond whose two faces are like each of these, and which they are; None
            where all are the same [Pa/m].
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
        pairs: Those of its conforming bonds, inside the group.
        elements: Which they are, shape (elements,).
        bonded: What part of each face is made up for.
        volume: Of all elements [m3].
        area: Of all faces [m2].
        height: Of the elements behind the faces above them [m].
        young: [Pa].
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
        """Of its faces, with so high h of all faces [m]."""
        return shares(self.t, self.elements, self.volume, self.bonded, self.area, height)

    @property
    def has_tets_only(self) -> bool:
        """Whether all its elements are tets, and some of their faces conform."""
        tets = len(self.t.element_nodes["tet4"])
        return len(self.pairs) > 0 and not self.elements[tets:].any()

    @cached_property
    def sizes(self) -> Floats:
        """Of all elements: edges of cubes of their volume [m]."""
        return same_everywhere(np.cbrt(self.volume))

    @property
    def is_graded(self) -> bool:
        """Whether some of its elements are far smaller than others."""
        low, high = np.quantile(self.sizes[self.elements], (0.05, 0.95))
        return bool(high > GRADED * low)

    @property
    def has_an_inside(self) -> bool:
        """Whether a tet lies `LAYERS` layers of them inside."""
        inside = surrounded(self.t, self.pairs)
        across = self.t.face_element[self.t.pair_faces[self.pairs]]
        for _ in range(LAYERS - 1):
            edge = ~inside[across].all(axis=1)
            inside[across[edge].ravel()] = False
        return bool(inside.any())


def compensate(
    case: Case, t: Topology, names: list[str], groups: list[int], between: NDArray[np.bool_]
) -> dict[str, Compensation]:
    """What makes up for the bonds of groups, those of `compensated_groups`.

    Args:
        case: With the rock of the groups.
        t: The mesh.
        names: Of all groups.
        groups: Which groups.
        between: Of `made_up_between`, for all groups of `compensated_groups`.

    Raises:
        CaseError: Poisson's ratio of one leaves no room for it, or its mesh cannot be solved.
    """
    out: dict[str, Compensation] = {}
    if not groups:
        return out
    shapes = t.element_nodes
    volume = np.concatenate(
        [element_shapes.volumes(s, t.node_position[n]).sum(axis=1) for s, n in shapes.items()]
    )
    group_of = np.concatenate([t.element_group[shape] for shape in shapes])
    area = in_pieces(lambda nodes: face_areas(t.node_position, nodes), t.face_nodes)
    height = face_heights(t, volume, area)
    bonded = bonded_parts(t, between, area)
    for group in groups:
        pairs = np.flatnonzero((t.face_kind[t.pair_faces] == group).all(axis=1))
        material = case.groups[names[group]].material
        rock = case.materials[material]
        if rock.poisson_ratio > LARGEST_POISSON:
            place = f"materials.{material}.poisson_ratio"
            raise CaseError(
                f"{case.where(place)}: {place}: {rock.poisson_ratio:g} is too large for bonds "
                f"between the elements of group {names[group]!r} to be made up for (at most "
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
    """Groups whose every element is a block, bonded to others with a stiffness left to the program."""
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
    """Between which kinds of faces bonds are made up for by groups, shape (kinds, kinds)."""
    automatic = np.array([*map(is_automatic, laws), False])  # the last where there is no interface
    made_up = np.isin(np.arange(len(bonds)), groups)
    return bonds & automatic[interface_of] & made_up & made_up[:, None]


def elements_of_blocks(t: Topology) -> NDArray[np.int64]:
    """How many elements each block has, shape (blocks,)."""
    elements = np.zeros(len(t.block_group), np.int64)
    for block in t.element_block.values():
        elements += np.bincount(block, minlength=len(elements))
    return elements


def is_automatic(law: Interface) -> bool:
    """Whether the case leaves the stiffness of an interface's bonds to the program."""
    return law.stiffness_n == AUTO and law.stiffness_s == AUTO


def _of_inside(g: _Group) -> Compensation:
    """Of tets some of which lie inside: one stiffness for all bonds; they are right there."""
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
    """Of other groups: each face has a stiffness of its own, and free ones are counted."""
    bonds, height = g.shares(g.height), g.height
    bonded = g.area[bonds.faces] * bonds.bonded * bonds.share
    h = _rounded((bonded * height[bonds.faces]).sum() / bonded.sum())
    if not g.elements[len(g.t.element_nodes["tet4"]) :].any():
        size = g.sizes[g.t.face_element]  # tets stand on all their faces alike
        height = size * h * bonded.sum() / (bonded * size[bonds.faces]).sum()
        bonds = g.shares(height)
    fabric, far = bonds.fabric(), longest(g.t, g.elements, g.volume)
    # what has bonds in some of its parts only is to be right in these
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
    """a of bonds that act as q, as far as Poisson's ratio leaves room."""
    return max(FACTOR, _rounded(q * poisson / (3 * (MOST_POISSON - poisson))))


def _rounded(value: float) -> float:
    return float(same_everywhere(np.array(value)))


def _uncut(g: _Group, some: NDArray[np.integer], tets: BondedTets) -> NDArray[np.bool_]:
    """Tets `LAYERS` layers away from those of the group that are not looked at, or all."""
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
        counted: Those that stand for the rock.
        e: Their stiffening.
        stiffness: Of their bonds.
        poisson: Poisson's ratio of the rock.
    """
    u = displacements(tets, e, poisson * e, stiffness)
    pulls = np.reshape(stiffness, (-1, 1, 1, 1)) * jumps(tets, u)
    return compliance(tets, u, e, poisson * e, counted), ElasticState(tets, pulls, counted)


def _own(e: float, poisson: float) -> Floats:
    """Compliance of elements alone, for Young's modulus 1 of the rock."""
    return inverses(elasticity(e, e * poisson)[None])[0]


def _renewed(c: Floats, e: float, e_new: float, poisson: float) -> Floats:
    """A compliance if e of its elements is another: that of bonds goes with 1 / e."""
    return (c - _own(e, poisson)) * e / e_new + _own(e_new, poisson)


def _errors(left: Floats, poisson: float, pulls: Floats) -> tuple[float, float, float]:
    """Of E where it is worst, and of the isotropic G and K, of a compliance for Young's modulus 1."""
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
    """Elements of which all faces are of these pairs, shape (elements,)."""
    count = sum(len(nodes) for nodes in t.element_nodes.values())
    faces = np.bincount(t.face_element, minlength=count)
    bonded = np.bincount(t.face_element[t.pair_faces[pairs]].ravel(), minlength=count)
    return (bonded == faces) & (faces > 0)


def around_the_middle(
    t: Topology, pairs: NDArray[np.intp], inner: NDArray[np.bool_]
) -> NDArray[np.integer]:
    """Tets of pairs around the middle of those inside, or of all, `MOST_TETS` at most."""
    used = found_in([t.face_element[t.pair_faces[pairs]]], len(inner))
    center = t.node_position[t.element_nodes["tet4"][used]].mean(axis=1)
    inside = center[inner[used]] if inner[used].any() else center
    start = inside[np.argmin(((inside - inside.mean(axis=0)) ** 2).sum(axis=1))]
    near = np.argsort(((center - start) ** 2).sum(axis=1), kind="stable")[:MOST_TETS]
    return used[near]


def counted_tets(tets: BondedTets) -> NDArray[np.bool_]:
    """Tets far enough inside the others to stand for the rock, or all where none is."""
    layers = [tets.inner(n) for n in range(LAYERS, 0, -1)]
    return next((inside for inside in layers if inside.any()), np.ones(len(tets.x), bool))


def bonded_tets(t: Topology, pairs: NDArray[np.intp], some: NDArray[np.integer]) -> BondedTets:
    """Some tets, by their numbers, with those faces of pairs that two of them have."""
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
    """Which corners of tets, (n, 4), nodes of theirs are, (n, 3)."""
    return (nodes[:, None, :] == some[:, :, None]).argmax(axis=2)
