"""From a mesh to blocks: own nodes for each block, exterior faces and edges, pairs of touching faces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cdem.errors import MeshError
from cdem.mesh.arrays import (
    PIECE,
    components,
    in_order,
    in_pieces,
    order_of_rows,
    same_rows,
)
from cdem.mesh.element_shapes import FACES, NODES, volumes
from cdem.mesh.mesh import Mesh
from cdem.mesh.overlap import Overlaps, find_overlaps
from cdem.mesh.topology import Floats, Ints, Topology
from cdem.units import LARGEST, coordinates

SAME_PLACE = 1e-9
"""Points of different pieces closer than this, relative to the model's size, coincide."""
FAR = 1e-6
"""Points must be exact to this fraction of the smallest element; contacts need a thousandth."""
NEAR = 1e-3
"""Ratio of the distance between an element's points to the distance between coinciding points."""
LARGE_BLOCK = 10_000
"""Blocks with more nodes are reordered in memory: this many nodes have 2 MB of state."""
SLANTED = np.array([0.5426, 0.6477, 0.5348])
"""A direction, of length below 1, along which the points of a grid have different coordinates."""


def build_topology(
    mesh: Mesh,
    split: Mapping[str, str],
    joints: Sequence[str] = (),
    bonded: NDArray[np.bool_] | None = None,
) -> Topology:
    """Divide a mesh into blocks and find touching faces.

    Args:
        mesh: The mesh.
        split: Blocks of each group: "one" (the whole group), "connected" (each connected
            part; the default) or "elements" (every element).
        joints: Sets of joints; the faces of each form the surface of its name.
        bonded: Whether non-conforming touching faces of two kinds (see `Topology.face_kind`) are
            to be bonded, shape (kinds, kinds).

    Raises:
        MeshError: An element is inverted, has no volume or is duplicated, or a point is not finite
            or too far from the origin.
    """
    check_elements(mesh)
    blocks = block_labels(mesh, split)
    topology = _nodes_and_elements(mesh, blocks)
    _faces(topology)
    _edges(topology)
    place = _places(mesh)
    topology.node_place = place[topology.node_point].astype(np.int32)
    _pairs(topology, place)
    _surfaces(topology, mesh)
    topology.face_kind = topology.face_group.copy()
    for number, name in enumerate(joints):
        topology.face_kind[topology.surfaces[name]] += (1 + number) * len(mesh.group_names)
    if bonded is not None:
        found: Overlaps = find_overlaps(topology, bonded)
        topology.overlap_faces, topology.overlap_first = found.faces, found.first
        topology.overlap_weights_a, topology.overlap_weights_b = found.weights_a, found.weights_b
        topology.overlap_area = found.area
    return topology


def check_elements(mesh: Mesh) -> None:
    """Refuse points that are not finite, and elements that are inverted, flat or too far away."""
    bad = np.flatnonzero(~(np.abs(mesh.points) <= LARGEST).all(axis=1))
    if len(bad):
        raise MeshError(f"mesh point {bad[0]} is not finite: {mesh.points[bad[0]].tolist()}")
    for shape, cells in mesh.cells.items():
        if len(cells) == 0:
            continue

        def measure(cells: NDArray, shape: str = shape) -> Floats:
            """Size, smallest volume at a Gauss point, and volume."""
            corners = mesh.points[cells]
            size = (corners.max(axis=1) - corners.min(axis=1)).max(axis=1)
            volume = volumes(shape, corners)
            return np.stack([size, volume.min(axis=1), volume.sum(axis=1)], axis=1)

        size, least, total = in_pieces(measure, cells).T
        _check_scale(mesh, shape, float(np.min(size[size > 0], initial=LARGEST)))
        flat = np.flatnonzero(~(least > 1e-12 * size**3))
        if len(flat):
            cell = flat[0]
            group = mesh.group_names[mesh.cell_group[shape][cell]]
            center = coordinates(mesh.points[cells[cell]].mean(axis=0))
            fault = "is inverted" if total[cell] < 0 else "has no volume or is folded"
            raise MeshError(
                f"{shape} element {cell} of group {group!r}, centred at ({center}), {fault} "
                f"(volume {total[cell]:.3g} m3); {len(flat)} such element(s). Correct the mesh: "
                f"nodes must be "
                "in gmsh/VTK order and no element may be flat"
            )


