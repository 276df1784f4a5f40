"""Kinds of rows for slices of a model, and flat arrays of the core as tables of rows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native

if TYPE_CHECKING:
    from cdem._core import Core

Rows = NDArray[np.int64]
Arrays = Mapping[str, NDArray[Any]]

PAIRS = {"triangles": 3, "quads": 4, "overlaps": 8}
"""Kinds of bonded pairs, with the corner rows of a pair."""
BLOCK = 8
"""Elements of a block: they stay together."""
ALL = frozenset({
    "materials", "interfaces", "interface_classes", "class_pairs", "curves", "supports",
    "mass_entries", "water_fields", "surfaces", "columns", "column_levels", "column_inputs",
})  # fmt: skip
"""Kinds whose rows are all kept by every rank. The first rank owns them: all compute the same."""
FREE = {
    "triangles": ("triangles.faces", "faces"),
    "quads": ("quads.faces", "faces"),
    "overlaps": ("overlaps.faces", "faces"),
    "wet_triangles": ("wet_triangles.face", "faces"),
    "wet_quads": ("wet_quads.face", "faces"),
    "surface_triangles": ("surface_triangles.nodes", "nodes"),
    "surface_quads": ("surface_quads.nodes", "nodes"),
    "column_sides": ("columns.node", "nodes"),
    "exposed": ("search.exposed_face", "faces"),
    "predicted": ("outer.predicted_nodes", "nodes"),
    "outer_edges": ("outer.ee_sides", "slots"),
    "outer_edge_pairs": ("outer.ee_pairs", "outer_edges"),
}
"""Kinds whose rows are kept where all that they refer to is, and the reference, the first of the
array, whose owner owns the row."""
NOT_KEPT = "old_edge_states"
"""Rows of one step ago: a reference to them is not read any more."""
LABELS = frozenset({"node.place", "node.block_first", "node.bonded_node", "node.body"})
"""Arrays that label nodes by the lowest node of those that belong together."""
BY_LABEL = "search.edge_star_first"
"""Lists of labels of `node.bonded_node`, not of nodes."""
OF_PADS = {"bond": 1.0, "jump_at_break": -1.0}
"""What fills a state past its last row, by the last word of its name; no step writes there."""


@dataclass
class Table:
    """An array of the core with its description.

    Attributes:
        info: Its description, from `Core.describe`.
        flat: The array as the core has it.
        count: Rows of its kind.
    """

    info: Mapping[str, Any]
    flat: NDArray[Any]
    count: int

    @property
    def name(self) -> str:
        """Name of the array."""
        return str(self.info["name"])

    @property
    def kind(self) -> str:
        """Kind of its rows."""
        return str(self.info["rows"])

    @property
    def is_used(self) -> bool:
        """Whether it has rows, of kinds that are cut."""
        return self.flat.size > 0 and bool(self.info["rows"])

    @property
    def is_list(self) -> bool:
        """Whether it holds the starts of lists."""
        return bool(self.info["layout"] == "starts")

    def rows(self) -> NDArray[Any]:
        """View of its rows, shape (rows, numbers)."""
        if self.info["layout"] == "columns":
            return self.flat.reshape(self.info["numbers"], -1)[:, : self.count].T
        return self.flat.reshape(self.count, self.info["numbers"])

    def kinds(self) -> list[str]:
        """Kind of rows that each number of a row refers to, or ""."""
        named, numbers = self.info["refers_to"], self.info["numbers"]
        if not any(named[1:]):
            return [named[0]] * numbers
        return [*named, *[""] * numbers][:numbers]


def tables_of(core: Core, arrays: Arrays, origin: str) -> list[Table]:
    """Arrays of one origin as tables."""
    counts = counts_of(core)
    return [
        Table(info, arrays[info["name"]], counts.get(info["rows"], 0))
        for info in core.describe()
        if info["origin"] == origin
    ]


def counts_of(core: Core) -> dict[str, int]:
    """How many rows a core has of each kind."""
    return {kind["name"]: kind["count"] for kind in core.describe_rows()}


def flat_of(info: Mapping[str, Any], rows: NDArray[Any]) -> NDArray[Any]:
    """Rows as the core has them. Columns are padded: those of a model with their last number."""
    if info["layout"] != "columns":
        return np.ascontiguousarray(rows).ravel()
    count, numbers = rows.shape
    columns = np.empty((numbers, native.padded_stride(count)), rows.dtype)
    columns[:, :count] = rows.T
    if info["origin"] == "given" and count:
        columns[:, count:] = rows[-1][:, None]
    else:
        columns[:, count:] = OF_PADS.get(info["name"].rpartition(".")[2], 0)
    return columns.ravel()


def items_of(first: NDArray[Any], rows: Rows) -> tuple[Rows, Rows]:
    """Items of some lists, list after list, and the place in `rows` of the list of each."""
    first = first.astype(np.int64)
    lengths = first[rows + 1] - first[rows]
    place = np.repeat(np.arange(len(rows)), lengths)
    before = np.cumsum(lengths) - lengths
    return np.arange(len(place)) + np.repeat(first[rows] - before, lengths), place


def starts_of(lengths: NDArray[Any]) -> Rows:
    """Starts of lists of these lengths, and the end."""
    return np.concatenate([np.zeros(1, np.int64), np.cumsum(lengths, dtype=np.int64)])


def lengths_of(first: NDArray[Any]) -> Rows:
    """Lengths of lists by their starts."""
    starts = first.astype(np.int64)
    return starts[1:] - starts[:-1]


def numbers_of(rows: Rows, count: int) -> Rows:
    """Place of each of `count` rows among some of them, or -1."""
    numbers = np.full(count, -1, np.int64)
    numbers[rows] = np.arange(len(rows))
    return numbers


def renumbered(index: NDArray[Any], number: Rows, *, opposite: bool) -> Rows:
    """Indices by other numbers of rows; -1 where a row has none."""
    if not len(number):
        return np.full(index.shape, -1, np.int64)
    row = np.where(index < 0, ~index, index) if opposite else index
    new = np.where(row < 0, -1, number[np.maximum(row, 0)])
    return np.where((index < 0) & (new >= 0), ~new, new) if opposite else new
