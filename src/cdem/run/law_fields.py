"""Fields of state variables, as declared by the laws, by element."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cdem._native import core as native
from cdem.case.case import Case
from cdem.case.laws import BLOCK_LAWS, INTERFACE_LAWS, STATES, Law
from cdem.case.output_fields import OF_WATER, YIELDED
from cdem.model.interfaces import interfaces_of
from cdem.rows import rows_of
from cdem.run.state import RunState

NOW = 0x33
"""The bits of `yielded` for present flow."""


def wanted_fields(case: Case) -> list[str]:
    """The output fields of a case, without states of laws and water that it does not have."""
    i = case.interfaces
    used = [BLOCK_LAWS[material.law] for material in case.materials.values()]
    used += [INTERFACE_LAWS[one.law] for one in (i.default, *i.pairs) if one is not None]
    states = {variable.name for law in used for variable in law.state}
    if any(BLOCK_LAWS[material.law].flows for material in case.materials.values()):
        states.add(YIELDED.name)
    of_laws = STATES.keys() | {YIELDED.name}
    return [
        name
        for name in case.output.fields
        if (name not in of_laws or name in states) and (name not in OF_WATER or case.water)
    ]


def yielded_of(sim: RunState) -> NDArray[np.int32]:
    """Present and past plastic flow of each element (`YIELDED`), shape by shape."""
    tables = sim.core.yielded()
    counts = {shape: len(nodes) for shape, nodes in sim.build.topology.element_nodes.items()}
    rows = [tables[shape][:count] if tables[shape].size else np.zeros(count)
            for shape, count in counts.items()]  # fmt: skip
    return np.concatenate(rows).astype(np.int32)


def yielded_counts(sim: RunState) -> dict[str, dict[str, int]]:
    """Number of elements that yield now, and that ever have, for each group with a plastic material."""
    case, names = sim.case, sim.build.group_names
    flow = [n for n in names if BLOCK_LAWS[case.materials[case.groups[n].material].law].flows]
    if not flow:
        return {}
    group, bits = np.concatenate(list(sim.build.topology.element_group.values())), yielded_of(sim)
    counts = {}
    for name in flow:
        own = bits[group == names.index(name)]
        counts[name] = {"now": int(((own & NOW) > 0).sum()), "ever": int((own > 0).sum())}
    return counts


def state_of(sim: RunState, name: str) -> NDArray[np.float64]:
    """The largest value of a state variable in each element, shape by shape.

    For a block law, the largest of its Gauss points; for an interface law, of the bond points,
    vertices and sides of its faces. Elements without the law have 0.
    """
    return np.maximum(_of_block_laws(sim, name), _of_interface_laws(sim, name))


STRAIN_THAT_ENDS = 1.0
"""Plastic strain above which a run ends: the stress is then wrong."""


@dataclass
class LargeStrain:
    """The largest plastic strain of a group above the limit of the case.

    Attributes:
        group: The group.
        state: Name of the strain.
        value: Its value [1].
        place: Present middle of the element [m].
        limit: Limit of the case [1].
    """

    group: str
    state: str
    value: float
    place: list[float]
    limit: float

    def text(self) -> str:
        """A one-line warning."""
        place = ", ".join(f"{x:.4g}" for x in self.place)
        return (
            f"{self.state} of group {self.group} is {self.value:.3g} at ({place}) m, above "
            f"elements.strain_limit {self.limit:g}: the stress is exact for small strain only. Let "
            f"rock "
            "with large displacements break along faces (bonds between blocks)"
        )


def large_strains(sim: RunState) -> list[LargeStrain]:
    """The largest plastic strain of each group above the limit of the case."""
    case, names = sim.case, sim.build.group_names
    group = np.concatenate(list(sim.build.topology.element_group.values()))
    found = []
    for number, name in enumerate(names):
        law = BLOCK_LAWS[case.materials[case.groups[name].material].law]
        if not law.flows:
            continue
        own = np.flatnonzero(group == number)
        tables = {v.name: _of_block_laws(sim, v.name)[own] for v in law.state}
        state = max(tables, key=lambda key: tables[key].max())
        worst = int(tables[state].argmax())
        value, limit = float(tables[state][worst]), case.elements.strain_limit
        if value > limit:
            place = _middle(sim, int(own[worst]))
            found.append(LargeStrain(name, state, value, place, limit))
    return found


def _middle(sim: RunState, element: int) -> list[float]:
    """Middle of an element, with its number counted over all shapes."""
    position = rows_of(sim.core, "node.motion").position
    for nodes in sim.build.topology.element_nodes.values():
        if element < len(nodes):
            middle: list[float] = position[nodes[element]].mean(axis=0).tolist()
            return middle
        element -= len(nodes)
    raise IndexError(element)


def _places(laws: dict[str, Law], name: str) -> dict[int, int]:
    """Number of a law in the core, and index of the variable in its state."""
    return {
        number: [v.name for v in law.state].index(name)
        for number, law in enumerate(laws.values())
        if name in [v.name for v in law.state]
    }


def _of_block_laws(sim: RunState, name: str) -> NDArray[np.float64]:
    t, case = sim.build.topology, sim.case
    fields = sim.core.fields()
    laws = [case.materials[case.groups[group].material].law for group in sim.build.group_names]
    law_of_group = np.array([list(BLOCK_LAWS).index(law) for law in laws])
    parts = []
    for shape, elements in t.element_nodes.items():
        value = np.zeros(len(elements))
        history = fields[f"{shape}.history"]
        for law, place in _places(BLOCK_LAWS, name).items():
            if not history.size:
                continue
            table = history.reshape(-1, native.point_history, native.padded_stride(len(elements)))
            own = law_of_group[t.element_group[shape]] == law
            value[own] = table[:, 6 + place, : len(elements)].max(axis=0)[own]
        parts.append(value)
    return np.concatenate(parts)


def _of_interface_laws(sim: RunState, name: str) -> NDArray[np.float64]:
    t = sim.build.topology
    value = np.zeros(sum(len(e) for e in t.element_nodes.values()))
    for law, place in _places(INTERFACE_LAWS, name).items():
        for faces, numbers in (*_bonds(sim, law, place), *_walls(sim, law, place)):
            np.maximum.at(value, t.face_element[faces], numbers)
    return value


def _bonds(sim: RunState, law: int, place: int) -> list[tuple[NDArray, NDArray]]:
    """Faces of bonded pairs with the law, and the largest value at their points."""
    b, fields, width = sim.build, sim.core.fields(), native.interface_law_state
    used, _ = interfaces_of(sim.case, b.group_names)
    numbers = np.array([list(INTERFACE_LAWS).index(one.law) for one in used])
    if law not in numbers:
        return []
    found = []
    for kind in ("triangles", "quads", "overlaps"):
        pairs = b.assembly.counts[f"{kind}.count"]
        if not pairs:
            continue
        history = fields[f"{kind}.history"].reshape(width, -1)[place]
        if kind == "overlaps":
            first = b.topology.overlap_first
            most = np.maximum.reduceat(history[: first[-1]], first[:-1])
        else:
            points = {"triangles": 3, "quads": 4}[kind]
            most = history.reshape(points, -1)[:, :pairs].max(axis=0)
        faces = rows_of(sim.core, f"{kind}.faces").numbers
        own = numbers[b.arrays[f"{kind}.interface"][:pairs]] == law
        found += [(faces[own, side], most[own]) for side in (0, 1)]
    return found


def _walls(sim: RunState, law: int, place: int) -> list[tuple[NDArray, NDArray]]:
    """Exposed faces whose vertices or sides have a state of the law, and their values."""
    fields, width = sim.core.fields(), native.interface_law_state
    found = []
    for kind in ("spring", "edge"):
        own = np.flatnonzero(fields[f"{kind}.history_law"] == law)
        values = fields[f"{kind}.history"].reshape(-1, width)[own, place]
        found.append((fields["search.exposed_face"][own // 4], values))
    return found
