"""Which rank owns which elements and nodes, and which elements it needs around its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.mesh.element_shapes import NODES
from cdem.rows import rows_of

if TYPE_CHECKING:
    from cdem._core import Core

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

FACE_WEIGHT = 3.0
"""Work of an exposed face over the work of an element, about."""
ROOM = 0.1
"""Motion that a fence leaves to a node on each side, in parts of L; besides the velocity."""
SWEPT_STEPS = 400
"""A fence leaves room for the present velocity over so many steps."""
REACH = 0.08
"""Distance at which the search lists faces that nothing brings nearer, in parts of L: depth of a
new contact, indentation and tolerance."""


@dataclass
class Mesh:
    """Elements of all shapes, as ranks see them.

    Attributes:
        corner_element: Element of each corner of an element.
        corner_node: Node of each corner.
        count: Number of elements.
        face_element: Element behind each exterior face.
    """

    corner_element: Indices
    corner_node: Indices
    count: int
    face_element: Indices

    @classmethod
    def of(cls, core: Core) -> Mesh:
        """The mesh of a core."""
        arrays, elements, nodes, first = core.model(), [], [], 0
        counts = {kind["name"]: kind["count"] for kind in core.describe_rows()}
        for shape, corners in NODES.items():
            count = counts[shape]
            table = arrays[f"{shape}.nodes"].reshape(corners, -1)[:, :count]
            nodes.append(table.T.ravel())
            elements.append(np.repeat(np.arange(first, first + count), corners))
            first += count
        return cls(
            np.concatenate(elements), np.concatenate(nodes).astype(np.int64), first,
            arrays["face.element"].astype(np.int64),
        )  # fmt: skip

    def lowest_element(self, nodes: int) -> Indices:
        """The first element at each node."""
        lowest = np.full(nodes, self.count)
        np.minimum.at(lowest, self.corner_node, self.corner_element)
        return lowest

    def at_nodes(self, flags: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Elements with a flagged node."""
        found = np.zeros(self.count, bool)
        found[self.corner_element[flags[self.corner_node]]] = True
        return found


@dataclass
class Parts:
    """Owners of elements and nodes.

    Attributes:
        of_element: Rank of each element, numbered over all shapes.
        of_node: Rank of each node.
    """

    of_element: Indices
    of_node: Indices


def divide(core: Core, mesh: Mesh, count: int) -> Parts:
    """Deal the elements to ranks: halves of about the same work, and so on, across the longest side.

    A block with a mass matrix stays together; a node belongs to its first element.

    Args:
        core: The whole model and its state.
        mesh: Its elements.
        count: Number of ranks.
    """
    position = rows_of(core, "node.motion").position
    center = np.zeros((mesh.count, 3))
    np.add.at(center, mesh.corner_element, position[mesh.corner_node])
    center /= np.bincount(mesh.corner_element, minlength=mesh.count)[:, None]
    work = np.ones(mesh.count)
    np.add.at(work, mesh.face_element[core.fields()["search.exposed_face"]], FACE_WEIGHT)
    together = _units(core, mesh)
    units = int(together.max(initial=-1)) + 1
    at = np.zeros((units, 3))
    weight = np.bincount(together, work, units)
    np.add.at(at, together, center * work[:, None])
    of_unit = np.zeros(units, np.int64)
    _bisect(at / weight[:, None], weight, np.arange(units), 0, count, of_unit)
    of_element = of_unit[together]
    lowest = mesh.lowest_element(len(position))
    return Parts(of_element, of_element[lowest])


def _units(core: Core, mesh: Mesh) -> Indices:
    """Number of the elements that stay together, of each element."""
    arrays = core.model()
    dense = arrays["node.mass_row_first"][mesh.corner_node] >= 0
    unit = np.arange(mesh.count)
    unit[mesh.corner_element[dense]] = mesh.count + arrays["node.block"][mesh.corner_node[dense]]
    found: Indices = np.unique(unit, return_inverse=True)[1].ravel()
    return found


