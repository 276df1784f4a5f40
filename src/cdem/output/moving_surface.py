"""The surface of a run as one set of rows shared by all its frames: the data of a page.

Faces appear when bonds break and disappear when rock is removed. Each gets a row at its first
frame: rows are in order of appearance, and new frames only add rows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cdem.case.output_fields import OUTPUT_FIELDS
from cdem.case.shown_fields import MISES, von_mises_stress
from cdem.errors import CdemError
from cdem.output.reader import Surface

NEVER = np.iinfo(np.int32).max
"""Last frame of a face that never disappears."""
FLOW_LABELS = ("has not yielded", "has yielded", "yields now")
FLOWS_NOW = 1 + 2 + 16 + 32
"""Bits of the field "yielded" for present plastic flow."""
COLORS = 251
"""Number of colours for blocks and pieces; a prime, so that neighbours differ."""


@dataclass(frozen=True)
class PageField:
    """A field on a page.

    Attributes:
        name: Name of the field, or `MISES`.
        label: Text for the reader.
        unit: Unit, as of an output field.
        on: "node", "element" or "face".
        kind: "amount", coloured from 0 to `top`; "label", by few colours; "scattered", by many.
        labels: Meanings of the numbers of a label.
    """

    name: str
    label: str
    unit: str
    on: str
    kind: str
    labels: tuple[str, ...] = ()


class _Rows:
    """Rows of items in order of appearance, found by their numbers."""

    def __init__(self) -> None:
        self.number = np.zeros(0, np.int64)
        self.born = np.zeros(0, np.int32)
        self._row = np.zeros(0, np.int64)

    def __len__(self) -> int:
        return len(self.number)

    def of(self, numbers: NDArray) -> NDArray[np.int64]:
        """Rows of known numbers."""
        return self._row[numbers]

    def add(self, numbers: NDArray, frame: int, again: NDArray | None = None) -> NDArray[np.int64]:
        """Give rows to new numbers, and new rows to numbers that reappear.

        Returns:
            The new rows.
        """
        if len(numbers) and numbers.max() >= len(self._row):
            grown = np.full(2 * int(numbers.max()) + 1, -1)
            grown[: len(self._row)] = self._row
            self._row = grown
        new = self._row[numbers] < 0
        if again is not None:
            new |= again
        fresh = np.unique(numbers[new])
        rows = np.arange(len(self), len(self) + len(fresh))
        self._row[fresh] = rows
        self.number = np.concatenate([self.number, fresh])
        self.born = np.concatenate([self.born, np.full(len(fresh), frame, np.int32)])
        return rows


@dataclass
class Faces:
    """Faces by row.

    Attributes:
        nodes: Rows of nodes, shape (faces, 4), -1 last in a triangle.
        element: Row of the element.
        joint: Set of joints.
        born: First frame of the face.
        goes: First frame without the face, or `NEVER`.
    """

    nodes: NDArray[np.int64] = field(default_factory=lambda: np.zeros((0, 4), np.int64))
    element: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    joint: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, np.int64))
    born: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))
    goes: NDArray[np.int32] = field(default_factory=lambda: np.zeros(0, np.int32))


class MovingSurface:
    """Rows of nodes, elements and faces over the added frames.

    Attributes:
        times: Times of the frames [s].
        faces: Faces by row.
        group, block: Group and block of each row of elements.
        group_names: Names by group number.
        fields: Fields in every frame.
        top: Value with the last colour: the largest 99.5th percentile of a frame.
        most: Largest value of a field.
        lowest, highest: Corners of the box of all frames [m].
    """

    def __init__(self) -> None:
        self.times: list[float] = []
        self.faces = Faces()
        self.group = np.zeros(0, np.int64)
        self.block = np.zeros(0, np.int64)
        self.group_names: list[str] = []
        self.fields: dict[str, PageField] = {}
        self.top: dict[str, float] = {}
        self.most: dict[str, float] = {}
        self.lowest, self.highest = np.full(3, np.inf), np.full(3, -np.inf)
        self.nodes, self.elements, self._faces = _Rows(), _Rows(), _Rows()
        self.last = np.zeros((0, 3))

    def add(self, surface: Surface, stress: NDArray | None = None) -> None:
        """Add the next frame.

        Args:
            surface: With the fields `node`, `element` and `face`.
            stress: Stress of all elements [Pa], shape (elements, 6), or None.

        Raises:
            CdemError: The surface lacks numbers of nodes, elements and faces.
        """
        if "node" not in surface.point_data or "face" not in surface.cell_data:
            raise CdemError(
                "No moving picture: an older cdem wrote these frames, without the numbers of nodes and "
                "faces; run the case again, or use cdem render"
            )
        frame = len(self.times)
        self._add_nodes(surface, frame)
        self._add_faces(surface, frame)
        self.times.append(surface.time)
        self.group_names = surface.group_names
        values = values_of(surface, stress)
        kept = fields_of(surface, values)
        self.fields = kept if frame == 0 else {k: f for k, f in self.fields.items() if k in kept}
        for name, of in values.items():
            finite = of[np.isfinite(of)]
            if len(finite):
                self.most[name] = max(self.most.get(name, 0.0), float(finite.max()))
                top = float(np.percentile(finite, 99.5))
                self.top[name] = max(self.top.get(name, 0.0), top)

    def _add_nodes(self, surface: Surface, frame: int) -> None:
        numbers = surface.point_data["node"]
        self.nodes.add(numbers, frame)
        grown = np.zeros((len(self.nodes), 3))
        grown[: len(self.last)] = self.last
        here = surface.points
        whole = np.isfinite(here).all(axis=1)
        grown[self.nodes.of(numbers[whole])] = here[whole]
        self.last = grown
        if whole.any():
            self.lowest = np.minimum(self.lowest, here[whole].min(axis=0))
            self.highest = np.maximum(self.highest, here[whole].max(axis=0))

    def _add_faces(self, surface: Surface, frame: int) -> None:
        cells, known = surface.cell_data, self.faces
        new = self.elements.add(cells["element"], frame)
        first = np.zeros(len(self.elements), np.int64)
        first[self.elements.of(cells["element"])] = np.arange(len(cells["element"]))
        self.group = np.concatenate([self.group, cells["group"][first[new]]])
        self.block = np.concatenate([self.block, cells["block"][first[new]]])
        numbers = cells["face"]
        before = len(self._faces)
        again = np.zeros(len(numbers), bool)
        if before:
            here = np.isin(self._faces.number, numbers)
            went = (known.goes == NEVER) & ~here
            known.goes[went] = frame
            gone = np.zeros(int(max(numbers.max(initial=0), self._faces.number.max())) + 1, bool)
            gone[self._faces.number] = True
            gone[self._faces.number[known.goes == NEVER]] = False
            again = gone[numbers]
        rows = self._faces.add(numbers, frame, again)
        place = np.zeros(len(self._faces), np.int64)
        place[self._faces.of(numbers)] = np.arange(len(numbers))
        some = place[rows]
        polygons = surface.polygons[some]
        nodes = self.nodes.of(surface.point_data["node"][polygons])
        nodes[polygons < 0] = -1
        self.faces = Faces(
            np.concatenate([known.nodes, nodes]),
            np.concatenate([known.element, self.elements.of(cells["element"][some])]),
            np.concatenate([known.joint, cells["joint"][some]]),
            self._faces.born,
            np.concatenate([known.goes, np.full(len(rows), NEVER, np.int32)]),
        )

    def rows(self, surface: Surface) -> dict[str, NDArray[np.int64]]:
        """Rows of the points and cells of an added frame.

        Returns:
            By kind: "node" for the points; "element" and "face" for the cells.
        """
        cells = surface.cell_data
        return {
            "node": self.nodes.of(surface.point_data["node"]),
            "element": self.elements.of(cells["element"]),
            "face": self._faces.of(cells["face"]),
        }


def values_of(surface: Surface, stress: NDArray | None) -> dict[str, NDArray]:
    """Values of the changing fields of a frame, one number for each of its points or cells."""
    points, cells = surface.point_data, surface.cell_data
    values: dict[str, NDArray] = {}
    for f in OUTPUT_FIELDS:
        data = points if f.on == "nodes" else cells
        if f.name not in data or f.colors is None or f.name in ("group", "block", "joint"):
            continue
        of = np.asarray(data[f.name])
        values[f.name] = np.linalg.norm(of, axis=1) if of.ndim == 2 else of
    if stress is not None:
        values[MISES] = von_mises_stress(stress[cells["element"]])
    if "yielded" in values:
        bits = values["yielded"].astype(np.int64)
        values["yielded"] = np.where(bits & FLOWS_NOW, 2, bits > 0).astype(np.int64)
    if "piece" in values:
        values["piece"] = values["piece"].astype(np.int64) % COLORS
    return values


def fields_of(surface: Surface, values: Mapping[str, NDArray]) -> dict[str, PageField]:
    """The fields of a frame on a page, in the order of its list."""
    labels: dict[str, tuple[str, ...]] = {
        "yielded": FLOW_LABELS,
        "group": tuple(surface.group_names),
    }
    sets = int(surface.cell_data["joint"].max(initial=0))
    if sets:
        labels["joint"] = ("no joint", *(f"set {k + 1}" for k in range(sets)))
    found = {}
    for f in OUTPUT_FIELDS:
        if f.name not in values and f.name not in ("group", "block", "joint"):
            continue
        if f.name == "joint" and not sets:
            continue
        kind = "scattered" if f.name in ("block", "piece") else "amount"
        kind = "label" if f.name in labels else kind
        found[f.name] = PageField(
            f.name, f.name.replace("_", " "), f.unit, f.on[:-1], kind, labels.get(f.name, ())
        )
    if MISES in values:
        found[MISES] = PageField(MISES, "von Mises stress", "Pa", "element", "amount")
    return found


SurfaceOf = Callable[[int], tuple[Surface, NDArray | None]]
"""Gives the surface of a frame, and the stress of all elements or None."""