def _check_scale(mesh: Mesh, shape: str, smallest: float) -> None:
    """Refuse coordinates too coarse for the smallest element [m]."""
    exact = float(np.spacing(np.abs(mesh.points).max()))
    if exact > FAR * smallest:
        raise MeshError(
            f"points lie so far from the origin, at ({coordinates(mesh.points[0])}), that "
            f"coordinates are exact to {exact:.2g} m only, and the smallest {shape} element is "
            f"{smallest:.3g} m; move the mesh to the origin in the program that made it"
        )
    wide = float(np.ptp(mesh.points, axis=0).max())
    if SAME_PLACE * wide > NEAR * smallest:
        raise MeshError(
            f"the model is {wide:.3g} m wide, and its smallest {shape} element {smallest:.3g} m: too "
            "small to distinguish its points; is a body far away, or a length in another unit?"
        )


def block_labels(mesh: Mesh, split: Mapping[str, str]) -> NDArray:
    """Label of the block of every cell, shape by shape."""
    counts = [len(mesh.cells.get(s, ())) for s in NODES]
    group = np.concatenate(
        [mesh.cell_group[s] for s in NODES if s in mesh.cells] or [np.zeros(0, np.int32)]
    )
    total = sum(counts)
    cell = np.arange(total)
    mode = [split.get(name, "connected") for name in mesh.group_names]
    label = cell.copy()

    starts = np.cumsum([0, *counts])
    links_a, links_b = [], []
    for shape, start in zip(NODES, starts, strict=False):
        if shape in mesh.cells and len(mesh.cells[shape]):
            cells = mesh.cells[shape]
            links_a.append(np.repeat(start + np.arange(len(cells)), cells.shape[1]))
            links_b.append(cells.ravel())
    owner, point = np.concatenate(links_a), np.concatenate(links_b)
    connected = np.array([m != "elements" for m in mode])[group[owner]]
    owner, point = owner[connected], point[connected]
    # cells of a group are connected by points: link each to the first cell at its points
    key = point * len(mode) + group[owner]
    order = np.argsort(key, kind="stable")
    new = np.r_[True, key[order][1:] != key[order][:-1]] if len(order) else np.zeros(0, bool)
    first = owner[order][np.flatnonzero(new)[np.cumsum(new) - 1]] if len(order) else owner
    label = components(total, owner[order], first)
    for index, kind in enumerate(mode):
        if kind == "one":
            some = group == index
            if some.any():
                label[some] = cell[some][0]
    return label


def _morton(points: Floats) -> NDArray[np.uint64]:
    low, high = points.min(axis=0), points.max(axis=0)
    cell = ((points - low) / np.maximum(high - low, 1e-300) * 2097151).astype(np.uint64)
    code = np.zeros(len(points), np.uint64)
    for bit in range(21):
        for axis in range(3):
            step = (cell[:, axis] >> np.uint64(bit)) & np.uint64(1)
            code |= step << np.uint64(3 * bit + axis)
    return code


@dataclass
class _Elements:
    """Elements in their order: by shape, the rows of the mesh, corners as mesh points, block and
    group."""

    cell: dict[str, Ints]
    points: dict[str, NDArray[np.int64]]
    block: dict[str, Ints]
    group: dict[str, Ints]


def _nodes_and_elements(mesh: Mesh, label: NDArray) -> Topology:
    """Give every block its nodes; order blocks, and elements inside them, along a Morton curve."""
    elements = _ordered_elements(mesh, label)
    node_block, node_point, element_nodes = _own_nodes(len(mesh.points), elements)
    count = 1 + int(node_block[-1])
    block_group = np.zeros(count, np.int32)
    for shape in NODES:
        block_group[elements.block[shape]] = elements.group[shape]
    return Topology(
        node_position=mesh.points[node_point].astype(np.float64),
        node_block=node_block,
        node_point=node_point,
        block_first_node=np.searchsorted(node_block, np.arange(count + 1)).astype(np.int32),
        block_group=block_group,
        element_nodes=element_nodes,
        element_block=elements.block,
        element_group=elements.group,
        element_cell=elements.cell,
        group_names=list(mesh.group_names),
    )