def _bisect(at: Array, weight: Array, some: Indices, first: int, count: int, rank: Indices) -> None:
    """Give the units `some` to `count` ranks from `first` on."""
    if count == 1 or not len(some):
        rank[some] = first
        return
    extent = np.ptp(at[some], axis=0)
    some = some[np.argsort(at[some, int(extent.argmax())], kind="stable")]
    left = count // 2
    sums = np.cumsum(weight[some])
    cut = int(np.searchsorted(sums, sums[-1] * left / count))
    cut = min(max(cut, min(left, len(some))), max(len(some) - (count - left), 0))
    _bisect(at, weight, some[:cut], first, left, rank)
    _bisect(at, weight, some[cut:], first + left, count - left, rank)


@dataclass
class Fences:
    """Boxes that nodes and elements must not leave, for ghosts to be all that are needed.

    Attributes:
        of_nodes: Of the paths of nodes without their skins, rows of 8 as in the core.
        of_elements: Of the search for contacts around elements, rows of lowest and highest x y z.
    """

    of_nodes: Array
    of_elements: Array

    @classmethod
    def around(cls, core: Core, mesh: Mesh, room: float = ROOM) -> Fences:
        """Fences around elements where they are now, and where they go."""
        motion, arrays = rows_of(core, "node.motion"), core.model()
        ahead = SWEPT_STEPS * core.scalars()["dt"]
        then = motion.position + ahead * core.rigid_velocities().reshape(-1, 3)
        size = _lengths(arrays["face.length"], arrays["face.nodes"], len(then))
        deep = size * (native.widest_skin + REACH) + core.lift()
        low = np.minimum(motion.position, then) - room * size[:, None]
        high = np.maximum(motion.position, then) + room * size[:, None]
        pad = np.zeros((len(then), 1))
        boxes = np.empty((mesh.count, 6))
        boxes[:, :3], boxes[:, 3:] = np.inf, -np.inf
        np.minimum.at(boxes[:, :3], mesh.corner_element, (low - deep[:, None])[mesh.corner_node])
        np.maximum.at(boxes[:, 3:], mesh.corner_element, (high + deep[:, None])[mesh.corner_node])
        return cls(np.hstack([low, pad, high, pad]), boxes)


def _lengths(length: Array, nodes: NDArray[np.integer], count: int) -> Array:
    """Largest L of the exterior faces at each node; 0 inside."""
    largest = np.zeros(count)
    corners = nodes.reshape(-1, 4)
    for k in range(4):
        there = corners[:, k] >= 0
        np.maximum.at(largest, corners[there, k], length[there])
    return largest


def needed(core: Core, mesh: Mesh, parts: Parts, fences: Fences, rank: int) -> Indices:
    """Elements that a rank needs: own ones, and two layers of ghosts.

    The forces on own nodes come from elements there, from bonds, and from contacts of faces near
    them; whom such a face touches depends on the faces near it.
    """
    own = parts.of_node == rank
    found = (parts.of_element == rank) | mesh.at_nodes(own | _bolted(core, own))
    for _ in range(2):
        near = native.near_boxes(fences.of_elements.ravel(), found.astype(np.int8)) != 0
        found = near | _with_partners(core, mesh, found)
    return np.flatnonzero(found)


def _bolted(core: Core, some: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Nodes that hold a bolt which some nodes hold, too."""
    arrays, bolted = core.model(), np.zeros(len(some), bool)
    hosts = arrays["bolts.hosts"].reshape(-1, 8)
    if not len(hosts):
        return bolted
    nodes, crossings = (np.diff(arrays[f"bolts.{name}"]) for name in ("first", "crossing_first"))
    bolt = np.arange(len(nodes))
    bolt_of = np.concatenate([np.repeat(bolt, nodes), np.repeat(bolt, 2 * crossings)])
    holds = np.zeros(len(bolt), bool)
    holds[bolt_of[(some[hosts] & (hosts >= 0)).any(axis=1)]] = True
    held = hosts[holds[bolt_of]]
    bolted[held[held >= 0]] = True
    return bolted


def _with_partners(core: Core, mesh: Mesh, found: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The elements, and those bonded to one of them."""
    arrays, more = core.model(), found.copy()
    for kind in ("triangles", "quads", "overlaps"):
        pairs = mesh.face_element[arrays[f"{kind}.faces"].reshape(-1, 2)]
        more[pairs[found[pairs].any(axis=1)]] = True
    return more
