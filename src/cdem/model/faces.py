"""Areas of faces, and heights of the elements behind them."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from cdem.mesh import element_shapes
from cdem.mesh.arrays import in_pieces, lengths
from cdem.mesh.topology import Topology

Floats = NDArray[np.float64]


def face_heights(t: Topology, volume: Floats, area: Floats) -> Floats:
    """Height of the element behind each face above it [m]: the h of k_n = factor E / h.

    Args:
        volume: Volume of all elements, shapes in the order of `element_shapes.NODES` [m3].
        area: Area of all faces [m2].
    """
    # volume = area * height / divisor: 1 for a prism, 3 for a pyramid; the sides of a wedge are
    # opposite an edge (2), the sides of a pyramid lie between the two cases
    by_sides = {
        "tet4": (3.0, 3.0),
        "pyramid5": (3.0, 3.0),
        "wedge6": (1.0, 2.0),
        "hex8": (1.0, 1.0),
    }
    counts = [len(t.element_nodes[shape]) for shape in element_shapes.NODES]
    divisors = np.array([by_sides[shape] for shape in element_shapes.NODES])
    triangle, quad = (np.repeat(divisors[:, k], counts) * volume for k in (0, 1))
    return np.where(t.face_nodes[:, 3] < 0, triangle[t.face_element], quad[t.face_element]) / area


def face_areas(position: Floats, face_nodes: NDArray) -> Floats:
    """Area of triangles and (mean-plane) quadrilaterals [m2], shape (faces,)."""
    return 0.5 * lengths(_doubled(position, face_nodes))


def face_normals(position: Floats, face_nodes: NDArray) -> Floats:
    """Outward unit normals of triangles and (mean-plane) quadrilaterals, shape (faces, 3)."""
    doubled = _doubled(position, face_nodes)
    return doubled / lengths(doubled)[:, None]


def _doubled(position: Floats, face_nodes: NDArray) -> Floats:
    """Vectors along the normals, twice as long as the areas [m2], shape (faces, 3)."""
    return in_pieces(partial(_diagonals_crossed, position), face_nodes)


def _diagonals_crossed(position: Floats, face_nodes: NDArray) -> Floats:
    a, b, c, d = face_nodes.T
    d = np.where(d < 0, c, d)
    # by columns: many times faster than np.cross of rows
    p = np.ascontiguousarray((position[c] - position[a]).T)
    q = np.ascontiguousarray((position[d] - position[b]).T)
    out = np.empty((len(face_nodes), 3))
    for k, i, j in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[:, k] = p[i] * q[j] - p[j] * q[i]
    return out
