"""The flat arrays of the core: what they are made from, what they are, and how they lie in memory."""

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
    """What the case says, by group.

    Attributes:
        density: [kg/m3], shape (groups,).
        young_modulus: [Pa], shape (groups,).
        poisson_ratio: shape (groups,).
        law: Number of the block law in the core, shape (groups,).
        law_parameters: Its parameters, shape (groups, most parameters of a law).
        interface_of: Index of the interface between two kinds of faces (see
            `Topology.face_kind`), shape (kinds, kinds).
        paired: Whether faces of it that touch at the start are pairs: if it has strength, or where
            `pairs_loose_joints`, the same shape.
        breaks: Whether bonds of it may break, see `that_may_break`, shape (interfaces,).
        strength_factors: From faces of pairs, shape (pairs, 2), to factors on their strength, by
            interface; None: all are 1.
        stiffness: (value, factor) of k_n and k_s of bonds by interface, shape (interfaces, 4).
        automatic: Whether the case leaves them to the program, shape (interfaces,).
        stiffening: How much stiffer the elements are than the whole, see `Compensation`, shape
            (groups,).
        bond_stiffness: Of bonds that are made up for between faces like each [Pa/m], else 0, shape
            (faces,).
        contact_stiffness: (value, factor) of k_n and k_s of contacts that unload by interface,
            shape (interfaces, 4).
        in_series: Whether E / h of contacts is that of both sides in series, shape (interfaces,).
        exact_mass: Whether blocks have their exact inertia, at least once they have no bonds.
        lumped_while_bonded: Whether they have it only then.
        supported: Components of nodes that are held or moved, shape (nodes, 3).
        driven: Nodes that are moved, shape (nodes,).
        mass_scaling: What mass to add, if any.
        safety: Share of the stable step that is used.
        added_mass: What mass scaling has added to each node at the start, once that is known [kg],
            shape (nodes,).
        one_point: Whether hexahedra have one Gauss point and hourglass springs.
        nodal_mean: Whether tets of blocks of several average their dilatation at the nodes, shape
            (groups,).
    """

    density: Floats
    young_modulus: Floats
    poisson_ratio: Floats
    law: Ints
    law_parameters: Floats
    interface_of: Ints
    paired: NDArray[np.bool_]
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
        return lame_constants(e * self.young_modulus, e * self.poisson_ratio)


@dataclass
class Assembly:
    """Flat arrays of the model by name, counts, and what the audit wants to know.

    `interfaces` are those of the core, `module_stiffness` is what modules put on each node at most
    [N/m]. `added_mass` is that of mass scaling by node, `least_mass` a diagonal that is no more than the mass
    matrix of each block, `limits` the stable step without it and with 0.1 %
    of mass added [s], `free_mass` that of the nodes that are not held [kg].
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

    The padding repeats the last item, so that a lane that reads past the end meets sane numbers.
    """
    count = rows.shape[1]
    if count == 0:
        return np.zeros(rows.shape[0] * stride, rows.dtype)
    return np.ascontiguousarray(np.pad(rows, ((0, 0), (0, stride - count)), "edge")).ravel()


def ragged(owner: NDArray, value: NDArray, count: int) -> tuple[Ints, NDArray]:
    """Values listed by owner in the given order: starts (count + 1,) and values."""
    order = np.argsort(owner, kind="stable")
    return first_of_each(owner, count), np.ascontiguousarray(value[order])
