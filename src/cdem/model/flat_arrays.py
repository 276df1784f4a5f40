"""The flat arrays of the core: their sources, meanings and layout in memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.schema import MassScaling
from cdem.mesh.arrays import first_of_each
from cdem.mesh.element_shapes import lame_constants

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


@dataclass
class Properties:
    """Properties from the case, by group.

    Attributes:
        density: [kg/m3], shape (groups,).
        young_modulus: [Pa], shape (groups,).
        poisson_ratio: shape (groups,).
        law: Number of the block law in the core, shape (groups,).
        law_parameters: Its parameters, shape (groups, largest number of parameters of a law).
        interface_of: Index of the interface between two kinds of faces (see
            `Topology.face_kind`), shape (kinds, kinds).
        paired: Whether faces with it that touch at the start are pairs: if it has strength, or with
            `pairs_loose_joints`, the same shape.
        flush: Whether faces of these kinds that begin flush hide each other from third blocks, the
            same shape.
        breaks: Whether bonds of it may break, see `that_may_break`, shape (interfaces,).
        strength_factors: Function from faces of pairs, shape (pairs, 2), to factors on their
            strength, by
            interface; None: all are 1.
        stiffness: (value, factor) of k_n and k_s of bonds by interface, shape (interfaces, 4).
        automatic: Whether the program chooses it, shape (interfaces,).
        stiffening: Stiffening of the elements relative to the whole, see `Compensation`, shape
            (groups,).
        bond_stiffness: Stiffness of compensated bonds between faces like each [Pa/m], else 0, shape
            (faces,).
        contact_stiffness: (value, factor) of k_n and k_s of unloading contacts by interface,
            shape (interfaces, 4).
        in_series: Whether E / h of contacts combines both sides in series, shape (interfaces,).
        exact_mass: Whether blocks have their exact inertia, at least once they have no bonds.
        lumped_while_bonded: Whether they have it only then.
        supported: Components of nodes that are fixed or driven, shape (nodes, 3).
        driven: Nodes that are driven, shape (nodes,).
        mass_scaling: Settings of mass scaling, if any.
        safety: Fraction of the stable step in use.
        added_mass: Mass that mass scaling has added to each node at the start, once known [kg],
            shape (nodes,).
        one_point: Whether hexahedra have one Gauss point and hourglass springs.
        nodal_mean: Whether tets of blocks of several average their dilatation at the nodes, shape
            (groups,).
        moduli: Moduli of the rock over those of its materials, see `Branches.part`.
    """

    density: Floats
    young_modulus: Floats
    poisson_ratio: Floats
    law: Ints
    law_parameters: Floats
    interface_of: Ints
    paired: NDArray[np.bool_]
    flush: NDArray[np.bool_]
    strength_factors: Sequence[Callable[[Ints], Floats] | None]
    breaks: NDArray[np.bool_]
    stiffness: Floats
    automatic: NDArray[np.bool_]
    stiffening: Floats
    bond_stiffness: Floats
    contact_stiffness: Floats
    in_series: NDArray[np.bool_]
    exact_mass: bool
    lumped_while_bonded: bool
    supported: NDArray[np.bool_]
    driven: NDArray[np.bool_]
    nodal_mean: NDArray[np.bool_]
    mass_scaling: MassScaling | None = None
    safety: float = 1.0
    added_mass: Floats | None = None
    one_point: bool = False
    moduli: float = 1.0

    @property
    def lame(self) -> Floats:
        """First Lame constant of the elements by group [Pa]."""
        return self._elements[0]

    @property
    def shear(self) -> Floats:
        """Shear modulus of the elements by group [Pa]."""
        return self._elements[1]

    @property
    def _elements(self) -> tuple[Floats, Floats]:
        e = self.stiffening
        lame, shear = lame_constants(e * self.young_modulus, e * self.poisson_ratio)
        return self.moduli * lame, self.moduli * shear


@dataclass
class Assembly:
    """Flat arrays of the model by name, counts, and data for the audit.

    `interfaces` are the interfaces of the core, `module_stiffness` the largest stiffness of modules
    at
    each node [N/m]. `added_mass` is the scaled mass by node, `least_mass` a diagonal not above the
    mass matrix of each block, `limits` the stable step without it and with 0.1 % of mass added [s],
    `free_mass` the mass of free nodes [kg].
    """

    arrays: dict[str, NDArray] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    interfaces: list[dict[str, Any]] = field(default_factory=list)
    module_stiffness: Floats = field(default_factory=lambda: np.zeros(0))
    element_mass: dict[str, Floats] = field(default_factory=dict)
    element_volume: dict[str, Floats] = field(default_factory=dict)
    element_frequency: dict[str, Floats] = field(default_factory=dict)
    added_mass: Floats = field(default_factory=lambda: np.zeros(0))
    least_mass: Floats = field(default_factory=lambda: np.zeros(0))
    limits: tuple[float, float] = (0.0, 0.0)
    free_mass: float = 0.0
    lumped_blocks: int = 0
    pair_faces: dict[str, Ints] = field(default_factory=dict)


def table(rows: NDArray, stride: int) -> NDArray:
    """Rows of numbers per item, shape (rows, items), padded to the core's stride and flattened.

    The padding repeats the last item, so that a lane past the end reads valid numbers.
    """
    count = rows.shape[1]
    if count == 0:
        return np.zeros(rows.shape[0] * stride, rows.dtype)
    return np.ascontiguousarray(np.pad(rows, ((0, 0), (0, stride - count)), "edge")).ravel()


def ragged(owner: NDArray, value: NDArray, count: int) -> tuple[Ints, NDArray]:
    """Values listed by owner in the given order: starts (count + 1,) and values."""
    order = np.argsort(owner, kind="stable")
    return first_of_each(owner, count), np.ascontiguousarray(value[order])
