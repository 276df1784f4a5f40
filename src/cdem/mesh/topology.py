"""The topology of a model: blocks, nodes, elements, exterior faces and edges, touching faces."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


@dataclass
class Topology:
    """Blocks, exterior faces and pairs of touching faces; indices are 32-bit, -1 means none.

    Attributes:
        node_position: Positions [m], shape (nodes, 3). Nodes of a block are contiguous.
        node_block: Block of each node.
        node_point: Mesh point of each node.
        node_place: A number shared by nodes with the same initial position.
        block_first_node: Start of each block's nodes, shape (blocks + 1,).
        block_group: Group of each block.
        element_nodes: By shape, (elements, nodes of the shape).
        element_block: By shape.
        element_group: By shape.
        element_cell: By shape, row of the element in the mesh.
        face_nodes: Exterior faces, (faces, 4), the fourth -1 for a triangle.
        face_block: Block of each face.
        face_group: Group of each face.
        face_kind: Determines its interface: its group, plus the number of groups times
            (1 + joint set) for a face made by a set of joints.
        face_element: Element behind each face; shapes in the order of `element_shapes.NODES`.
        face_edges: Edge from vertex k to k + 1, (faces, 4).
        edge_nodes: Exterior edges, (edges, 2).
        edge_faces: The two exterior faces of the block at the edge, (edges, 2).
        node_ring_first: Start of each node's ring, (nodes + 1,).
        node_ring: Other ends of the exterior edges at each node.
        pair_faces: Conforming faces of different blocks, (pairs, 2).
        pair_shift: Vertex k of the first coincides with vertex (shift - k) mod n of the second.
        overlap_faces: Touching faces that do not conform, (overlaps, 2).
        overlap_first: Start of each overlap's points, (overlaps + 1,).
        overlap_weights_a: Weights of a point on the first face's vertices, (points, 4).
        overlap_weights_b: Weights on the second face's vertices.
        overlap_area: Share of each point in the true overlap area [m2].
        surfaces: Named surfaces, as ids of exterior faces.
    """

    node_position: Floats
    node_block: Ints
    node_point: Ints
    block_first_node: Ints
    block_group: Ints
    element_nodes: dict[str, Ints]
    element_block: dict[str, Ints]
    element_group: dict[str, Ints]
    element_cell: dict[str, Ints]
    group_names: list[str]
    node_place: Ints = field(default_factory=lambda: np.zeros(0, np.int32))
    face_nodes: Ints = field(default_factory=lambda: np.zeros((0, 4), np.int32))
    face_block: Ints = field(default_factory=lambda: np.zeros(0, np.int32))
    face_group: Ints = field(default_factory=lambda: np.zeros(0, np.int32))
    face_kind: Ints = field(default_factory=lambda: np.zeros(0, np.int32))
    face_element: Ints = field(default_factory=lambda: np.zeros(0, np.int32))
    face_edges: Ints = field(default_factory=lambda: np.zeros((0, 4), np.int32))
    edge_nodes: Ints = field(default_factory=lambda: np.zeros((0, 2), np.int32))
    edge_faces: Ints = field(default_factory=lambda: np.zeros((0, 2), np.int32))
    node_ring_first: Ints = field(default_factory=lambda: np.zeros(1, np.int32))
    node_ring: Ints = field(default_factory=lambda: np.zeros(0, np.int32))
    pair_faces: Ints = field(default_factory=lambda: np.zeros((0, 2), np.int32))
    pair_shift: Ints = field(default_factory=lambda: np.zeros(0, np.int32))
    overlap_faces: Ints = field(default_factory=lambda: np.zeros((0, 2), np.int32))
    overlap_first: Ints = field(default_factory=lambda: np.zeros(1, np.int32))
    overlap_weights_a: Floats = field(default_factory=lambda: np.zeros((0, 4)))
    overlap_weights_b: Floats = field(default_factory=lambda: np.zeros((0, 4)))
    overlap_area: Floats = field(default_factory=lambda: np.zeros(0))
    surfaces: dict[str, NDArray[np.intp]] = field(default_factory=dict)


def group_touching(t: Topology) -> set[tuple[str, str]]:
    """Pairs of group names (sorted) that touch through conforming faces or overlaps."""
    faces = np.concatenate([t.pair_faces, t.overlap_faces])
    a, b = t.face_group[faces].reshape(-1, 2).astype(np.int64).T
    count = len(t.group_names)
    met = np.unique(a * count + b)
    return {tuple(sorted((t.group_names[k // count], t.group_names[k % count]))) for k in met}