def _ordered_elements(mesh: Mesh, label: NDArray) -> _Elements:
    shapes = [s for s in NODES if s in mesh.cells]
    center = np.concatenate([mesh.points[mesh.cells[s]].mean(axis=1) for s in shapes])
    group = np.concatenate([mesh.cell_group[s] for s in shapes])
    block, curve = _ordered_blocks(label, center), _morton(center)
    found = _Elements({}, {}, {}, {})
    start = 0
    for shape in NODES:
        cells = mesh.cells.get(shape, np.zeros((0, NODES[shape]), np.int64))
        here = slice(start, start + len(cells))
        start += len(cells)
        order = np.lexsort((np.arange(len(cells)), curve[here], block[here]))
        found.cell[shape] = order.astype(np.int32)
        found.points[shape] = cells[order]
        found.block[shape] = block[here][order].astype(np.int32)
        found.group[shape] = group[here][order].astype(np.int32)
    return found


def _ordered_blocks(label: NDArray, center: Floats) -> NDArray[np.int64]:
    """Number of each element's block: blocks follow a Morton curve by the mean of their elements."""
    _, block = np.unique(label, return_inverse=True)
    count = block.max() + 1
    members = np.bincount(block, minlength=count)
    middle = np.stack([np.bincount(block, c, count) / members for c in center.T], axis=1)
    order = np.lexsort((np.arange(count), _morton(middle)))
    return _ranks(order)[block]


def _ranks(order: NDArray) -> NDArray[np.int64]:
    """Index of each item in an order."""
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    return rank


