"""Bodies that move while a static stage finds no rest: their blocks, and the joints they slip on."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.case.laws import INTERFACE_LAWS
from cdem.mesh.arrays import components
from cdem.model.faces import face_areas
from cdem.model.interfaces import interfaces_of, name_of
from cdem.run.fields import bonds_of, group_of
from cdem.run.state import RunState
from cdem.units import coordinates

Floats = NDArray[np.float64]

MOVES = 0.1
"""Displacement of an element that moves, over that of the farthest."""


@dataclass
class Slip:
    """A joint or interface between a body and rock that stays behind.

    Attributes:
        interface: Its name.
        area: Area on which the two touched at the start [m2].
        slip: Mean displacement across it, weighted by that area [m].
    """

    interface: str
    area: float
    slip: float


@dataclass
class Body:
    """Elements that touch one another and move.

    Attributes:
        blocks: Number of blocks.
        volume: [m3].
        mass: [kg].
        groups: Names of their groups.
        moved: Mean displacement [m].
        middle: Centre of mass [m].
        through: Joints and interfaces on which it slips, the largest area first.
        whole: Whether whole blocks move, so that the body is apart from the rest.
        members: Numbers of its blocks.
    """

    blocks: int
    volume: float
    mass: float
    groups: list[str]
    moved: float
    middle: list[float]
    through: list[Slip]
    whole: bool
    members: NDArray[np.int32]

    def as_dict(self) -> dict[str, Any]:
        """All values but the numbers of blocks, ready for JSON."""
        values = asdict(self)
        del values["members"]
        return values

    def text(self) -> str:
        """One line of a report."""
        count = "part of a block" if not self.whole and self.blocks == 1 else f"{self.blocks} block"
        plural = "s" if self.blocks > 1 else ""
        on = ", ".join(
            f"{s.interface} ({s.area:.3g} m2, slip {s.slip:.2g} m)" for s in self.through
        )
        return (
            f"{count}{plural} of {', '.join(self.groups)}, {self.volume:.4g} m3, {self.mass:.4g} kg, "
            f"around ({coordinates(np.round(self.middle, 2))}), moved {self.moved:.2g} m on average"
            + (f", on {on}" if on else "")
        )


def moving_bodies(sim: RunState, start: Floats) -> list[Body]:
    """Bodies that have moved since a start, the largest first.

    An element moves if its displacement is more than `MOVES` of the largest. Moving elements are of
    one body if they share nodes, or if faces of them touched at the start or do now.

    Args:
        sim: A run.
        start: Positions of the nodes at the start [m], shape (nodes, 3).
    """
    t = sim.build.topology
    moved = sim.fields["position"] - start
    nodes = list(t.element_nodes.values())
    of_elements = np.concatenate([np.linalg.norm(moved[n].mean(axis=1), axis=1) for n in nodes])
    block = np.concatenate(list(t.element_block.values()))
    of_elements[sim.out[block]] = 0.0
    moves = of_elements > MOVES * of_elements.max()
    label = _labels(sim, moves)
    found = [
        _body(sim, label == one, moves, moved, of_elements, block)
        for one in np.unique(label[moves])
    ]
    return sorted(found, key=lambda body: -body.volume)


def volume_of(sim: RunState, blocks: NDArray[np.int32]) -> float:
    """Volume of blocks [m3]."""
    b, t = sim.build, sim.build.topology
    return sum(
        float(b.assembly.element_volume[shape][np.isin(t.element_block[shape], blocks)].sum())
        for shape in t.element_nodes
    )


def _touching(sim: RunState) -> NDArray[np.int32]:
    """Pairs of faces that touched at the start, or touch now, shape (pairs, 2)."""
    t, now = sim.build.topology, sim.contacts
    contacts = np.column_stack([now["mother_face"], now["target_face"]])
    return np.concatenate([t.pair_faces, t.overlap_faces, contacts]).astype(np.int32)


def _labels(sim: RunState, moves: NDArray[np.bool_]) -> NDArray[np.int64]:
    """A number of each element, the same for all moving elements of a body."""
    t, count = sim.build.topology, len(moves)
    at, ends, first = [], [], 0
    for nodes in t.element_nodes.values():
        numbers = np.arange(first, first + len(nodes))
        some = moves[numbers]
        at.append(np.repeat(numbers[some], nodes.shape[1]))
        ends.append(count + nodes[some].ravel())
        first += len(nodes)
    pairs = t.face_element[_touching(sim)]
    pairs = pairs[moves[pairs].all(axis=1)]
    a, b = np.concatenate([*at, pairs[:, 0]]), np.concatenate([*ends, pairs[:, 1]])
    return components(count + len(t.node_position), a, b)[:count]


def _body(
    sim: RunState,
    mine: NDArray[np.bool_],
    moves: NDArray[np.bool_],
    moved: Floats,
    of_elements: Floats,
    block: NDArray[np.int32],
) -> Body:
    b, t = sim.build, sim.build.topology
    volume = np.concatenate([b.assembly.element_volume[shape] for shape in t.element_nodes])
    mass = np.concatenate([b.assembly.element_mass[shape] for shape in t.element_nodes])
    at = sim.fields["position"]
    middle = np.concatenate([at[n].mean(axis=1) for n in t.element_nodes.values()])
    members = np.unique(block[mine]).astype(np.int32)
    names = [b.group_names[g] for g in np.unique(group_of(sim)[mine])]
    return Body(
        len(members),
        float(volume[mine].sum()),
        float(mass[mine].sum()),
        names,
        float(np.average(of_elements[mine], weights=mass[mine])),
        np.average(middle[mine], axis=0, weights=mass[mine]).tolist(),
        _through(sim, mine, moved),
        whole=bool(mine[np.isin(block, members)].all()),
        members=members,
    )


def _through(sim: RunState, mine: NDArray[np.bool_], moved: Floats) -> list[Slip]:
    """Interfaces between a body and the other elements."""
    b, t = sim.build, sim.build.topology
    faces = np.concatenate([t.pair_faces, t.overlap_faces])
    area = _areas(sim, faces)
    border = mine[t.face_element[faces]].sum(axis=1) == 1
    faces, area = faces[border], area[border]
    real = (t.face_nodes >= 0)[..., None]
    of_faces = np.where(real, moved[t.face_nodes], 0.0).sum(axis=1) / real.sum(axis=1)
    slip = np.linalg.norm(of_faces[faces[:, 0]] - of_faces[faces[:, 1]], axis=1)
    laws, table = interfaces_of(sim.case, b.group_names)
    law = table[t.face_kind[faces[:, 0]], t.face_kind[faces[:, 1]]]
    found = [
        Slip(name_of(laws[k]), float(area[law == k].sum()),
             float(np.average(slip[law == k], weights=area[law == k])))
        for k in np.unique(law)
        if k >= 0
    ]  # fmt: skip
    return sorted(found, key=lambda s: -s.area)


def _areas(sim: RunState, faces: NDArray[np.int32]) -> Floats:
    """Areas on which pairs of faces touched at the start [m2]; overlaps, if any, come last."""
    b, t = sim.build, sim.build.topology
    overlaps = len(t.overlap_faces)
    conforming = faces[: len(faces) - overlaps, 0]
    areas = face_areas(b.start_position, t.face_nodes[conforming])
    if not overlaps:
        return areas
    return np.concatenate([areas, np.add.reduceat(t.overlap_area, t.overlap_first[:-1])])


def lost_cohesion(sim: RunState) -> dict[str, float]:
    """Broken part of the bonded area of each interface that has strength now, by its name."""
    b, t = sim.build, sim.build.topology
    faces, intact = bonds_of(sim)
    kept = ~sim.out[t.face_block[faces]].any(axis=1)
    faces, intact, area = faces[kept], intact[kept], _areas(sim, faces)[kept]
    laws, table = interfaces_of(sim.case, b.group_names)
    law = table[t.face_kind[faces[:, 0]], t.face_kind[faces[:, 1]]]
    return {
        name_of(laws[k]): float(np.average(1 - intact[law == k], weights=area[law == k]))
        for k in np.unique(law)
        if k >= 0 and INTERFACE_LAWS[laws[k].law].bonds(laws[k])
    }
