"""Put the state of a whole model together from the rows that each rank owns.

What ranks send speaks of rows by numbers that all understand: whole rows of the model, faces for
exposed faces, 4 times the face and the place in it for slots. Only `put_together` knows how many
exposed faces and pairs there are, and gives each its place in the order that one rank would have.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import CdemError
from cdem.mesh.arrays import components, first_of_each, in_order, same_rows
from cdem.ranks.kinds import (
    BY_LABEL,
    LABELS,
    NOT_KEPT,
    Rows,
    Table,
    counts_of,
    flat_of,
    items_of,
    lengths_of,
    numbers_of,
    renumbered,
    starts_of,
)
from cdem.ranks.patches import first_patches, mothers_of, patches_of
from cdem.ranks.slices import Slice

if TYPE_CHECKING:
    from cdem._core import Core

Arrays = Mapping[str, NDArray[Any]]
VERTEX_FACES, EDGE_PAIRS = "outer_vertex_faces", "outer_edge_pairs"
DERIVED = ("outer.edge_first", "outer.edge_pairs")
"""Lists that follow from the pairs of edges."""
BEFORE = "edge.old_first"


@dataclass
class OwnRows:
    """What a rank sends of its state: the rows that it owns, with whole numbers.

    Attributes:
        rows: Whole rows by kind. Exposed faces are sent as faces, slots as 4 times the face and the
            place in it, edges of the outer list as the slot of their first side, and pairs of the
            outer list as the first exposed face of the patch that has found them.
        numbers: Rows of every stored array by name, shape (rows, numbers).
        lengths: Lengths of the lists of these rows, by name of their starts.
        links: Nodes and their labels by name, shape (links, 2): of labels of which it owns a node.
        vertex_faces: First exposed face of the patch of the vertex, its node, and the face, of pairs
            of the outer list, shape (pairs, 3).
    """

    rows: dict[str, Rows] = field(default_factory=dict)
    numbers: dict[str, NDArray[Any]] = field(default_factory=dict)
    lengths: dict[str, Rows] = field(default_factory=dict)
    links: dict[str, Rows] = field(default_factory=dict)
    vertex_faces: Rows = field(default_factory=lambda: np.zeros((0, 3), np.int64))


def own_rows(kept: Slice, state: Arrays, old_first: NDArray[Any] | None = None) -> OwnRows:
    """What a rank sends.

    Args:
        kept: What it keeps of the model.
        state: Its stored arrays.
        old_first: "edge.old_first" of `Core.rebuilt`, after a step. It makes the places one step ago
            of contacts of edges those of one rank. Nothing reads them between steps, so without
            it they stay as they are.
    """
    local = _Local(kept, state)
    out = OwnRows(vertex_faces=local.vertex_faces[local.own[VERTEX_FACES]])
    out.rows = {kind: rows[local.own[kind]] for kind, rows in local.whole.items()}
    for info in kept.infos:
        name, kind = info["name"], info["rows"]
        if name in DERIVED or not len(state[name]):
            continue
        if not kind:
            if kept.rank == 0:
                out.numbers[name] = state[name].reshape(-1, 1)
        elif info["layout"] == "starts":
            out.lengths[name] = lengths_of(state[name])[local.own[kind]]
        elif name in LABELS:
            out.links[name] = local.links(state[name])
        else:
            out.numbers[name] = local.numbers(Table(info, state[name], local.counts[kind]))
    if old_first is not None and len(old_first) == len(local.own["exposed"]) + 1:
        _place_before(local, old_first, out)
    return out


class _Local:
    """The rows of a rank by kind, as its present state has them.

    Attributes:
        whole: Whole numbers of the rows, see `OwnRows.rows`.
        own: Whether the rank owns them.
        counts: How many there are, with pads that are rows.
        vertex_faces: See `OwnRows.vertex_faces`.
    """

    def __init__(self, kept: Slice, state: Arrays) -> None:
        self._kept = kept
        self._state = state
        dynamic = {"exposed", "slots", "predicted", "outer_edges", EDGE_PAIRS, VERTEX_FACES}
        items = {info["refers_to"][0] for info in kept.infos if info["layout"] == "starts"}
        fixed = kept.keep.keys() - dynamic - items
        self.whole = {kind: kept.keep[kind] for kind in fixed}
        self.own = {kind: kept.own[kind] for kind in fixed}
        face = state["search.exposed_face"].astype(np.int64)
        self._put("exposed", kept.keep["faces"][face], kept.own["faces"][face])
        slots = 4 * self.whole["exposed"][:, None] + np.arange(4)
        self._put("slots", slots.ravel(), np.repeat(self.own["exposed"], 4))
        nodes = state["outer.predicted_nodes"]
        self._put("predicted", kept.keep["nodes"][nodes], kept.own["nodes"][nodes])
        sides = state["outer.ee_sides"].reshape(-1, 2)[:, 0]
        self._put("outer_edges", self.whole["slots"][sides], self.own["slots"][sides])
        self._put_pairs(kept.face_element[face], kept.face_movable[face])
        self.counts = {kind: len(rows) for kind, rows in self.own.items()}
        self.counts[VERTEX_FACES] = len(state["outer.vf_pairs"]) // 2
        for info in kept.infos:
            if info["layout"] == "starts" and info["name"] not in DERIVED:
                self._put_items(info)

    def _put(self, kind: str, whole: Rows, own: NDArray[np.bool_]) -> None:
        self.whole[kind], self.own[kind] = whole, own

    def _put_pairs(self, element: Rows, movable: NDArray[np.bool_]) -> None:
        """Pairs of the outer list, of the owner of the patch that has found them."""
        state, exposed, own = self._state, self.whole["exposed"], self.own["exposed"]
        patches = patches_of(element)
        vertex = patches[mothers_of(state["outer.slot_first"], state["outer.slot_pairs"])]
        node, face = state["outer.vf_pairs"].reshape(2, -1)[:, : len(vertex)]
        found = first_patches(vertex, patches[face], movable)
        self._put(VERTEX_FACES, exposed[found], own[found])
        node = self.whole["nodes"][node]
        self.vertex_faces = np.stack([exposed[vertex], node, exposed[face]], axis=1)
        edge = state["outer.ee_pairs"].reshape(2, -1)[0, : len(state["outer.ee_codes"])]
        found = patches[state["outer.ee_sides"].reshape(-1, 2)[edge, 0] // 4]
        self._put(EDGE_PAIRS, exposed[found], own[found])

    def _put_items(self, info: Mapping[str, Any]) -> None:
        """Items of lists, of the owner of the list."""
        items, first = info["refers_to"][0], self._state[info["name"]]
        if len(first):
            self.own[items] = np.repeat(self.own[info["rows"]], lengths_of(first))
            self.counts[items] = len(self.own[items])
        elif items not in self.own:  # several sets may have lists of the same items
            self.own[items], self.counts[items] = np.zeros(0, bool), 0

    def links(self, label: NDArray[Any]) -> Rows:
        """Nodes and their labels, of labels of which the rank owns a node."""
        nodes = self.whole["nodes"]
        is_own = np.zeros(len(nodes), bool)
        is_own[label[self.own["nodes"]]] = True
        return np.stack([nodes, nodes[label]], axis=1)[is_own[label]]

    def numbers(self, table: Table) -> NDArray[Any]:
        """The own rows of an array, with whole numbers."""
        own, kinds = self.own[table.kind], table.kinds()
        rows = table.rows()[: len(own)][own]
        if not any(kinds):
            return rows.copy()
        if kinds == [VERTEX_FACES]:
            return self.vertex_faces[rows[:, 0]]
        whole = rows.astype(np.int64)
        for number, kind in enumerate(kinds):
            if kind and kind != NOT_KEPT:
                opposite = table.info["opposite"]
                whole[:, number] = renumbered(rows[:, number], self.whole[kind], opposite=opposite)
        return whole


def _place_before(local: _Local, old_first: NDArray[Any], out: OwnRows) -> None:
    """Places of contacts of edges one step ago, among those of their mother.

    Those that come from bonds that have let go in that step follow all others: they are less than
    -1, and get the numbers of one rank only if they are of one rank.
    """
    own = local.own["exposed"]
    out.lengths[BEFORE] = lengths_of(old_first)[own]
    if "edge.contact" not in out.numbers:
        return
    mother = np.repeat(old_first[:-1][own], out.lengths["edge.first"])
    place = out.numbers["edge.contact"][:, 3]
    released = place - old_first[-1]
    place[:] = np.where(place < 0, -1, np.where(released < 0, place - mother, -2 - released))


def put_together(core: Core, sent: Sequence[OwnRows]) -> dict[str, NDArray[Any]]:
    """The whole stored arrays from what all ranks send.

    Args:
        core: The whole model, whose state does not matter.
        sent: What each rank sends.

    Raises:
        CdemError: Not every row was sent once.
    """
    return _Whole(core, sent).arrays()


class _Whole:
    """Gives the rows of all ranks their places in the whole."""

    def __init__(self, core: Core, sent: Sequence[OwnRows]) -> None:
        self._sent = sent
        self._infos = [info for info in core.describe() if info["origin"] == "stored"]
        self._types = {name: array.dtype for name, array in core.fields().items()}
        kinds = {kind for one in sent for kind in one.rows}
        self._counts = {kind: n for kind, n in counts_of(core).items() if kind in kinds}
        self._places = {kind: [one.rows[kind] for one in sent] for kind in kinds}
        self._faces = np.sort(self._all("exposed"))
        self._of_face = numbers_of(self._faces, self._counts["faces"])
        self._edges = np.sort(self._all("outer_edges"))
        self._counts["exposed"] = len(self._faces)
        self._counts["slots"] = 4 * len(self._faces)
        for kind in ("exposed", "slots", "outer_edges"):
            self._places[kind] = [self._number(kind, rows) for rows in self._places[kind]]
        for kind in ("predicted", VERTEX_FACES, EDGE_PAIRS):
            self._sort(kind)
        self._counts["outer_edges"] = len(self._edges)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """All stored arrays."""
        labels = {name: self._labels(name) for name in LABELS & self._types.keys()}
        arrays = {}
        for info in self._infos:
            if info["layout"] == "starts":
                label = labels.get("node.bonded_node") if info["name"] == BY_LABEL else None
                arrays[info["name"]] = self._starts(info, label)
        for info in self._infos:
            name = info["name"]
            if name in labels:
                arrays[name] = labels[name]
            elif name not in arrays:
                arrays[name] = self._numbers(info)
        self._list_edge_pairs(arrays)
        return {info["name"]: arrays[info["name"]] for info in self._infos}

    def _all(self, kind: str) -> Rows:
        return np.concatenate(self._places[kind])

    def _sort(self, kind: str) -> None:
        """Places of rows of a kind in the order of what was sent; equal ones stay in order."""
        rows = self._all(kind)
        place = np.empty(len(rows), np.int64)
        place[in_order(rows)[1]] = np.arange(len(rows))
        lengths = [len(of_rank) for of_rank in self._places[kind]]
        self._places[kind] = np.split(place, np.cumsum(lengths)[:-1])
        self._counts[kind] = len(rows)

    def _number(self, kind: str, rows: Rows) -> Rows:
        """Places of rows of a kind, given as ranks send them."""
        if kind == "exposed":
            return renumbered(rows, self._of_face, opposite=False)
        if kind == "slots":
            face = renumbered(np.where(rows < 0, -1, rows // 4), self._of_face, opposite=False)
            return np.where(face < 0, -1, 4 * face + rows % 4)
        if kind == "outer_edges":
            return np.searchsorted(self._edges, rows)
        return rows

    def _labels(self, name: str) -> NDArray[Any]:
        """The lowest node of those that any rank has under one label."""
        links = np.concatenate(
            [one.links.get(name, np.zeros((0, 2), np.int64)) for one in self._sent]
        )
        if not len(links):
            return np.zeros(0, self._types[name])
        return components(self._counts["nodes"], *links.T).astype(self._types[name])

    def _starts(self, info: Mapping[str, Any], label: NDArray[Any] | None) -> NDArray[Any]:
        """Starts of lists, whose items get their places. Labels have lists, other nodes have none."""
        name, owner, items = info["name"], info["rows"], info["refers_to"][0]
        if not any(name in one.lengths for one in self._sent):
            if name not in DERIVED and items not in self._places:
                self._places[items] = [np.zeros(0, np.int64) for _ in self._sent]
                self._counts[items] = 0
            return np.zeros(0, self._types[name])
        lengths = self._lengths(name, owner)
        if label is not None:
            lengths[label != np.arange(len(label))] = 0
        first = starts_of(lengths)
        self._places[items] = []
        for one, rows in zip(self._sent, self._places[owner], strict=True):
            places = items_of(first, rows)[0]
            if label is not None:  # of nodes that are labels for their rank only
                of_items = np.repeat(rows, one.lengths[name])
                known = label[of_items] == of_items
                places = np.where(known, 0, -1)
                places[known] = items_of(first, rows)[0]
            self._places[items].append(places)
        self._counts[items] = int(first[-1])
        return first.astype(self._types[name])

    def _lengths(self, name: str, owner: str) -> Rows:
        """Lengths of all lists of a name."""
        lengths = np.zeros(self._counts[owner], np.int64)
        for one, rows in zip(self._sent, self._places[owner], strict=True):
            lengths[rows] = one.lengths.get(name, 0)
        return lengths

    def _numbers(self, info: Mapping[str, Any]) -> NDArray[Any]:
        """An array of rows."""
        name, kind = info["name"], info["rows"]
        some = [one.numbers[name] for one in self._sent if name in one.numbers]
        if not some or name in DERIVED:
            return np.zeros(0, self._types[name])
        if not kind:
            return some[0].ravel().astype(self._types[name])
        rows = np.concatenate(some)
        at = zip(self._places[kind], self._sent, strict=True)
        place = np.concatenate([places for places, one in at if name in one.numbers])
        rows, place = rows[place >= 0], place[place >= 0]
        count = self._counts[kind]
        if len(place) != count or (np.bincount(place, minlength=count) != 1).any():
            raise CdemError(f"ranks do not own every one of {count} {kind} once: {name}")
        whole = np.empty((count, info["numbers"]), self._types[name])
        whole[place] = self._renumbered(info, rows)
        return flat_of(info, whole)

    def _renumbered(self, info: Mapping[str, Any], rows: NDArray[Any]) -> NDArray[Any]:
        """Rows with whole numbers."""
        kinds = Table(info, rows, len(rows)).kinds()
        if kinds == [VERTEX_FACES]:
            return self._vertex_faces(rows)[:, None]
        for number, kind in enumerate(kinds):
            if kind == NOT_KEPT:
                rows[:, number] = self._before(rows[:, number])
            elif kind:
                rows[:, number] = self._number(kind, rows[:, number])
        return rows

    def _vertex_faces(self, rows: Rows) -> Rows:
        """Places of pairs of vertex and face."""
        pairs = np.concatenate([one.vertex_faces for one in self._sent])
        number = same_rows(np.concatenate([pairs, rows]))
        place = np.full(len(number) + 1, -1, np.int64)
        place[number[: len(pairs)]] = self._all(VERTEX_FACES)
        found = place[number[len(pairs) :]]
        if (found < 0).any():
            raise CdemError("ranks do not own every pair of vertex and face that they list")
        return found

    def _before(self, place: Rows) -> Rows:
        """Places of contacts of edges one step ago."""
        if not all(BEFORE in one.lengths for one in self._sent):
            return place
        first = starts_of(self._lengths(BEFORE, "exposed"))
        own = [
            np.repeat(first[rows], one.lengths["edge.first"])
            for one, rows in zip(self._sent, self._places["exposed"], strict=True)
        ]
        of_mother = np.concatenate(own) + place
        return np.where(place == -1, -1, np.where(place < 0, first[-1] - 2 - place, of_mother))

    def _list_edge_pairs(self, arrays: dict[str, NDArray[Any]]) -> None:
        """Pairs of edges by the lower edge, as the core lists them."""
        count = self._counts[EDGE_PAIRS]
        if count == 0:
            return
        edges = arrays["outer.ee_edges"][arrays["outer.ee_pairs"].reshape(2, -1)[:, :count]]
        lower = edges.min(axis=0).astype(np.int64)
        first = first_of_each(lower, self._counts["edges"])
        arrays["outer.edge_first"] = first.astype(self._types["outer.edge_first"])
        arrays["outer.edge_pairs"] = in_order(lower)[1].astype(self._types["outer.edge_pairs"])
