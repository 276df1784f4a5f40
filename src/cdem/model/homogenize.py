"""The elastic compliance of tets connected by springs on their faces, found numerically."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.errors import ModelError
from cdem.mesh import element_shapes
from cdem.mesh.arrays import inverses, lengths, matrix_product

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

TOLERANCE = 1e-5
"""Residual of the equilibrium, of the load, at which the search for it ends."""
MOST_ITERATIONS = 2000
GROUND = 1e-9
"""Springs of the corners to the ground, by those of their faces: nothing else holds the whole, and
its loads are in balance."""
ROW, COLUMN = [0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]
"""Components xx, yy, zz, xy, yz, zx of a tensor, the order of `element_shapes.strain_rows`."""


def _states() -> Floats:
    tensors = np.zeros((6, 3, 3))
    tensors[range(6), ROW, COLUMN] = tensors[range(6), COLUMN, ROW] = 1
    return tensors


STATES = _states()
"""Six uniform stresses [Pa], each of one component."""


@dataclass
class BondedTets:
    """Tets, each a block of its own, and the faces between them.

    Attributes:
        x: Positions of the tets' corners [m], shape (tets, 4, 3).
        tet: The tets on either side of each face, shape (faces, 2).
        corner: Their corners on the face, touching corners in the same place, shape
            (faces, 2, 3).
        pair: Numbers of the model's pairs of faces, shape (faces,).
    """

    x: Floats
    tet: Ints
    corner: Ints
    pair: NDArray[np.intp]

    @cached_property
    def volume(self) -> Floats:
        """Volumes of the tets [m3], shape (tets,)."""
        return element_shapes.volumes("tet4", self.x)[:, 0]

    @cached_property
    def strain_rows(self) -> Floats:
        """Strains by displacements of the corners [1/m], shape (tets, 6, 12)."""
        return element_shapes.strain_rows(
            "tet4", *element_shapes.reference_gradients("tet4", self.x)
        )[:, 0]

    @cached_property
    def vectors(self) -> Floats:
        """Area vectors of the faces, out of the first tet [m2], shape (faces, 3)."""
        x = self.x[self.tet[:, 0, None], self.corner[:, 0]]
        vector = 0.5 * np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
        out = (x.mean(axis=1) - self.x[self.tet[:, 0]].mean(axis=1)) * vector
        return vector * np.sign(out.sum(axis=1))[:, None]

    def inner(self, layers: int) -> NDArray[np.bool_]:
        """Tets at least this many layers of faces inside the rest, shape (tets,)."""
        faces = np.bincount(self.tet.ravel(), minlength=len(self.x))
        inside = faces == 4
        for _ in range(layers - 1):
            edge = ~inside[self.tet].all(axis=1)
            inside[self.tet[edge].ravel()] = False
        return inside


def compliance(
    tets: BondedTets, u: Floats, young: float, poisson: float, inner: NDArray[np.bool_]
) -> Floats:
    """Compliance of the whole under six uniform stresses, from its inner tets.

    Args:
        tets: The tets.
        u: Their `displacements` [m].
        young: Young's modulus of the tets [Pa].
        poisson: Their Poisson's ratio.
        inner: Tets for the mean strain and stress.

    Returns:
        Strains (engineering shears) by stresses, in the order of `STATES` [1/Pa], shape (6, 6).
    """
    strains, stresses = means(tets, u, young, poisson, inner)
    normal = matrix_product(stresses, stresses.T)
    return matrix_product(matrix_product(strains, stresses.T), inverses(normal))


def displacements(
    tets: BondedTets, young: float, poisson: float, stiffness: float | Floats
) -> Floats:
    """Displacements of the tets' corners under the six uniform stresses, shape (tets, 12, 6) [m].

    Args:
        tets: The tets.
        young: Young's modulus of the tets [Pa].
        poisson: Their Poisson's ratio.
        stiffness: Stiffness of the faces, normal and shear, one value or shape (faces,) [Pa/m].

    Raises:
        ModelError: The iteration found no equilibrium.
    """
    rows = tets.strain_rows
    stresses_of = matrix_product(elasticity(young, poisson), rows)
    own = matrix_product(tets.volume[:, None, None] * rows.transpose(0, 2, 1), stresses_of)
    mate, spring = _springs(tets, stiffness * lengths(tets.vectors) / 3)
    load = _loads(tets).reshape(-1, len(STATES)).T
    answer = native.solve_blocks(
        _system(tets, own, mate, spring), np.ascontiguousarray(load), TOLERANCE, MOST_ITERATIONS
    )
    if not len(answer):
        raise ModelError(
            "no equilibrium of its elements and bonds was found; is the mesh very flat?"
        )
    return np.ascontiguousarray(answer.reshape(len(STATES), -1).T).reshape(-1, 12, len(STATES))


def _system(
    tets: BondedTets, own: Floats, mate: NDArray[np.intp], spring: Floats
) -> dict[str, NDArray]:
    """The stiffness of the whole by blocks of nodes, for the core.

    Args:
        tets: The tets.
        own: Stiffness of each by itself [N/m], shape (tets, 12, 12).
        mate: Corners that touch each corner, shape (corners, 3).
        spring: Springs to these [N/m], 0 where there is none.
    """
    count = len(mate)
    blocks = own.reshape(-1, 4, 3, 4, 3).transpose(0, 1, 3, 2, 4).copy()
    held = spring.sum(axis=1).reshape(-1, 4)
    held += GROUND * held.mean()
    for k in range(4):
        blocks[:, k, k] += held[:, k, None, None] * np.eye(3)
    corner = np.arange(count).reshape(-1, 4)
    row, column = (
        np.broadcast_to(c, (len(own), 4, 4)) for c in (corner[:, :, None], corner[:, None])
    )
    joined = spring.ravel() > 0
    rows = np.concatenate([row.ravel(), np.repeat(np.arange(count), 3)[joined]])
    columns = np.concatenate([column.ravel(), mate.ravel()[joined]])
    pulls = -spring.ravel()[joined, None, None] * np.eye(3)
    order = np.lexsort((columns, rows))
    return {
        "first": np.searchsorted(rows[order], np.arange(count + 1)).astype(np.int32),
        "column": columns[order].astype(np.int32),
        "block": np.concatenate([blocks.reshape(-1, 3, 3), pulls])[order].ravel(),
        "group_first": np.arange(0, count + 1, 4, dtype=np.int32),
        "point": _points(mate, spring),
        "place": tets.x.ravel(),
    }


def _points(mate: NDArray[np.intp], spring: Floats) -> Ints:
    """Number of the point that each corner is at: springs join the corners of a point."""
    own = np.arange(len(mate))
    other = np.where(spring > 0, mate, own[:, None])
    label = own
    while True:
        least = np.minimum(label, label[other].min(axis=1))
        if (least == label).all():
            return np.unique(label, return_inverse=True)[1].ravel().astype(np.int32)
        label = least


def jumps(tets: BondedTets, u: Floats) -> Floats:
    """Jumps of displacements of the corners, (tets, 12, states), across the faces from the first
    tet to the other, at their corners, shape (faces, 3, xyz, states) [m]."""
    at = u.reshape(-1, 4, 3, u.shape[2])
    a, b = (at[tets.tet[:, side, None], tets.corner[:, side]] for side in (0, 1))
    return b - a


def _springs(tets: BondedTets, stiffness: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Corner that touches each corner on each of its three faces, and the spring (or 0)."""
    mate = np.zeros((4 * len(tets.x), 3), np.intp)
    spring = np.zeros(mate.shape)
    place = np.array([[0, 0, 0, 0], [0, 0, 1, 1], [1, 1, 0, 2], [2, 2, 2, 0]])  # [opposite, corner]
    a, b = (4 * tets.tet[:, side, None] + tets.corner[:, side] for side in (0, 1))
    for this, other, side in ((a, b, 0), (b, a, 1)):
        opposite = 6 - tets.corner[:, side].sum(axis=1)
        at = place[opposite[:, None], tets.corner[:, side]]
        mate[this, at], spring[this, at] = other, stiffness[:, None]
    return mate, spring


