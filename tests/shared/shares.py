"""Models shared out to ranks at random, with ghosts."""

import numpy as np

from cdem._native import core as native
from cdem.model.curves import hand_over
from cdem.model.options import options_of
from cdem.ranks.kinds import BY_LABEL, LABELS, NOT_KEPT, tables_of
from cdem.ranks.merge import own_rows, put_together
from cdem.ranks.slices import Slice
from cdem.run import stages

SHAPES = {"tet4": 4, "pyramid5": 5, "wedge6": 6, "hex8": 8}


def counts_of(core):
    """How many rows there are of each kind."""
    return {kind["name"]: kind["count"] for kind in core.describe_rows()}


def corners_of(core):
    """Element and node of every corner of all elements."""
    counts, model, first = counts_of(core), core.model(), 0
    elements, nodes = [], []
    for shape, corners in SHAPES.items():
        count = counts[shape]
        table = model[f"{shape}.nodes"].reshape(corners, -1)[:, :count]
        elements.append(np.tile(first + np.arange(count), corners))
        nodes.append(table.ravel())
        first += count
    return np.concatenate(elements), np.concatenate(nodes)


def centers_of(core):
    """Centres of all elements."""
    elements, nodes = corners_of(core)
    at = core.fields()["node.motion"].reshape(-1, 8)[nodes, :3]
    sums = np.stack([np.bincount(elements, x) for x in at.T], axis=1)
    return sums / np.bincount(elements)[:, None]


def parts_of(core, parts, seed):
    """A part for every element, by halving along random axes, and for every node."""
    random = np.random.default_rng(seed)
    center = centers_of(core)
    part = np.zeros(len(center), np.int32)

    def halve(elements, first, last):
        if last - first == 1:
            part[elements] = first
            return
        order = elements[np.argsort(center[elements] @ random.normal(size=3), kind="stable")]
        middle = (first + last) // 2
        at = len(order) * (middle - first) // (last - first)
        halve(order[:at], first, middle)
        halve(order[at:], middle, last)

    halve(np.arange(len(center)), 0, parts)
    return part, node_parts(core, part)


def node_parts(core, element_part):
    """A part for every node: that of its first element."""
    elements, nodes = corners_of(core)
    lowest = np.full(counts_of(core)["nodes"], len(element_part))
    np.minimum.at(lowest, nodes, elements)
    return element_part[lowest]


def shared_things(core):
    """Things and the elements at them, as arrays of numbers: nodes, places, pairs, contacts, pairs
    of the outer list, faces that began flush, bolts."""
    model, state = core.model(), core.fields()
    elements, nodes = corners_of(core)
    of_face = model["face.element"]
    of_exposed = of_face[state["search.exposed_face"]]
    things = [(nodes, elements), (model["node.place"][nodes], elements)]

    def both(a, b):
        there = (a >= 0) & (b >= 0)
        number = np.arange(there.sum())
        things.append((np.tile(number, 2), np.concatenate([a[there], b[there]])))

    for kind in ("triangles", "quads", "overlaps"):
        both(*of_face[model[f"{kind}.faces"].reshape(-1, 2)].T)
    both(np.repeat(of_face, np.diff(model["flush.first"])), of_face[model["flush.face"]])
    slot = np.repeat(of_exposed, 4)
    for name in ("spring.target", "spring.target_before"):
        target = state[name]
        both(np.where(target < 0, -1, slot), of_exposed[np.maximum(target, 0)])
    edge = state["edge.contact"].reshape(-1, 4)
    both(slot[edge[:, 0]], of_exposed[edge[:, 1]])
    vertex = np.repeat(slot, np.diff(state["outer.slot_first"]))
    both(vertex, of_exposed[state["outer.vf_pairs"].reshape(2, -1)[1][state["outer.slot_pairs"]]])
    pairs = state["outer.ee_pairs"].reshape(2, -1)[:, : len(state["outer.ee_codes"])]
    both(*slot[state["outer.ee_sides"].reshape(-1, 2)[pairs, 0]])
    if len(model["bolts.hosts"]):
        hosts = model["bolts.hosts"].reshape(-1, 8)
        count = np.diff(model["bolts.first"]), 2 * np.diff(model["bolts.crossing_first"])
        bolt = np.concatenate([np.repeat(np.arange(len(n)), n) for n in count])
        of_node = np.full(counts_of(core)["nodes"], -1)
        of_node[nodes] = elements
        there = hosts >= 0
        things.append((np.repeat(bolt, 8)[there.ravel()], of_node[hosts[there]]))
    return things


