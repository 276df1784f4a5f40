"""Mass added where small elements, bonds and contacts would shorten the step (`time.mass_scaling`).

A step t is stable if every node has a mass of at least t^2 / 4 (S + 2 k): S = sum w_e^2 m_e of its
elements, k the stiffness of its bonds and contacts (Gershgorin). For a mass matrix M, use a
diagonal below it, M >= diag(least).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.case.schema import MassScaling
from cdem.errors import CaseError
from cdem.mesh.arrays import same_everywhere
from cdem.mesh.topology import Topology
from cdem.model.flat_arrays import Assembly, Floats, Properties
from cdem.model.masses import one_element_blocks

OFFER = 0.001
"""Fraction of the mass of free nodes; the audit reports the step for it."""
ROUNDS = 100
"""Most looks for the step for a given mass."""
NEAR = 1e-9
"""Of the step: looks on both sides of a guess are this far from it."""


class Scaling:
    """Mass of each node for a step: with bonds intact, and with breakable bonds broken.

    Attributes:
        free_mass: Mass of the nodes that are not fixed in all directions [kg].

    Args:
        t: Blocks, elements, faces and pairs.
        p: Properties from the case.
        out: Masses without scaling, and pairs.
    """

    def __init__(self, t: Topology, p: Properties, out: Assembly) -> None:
        held = p.supported.all(axis=1)
        self.free_mass = float(out.arrays["node.mass"][~held].sum())
        exposed = out.arrays["face.initially_exposed"].astype(bool)
        bonds = bond_stiffness(t, out)
        springs = bonds + out.module_stiffness + contact_stiffness(t, p, out, exposed)
        self._states = [_Needs(t, p, out, springs, True)]
        breaking = _breaking_faces(t, p, out)
        if breaking.any():
            springs = bond_stiffness(t, out, p.breaks) + contact_stiffness(
                t, p, out, exposed | breaking, any_mate=True
            )
            self._states.append(_Needs(t, p, out, springs + out.module_stiffness, False))

    def added(self, limit: float) -> Floats:
        """Mass to add for a stable step [s] to each node [kg], shape (nodes,)."""
        return np.maximum.reduce([state.added(limit) for state in self._states])

    def limit(self, share: float) -> float:
        """The longest stable step [s] that needs no more than this fraction of the free mass."""
        largest = max(state.largest for state in self._states)
        if not largest > 0:
            return np.inf
        shortest, longest = _steps(largest)
        needing, total = np.arange(len(self._states[0].mass)), np.zeros(len(self._states[0].mass))

        def too_much(step: float) -> float:
            """Mass that this step needs beyond the share [kg]."""
            here = [state.added(step, needing) for state in self._states]
            total[needing] = np.maximum.reduce(here)
            return float(total.sum() - share * self.free_mass)

        low, high = (shortest, -share * self.free_mass), (longest, np.inf)
        for turn in range(ROUNDS):
            middle = _between(low, high, turn)
            excess = too_much(middle)
            if excess > 0:  # nodes without added mass need none for shorter steps
                high, needing = (middle, excess), needing[total[needing] > 0]
            else:
                low = (middle, excess)
            if same_everywhere(np.array(low[0])) == same_everywhere(np.array(high[0])):
                break
        return float(same_everywhere(np.array(low[0])))

    def limit_at_the_start(self, added: Floats) -> float:
        """The longest stable step [s] with bonds intact and this mass added, shape (nodes,)."""
        intact = self._states[0]
        if not intact.largest > 0:
            return np.inf
        return float(same_everywhere(np.clip(intact.limit(added), *_steps(intact.largest))))

    def wanted(self, asked: MassScaling, safety: float) -> Floats:
        """Mass asked for by a case, for this fraction of the stable step: as `added`.

        Raises:
            CaseError: The step is longer than 100 times the stable step without added mass.
        """
        limit = np.inf if asked.step is None else asked.step / safety
        if asked.most is not None:
            limit = min(limit, self.limit(asked.most))
        longest = _steps(max(state.largest for state in self._states) or np.inf)[1]
        if 0 < longest < limit < np.inf:
            raise CaseError(
                f"time.mass_scaling.step: {asked.step:.3g} s is more than 100 times the stable step of "
                f"the model; write at most {safety * longest:.2g} s, or most: 0.001 instead"
            )
        return self.added(limit)


def _between(low: tuple[float, float], high: tuple[float, float], turn: int) -> float:
    """A step between two, with the mass that each needs too much: that mass goes with its square.

    In turns a little shorter and a little longer than where the line between both is zero, so that
    both ends come close; every third is halfway, for masses that do not go along a line.
    """
    if high[1] == np.inf:  # too long, or not tried
        return min(2 * low[0], high[0])
    if turn % 3 == 2:
        return 0.5 * (low[0] + high[0])
    a, b = low[0] ** 2, high[0] ** 2
    square = a - low[1] * (b - a) / (high[1] - low[1])
    return float(np.clip(np.sqrt(square) * (1 + (-1, 1)[turn % 3] * NEAR), low[0], high[0]))


def _steps(largest: float) -> tuple[float, float]:
    """The stable step of the largest squared frequency, and the longest that mass may give [s]."""
    return 2 / np.sqrt(largest), 200 / np.sqrt(largest)


class _Needs:
    """Mass of each node in one state of the bonds.

    Attributes:
        mass: Mass without scaling [kg], shape (nodes,).
        largest: Squared frequency that limits the step without scaling [1/s2].

    Args:
        t, p, out: As for `Scaling`.
        stiffness: Stiffness of bonds and contacts at each node [N/m], shape (nodes,).
        bonded: Whether blocks that are lumped while bonded have lumped masses.
    """

    def __init__(
        self, t: Topology, p: Properties, out: Assembly, stiffness: Floats, bonded: bool
    ) -> None:
        arrays = out.arrays
        self.mass = arrays["node.mass"]
        dense = arrays["node.mass_row_first"] >= 0
        alone = one_element_blocks(t)
        as_bonded = np.zeros(len(alone), bool)
        if bonded and p.lumped_while_bonded:  # larger blocks come loose as a whole
            as_bonded = alone & _bonded_blocks(t, out)
        lumped = ~dense | as_bonded[t.node_block]
        held = p.supported.all(axis=1)  # cannot become unstable
        springs = 2 * stiffness
        load = arrays["node.lumped_frequency_squared"] * self.mass + springs
        self._load = np.where(held, 0.0, load)
        self._least = np.where(lumped, self.mass, out.least_mass)
        # for blocks with a matrix, as in the core: a lower bound for any step
        square = arrays["node.frequency_squared"] + _most_of_block(
            springs * arrays["node.inverse_mass_bound"], t
        )
        by_matrix = np.where(held, 0.0, _most_of_block(square, t))
        by_node = _most_of_block(self._load / self._least, t)
        self._square = np.where(lumped, np.inf, by_matrix)
        # single elements keep the shape of their matrix: one factor for all nodes
        self._alone = dense & alone[t.node_block]
        self._factor_square = np.minimum(by_node, np.where(lumped, np.inf, by_matrix))
        one_by_one = np.minimum(self._square, self._load / self._least)
        self.largest = np.where(self._alone, self._factor_square, one_by_one).max(initial=0.0)

    def added(self, limit: float, nodes: NDArray | slice = slice(None)) -> Floats:
        """As `Scaling.added`, for some nodes."""
        quarter = limit**2 / 4
        load, least = self._load[nodes], self._least[nodes]
        needs = np.where(self._square[nodes] * quarter > 1, quarter * load - least, 0.0)
        factor = np.maximum(1.0, quarter * self._factor_square[nodes])
        return np.where(self._alone[nodes], (factor - 1) * self.mass[nodes], np.maximum(needs, 0.0))

    def limit(self, added: Floats) -> float:
        """The longest stable step [s] with this mass added [kg], shape (nodes,)."""
        with np.errstate(divide="ignore"):
            alone = (1 + added / self.mass) / self._factor_square
            others = np.maximum(1 / self._square, (self._least + added) / self._load)
        return float(2 * np.sqrt(np.where(self._alone, alone, others).min()))


def bond_stiffness(t: Topology, out: Assembly, broken: NDArray[np.bool_] | None = None) -> Floats:
    """Stiffness of intact bonds at each node [N/m], shape (nodes,), without broken interfaces."""
    nodes = len(t.node_position)
    total = np.zeros(nodes)
    for kind, n in (("triangles", 3), ("quads", 4)):
        count = out.counts[f"{kind}.count"]
        largest = out.arrays[f"{kind}.stiffness"].reshape(2, -1)[:, :count].max(axis=0, initial=0.0)
        ends = out.arrays[f"{kind}.nodes"].reshape(2 * n, -1)[:, :count]
        holds = _holds(out, kind, count, broken)
        share = np.tile(holds * largest * out.arrays[f"{kind}.area"][:count] / n, 2 * n)
        total += np.bincount(ends.ravel(), share, nodes)
    count = out.counts["overlaps.count"]
    largest = out.arrays["overlaps.stiffness"].reshape(2, -1)[:, :count].max(axis=0, initial=0.0)
    points = np.diff(t.overlap_first)
    largest = _holds(out, "overlaps", count, broken) * largest
    per_point = np.repeat(largest, points) * t.overlap_area
    owner = np.repeat(np.arange(count), points)
    for side, weights in enumerate((t.overlap_weights_a, t.overlap_weights_b)):
        ends = t.face_nodes[t.overlap_faces.reshape(-1, 2)[owner, side]]
        used = ends >= 0
        total += np.bincount(ends[used], (per_point[:, None] * np.abs(weights))[used], nodes)
    return total


def _holds(
    out: Assembly, kind: str, count: int, broken: NDArray[np.bool_] | None
) -> NDArray[np.bool_]:
    """Pairs of a kind that hold while bonds of some interfaces are broken, shape (count,)."""
    interface = out.arrays[f"{kind}.interface"][:count]
    return np.ones(count, bool) if broken is None else ~broken[interface]


def _breaking_faces(t: Topology, p: Properties, out: Assembly) -> NDArray[np.bool_]:
    """Faces of bonds that may break, shape (faces,)."""
    breaking = np.zeros(len(t.face_nodes), bool)
    for kind, faces in out.pair_faces.items():
        breaks = p.breaks[out.arrays[f"{kind}.interface"][: len(faces)]]
        breaking[faces[breaks].ravel()] = True
    return breaking


def contact_stiffness(
    t: Topology,
    p: Properties,
    out: Assembly,
    exposed: NDArray[np.bool_],
    *,
    any_mate: bool = False,
) -> Floats:
    """Stiffness of possible contacts of exposed faces at each node [N/m], shape (nodes,).

    Faces that lie on each other at the start count with their own contact; all others with a
    contact on
    a face of the same kind, area and stiffness. In rubble a face may meet any other (`any_mate`):
    then the other side counts as rigid if both sides are in series.
    """
    if len(p.contact_stiffness) == 0:
        return np.zeros(len(t.node_position))
    corners = (t.face_nodes >= 0).sum(axis=1)
    own, area = out.arrays["face.stiffness"], out.arrays["face.area"] / corners
    most = np.zeros(len(own))

    def count(a: NDArray, b: NDArray) -> None:
        interface = p.interface_of[t.face_kind[a], t.face_kind[b]]
        law = p.contact_stiffness[interface]
        in_series = 2 * own[a] * (1 if any_mate else own[b] / (own[a] + own[b]))
        both = np.where(p.in_series[interface], in_series, np.maximum(own[a], own[b]))
        rows = [np.where(law[:, i] > 0, law[:, i], law[:, i + 1] * both) for i in (0, 2)]
        spring = np.maximum(*rows) * np.minimum(area[a], area[b])
        np.maximum.at(most, a, spring)
        np.maximum.at(most, b, spring)

    faces = np.flatnonzero(exposed)
    mates = t.pair_faces.reshape(-1, 2)
    mates = mates[exposed[mates].all(axis=1)]
    lonely = faces if any_mate else np.setdiff1d(faces, mates)
    count(lonely, lonely)
    if not any_mate:
        count(*mates.T)
    ends = t.face_nodes[faces]
    used = ends >= 0
    # semi-springs of either side, the same for semi-edges
    share = np.repeat(2 * most[faces], used.sum(axis=1))
    return np.bincount(ends[used], share, len(t.node_position)).astype(float)


def _most_of_block(of_nodes: Floats, t: Topology) -> Floats:
    """The largest value in each block, for each of its nodes; nodes of a block are contiguous."""
    return np.maximum.reduceat(of_nodes, t.block_first_node[:-1])[t.node_block]


def _bonded_blocks(t: Topology, out: Assembly) -> NDArray[np.bool_]:
    bonded = np.zeros(len(t.block_group), bool)
    for faces in out.pair_faces.values():
        bonded[t.face_block[faces]] = True
    return bonded
