"""What a rank keeps of a model: some rows of every kind, in their order, with numbers of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem.mesh.arrays import found_in
from cdem.mesh.element_shapes import NODES as SHAPES
from cdem.ranks.kinds import (
    ALL,
    BLOCK,
    BY_LABEL,
    FREE,
    LABELS,
    NOT_KEPT,
    PAIRS,
    Rows,
    Table,
    counts_of,
    flat_of,
    items_of,
    numbers_of,
    renumbered,
    starts_of,
    tables_of,
)
from cdem.ranks.patches import first_patches, mothers_of, patches_of

if TYPE_CHECKING:
    from cdem._core import Core

Flags = NDArray[np.bool_]


class Slice:
    """What a rank keeps of a model: the rows of every kind that belong to some elements.

    Elements stay together in blocks of eight. Whatever refers to rows that are not kept is not
    kept either, or refers to none (-1). Tables of what is shared, as materials, interfaces or
    columns, are kept whole. Nodes that share a label get the lowest kept one of them as label.

    Arrays are those of the whole core when they are asked for: it must not change before.

    Attributes:
        rank: The rank.
        keep: Whole rows that the rank keeps, by kind; ascending, but for lists of labels.
        local: Place of whole rows among the kept ones, or -1, by kind.
        own: Whether the rank owns the kept rows, by kind; every whole row has one owner.
        lengths: Lengths of lists of the kept rows, by name of their starts.
        infos: Descriptions of the stored arrays.
        face_element: Element behind each kept face, by its whole number.
        face_movable: Whether the block of a kept face can move.
    """

    def __init__(
        self,
        core: Core,
        elements: NDArray[np.integer],
        element_part: NDArray[np.integer],
        node_part: NDArray[np.integer],
        rank: int,
    ) -> None:
        """Choose the rows.

        Args:
            core: The whole model and its state.
            elements: Elements to keep, numbered over all shapes; more are kept to fill blocks.
            element_part: Rank that owns each element.
            node_part: Rank that owns each node.
            rank: The rank that keeps them.

        Raises:
            LookupError: An array has rows of a kind that no rule covers.
        """
        self.rank = rank
        self._core = core
        cut = _Cut(core, rank)
        cut.cut(np.asarray(elements), np.asarray(element_part), np.asarray(node_part))
        self.keep, self.local, self.own, self.lengths = cut.keep, cut.local, cut.own, cut.lengths
        self.infos = [info for info in core.describe() if info["origin"] == "stored"]
        faces = self.keep["faces"]
        self.face_element = cut.flat("face.element")[faces].astype(np.int64)
        self.face_movable = cut.flat("face.movable")[faces].astype(bool)

    def counts(self) -> dict[str, int]:
        """Counts for `Core.take_counts`."""
        count = {kind: len(rows) for kind, rows in self.keep.items()}
        counts = {name: count[name] for name in ("nodes", "faces", "edges", "interface_classes")}
        row = 0
        for shape, corners in SHAPES.items():
            counts |= {f"{shape}.count": count[shape], f"{shape}.corner_first": row}
            row += corners * count[shape]
        row = 0
        for kind, rows in PAIRS.items():
            counts |= {f"{kind}.count": count[kind], f"{kind}.corner_first": row}
            row += rows * count[kind]
        for kind in ("bolts", "wet_triangles", "wet_quads", "surface_triangles", "surface_quads"):
            counts[f"{kind}.count"] = count[kind]
        return counts | {
            "overlaps.points": count["overlap_points"],
            "bolts.corner_first": row,
            "surface.count": count["surfaces"],
            "columns.count": count["columns"],
            "columns.side_count": count["column_sides"],
            "corner_rows": count["corner_rows"] - 1,
        }

    def model(self) -> dict[str, NDArray[Any]]:
        """Arrays for `Core.take_model`."""
        tables = tables_of(self._core, self._core.model(), "given")
        arrays = {table.name: self._of(table) for table in tables}
        block = arrays["node.block"]
        count = np.bincount(block, minlength=1)[block]
        arrays["node.block_count"] = count.astype(arrays["node.block_count"].dtype)
        for kind in ("wet_triangles", "wet_quads"):
            arrays[f"{kind}.pair"] = self._pairs_of_wet(arrays[f"{kind}.pair"])
        return arrays

    def state(self) -> dict[str, NDArray[Any]]:
        """Arrays for `Core.restore`."""
        tables = tables_of(self._core, self._core.fields(), "stored")
        arrays = {table.name: self._of(table) for table in tables}
        if not len(arrays["outer.ee_codes"]):  # as the core has it
            arrays["outer.edge_first"] = arrays["outer.edge_first"][:0]
        return arrays

    def forget_whole(self) -> None:
        """Free what only `model` and `state` need."""
        self.local = {}

    def _of(self, table: Table) -> NDArray[Any]:
        """The kept rows of an array."""
        if not table.is_used:
            return table.flat.copy()
        dtype = table.flat.dtype
        if table.is_list:
            return starts_of(self.lengths[table.name]).astype(dtype)
        rows = table.rows()[self.keep[table.kind]]
        if table.name in LABELS:
            _, first, label = np.unique(rows[:, 0], return_index=True, return_inverse=True)
            return first[label.ravel()].astype(dtype)
        for number, kind in enumerate(table.kinds()):
            if kind and kind != NOT_KEPT:
                opposite = table.info["opposite"]
                rows[:, number] = renumbered(rows[:, number], self.local[kind], opposite=opposite)
        return flat_of(table.info, rows)

    def _pairs_of_wet(self, pair: NDArray[Any]) -> NDArray[Any]:
        """Pairs of wet faces: 3 times the pair, plus its kind."""
        new = np.full(len(pair), -1, pair.dtype)
        for number, kind in enumerate(PAIRS):
            of_kind = (pair >= 0) & (pair % 3 == number)
            local = renumbered(pair[of_kind] // 3, self.local[kind], opposite=False)
            new[of_kind] = np.where(local < 0, -1, 3 * local + number)
        return new


def filled(some: Rows, joined: Flags) -> Rows:
    """Elements of a shape, with others so that those which share nodes stay in their blocks of eight.

    The forces of such elements are summed tile by tile, which are whole blocks. Elements with nodes of their own may lie
    in any block, but others that come later must begin at a multiple of eight again.

    Args:
        some: Elements to keep.
        joined: Whether each element of the shape shares a node with another one.
    """
    count = len(joined)
    blocks = -(-count // BLOCK)
    of_block: Flags = np.zeros(blocks, bool)
    of_block[np.flatnonzero(joined) // BLOCK] = True
    kept = np.zeros(count, bool)
    kept[some] = True
    block = np.arange(count) // BLOCK
    whole = np.zeros(blocks, bool)
    whole[block[kept]] = True
    kept |= (whole & of_block)[block]
    run = np.cumsum(np.diff(of_block, prepend=False) != 0)[block]  # blocks of one kind
    spare = ~kept & ~of_block[block]
    if not spare.any():
        return np.flatnonzero(kept)
    lacks = -np.bincount(run, kept).astype(np.int64) % BLOCK
    lacks[run[-1]] = 0
    before: Rows = np.cumsum(spare) - spare
    first = np.searchsorted(run, run)
    kept |= spare & (before - before[first] < lacks[run])
    return np.flatnonzero(kept)


class _Cut:
    """Chooses the rows of every kind for a `Slice`."""

    def __init__(self, core: Core, rank: int) -> None:
        given = tables_of(core, core.model(), "given")
        tables = [*given, *tables_of(core, core.fields(), "stored")]
        self.tables = {table.name: table for table in tables}
        self.counts = counts_of(core)
        self.rank = rank
        self.keep: dict[str, Rows] = {}
        self.local: dict[str, Rows] = {}
        self.own: dict[str, Flags] = {}
        self.lengths: dict[str, Rows] = {}
        self._part: dict[str, NDArray[Any]] = {}

    def flat(self, name: str) -> NDArray[Any]:
        """An array by its name."""
        return self.tables[name].flat

    def cut(self, elements: Rows, element_part: Rows, node_part: Rows) -> None:
        """Choose the rows of all kinds."""
        for kind in ALL:
            count = self.counts[kind]
            self._put(kind, np.arange(count), np.zeros(count, np.int32))
        self._elements(elements, element_part)
        self._nodes(node_part)
        self._faces()
        for kind in PAIRS:
            self._free(kind)
        self._bolts()
        self._corner_rows()
        for kind in FREE.keys() - PAIRS.keys() - {"predicted", "outer_edges", "outer_edge_pairs"}:
            self._free(kind)
        self._put_slots()
        self._vertex_faces()
        for kind in ("predicted", "outer_edges", "outer_edge_pairs"):
            self._free(kind)
        for table in self.tables.values():
            if table.is_list:
                self._list(table)
        self._check()

    def _put(self, kind: str, rows: Rows, part: NDArray[Any]) -> None:
        """Keep rows of a kind, of which each belongs to a part."""
        self._part[kind] = part
        self.keep[kind] = rows
        self.local[kind] = numbers_of(rows, len(part))
        self.own[kind] = part[rows] == self.rank

    def _elements(self, elements: Rows, part: NDArray[Any]) -> None:
        first, kept = 0, [np.zeros(0, np.int64)]
        corners = {
            shape: self.tables[f"{shape}.nodes"].rows()[: self.counts[shape]] for shape in SHAPES
        }
        at_node = np.bincount(np.concatenate([table.ravel() for table in corners.values()]))
        for shape in SHAPES:
            count = self.counts[shape]
            own = elements[(elements >= first) & (elements < first + count)] - first
            joined = (at_node[corners[shape]] > 1).any(axis=1)
            if self.tables[f"{shape}.nodal_mean"].is_used:  # a kernel for tiles with such tets
                joined[:] = True
            own = filled(own, joined)
            self._put(shape, own, part[first : first + count])
            kept.append(own + first)
            first += count
        self._put("elements", np.concatenate(kept), part)

    def _nodes(self, part: NDArray[Any]) -> None:
        tables = [self.tables[f"{shape}.nodes"].rows()[self.keep[shape]] for shape in SHAPES]
        self._put("nodes", found_in([t.ravel() for t in tables], len(part)), part)
        block = self.flat("node.block")
        of_blocks = np.zeros(self.counts["blocks"], part.dtype)
        blocks, first = np.unique(block, return_index=True)
        of_blocks[blocks] = part[first]
        self._put("blocks", found_in([block[self.keep["nodes"]]], len(of_blocks)), of_blocks)

    def _faces(self) -> None:
        element = self.flat("face.element")
        kept = np.flatnonzero(self.local["elements"][element] >= 0)
        self._put("faces", kept, self._part["elements"][element])
        edges = self.tables["face.edges"].rows()[kept].ravel()
        of_edges = self._part["faces"][self.tables["edge.faces"].rows()[:, 0]]
        self._put("edges", found_in([edges[edges >= 0]], len(of_edges)), of_edges)

    def _bolts(self) -> None:
        """Bolts of which all nodes of the rock are kept, of the owner of their lowest one."""
        count = self.counts["bolts"]
        if count == 0:
            for kind in ("bolts", "bolt_nodes", "bolt_crossings", "bolt_points"):
                self._put(kind, np.zeros(0, np.int64), np.zeros(0, np.int32))
            return
        first, crossings = self.flat("bolts.first"), self.flat("bolts.crossing_first")
        of_points = np.concatenate([
            np.repeat(np.arange(count), np.diff(first)),
            np.repeat(np.arange(count), 2 * np.diff(crossings)),
        ])  # fmt: skip
        hosts = self.flat("bolts.hosts").reshape(len(of_points), -1)
        is_missing = ((hosts >= 0) & (self.local["nodes"][np.maximum(hosts, 0)] < 0)).any(axis=1)
        misses = np.bincount(of_points, is_missing, count) > 0
        lowest = np.full(count, len(self.local["nodes"]) - 1, np.int64)
        np.minimum.at(lowest, of_points, np.where(hosts < 0, lowest[0], hosts).min(axis=1))
        part = self._part["nodes"][lowest]
        self._put("bolts", np.flatnonzero(~misses), part)
        self._list(self.tables["bolts.first"])
        self._list(self.tables["bolts.crossing_first"])
        sides = (2 * self.keep["bolt_crossings"][:, None] + np.arange(2)).ravel()
        points = np.concatenate([self.keep["bolt_nodes"], self.counts["bolt_nodes"] + sides])
        self._put("bolt_points", points, part[of_points])

    def _corner_rows(self) -> None:
        """Rows of the kept pairs and bolts, and the last one, which adds nothing."""
        for table in self.tables.values():
            if table.is_list and table.kind in PAIRS:
                self._list(table)
        first, kept, parts = 0, [], []
        for kind, rows in [*PAIRS.items(), ("bolt_points", 8)]:
            kept.append((first + self.keep[kind][:, None] * rows + np.arange(rows)).ravel())
            parts.append(np.repeat(self._part[kind], rows))
            first += self.counts[kind] * rows
        kept.append(np.array([first]))
        parts.append(np.zeros(1, np.int32))
        self._put("corner_rows", np.concatenate(kept), np.concatenate(parts))

    def _put_slots(self) -> None:
        """Four slots for each exposed face."""
        slots = 4 * self.keep["exposed"][:, None] + np.arange(4)
        self._put("slots", slots.ravel(), np.repeat(self._part["exposed"], 4))

    def _vertex_faces(self) -> None:
        """Pairs of vertex and face whose elements are kept, of the owner of the first element."""
        elements = self.flat("face.element")[self.flat("search.exposed_face")]
        patches = patches_of(elements)
        mothers = mothers_of(self.flat("outer.slot_first"), self.flat("outer.slot_pairs"))
        faces = self.tables["outer.vf_pairs"].rows()[: len(mothers), 1]
        vertex, face = patches[mothers], patches[faces]
        local = self.local["exposed"]
        kept = np.flatnonzero((local[vertex] >= 0) & (local[face] >= 0))
        movable = self.flat("face.movable")[self.flat("search.exposed_face")]
        part = self._part["exposed"][first_patches(vertex, face, movable)]
        self._put("outer_vertex_faces", kept, part)

    def _free(self, kind: str) -> None:
        """Keep the rows of which all that they refer to is kept."""
        if kind not in self.counts:
            raise LookupError(f"no rows of kind {kind}")
        name, of = FREE[kind]
        count, by = self.counts[kind], self.tables[name]
        part = np.zeros(0, np.int32)
        if count:
            part = self._part[of][by.rows()[:, 0]]
        self._put(kind, np.flatnonzero(self._present(kind)), part)

    def _present(self, kind: str) -> Flags:
        """Whether all rows are kept that the rows of a kind refer to."""
        present = np.ones(self.counts[kind], bool)
        for table in self.tables.values():
            if table.kind != kind or table.is_list or not table.is_used:
                continue
            for number, other in enumerate(table.kinds()):
                if not other or other == NOT_KEPT:
                    continue
                if other not in self.local:
                    raise LookupError(f"{table.name} refers to rows of kind {other}")
                index = table.rows()[:, number]
                row = np.where(index < 0, ~index, index) if table.info["opposite"] else index
                present &= (row < 0) | (self.local[other][np.maximum(row, 0)] >= 0)
        return present

    def _list(self, table: Table) -> None:
        """Keep items of the lists of kept rows, those of which all that they refer to is kept."""
        items, owner = table.info["refers_to"][0], table.kind
        if table.name in self.lengths or not table.is_used:
            return
        if owner in ALL:
            self.lengths[table.name] = np.diff(table.flat)
            return
        if owner not in self.keep:
            raise LookupError(f"{table.name} has rows of kind {owner}")
        rows, owners = self.keep[owner], np.arange(len(self.keep[owner]))
        if table.name == BY_LABEL:
            labels = self.flat("node.bonded_node")[rows]
            owners = np.sort(np.unique(labels, return_index=True)[1])
            rows = labels[owners]
        kept, place = items_of(table.flat, rows)
        present = self._present(items)[kept]
        lengths = np.bincount(owners[place[present]], minlength=len(self.keep[owner]))
        self.lengths[table.name] = lengths
        self._put(items, kept[present], np.repeat(self._part[owner], np.diff(table.flat)))

    def _check(self) -> None:
        """Kinds without items keep none; every other kind must have been cut."""
        for kind, count in self.counts.items():
            if count == 0 and kind not in self.keep:
                self._put(kind, np.zeros(0, np.int64), np.zeros(0, np.int32))
        for table in self.tables.values():
            if not table.kind and len(table.flat) and any(table.kinds()):
                raise LookupError(f"{table.name} refers to rows, but has none")
            kinds = {table.kind, *table.kinds()} - {NOT_KEPT, ""} if table.is_used else set()
            if missing := kinds - self.keep.keys():
                raise LookupError(f"{table.name}: no rule for rows of kind {missing.pop()}")
