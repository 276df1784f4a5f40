"""Rock whose every element is a block: its elements are made so stiff that the whole is as given.

Bonds add to the compliance of the elements. With one stiffness k = a E' / h for all bonds of a group,
normal and shear, and isotropic faces, the whole has

    1/E = (1 + q / (3 a)) / E',    nu / E = nu' / E',    q = S_v h,

S_v the area of faces per volume and h their mean distance from the middle of the elements behind: so
E' = e E and nu' = e nu with e = 1 + q / (3 a). Irregular tets are less compliant than that sum says,
which takes their stress for uniform: their q is found numerically.
"""

from __future__ import annotations

from dataclasses import dataclass
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
    """

    tets: BondedTets
    tractions: Floats


@dataclass(frozen=True)
class Compensation:
    """What the elements and bonds of a group have, so that the whole is as the case says.

    Attributes:
        q: S_v h, as it acts.
        area_per_volume: S_v, of the faces of inner elements [1/m].
        height: h [m].
        factor: a.
        stiffening: e = E' / E = nu' / nu, of the elements.
        stiffness: Of the bonds [Pa/m].
        errors: What is left: in E along the axis or diagonal of space where it is worst, and in the
            isotropic G and K [1].
        state: From which q was found; None where it is the sum over faces.
    """

    q: float
    area_per_volume: float
    height: float
    factor: float
    stiffening: float
    stiffness: float
    errors: tuple[float, float, float]
    state: ElasticState | None


def compensate(
    case: Case, t: Topology, names: list[str], groups: list[int]
) -> dict[str, Compensation]:
    """What makes up for the bonds of groups, those of `compensated_groups`.

    Raises:
        CaseError: Poisson's ratio of one leaves no room for it, or its mesh cannot be solved.
    """
    out: dict[str, Compensation] = {}
    if not groups:
        return out
    volume = np.concatenate(
        [
            element_shapes.volumes(shape, t.node_position[nodes]).sum(axis=1)
            for shape, nodes in t.element_nodes.items()
        ]
    )
    area = in_pieces(lambda nodes: face_areas(t.node_position, nodes), t.face_nodes)
    height = face_heights(t, volume, area)
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
        with case.blame("model"):
            out[names[group]] = _of_group(
                t, pairs, volume, area, height, rock.young_modulus, rock.poisson_ratio
            )
    return out


def compensated_groups(
    case: Case,
    t: Topology,
    names: list[str],
    laws: list[Interface],
    interface_of: NDArray[np.int32],
    bonds: NDArray[np.bool_],
) -> list[int]:
    """Groups whose every element is a block, bonded to others with the stiffness left to cdem: 2."""
    if case.cdem < 2:
        return []
    elements = elements_of_blocks(t)
    kind = t.face_kind[t.pair_faces]
    bonded = np.unique(kind[(kind[:, 0] == kind[:, 1]) & bonds[kind[:, 0], kind[:, 1]], 0])
    return [
        int(group)
        for group in bonded[bonded < len(names)]
        if is_automatic(laws[interface_of[group, group]])
        and (elements[t.block_group == group] == 1).all()
    ]


def elements_of_blocks(t: Topology) -> NDArray[np.int64]:
    """How many elements each block has, shape (blocks,)."""
    elements = np.zeros(len(t.block_group), np.int64)
    for block in t.element_block.values():
        elements += np.bincount(block, minlength=len(elements))
    return elements


def is_automatic(law: Interface) -> bool:
    """Whether the case leaves the stiffness of an interface's bonds to the program."""
    return law.stiffness_n == AUTO and law.stiffness_s == AUTO


def _of_group(
    t: Topology,
    pairs: NDArray[np.intp],
    volume: Floats,
    area: Floats,
    height: Floats,
    young: float,
    poisson: float,
) -> Compensation:
    """See `Compensation`; pairs are those of the bonds inside the group."""
    faces = t.pair_faces[pairs]
    elements = t.face_element[faces]
    count = np.bincount(elements.ravel(), minlength=len(volume))
    inner = surrounded(t, pairs)
    if not inner[elements].any():
        inner = count > 0
    share = 0.5 * inner[elements].sum(axis=1) * area[faces[:, 0]]
    whole = volume[inner & (count > 0)].sum()
    area_per_volume = share.sum() / whole
    q = (share * height[faces].min(axis=1)).sum() / whole
    h = float(same_everywhere(q / area_per_volume))
    factor = max(FACTOR, float(same_everywhere(q * poisson / (3 * (MOST_POISSON - poisson)))))
    tets = len(t.element_nodes["tet4"])
    errors, state = (0.0, 0.0, 0.0), None
    if (elements < tets).all():
        near = bonded_tets(t, pairs, around_the_middle(t, pairs, inner))
        q, errors, state = _found(near, q, h, factor, poisson)
    q = float(same_everywhere(q))
    stiffening = 1 + q / (3 * factor)
    return Compensation(
        q=q,
        area_per_volume=float(area_per_volume),
        height=h,
        factor=factor,
        stiffening=stiffening,
        stiffness=factor * stiffening * young / h,
        errors=errors,
        state=state,
    )


def _found(
    tets: BondedTets, q: float, h: float, a: float, poisson: float
) -> tuple[float, tuple[float, float, float], ElasticState]:
    """q of tets as it acts, what errors are left, and their state, for Young's modulus 1."""
    e = 1 + q / (3 * a)
    u = displacements(tets, e, poisson * e, a * e / h)
    state = ElasticState(tets, a * e / h * jumps(tets, u))
    c = compliance(tets, u, e, poisson * e, counted_tets(tets))
    acts = 3 * a * (e * _isotropic(c)[0] - 1)
    e_new = 1 + acts / (3 * a)
    own, new = inverses(np.stack([elasticity(x, poisson * x) for x in (e, e_new)]))
    left = (c - own) * e / e_new + new
    along = 1 / np.einsum("di,ij,dj->d", DIRECTIONS, left, DIRECTIONS) - 1
    worst = float(along[np.argmax(abs(along))])
    young, bulk = (1 / part for part in _isotropic(left))
    shear = 3 * bulk * young / (9 * bulk - young)
    errors = (worst, shear * 2 * (1 + poisson) - 1, bulk * 3 * (1 - 2 * poisson) - 1)
    return acts, errors, state


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
    """Tets of pairs around the middle of those inside, `MOST_TETS` at most."""
    used = found_in([t.face_element[t.pair_faces[pairs]]], len(inner))
    center = t.node_position[t.element_nodes["tet4"][used]].mean(axis=1)
    inside = center[inner[used]]
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
