"""Masses of the nodes, mass matrices of small blocks, and the frequencies that limit the time step."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cdem.mesh import element_shapes
from cdem.mesh.arrays import along, inverses, matrix_product, same_everywhere, solve_semidefinite
from cdem.mesh.topology import Topology
from cdem.model.flat_arrays import Assembly, Floats, Properties

Geometry = tuple[Floats, Floats, Floats]
"""Gradients, volumes of the Gauss points, and hourglass rows of elements, see `element_shapes`."""
DENSE_NODES = 16
"""Blocks of up to this many nodes get the full mass matrix: exact inertia at little cost."""
DENSE_NODES_MOST = 256
"""Larger blocks get it only if no lumped masses have the exact inertia (one element thick)."""
LEAST_LUMP = 0.3
"""Lower limit of a corrected lumped mass, relative to the uncorrected one."""


def node_masses(
    t: Topology,
    p: Properties,
    matrices: dict[str, Floats],
    geometry: dict[str, Geometry],
    added: Floats,
    out: Assembly,
) -> None:
    """Masses of the nodes, and the squared frequency that limits the time step.

    Args:
        t: Blocks and elements.
        p: Properties from the case.
        matrices: Mass matrices of the elements by shape [kg].
        geometry: Geometry of the elements by shape.
        added: Mass added to each node by mass scaling [kg], shape (nodes,).
        out: Receives the arrays of the nodes.
    """
    first = t.block_first_node
    size = np.diff(first)
    block_nodes = size[t.node_block]
    dense_block = (size <= DENSE_NODES) & p.exact_mass
    held = np.ones(len(size), bool)
    held[t.node_block[~p.supported.all(axis=1)]] = False
    dense_block &= ~held  # a block that cannot move needs no inverse

    while True:
        lumped, stiffness, frequency2 = _lumped_masses(t, p, matrices, geometry, dense_block, out)
        mass = lumped.copy()
        if not p.exact_mass:
            break
        without = _correct_lumps(t, matrices, lumped, mass, dense_block | held, out)
        if len(without) == 0:
            break
        dense_block[without] = True  # a full matrix has other frequencies: repeat
    # u K u <= sum_e w_e^2 u_e M_e u_e: with lumped masses that is a sum over the nodes, and no
    # frequency of the mesh exceeds the largest sum_e w_e^2 m_e / m of a node
    mass += added
    lumped_frequency2 = stiffness / mass
    out.arrays["node.mass"] = mass
    out.arrays["node.frequency_squared"] = np.where(
        dense_block[t.node_block], frequency2, lumped_frequency2
    )
    out.arrays["node.lumped_frequency_squared"] = lumped_frequency2
    out.arrays["node.block_first"] = first[t.node_block].astype(np.int32)
    out.arrays["node.block_count"] = block_nodes.astype(np.int32)
    _dense_blocks(t, p, matrices, added, stiffness, dense_block, out)
    out.least_mass = _least_masses(t, matrices, added, out)
    out.arrays["node.least_mass"] = out.least_mass if added.any() else np.zeros(0)


def one_element_blocks(t: Topology) -> NDArray[np.bool_]:
    """Whether a block is a single element, shape (blocks,)."""
    blocks = np.concatenate([t.element_block[shape] for shape in element_shapes.NODES])
    return np.bincount(blocks, minlength=len(t.block_group)) == 1


def _lumped_masses(
    t: Topology,
    p: Properties,
    matrices: dict[str, Floats],
    geometry: dict[str, Geometry],
    dense_block: NDArray[np.bool_],
    out: Assembly,
) -> tuple[Floats, Floats, Floats]:
    """For each node its lumped mass, the sum of w_e^2 m_e over its elements, with the frequencies of
    lumped masses, and their largest w_e^2.

    The last counts elements of blocks with a full mass matrix with this matrix, all others with
    lumped masses.
    """
    lumped = np.zeros(len(t.node_position))
    stiffness = np.zeros(len(t.node_position))
    frequency2 = np.zeros(len(t.node_position))
    out.element_frequency = {}
    for shape in element_shapes.NODES:
        connectivity, m = t.element_nodes[shape], matrices[shape]
        if len(m) == 0:
            out.element_frequency[shape] = np.zeros(0)
            continue
        group = t.element_group[shape]
        dense = dense_block[t.element_block[shape]]
        rock = (p.lame[group], p.shear[group])
        gradient, volume, hourglass = geometry[shape]
        row_sums = m.sum(axis=2)
        lumped_square = same_everywhere(
            element_shapes.squared_frequencies(
                shape, gradient, volume, rock[0], rock[1], row_sums, hourglass
            )
        )
        square = lumped_square.copy()
        if dense.any():
            square[dense] = same_everywhere(
                element_shapes.squared_frequencies(
                    shape,
                    gradient[dense],
                    volume[dense],
                    rock[0][dense],
                    rock[1][dense],
                    m[dense],
                    hourglass[dense],
                )
            )
        out.element_frequency[shape] = np.sqrt(square)
        np.maximum.at(frequency2, connectivity, square[:, None])
        np.add.at(stiffness, connectivity, lumped_square[:, None] * row_sums)
        np.add.at(lumped, connectivity, row_sums)
    return lumped, stiffness, frequency2


def _second_moments(
    t: Topology, masses: dict[str, Floats], blocks: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    """Exact centre (sum m x) and second moments (sum m x x^T) of blocks about their first node."""
    origin = t.node_position[t.block_first_node[:-1]]
    second = np.zeros((len(blocks), 3, 3))
    for shape, m in masses.items():
        some = blocks[t.element_block[shape]]
        if not some.any():
            continue
        block = t.element_block[shape][some]
        x = t.node_position[t.element_nodes[shape][some]] - origin[block][:, None]
        np.add.at(second, block, matrix_product(x.transpose(0, 2, 1), matrix_product(m[some], x)))
    return origin, second


def _correct_lumps(
    t: Topology,
    masses: dict[str, Floats],
    lumped: Floats,
    mass: Floats,
    skip: NDArray[np.bool_],
    out: Assembly,
) -> NDArray[np.intp]:
    """Shift the lumped masses of larger blocks, as little as possible, to their exact inertia.

    Minimises sum (m - m_lumped)^2 / m_lumped with mass, centre and second moments given. Blocks
    that would need a mass near zero (one element thick) are returned if small enough for the full
    mass matrix; else they keep their lumped masses and are counted for the audit.
    """
    todo = np.flatnonzero(~skip)
    without: list[int] = []
    out.lumped_blocks = 0
    if len(todo) == 0:
        return np.array(without, np.intp)
    origin, second = _second_moments(t, masses, ~skip)
    upper = np.triu_indices(3)
    for b in todo:
        nodes = slice(t.block_first_node[b], t.block_first_node[b + 1])
        m = lumped[nodes]
        x = t.node_position[nodes] - origin[b]
        center = (m[:, None] * x).sum(axis=0) / m.sum()
        x = x - center
        exact = second[b] - m.sum() * np.outer(center, center)
        scale = np.sqrt(np.trace(exact) / m.sum())
        x, exact = x / scale, exact / scale**2
        rows = np.vstack([np.ones(len(m)), x.T, (x[:, upper[0]] * x[:, upper[1]]).T])
        target = np.concatenate([[m.sum()], np.zeros(3), exact[upper]])
        normal = matrix_product(rows * m, rows.T)
        multipliers = solve_semidefinite(normal, target - along(rows, m), 1e-12)
        shift = m * along(rows.T, multipliers)
        good = np.abs(along(rows, m + shift) - target).max() < 1e-9 * m.sum()
        if good and (m + shift > LEAST_LUMP * m).all():
            mass[nodes] = m + shift
        elif len(m) <= DENSE_NODES_MOST:
            without.append(int(b))
        else:
            out.lumped_blocks += 1
    return np.array(without, np.intp)


def _least_masses(t: Topology, matrices: dict[str, Floats], added: Floats, out: Assembly) -> Floats:
    """Diagonal not above the mass matrix of each block, D <= M [kg], shape (nodes,).

    For an element with row sums m it is lambda diag(m), lambda the smallest eigenvalue of
    diag(m)^-1/2 M diag(m)^-1/2: 1/5 for a tet, 1/27 for a box. For lumped masses, the masses.
    """
    dense = out.arrays["node.mass_row_first"] >= 0
    least = np.zeros(len(dense))
    for shape, m in matrices.items():
        nodes = t.element_nodes[shape]
        if len(m) == 0:
            continue
        rows = m.sum(axis=2)
        part = np.full(len(m), 0.2)
        if shape != "tet4":
            some = dense[nodes[:, 0]]
            root = np.sqrt(rows[some])
            scaled = m[some] / root[:, :, None] / root[:, None]
            part[some] = same_everywhere(1 / np.linalg.eigvalsh(scaled)[:, 0]) ** -1.0
        least += np.bincount(nodes.ravel(), (part[:, None] * rows).ravel(), len(least))
    mass = out.arrays["node.mass"]
    grown = least * mass / (mass - added)  # blocks of one element keep the shape of their matrix
    least = np.where(one_element_blocks(t)[t.node_block], grown, least + added)
    return np.where(dense, least, mass)


class _MatrixTable:
    """The mass matrices of small blocks in the core's format, one after the other.

    Attributes:
        first: Start of each node's row of the matrix, or -1.
        step: For each node, distance between the matrices of two axes; 0 if they are equal.
        inverse: Inverses, each row times its node's mass.
        matrix: Matrices, each row over its node's mass.
    """

    def __init__(self, nodes: int) -> None:
        self.first = np.full(nodes, -1, np.int32)
        self.step = np.zeros(nodes, np.int32)
        self.inverse, self.matrix = [np.zeros(0)], [np.zeros(0)]
        self._size = 0

    def keep(self, nodes: NDArray, inverses: Floats, matrices: Floats) -> None:
        """Nodes of blocks, (blocks, n), with one matrix for each or for all, or one for each axis."""
        n = nodes.shape[1]
        rows = self._size + matrices[0].size * np.arange(len(matrices))[:, None] + n * np.arange(n)
        self.first[nodes] = rows
        self.step[nodes] = n * n if matrices.ndim == 4 else 0
        self.inverse.append(inverses.ravel())
        self.matrix.append(matrices.ravel())
        self._size += matrices.size


def _dense_blocks(
    t: Topology,
    p: Properties,
    masses: dict[str, Floats],
    added: Floats,
    stiffness: Floats,
    dense_block: NDArray[np.bool_],
    out: Assembly,
) -> None:
    """Mass matrices of small blocks and their inverses, without supported nodes."""
    mass, frequency2 = out.arrays["node.mass"], out.arrays["node.frequency_squared"]
    first, size = t.block_first_node, np.diff(t.block_first_node)
    bound = 1 / mass
    held = np.zeros(len(size), bool)
    held[t.node_block[p.supported.any(axis=1)]] = True
    of_one = one_element_blocks(t)
    table = _MatrixTable(len(mass))
    for n in np.unique(size[dense_block]).tolist():
        free = np.flatnonzero(dense_block & ~held & (size == n))
        bound_to = np.flatnonzero(dense_block & held & (size == n))
        if n == 4 and len(free):  # tets: one matrix for all, over their mass
            nodes = first[free][:, None] + np.arange(n)
            bound[nodes] = 5 / mass[nodes]
            frequency2[nodes] *= (mass - added)[nodes] / mass[nodes]
            table.keep(nodes, (5 * np.eye(4) - 1)[None], ((1 + np.eye(4)) / 5)[None])
            free = free[:0]
        for blocks in (free, bound_to):
            if len(blocks) == 0:
                continue
            nodes = first[blocks][:, None] + np.arange(n)
            m = _block_matrices(t, masses, blocks, n)
            # single elements keep the shape of their matrix, and so their inertia
            one = of_one[blocks][:, None, None]
            heavier = 1 + added[nodes[:, 0]] / (mass - added)[nodes[:, 0]]
            m = np.where(one, heavier[:, None, None] * m, m + added[nodes][:, :, None] * np.eye(n))
            frequency2[nodes] /= np.where(one[:, 0], heavier[:, None], 1.0)
            bound[nodes] = same_everywhere(1 / np.linalg.eigvalsh(m)[:, 0])[:, None]
            # K <= diag(stiffness) as well, often below the bound of the worst element
            root = np.sqrt(stiffness[nodes])
            least = np.linalg.eigvalsh(m / root[:, :, None] / root[:, None])[:, 0]
            frequency2[nodes] = np.minimum(frequency2[nodes], same_everywhere(1 / least)[:, None])
            if blocks is free:
                per_row = mass[nodes][:, :, None]
                table.keep(nodes, inverses(m) * per_row, m / per_row)
            else:
                per_row = mass[nodes][:, None, :, None]
                by_axis = _supported_inverses(m, p.supported[nodes])
                table.keep(nodes, by_axis * per_row, np.repeat(m[:, None], 3, axis=1) / per_row)
    out.arrays["node.mass_row_first"] = table.first
    out.arrays["node.mass_axis_stride"] = table.step
    out.arrays["node.inverse_mass_bound"] = bound
    out.arrays["mass.inverse"] = np.concatenate(table.inverse)
    out.arrays["mass.matrix"] = np.concatenate(table.matrix)


def _block_matrices(t: Topology, masses: dict[str, Floats], blocks: NDArray, n: int) -> Floats:
    place = np.full(len(t.block_first_node) - 1, -1)
    place[blocks] = np.arange(len(blocks))
    m = np.zeros((len(blocks), n, n))
    for shape, matrices in masses.items():
        where = place[t.element_block[shape]]
        some = where >= 0
        if not some.any():
            continue
        nodes = t.element_nodes[shape][some]
        local = nodes - t.block_first_node[t.element_block[shape][some]][:, None]
        np.add.at(
            m, (where[some][:, None, None], local[:, :, None], local[:, None]), matrices[some]
        )
    return m


def _supported_inverses(matrices: Floats, supported: NDArray[np.bool_]) -> Floats:
    """Inverses per axis of the free parts of mass matrices, zero elsewhere.

    Args:
        matrices: Mass matrices [kg], shape (blocks, n, n).
        supported: Components of the blocks' nodes that are fixed or driven, shape (blocks, n, 3).
    """
    out = np.zeros((len(matrices), 3, *matrices.shape[1:]))
    for axis in range(3):
        patterns, which = np.unique(supported[..., axis], axis=0, return_inverse=True)
        for number, held in enumerate(patterns):
            alike, free = np.flatnonzero(which.ravel() == number), np.flatnonzero(~held)
            part = matrices[np.ix_(alike, free, free)]
            out[np.ix_(alike, np.array([axis]), free, free)] = inverses(part)[:, None]
    return out
