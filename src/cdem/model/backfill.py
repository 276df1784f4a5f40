"""Groups that come in later: where their nodes lie between rock that has moved meanwhile."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from cdem.mesh import element_shapes
from cdem.mesh.topology import Topology

Floats = NDArray[np.float64]

GONE = 0.5
"""A face is no neighbour any more once it has moved so much further than most others, in parts of
the root of its area."""
TOLERANCE = 1e-9
"""Residual at which the nodes between are placed, in parts of the largest displacement."""


def nodes_of_groups(t: Topology, names: Iterable[str]) -> NDArray[np.bool_]:
    """Whether each node is of one of these groups, shape (nodes,)."""
    groups = [t.group_names.index(name) for name in names]
    return np.isin(t.block_group, groups)[t.node_block]


def places(t: Topology, comes: NDArray[np.bool_], there: NDArray[np.bool_],
           held: NDArray[np.bool_], moved: Floats) -> Floats:  # fmt: skip
    """Where nodes that come in lie: beside the rock as it lies now, evenly spread between.

    Vertices that touched rock at the start move with it, supports stay; nodes between take the mean of
    their neighbours. A face whose rock has left its place is not followed.

    Args:
        t: Blocks, as they lay at the start, and pairs of touching faces.
        comes: Nodes that come in, shape (nodes,).
        there: Nodes that are part of the model already, the same shape.
        held: Components of nodes that a support holds, shape (nodes, 3).
        moved: Displacement of the nodes since the start [m], shape (nodes, 3).

    Returns:
        Positions [m], those of other nodes as at the start; shape (nodes, 3).
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
    """Node of an element of nodes that come in which is turned inside out, or -1."""
    for shape, nodes in t.element_nodes.items():
        mine = nodes[comes[nodes].all(axis=1)]
        wrong = (element_shapes.volumes(shape, position[mine]) <= 0).any(axis=1)
        if wrong.any():
            return int(mine[wrong.argmax(), 0])
    return -1


def _mates(t: Topology) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Vertices of conforming faces, and their mates; both ways."""
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
    """Weights and nodes of points of overlaps, on either side: mine, the other's."""
    pair = np.repeat(np.arange(len(t.overlap_faces)), np.diff(t.overlap_first))
    nodes = [np.maximum(t.face_nodes[t.overlap_faces[pair, side]], 0) for side in (0, 1)]
    weights = [t.overlap_weights_a, t.overlap_weights_b]
    for mine in (0, 1):
        yield weights[mine], nodes[mine], weights[1 - mine], nodes[1 - mine]


def _followed(
    t: Topology, comes: NDArray[np.bool_], there: NDArray[np.bool_], moved: Floats
) -> tuple[NDArray, Floats, Floats]:
    """Nodes that come in, displacements that they are to follow, and with what weight."""
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
    """Length of the shortest edge that leaves each node [m]; of a node without edges 0."""
    a, b = t.edge_nodes.T
    length = np.sqrt(((t.node_position[a] - t.node_position[b]) ** 2).sum(axis=1))
    size = np.full(len(t.node_position), np.inf)
    np.minimum.at(size, a, length)
    np.minimum.at(size, b, length)
    return np.where(np.isfinite(size), size, 0.0)


def _spread(t: Topology, comes: NDArray[np.bool_], led: NDArray[np.bool_], own: Floats) -> Floats:
    """Displacement along an axis of nodes that come in: `own` where it is led, the mean of
    neighbours elsewhere [m], shape (nodes,).

    Nodes that began at the same place move alike. What nothing leads stays.
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
        """What neighbours pull each free place by: 0 where it takes their mean."""
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
    """Places of which elements that come in join two, once each, both ways."""
    ends: list[NDArray] = [np.zeros((0, 2), np.intp)]
    for nodes in t.element_nodes.values():
        mine = place[nodes[comes[nodes].all(axis=1)]]
        for i in range(nodes.shape[1]):
            ends += [mine[:, [i, j]] for j in range(nodes.shape[1]) if j != i]
    pairs = np.unique(np.concatenate(ends), axis=0)
    return pairs[:, 0], pairs[:, 1]