def _own_nodes(points: int, elements: _Elements) -> tuple[Ints, Ints, dict[str, Ints]]:
    """Block and mesh point of each node, and the elements' corners as nodes.

    Nodes of a large block are in the order in which its elements use them, so that neighbours are
    close in memory; nodes of a block of one element follow its corners, as fused blocks need
    (core/nodes/fused_blocks.hpp); other blocks fit into a cache, and stay in the order of the
    mesh.
    """
    keys = [
        elements.block[shape][:, None].astype(np.int64) * points + elements.points[shape]
        for shape in NODES
    ]
    flat = np.concatenate([k.ravel() for k in keys])
    unique, first, inverse = np.unique(flat, return_index=True, return_inverse=True)
    owner = unique // points
    members = np.bincount(np.concatenate([elements.block[shape] for shape in NODES]))
    follows = (np.bincount(owner) > LARGE_BLOCK) | (members == 1)
    order = np.lexsort((np.where(follows[owner], first, np.arange(len(unique))), owner))
    unique, inverse = unique[order], _ranks(order)[inverse]
    ends = np.cumsum([key.size for key in keys])[:-1]
    corners = {
        shape: nodes.reshape(key.shape).astype(np.int32)
        for shape, key, nodes in zip(NODES, keys, np.split(inverse, ends), strict=True)
    }
    return (unique // points).astype(np.int32), (unique % points).astype(np.int32), corners


def _faces(t: Topology) -> None:
    nodes, block, group, element = [], [], [], []
    first = 0
    for shape, faces in FACES.items():
        corners = t.element_nodes[shape]
        every = np.full((len(corners), len(faces), 4), -1, np.int32)
        for k, face in enumerate(faces):
            every[:, k, : len(face)] = corners[:, face]
        nodes.append(every.reshape(-1, 4))
        block.append(np.repeat(t.element_block[shape], len(faces)))
        group.append(np.repeat(t.element_group[shape], len(faces)))
        element.append(np.repeat(np.arange(first, first + len(corners)), len(faces)))
        first += len(corners)
    face_nodes, face_block = np.concatenate(nodes), np.concatenate(block)
    # two elements of a block share an inner face; a block of one element has none
    members = np.bincount(np.concatenate([*t.element_block.values()]))
    some = np.flatnonzero((members > 1)[face_block])
    number = same_rows(np.sort(face_nodes[some], axis=1))
    _check_inner_faces(t, face_nodes[some], number)
    outer = np.ones(len(face_nodes), bool)
    outer[some] = np.bincount(number)[number] == 1
    ids = np.flatnonzero(outer)
    ids = ids[np.argsort(face_block[ids], kind="stable")]
    t.face_nodes, t.face_block = face_nodes[ids], face_block[ids]
    t.face_group = np.concatenate(group)[ids]
    t.face_element = np.concatenate(element)[ids].astype(np.int32)


def _check_inner_faces(t: Topology, faces: Ints, number: NDArray[np.int64]) -> None:
    """Refuse elements of a block inside one another.

    A face of three elements, or of two elements that see it in the same orientation, has two
    elements on the same side.

    Args:
        t: Nodes and elements.
        faces: Nodes of the faces of all elements, (faces, 4), the fourth -1 for a triangle.
        number: Equal for faces with the same nodes.

    Raises:
        MeshError: Elements overlap.
    """
    order = np.argsort(number, kind="stable")
    same = number[order][1:] == number[order][:-1]
    wrong = np.flatnonzero(same[1:] & same[:-1])  # three elements
    if len(wrong) == 0:
        first, second = faces[order[:-1][same]], faces[order[1:][same]]
        sides = np.where(first[:, 3] < 0, 3, 4)
        start = np.where(first < 0, np.iinfo(np.int32).max, first).argmin(axis=1)
        other = np.where(second < 0, np.iinfo(np.int32).max, second).argmin(axis=1)
        rows = np.arange(len(first))
        wrong = np.flatnonzero(
            first[rows, (start + 1) % sides] == second[rows, (other + 1) % sides]
        )
        wrong = np.flatnonzero(same)[wrong]
    if len(wrong):
        nodes = faces[order[wrong[0]]]
        group = t.group_names[t.block_group[t.node_block[nodes[0]]]]
        place = coordinates(t.node_position[nodes[nodes >= 0]].mean(axis=0))
        raise MeshError(
            f"elements of group {group!r} lie inside one another: they share a face at ({place}) and "
            f"are on the same side of it; {len(wrong)} such face(s). Correct the mesh: an element "
            f"may "
            "be duplicated"
        )


def _edges(t: Topology) -> None:
    """Find edges and rings of nodes; blocks share none, so a few blocks at a time fit into a cache."""
    count = len(t.face_nodes)
    starts = np.append(np.flatnonzero(np.diff(t.face_block, prepend=-1)), count)
    some = np.arange(0, count + PIECE, PIECE).clip(max=count)
    cuts = np.unique(starts[np.searchsorted(starts, some)])
    t.face_edges = np.empty((count, 4), np.int32)
    ring_size = np.zeros(len(t.node_position), np.int32)
    nodes, faces, rings, found = [], [], [], 0
    for first, last in pairwise(cuts):
        start = t.block_first_node[t.face_block[first]]
        end = t.block_first_node[t.face_block[last - 1] + 1]
        local = t.face_nodes[first:last]
        e = _edges_of(np.where(local < 0, -1, local - start), end - start)
        t.face_edges[first:last] = np.where(local < 0, -1, e.of_face + found)
        nodes.append(e.nodes + start)
        faces.append(np.where(e.faces < 0, -1, e.faces + np.int32(first)))
        ring_size[start:end] = e.ring_size
        rings.append(e.ring + start)
        found += len(e.nodes)
    t.edge_nodes, t.edge_faces = np.concatenate(nodes), np.concatenate(faces)
    t.node_ring_first = np.zeros(len(ring_size) + 1, np.int32)
    np.cumsum(ring_size, out=t.node_ring_first[1:])
    t.node_ring = np.concatenate(rings)


@dataclass
class _EdgesOf:
    """Edges of some faces, see `Topology`; `ring_size` is the number of edges that start at each node."""

    of_face: Ints
    nodes: Ints
    faces: Ints
    ring_size: NDArray[np.intp]
    ring: Ints


def _edges_of(start: Ints, count: int) -> _EdgesOf:
    """Edges of faces with these nodes, (faces, 4), out of this number."""
    end = np.roll(start, -1, axis=1)
    end[:, 3] = start[:, 0]
    end[:, 2] = np.where(start[:, 3] < 0, start[:, 0], start[:, 3])
    used = start >= 0
    a, b = start[used], end[used]  # sides, face by face
    bits = int(a.max()).bit_length()
    key, order = in_order((np.minimum(a, b).astype(np.int64) << bits) | np.maximum(a, b))
    new = np.flatnonzero(np.r_[True, key[1:] != key[:-1]])
    members = np.diff(new, append=len(key))
    low, high = key[new] >> bits, key[new] & ((1 << bits) - 1)
    number = np.empty(len(key), np.int32)
    number[order] = np.repeat(np.arange(len(new), dtype=np.int32), members)
    of_face = np.full(start.shape, -1, np.int32)
    of_face[used] = number
    side_face = np.nonzero(used)[0]
    # if more than two faces of a block meet at an edge, the first two represent it
    faces = np.full((len(new), 2), -1, np.int32)
    faces[:, 0] = side_face[order[new]]
    two = members > 1
    faces[two, 1] = side_face[order[new[two] + 1]]
    ring = np.concatenate([(low << bits) | high, (high << bits) | low])
    ring.sort()
    return _EdgesOf(
        of_face,
        np.stack([low, high], axis=1).astype(np.int32),
        faces,
        np.bincount(ring >> bits, minlength=count),
        (ring & ((1 << bits) - 1)).astype(np.int32),
    )


def _places(mesh: Mesh) -> NDArray:
    """A number for every mesh point, equal for points of different pieces at the same place."""
    near = SAME_PLACE * float(np.ptp(mesh.points, axis=0).max())
    # along a slanted line only coinciding points have close coordinates, even in regular grids
    along = (mesh.points - mesh.points.min(axis=0)) @ SLANTED
    order = np.argsort(along, kind="stable")
    x, along = mesh.points[order], along[order]
    first, second = [], []
    for step in range(1, len(x)):
        i = np.flatnonzero(along[step:] - along[:-step] <= near)
        if len(i) == 0:
            break
        i = i[np.linalg.norm(x[i + step] - x[i], axis=1) <= near]
        first.append(order[i])
        second.append(order[i + step])
    none = np.zeros(0, np.intp)
    return components(len(x), np.concatenate([none, *first]), np.concatenate([none, *second]))


def _pairs(t: Topology, place: NDArray) -> None:
    at = np.where(t.face_nodes >= 0, place[t.node_point[t.face_nodes]], -1)
    key = np.sort(at, axis=1)
    order = order_of_rows(key)
    key = key[order]
    same = (key[1:] == key[:-1]).all(axis=1)
    i = np.flatnonzero(same)
    pairs = np.sort(np.stack([order[i], order[i + 1]], axis=1), axis=1)
    pairs = pairs[t.face_block[pairs[:, 0]] != t.face_block[pairs[:, 1]]]
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    a, b = pairs.T
    shift = (at[b] == at[a][:, :1]).argmax(axis=1)
    # mated faces have opposite orientations; faces of bodies inside one another do not
    k = np.arange(4)
    sides = (at[a] >= 0).sum(axis=1)[:, None]
    mate = np.take_along_axis(at[b], (shift[:, None] - k) % sides, axis=1)
    facing = ((mate == at[a]) | (k >= sides)).all(axis=1)
    pairs, shift = pairs[facing], shift[facing]
    if np.bincount(pairs.ravel(), minlength=1).max() > 1:  # bodies inside one another
        _, first = np.unique(pairs, return_index=True)
        alone = np.isin(np.arange(pairs.size), first).reshape(pairs.shape).all(axis=1)
        pairs, shift = pairs[alone], shift[alone]
    t.pair_faces = pairs.astype(np.int32)
    t.pair_shift = shift.astype(np.int32)


def _surfaces(t: Topology, mesh: Mesh) -> None:
    points = np.where(t.face_nodes >= 0, t.node_point[t.face_nodes], -1)
    key = np.sort(points, axis=1)
    for name, parts in mesh.surfaces.items():
        if not parts:  # a set of joints without cuts
            t.surfaces[name] = np.zeros(0, np.int64)
            continue
        wanted = [np.pad(p, ((0, 0), (0, 4 - p.shape[1])), constant_values=-1) for p in parts]
        sought = np.sort(np.concatenate(wanted), axis=1)
        number = same_rows(np.concatenate([sought, key]))
        hit = np.isin(number[len(sought) :], number[: len(sought)])
        t.surfaces[name] = np.flatnonzero(hit)


def snap_mates(topology: Topology) -> None:
    """Move the vertices of conforming faces to exactly the same place (they differ by round-off)."""
    faces, shift = topology.pair_faces, topology.pair_shift
    if len(faces) == 0:
        return
    for n in (3, 4):
        some = (topology.face_nodes[faces[:, 0]] >= 0).sum(axis=1) == n
        k = np.arange(n)
        a = topology.face_nodes[faces[some, 0]][:, :n]
        mates = (shift[some][:, None] - k) % n
        b = np.take_along_axis(topology.face_nodes[faces[some, 1]], mates, axis=1)
        topology.node_position[b] = topology.node_position[a]
