"""Shares of faces in the compliance of bonds, and the compliance of bonds by direction.

Under a uniform stress S a bond of area A, normal n and stiffness k opens by S n / k. An inner
element
gets half of the openings at each of its faces; so with k = a E' / h, h its height above the face,
equal bricks gain 1 / (a E') along each axis. A free face gets no half from a bond. Its missing part
goes to the element's faces with a similar direction, up or down: in a brick, to the opposite face.
If this one is free too, as in a slice one element thick, no face can replace it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.arrays import first_of_each, found_in, in_pieces
from cdem.mesh.topology import Topology
from cdem.model.faces import face_normals
from cdem.model.homogenize import COLUMN, ROW, STATES

Floats = NDArray[np.float64]

SHARPNESS = 2
"""A face replaces another with the weight |cos|^(2 this) of the angle between them."""


@dataclass(frozen=True)
class Shares:
    """Shares of the faces of some elements.

    Attributes:
        faces: Their numbers, ascending.
        share: Share of each in the compliance of its bonds: 1/2 inside a mesh [1].
        bonded: Bonded fraction of its area [1].
        weight: Its area times the h of its bonds over the volume of all elements [1].
        normal: shape (faces, 3).
    """

    faces: NDArray[np.intp]
    share: Floats
    bonded: Floats
    weight: Floats
    normal: Floats

    def fabric(self, share: Floats | float | None = None) -> Floats:
        """M of the part of 1 / E along d from bonds, d M d / (a E'), shape (3, 3); or with other shares."""
        some = self.weight * self.bonded * (self.share if share is None else share)
        return _moment(some, self.normal)

    def surrounded(self) -> Floats:
        """The same with all faces bonded, shape (3, 3)."""
        return _moment(0.5 * self.weight, self.normal)


def _moment(weight: Floats, normal: Floats) -> Floats:
    return np.einsum("f,fi,fj->ij", weight, normal, normal)


def longest(t: Topology, elements: NDArray[np.bool_], volume: Floats) -> Floats:
    """Weights of directions of some elements, in sum 1, large along their long axes, shape (3, 3).

    The square of the second moment of their volume: 10,000 to 1 for a column of ten bricks.
    """
    center = np.concatenate(
        [t.node_position[nodes].mean(axis=1) for nodes in t.element_nodes.values()]
    )[elements]
    weight = volume[elements] / volume[elements].sum()
    away = center - np.einsum("e,ex->x", weight, center)
    moment = np.einsum("e,ex,ey->xy", weight, away, away)
    squared = np.einsum("xy,yz->xz", moment, moment)
    return squared / np.trace(squared)


def bonded_parts(t: Topology, between: NDArray[np.bool_], area: Floats) -> Floats:
    """Fraction of each face bonded to a face of a kind that it is compensated with, (faces,)."""
    out = np.zeros(len(area))
    overlap = np.zeros(0)
    if len(t.overlap_faces):
        overlap = np.add.reduceat(t.overlap_area, t.overlap_first[:-1])
    sets = ((t.pair_faces, area[t.pair_faces[:, 0]]), (t.overlap_faces, overlap))
    for faces, common in sets:
        kinds = t.face_kind[faces].reshape(-1, 2)
        made_up = between[kinds[:, 0], kinds[:, 1]]
        for side in (0, 1):
            some = faces[made_up, side]
            np.add.at(out, some, common[made_up] / area[some])
    return np.minimum(out, 1.0)


def shares(
    t: Topology,
    elements: NDArray[np.bool_],
    volume: Floats,
    bonded: Floats,
    area: Floats,
    height: Floats,
) -> Shares:
    """Shares of the faces of some elements.

    Args:
        t: The mesh.
        elements: Their numbers, shape (elements,).
        volume: Volume of all elements [m3].
        bonded: Result of `bonded_parts`.
        area: Area of all faces [m2].
        height: h of the bonds of each face [m].
    """
    faces = np.flatnonzero(elements[t.face_element])
    normal = face_normals(t.node_position, t.face_nodes[faces])
    owner = t.face_element[faces]
    used = found_in([owner], len(elements))
    number = np.zeros(len(elements), np.intp)
    number[used] = np.arange(len(used))
    order = np.argsort(owner, kind="stable")
    of_order = number[owner[order]]
    first = first_of_each(of_order, len(used))
    table = np.full((len(used), np.diff(first).max(initial=0)), -1)
    table[of_order, np.arange(len(order)) - first[of_order]] = order
    some = area[faces], bonded[faces], normal
    extra = np.zeros(len(faces))
    there = table >= 0
    extra[table[there]] = in_pieces(lambda rows: _taken_over(rows, *some), table)[there]
    weight = area[faces] * height[faces] / volume[used].sum()
    return Shares(faces, 0.5 + extra, some[1], weight, normal)


def _taken_over(rows: NDArray[np.intp], area: Floats, bonded: Floats, normal: Floats) -> Floats:
    """Additional shares of faces of elements (rows, -1 past the last), beyond their own halves."""
    a = np.where(rows >= 0, area[rows], 0.0)
    n, part = normal[rows], bonded[rows]
    alike = np.einsum("efx,egx->efg", n, n) ** (2 * SHARPNESS) * a[:, None]
    own = np.arange(rows.shape[1])
    alike[:, own, own] *= part
    lacks = 0.5 * a * (1 - part) / np.maximum(alike.sum(axis=2), 1e-300)
    return np.einsum("ef,efg->eg", lacks, alike) / np.where(rows >= 0, a, 1.0)


def added(fabric: Floats) -> Floats:
    """Strains (engineering shears) by stresses that bonds of k h = 1 add, as in `STATES`, (6, 6)."""
    opened = np.einsum("ij,sjk->sik", fabric, STATES)
    both = 0.5 * (opened + opened.transpose(0, 2, 1))
    return both[:, ROW, COLUMN].T * np.array([1, 1, 1, 2, 2, 2])[:, None]
