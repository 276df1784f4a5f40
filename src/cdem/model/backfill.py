"""Groups that a stage adds: positions of their nodes between rock that has moved."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from cdem.mesh import element_shapes
from cdem.mesh.topology import Topology

Floats = NDArray[np.float64]

GONE = 0.5
"""A face is no longer a neighbour once it has moved this much further than most others, relative to
the root of its area."""
TOLERANCE = 1e-9
"""Residual of the positions of nodes in between, relative to the largest displacement."""


def nodes_of_groups(t: Topology, names: Iterable[str]) -> NDArray[np.bool_]:
    """Whether each node belongs to one of these groups, shape (nodes,)."""
    groups = [t.group_names.index(name) for name in names]
    return np.isin(t.block_group, groups)[t.node_block]


def places(t: Topology, comes: NDArray[np.bool_], there: NDArray[np.bool_],
           held: NDArray[np.bool_], moved: Floats) -> Floats:  # fmt: skip
    """Positions of added nodes: beside the rock as it lies now, evenly spread between.

    Vertices that touched rock at the start move with it, supports stay; nodes in between take the
    mean of their neighbours. A face whose rock has moved away is not followed.

    Args:
        t: Blocks in their initial positions, and pairs of touching faces.
        comes: Added nodes, shape (nodes,).
        there: Nodes already in the model, the same shape.
        held: Components of nodes that a support fixes, shape (nodes, 3).
        moved: Displacement of the nodes since the start [m], shape (nodes, 3).

    Returns:
        Positions [m], initial ones for other nodes; shape (nodes, 3).
    """
    node, follows, weight = _followed(t, comes, there, moved)
    count = len(t.node_position)
    total = np.bincount(node, weight, count)
    way = np.zeros((count, 3))
    for axis in range(3):
        own = np.bincount(node, weight * follows[:, axis], count) / np.maximum(total, 1e-300)
        led = (total > 0) | (held[:, axis] & comes)
        way[:, axis] = _spread(t, comes, led, np.where(held[:, axis], 0.0, own))
    return np.where(comes[:, None], t.node_position + way, t.node_position)


def folded(t: Topology, position: Floats, comes: NDArray[np.bool_]) -> int:
    """Node of an added element that is turned inside out, or -1."""
    for shape, nodes in t.element_nodes.items():
        mine = nodes[comes[nodes].all(axis=1)]
        wrong = (element_shapes.volumes(shape, position[mine]) <= 0).any(axis=1)
        if wrong.any():
            return int(mine[wrong.argmax(), 0])
    return -1


def _mates(t: Topology) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Vertices of conforming faces, and their mates; in both directions."""
    corners = (t.face_nodes >= 0).sum(axis=1)[t.pair_faces].reshape(-1, 2)[:, 0]
    ends = [np.zeros((0, 2), np.intp)]
    for n in (3, 4):
        some = corners == n
        one = t.face_nodes[t.pair_faces[some, 0]][:, :n]
        k = (t.pair_shift[some, None] - np.arange(n)) % n
        mate = np.take_along_axis(t.face_nodes[t.pair_faces[some, 1]], k, axis=1)
        ends.append(np.stack([one.ravel(), mate.ravel()], axis=1).astype(np.intp))
    a, b = np.concatenate(ends).T
    return np.concatenate([a, b]), np.concatenate([b, a])


def _overlapping(t: Topology) -> Iterator[tuple[Floats, NDArray, Floats, NDArray]]:
    """Weights and nodes of points of overlaps, for either side: own face, other face."""
    pair = np.repeat(np.arange(len(t.overlap_faces)), np.diff(t.overlap_first))
    nodes = [np.maximum(t.face_nodes[t.overlap_faces[pair, side]], 0) for side in (0, 1)]
    weights = [t.overlap_weights_a, t.overlap_weights_b]
    for mine in (0, 1):
        yield weights[mine], nodes[mine], weights[1 - mine], nodes[1 - mine]


def _followed(
    t: Topology, comes: NDArray[np.bool_], there: NDArray[np.bool_], moved: Floats
) -> tuple[NDArray, Floats, Floats]:
    """Added nodes, displacements for them to follow, and weights."""
    vertex, mate = _mates(t)
    some = comes[vertex] & there[mate]
    found = [(vertex[some], moved[mate[some]], np.ones(some.sum()))]
    for own, mine, other, nodes in _overlapping(t):
        some = comes[mine[:, 0]] & there[nodes[:, 0]]
        way = np.einsum("pk,pkx->px", other[some], moved[nodes[some]])
        found.append(
            (mine[some].ravel(), np.repeat(way, 4, axis=0), np.maximum(own[some], 0).ravel())
        )
    node, way, weight = (np.concatenate(parts) for parts in zip(*found, strict=True))
    if len(node):
        far = np.abs(way - np.median(way, axis=0)).max(axis=1)
        weight = np.where(far > GONE * _size(t)[node], 0.0, weight)
    return node, way, weight


def _size(t: Topology) -> Floats:
    """Length of the shortest edge at each node [m]; 0 for a node without edges."""
    a, b = t.edge_nodes.T
    length = np.sqrt(((t.node_position[a] - t.node_position[b]) ** 2).sum(axis=1))
    size = np.full(len(t.node_position), np.inf)
    np.minimum.at(size, a, length)
    np.minimum.at(size, b, length)
    return np.where(np.isfinite(size), size, 0.0)


def _spread(t: Topology, comes: NDArray[np.bool_], led: NDArray[np.bool_], own: Floats) -> Floats:
    """Displacement of added nodes along an axis: `own` if prescribed, elsewhere the mean of
    neighbours [m], shape (nodes,).

    Nodes with the same initial position move together. Nodes without any prescribed neighbour stay.
    """
    place = t.node_place.astype(np.intp)
    count = int(place.max(initial=-1)) + 1
    share = np.bincount(place[led], minlength=count).astype(float)
    fixed = share > 0
    way = np.bincount(place[led], own[led], count) / np.maximum(share, 1.0)
    a, b = _neighbours(t, comes, place)
    degree = np.bincount(a, minlength=count).astype(float)
    free = (degree > 0) & ~fixed

    def pull(x: Floats) -> Floats:
        """Residual of each free node: 0 if it has the mean of its neighbours."""
        return np.where(free, np.bincount(a, x[b], count) - degree * x, 0.0)

    largest = np.abs(way).max(initial=0.0)
    residual = pull(way)
    direction, square = residual.copy(), (residual**2).sum()
    for _ in range(count):  # conjugate gradients
        if np.abs(residual).max(initial=0.0) <= TOLERANCE * largest:
            break
        change = -pull(direction)
        step = square / (direction * change).sum()
        way += step * direction
        residual -= step * change
        before, square = square, (residual**2).sum()
        direction = residual + square / before * direction
    return way[place]


def _neighbours(t: Topology, comes: NDArray[np.bool_], place: NDArray) -> tuple[NDArray, NDArray]:
    """Edges between nodes of added elements, once each, in both directions."""
    ends: list[NDArray] = [np.zeros((0, 2), np.intp)]
    for nodes in t.element_nodes.values():
        mine = place[nodes[comes[nodes].all(axis=1)]]
        for i in range(nodes.shape[1]):
            ends += [mine[:, [i, j]] for j in range(nodes.shape[1]) if j != i]
    pairs = np.unique(np.concatenate(ends), axis=0)
    return pairs[:, 0], pairs[:, 1]