def elasticity(young: float, poisson: float) -> Floats:
    """Stresses by strains of isotropic rock [Pa], shape (6, 6)."""
    return element_shapes.elasticity(
        *element_shapes.lame_constants(np.array([young]), np.array([poisson]))
    )[0]


def _loads(tets: BondedTets) -> Floats:
    """Forces on the corners by the six stresses on faces without another tet [N]."""
    # a uniform stress in the tets balances the stress on all faces; less the inner faces
    load = (tets.volume[:, None, None] * tets.strain_rows).transpose(0, 2, 1).reshape(-1, 4, 3, 6)
    load = np.ascontiguousarray(load)
    traction = np.einsum("sxy,fy->fxs", STATES, tets.vectors) / 3
    for side, sign in ((0, 1.0), (1, -1.0)):
        for k in range(3):
            np.add.at(load, (tets.tet[:, side], tets.corner[:, side, k]), -sign * traction)
    return load.reshape(-1, 12, len(STATES))


def means(
    tets: BondedTets, u: Floats, young: float, poisson: float, inner: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    """Mean strain and stress of the inner tets, including half of their faces to others.

    Args:
        tets: The tets.
        u: Displacements of their corners in several states [m], shape (tets, 12, states).
        young: Young's modulus of the tets [Pa].
        poisson: Their Poisson's ratio.
        inner: The inner tets.

    Returns:
        Strains (engineering shears) [1] and stresses [Pa], shape (6, states), as in `STATES`.
    """
    volume = tets.volume[inner]
    strain = np.einsum("eik,eks,e->is", tets.strain_rows[inner], u[inner], volume)
    stress = np.einsum("ij,js->is", elasticity(young, poisson), strain)
    share = 0.5 * inner[tets.tet].sum(axis=1)
    opened = np.einsum("f,fxs,fy->xys", share, jumps(tets, u).mean(axis=1), tets.vectors)
    both = 0.5 * (opened + opened.transpose(1, 0, 2))
    strain += both[ROW, COLUMN] * np.array([1, 1, 1, 2, 2, 2])[:, None]
    return strain / volume.sum(), stress / volume.sum()