def with_ghosts(core, own, layers=2):
    """Elements and those that share something with them, some times over."""
    present = own.copy()
    things = shared_things(core)
    for _ in range(layers):
        before = present.copy()
        for thing, element in things:
            touched = np.zeros(int(thing.max(initial=-1)) + 1, bool)
            touched[thing[before[element]]] = True
            present[element[touched[thing]]] = True
    return np.flatnonzero(present)


def slices_of(core, parts, seed, layers=2):
    """The slices of all ranks."""
    element_part, node_part = parts_of(core, parts, seed)
    return [
        Slice(core, with_ghosts(core, element_part == rank, layers), element_part, node_part, rank)
        for rank in range(parts)
    ]


def set_rules(sim, core, **options):
    """Give a core the rules of the last stage of a simulation."""
    case, names = sim.build.case, sim.build.group_names
    materials = [case.materials[case.groups[name].material] for name in names]
    core.set_options(options_of(case, materials) | options)
    stage = case.stages[max(sim.begun, 1) - 1]
    core.set_damping(*stages.damping_of(stage))
    core.set_rock_damping(*stages.rock_damping_of(stage))
    core.set_lumped(stages.is_lumped(stage))


def core_of(sim, kept, **options):
    """A core of a slice of a simulation, ready to run."""
    core = native.Core()
    core.take_counts(kept.counts())
    core.take_model(kept.model())
    hand_over(core, sim.build.curves, sim.begins)
    core.set_interfaces(sim.build.assembly.interfaces)
    set_rules(sim, core, **options)
    core.start(np.ascontiguousarray(sim.build.start_position[kept.keep["nodes"]]))
    core.restore(kept.state(), sim.core.scalars())
    core.prepare()
    return core


def differences(found, expected):
    """Names of arrays that are not the same, byte by byte."""
    assert list(found) == list(expected)
    return [
        name
        for name, array in expected.items()
        if found[name].dtype != array.dtype or found[name].tobytes() != array.tobytes()
    ]


def merge(core, slices, states, old_firsts=None):
    """The whole stored arrays from those of all ranks, see `own_rows`."""
    old = old_firsts or [None] * len(slices)
    return put_together(core, [own_rows(*one) for one in zip(slices, states, old, strict=True)])


def lost(core, kept):
    """How many references of own rows to rows that are not kept there are, by name of the array.

    None where the elements around the own ones suffice.
    """
    given = tables_of(core, core.model(), "given")
    tables = [*given, *tables_of(core, core.fields(), "stored")]
    used = [table for table in tables if table.is_used and table.name not in LABELS]
    return {table.name: count for table in used if (count := lost_of(core, kept, table))}


def lost_of(core, kept, table):
    """The same of one array."""
    own = kept.own[table.kind]
    rows = kept.keep[table.kind][own]
    if table.is_list:
        length = kept.lengths[table.name][own]
        if table.name == BY_LABEL:  # others have the lists of labels that are not kept
            length = length[core.fields()["node.bonded_node"][rows] == rows]
        return int(np.diff(table.flat)[rows].sum() - length.sum())
    count = 0
    for number, kind in enumerate(table.kinds()):
        if kind and kind != NOT_KEPT:
            index = table.rows()[rows, number]
            row = np.where(index < 0, ~index, index) if table.info["opposite"] else index
            count += int((kept.local[kind][row[row >= 0]] < 0).sum())
    return count
