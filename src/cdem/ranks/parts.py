"""Which rank owns which elements and nodes, and which elements it needs around its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.mesh.element_shapes import FACES, NODES
from cdem.rows import rows_of

if TYPE_CHECKING:
    from cdem._core import Core

Array = NDArray[np.float64]
Indices = NDArray[np.integer]

FACE_WORK, PAIR_WORK = 2.0, 1.5
"""Work of an exposed face, and of a listed pair, over the work of an element, about."""
ROOM = 0.1
"""Motion that a fence leaves to a node on each side, in parts of L; besides velocity and skin."""
SKIN = native.widest_skin
"""Skin that a fence leaves room for, in parts of L."""
GROWTH = 1.5
"""Growth of wider skins, which large faces have."""
SWEPT_STEPS = 400
"""A fence leaves room for the present velocity over so many steps."""
REACH = 0.08
"""Half of the distance at which the search lists faces that nothing brings nearer, in parts of the
smaller L: depth of a new contact, indentation and tolerance."""
DEPTH = 0.15
"""Half of the depth at which a vertex may be behind the face that it touches. It may then be beyond
the element, if the block goes on there."""
EDGES = {
    shape: sorted(
        {
            tuple(sorted(side))
            for face in faces
            for side in zip(face, face[1:] + face[:1], strict=True)
        }
    )
    for shape, faces in FACES.items()
}
"""Edges of an element, by its corners."""


@dataclass
class Mesh:
    """Elements of all shapes, as ranks see them.

    Attributes:
        corner_element: Element of each corner of an element.
        corner_node: Node of each corner.
        count: Number of elements.
        face_element: Element behind each exterior face.
        is_alone: Whether all faces of an element are exterior ones.
        tables: Nodes of the elements of each shape, by its first element.
    """

    corner_element: Indices
    corner_node: Indices
    count: int
    face_element: Indices
    is_alone: NDArray[np.bool_]
    tables: list[tuple[str, int, Indices]]

    @classmethod
    def of(cls, core: Core) -> Mesh:
        """The mesh of a core."""
        arrays, first = core.model(), 0
        elements, faces, tables = [], [], []
        counts = {kind["name"]: kind["count"] for kind in core.describe_rows()}
        for shape, corners in NODES.items():
            count = counts[shape]
            table = arrays[f"{shape}.nodes"].reshape(corners, -1)[:, :count].T.copy()
            tables.append((shape, first, table))
            elements.append(np.repeat(np.arange(first, first + count, dtype=np.int32), corners))
            faces.append(np.full(count, len(FACES[shape])))
            first += count
        face_element = arrays["face.element"]
        return cls(
            corner_element=np.concatenate(elements),
            corner_node=np.concatenate([table.ravel() for _, _, table in tables]),
            count=first, face_element=face_element, tables=tables,
            is_alone=np.bincount(face_element, minlength=first) == np.concatenate(faces),
        )  # fmt: skip

    def edges(self, some: NDArray[np.bool_]) -> Indices:
        """Ends of the edges of some elements, shape (edges, 2)."""
        ends = [
            table[some[first : first + len(table)]][:, EDGES[shape]].reshape(-1, 2)
            for shape, first, table in self.tables
        ]
        return np.concatenate(ends)

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


def divide(core: Core, mesh: Mesh, count: int, work: Array) -> Parts:
    """Deal the elements to ranks: halves of about the same work, cut across where work is
    spread widest, and so on.

    A block with a mass matrix stays together; a node belongs to its first element.

    Args:
        core: The whole model and its state.
        mesh: Its elements.
        count: Number of ranks.
        work: Of each element.
    """
    position = rows_of(core, "node.motion").position
    center = np.zeros((mesh.count, 3))
    np.add.at(center, mesh.corner_element, position[mesh.corner_node])
    center /= np.bincount(mesh.corner_element, minlength=mesh.count)[:, None]
    together = _units(core, mesh)
    units = int(together.max(initial=-1)) + 1
    at = np.zeros((units, 3))
    weight = np.bincount(together, work, units).astype(float)
    np.add.at(at, together, center * work[:, None])
    of_unit = np.zeros(units, np.int64)
    _bisect(at / weight[:, None], weight, np.arange(units, dtype=np.int64), 0, count, of_unit)
    of_element = of_unit[together]
    lowest = mesh.lowest_element(len(position))
    return Parts(of_element, of_element[lowest])


def work_of(core: Core, mesh: Mesh) -> Array:
    """Work of each element in a step, about: its own, and of contacts that its faces may have."""
    fields = core.fields()
    element = mesh.face_element[fields["search.exposed_face"]]
    work: Array = 1 + FACE_WORK * np.bincount(element, minlength=mesh.count).astype(float)
    if len(first := fields["outer.slot_first"]):
        pairs = np.add.reduceat(np.diff(first), np.arange(0, len(first) - 1, 4))
        work += PAIR_WORK * np.bincount(element, pairs, mesh.count)
    if count := len(fields["outer.ee_codes"]):
        edges = fields["outer.ee_pairs"].reshape(2, -1)[:, :count]
        of_edge = element[fields["outer.ee_sides"].reshape(-1, 2)[:, 0] // 4]
        work += 0.5 * PAIR_WORK * np.bincount(of_edge[edges.ravel()], minlength=mesh.count)
    return work


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
    share = weight[some] / weight[some].sum()
    middle = share @ at[some]
    spread = share @ (at[some] - middle) ** 2
    some = some[np.argsort(at[some, int(spread.argmax())], kind="stable")]
    left = count // 2
    sums = np.cumsum(weight[some])
    cut = int(np.searchsorted(sums, sums[-1] * left / count))
    cut = min(max(cut, min(left, len(some))), max(len(some) - (count - left), 0))
    _bisect(at, weight, some[:cut], first, left, rank)
    _bisect(at, weight, some[cut:], first + left, count - left, rank)


@dataclass
class Boxes:
    """Boxes of a search.

    Attributes:
        sides: Rows of lowest and highest x y z [m].
        reach: Half of the distance at which they are near each other [m]; the smaller one counts.
    """

    sides: Array
    reach: Array

    def some(self, which: NDArray[np.bool_]) -> Boxes:
        """Some of them."""
        return Boxes(self.sides[which], self.reach[which])

    def and_others(self, others: Boxes) -> Boxes:
        """These, then others."""
        return Boxes(
            np.vstack([self.sides, others.sides]), np.concatenate([self.reach, others.reach])
        )

    def near(self, others: Boxes) -> NDArray[np.bool_]:
        """Which of them are near one of others."""
        every, flags = (
            self.and_others(others),
            np.zeros(len(self.reach) + len(others.reach), np.int8),
        )
        flags[len(self.reach) :] = 1
        near = native.near_boxes(every.sides.ravel(), every.reach, flags)
        found: NDArray[np.bool_] = near[: len(self.reach)] != 0
        return found


@dataclass
class Fences:
    """Boxes that nodes must not leave, for ghosts to be all that are needed.

    Attributes:
        nodes: Of the paths of nodes with their skins.
        size: Largest L of the faces at each node; 0 where there are none [m].
    """

    nodes: Boxes
    size: Array

    @classmethod
    def around(cls, core: Core, mesh: Mesh) -> Fences:
        """Fences around nodes where they are now, and where they go."""
        arrays = core.model()
        position = rows_of(core, "node.motion").position
        length = arrays["face.length"]
        size = _lengths(length, arrays["face.nodes"], len(position))
        paths = core.coming_paths(size).reshape(-1, 4)
        steps = max(SWEPT_STEPS, 2 * core.rebuild_interval())
        then = position + steps * core.scalars()["dt"] * paths[:, :3]
        usual = np.median(length) if len(length) else 0.0
        small = np.minimum(size, usual)
        skin = np.maximum(SKIN * small, GROWTH * paths[:, 3])
        room = (ROOM * small + skin)[:, None]
        low, high = np.minimum(position, then) - room, np.maximum(position, then) + room
        reach = np.full(len(size), REACH)
        reach[mesh.corner_node[~mesh.is_alone[mesh.corner_element]]] += DEPTH
        return cls(Boxes(np.hstack([low, high]), reach * size + core.lift()), size)

    def of_nodes(self, some: Indices) -> Array:
        """Boxes of the paths of nodes with their skins, rows of 8 as in the core."""
        sides, size = self.nodes.sides[some], self.size[some, None]
        fences = np.hstack([sides[:, :3], size, sides[:, 3:], np.zeros((len(some), 1))])
        inside = size[:, 0] == 0  # on no face: in no list
        fences[inside, :3], fences[inside, 4:7] = -np.inf, np.inf
        return fences

    def of_elements(self, mesh: Mesh) -> Boxes:
        """Boxes of elements."""
        sides, reach = np.empty((mesh.count, 6)), np.zeros(mesh.count)
        sides[:, :3], sides[:, 3:] = np.inf, -np.inf
        np.minimum.at(sides[:, :3], mesh.corner_element, self.nodes.sides[mesh.corner_node, :3])
        np.maximum.at(sides[:, 3:], mesh.corner_element, self.nodes.sides[mesh.corner_node, 3:])
        np.maximum.at(reach, mesh.corner_element, self.nodes.reach[mesh.corner_node])
        return Boxes(sides, reach)

    def of_edges(self, nodes: Indices) -> Boxes:
        """Boxes of edges, given by their ends."""
        one, other = self.nodes.sides[nodes[:, 0]], self.nodes.sides[nodes[:, 1]]
        low, high = np.minimum(one[:, :3], other[:, :3]), np.maximum(one[:, 3:], other[:, 3:])
        return Boxes(np.hstack([low, high]), self.nodes.reach[nodes].max(axis=1))


def _lengths(length: Array, nodes: NDArray[np.integer], count: int) -> Array:
    """Largest L of the exterior faces at each node; 0 inside."""
    largest = np.zeros(count)
    corners = nodes.reshape(-1, 4)
    for k in range(4):
        there = corners[:, k] >= 0
        np.maximum.at(largest, corners[there, k], length[there])
    return largest


def needed(core: Core, mesh: Mesh, parts: Parts, fences: Fences, rank: int) -> NDArray[np.bool_]:
    """Elements that a rank needs: its own and ghosts.

    The forces on own nodes come from elements there, from bonds, and from contacts of faces near
    them. Whom the vertices and edges of such a face touch there depends on the faces near these.
    """
    own = parts.of_node == rank
    found = (parts.of_element == rank) | mesh.at_nodes(own | _bolted(core, own))
    boxes = fences.of_elements(mesh)
    acting = boxes.near(boxes.some(found)) | _with_partners(core, mesh, found)
    if core.asks_area():  # the area of a contact depends on all that touch its faces
        return boxes.near(boxes.some(acting)) | acting
    edges = fences.of_edges(mesh.edges(acting))
    choosing = edges.some(edges.near(boxes.some(found)))
    return boxes.near(boxes.some(found).and_others(choosing)) | acting


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
