"""Mass added where small elements, bonds and contacts would hold up all others (`time.mass_scaling`).

A step t is stable where every node has a mass of t^2 / 4 (S + 2 k) at least: S = sum w_e^2 m_e of its
elements, k the stiffness of its bonds and contacts (Gershgorin). Of a mass matrix M the diagonal
below it counts, M >= diag(least).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.case.schema import MassScaling
from cdem.mesh.arrays import same_everywhere
from cdem.mesh.topology import Topology
from cdem.model.flat_arrays import Assembly, Floats, Properties
from cdem.model.masses import one_element_blocks

OFFER = 0.001
"""Share of the mass that is not held, of which the audit says what it would buy."""
ROUNDS = 60
"""Halvings of the range in which the step lies that a share of the mass buys."""


class Scaling:
    """What mass each node needs for a step, bonds intact.

    Attributes:
        free_mass: Of the nodes that are not held in all directions [kg].

    Args:
        t: Blocks, elements, faces and pairs.
        p: What the case says about them.
        out: Masses without scaling, and pairs.
    """

    def __init__(self, t: Topology, p: Properties, out: Assembly) -> None:
        arrays = out.arrays
        self._mass = arrays["node.mass"]
        dense = arrays["node.mass_row_first"] >= 0
        alone = one_element_blocks(t)
        # rock of single elements stays bonded for the most part; larger blocks come loose as a whole
        loose = ~(p.lumped_while_bonded & alone & _bonded_blocks(t, out))
        lumped = ~dense | ~loose[t.node_block]
        held = p.supported.all(axis=1)  # cannot become unstable
        self.free_mass = float(self._mass[~held].sum())
        springs = 2 * (bond_stiffness(t, out) + contact_stiffness(t, p, out))
        load = arrays["node.lumped_frequency_squared"] * self._mass + springs
        self._load = np.where(held, 0.0, load)
        self._least = np.where(lumped, self._mass, out.least_mass)
        # of blocks with a matrix, as the core has it: whatever the step, less need not be
        square = arrays["node.frequency_squared"] + _most_of_block(
            springs * arrays["node.inverse_mass_bound"], t
        )
        by_matrix = np.where(held, 0.0, _most_of_block(square, t))
        by_node = _most_of_block(self._load / self._least, t)
        self._square = np.where(lumped, np.inf, by_matrix)
        # single elements keep the shape of their matrix: all their nodes grow by one factor
        self._alone = dense & alone[t.node_block]
        self._factor_square = np.minimum(by_node, np.where(lumped, np.inf, by_matrix))

    def added(self, limit: float) -> Floats:
        """Mass to add for a stable step [s] to each node [kg], shape (nodes,)."""
        quarter = limit**2 / 4
        needs = np.where(self._square * quarter > 1, quarter * self._load - self._least, 0.0)
        factor = np.maximum(1.0, quarter * self._factor_square)
        return np.where(self._alone, (factor - 1) * self._mass, np.maximum(needs, 0.0))

    def limit(self, share: float) -> float:
        """The longest stable step [s] for which no more than a share of what is not held is added."""
        largest = np.where(
            self._alone, self._factor_square, np.minimum(self._square, self._load / self._least)
        ).max(initial=0.0)
        if not largest > 0:
            return np.inf
        low, high = 2 / np.sqrt(largest), 200 / np.sqrt(largest)
        for _ in range(ROUNDS if share > 0 else 0):
            middle = 0.5 * (low + high)
            fits = self.added(middle).sum() <= share * self.free_mass
            low, high = (middle, high) if fits else (low, middle)
        return float(same_everywhere(np.array(low)))

    def wanted(self, asked: MassScaling, safety: float) -> Floats:
        """What a case asks for, when this share of the stable step is used: as `added`."""
        limit = np.inf if asked.step is None else asked.step / safety
        if asked.most is not None:
            limit = min(limit, self.limit(asked.most))
        return self.added(limit)


def bond_stiffness(t: Topology, out: Assembly) -> Floats:
    """Stiffness of all bonds at each node [N/m], shape (nodes,)."""
    nodes = len(t.node_position)
    total = np.zeros(nodes)
    for kind, n in (("triangles", 3), ("quads", 4)):
        count = out.counts[f"{kind}.count"]
        largest = out.arrays[f"{kind}.stiffness"].reshape(2, -1)[:, :count].max(axis=0, initial=0.0)
        ends = out.arrays[f"{kind}.nodes"].reshape(2 * n, -1)[:, :count]
        share = np.tile(largest * out.arrays[f"{kind}.area"][:count] / n, 2 * n)
        total += np.bincount(ends.ravel(), share, nodes)
    count = out.counts["overlaps.count"]
    largest = out.arrays["overlaps.stiffness"].reshape(2, -1)[:, :count].max(axis=0, initial=0.0)
    points = np.diff(t.overlap_first)
    per_point = np.repeat(largest, points) * t.overlap_area
    owner = np.repeat(np.arange(count), points)
    for side, weights in enumerate((t.overlap_weights_a, t.overlap_weights_b)):
        ends = t.face_nodes[t.overlap_faces.reshape(-1, 2)[owner, side]]
        used = ends >= 0
        total += np.bincount(ends[used], (per_point[:, None] * np.abs(weights))[used], nodes)
    return total


def contact_stiffness(t: Topology, p: Properties, out: Assembly) -> Floats:
    """Stiffness that contacts of the faces without bonds may have at each node [N/m], (nodes,).

    Of faces that lie on each other at the start their own contact counts; of all others one with a
    face of the same kind, area and stiffness.
    """
    if len(p.contact_stiffness) == 0:
        return np.zeros(len(t.node_position))
    exposed = out.arrays["face.initially_exposed"].astype(bool)
    corners = (t.face_nodes >= 0).sum(axis=1)
    own, area = out.arrays["face.stiffness"], out.arrays["face.area"] / corners
    most = np.zeros(len(own))

    def count(a: NDArray, b: NDArray) -> None:
        interface = p.interface_of[t.face_kind[a], t.face_kind[b]]
        law = p.contact_stiffness[interface]
        in_series = 2 * own[a] * own[b] / (own[a] + own[b])
        both = np.where(p.in_series[interface], in_series, np.maximum(own[a], own[b]))
        rows = [np.where(law[:, i] > 0, law[:, i], law[:, i + 1] * both) for i in (0, 2)]
        spring = np.maximum(*rows) * np.minimum(area[a], area[b])
        np.maximum.at(most, a, spring)
        np.maximum.at(most, b, spring)

    faces = np.flatnonzero(exposed)
    mates = t.pair_faces.reshape(-1, 2)
    mates = mates[exposed[mates].all(axis=1)]
    lonely = np.setdiff1d(faces, mates)
    count(lonely, lonely)
    count(*mates.T)
    ends = t.face_nodes[faces]
    used = ends >= 0
    # semi-springs of either side, as much again for semi-edges
    share = np.repeat(2 * most[faces], used.sum(axis=1))
    return np.bincount(ends[used], share, len(t.node_position)).astype(float)


def _most_of_block(of_nodes: Floats, t: Topology) -> Floats:
    """The largest of the nodes of each block, for each of them; nodes of a block follow one another."""
    return np.maximum.reduceat(of_nodes, t.block_first_node[:-1])[t.node_block]


def _bonded_blocks(t: Topology, out: Assembly) -> NDArray[np.bool_]:
    bonded = np.zeros(len(t.block_group), bool)
    for faces in out.pair_faces.values():
        bonded[t.face_block[faces]] = True
    return bonded
