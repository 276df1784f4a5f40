"""The state of a whole model from the rows that each rank owns."""

import pickle

import numpy as np
import pytest
from scenes import simulate
from shared.shares import (
    core_of,
    counts_of,
    differences,
    lost,
    merge,
    node_parts,
    parts_of,
    set_rules,
    slices_of,
)

from cdem.errors import CdemError
from cdem.ranks.merge import own_rows, put_together
from cdem.ranks.slices import Slice

WEAK = {"friction_angle": 20, "cohesion": 1e4, "tensile_strength": 1e4}
LAWS = {
    "brittle": {},
    "softening": {"law": "softening", "fracture_energy_1": 1, "fracture_energy_2": 2},
    "residual": {"law": "residual", "residual_friction_angle": 10, "residual_cohesion": 1e3},
}


def fall(**law):
    """Bonded tets hit a bed of cubes: they touch by vertices and edges, and some bonds break."""
    bar = {"size": [16, 1, 1], "divisions": [16, 1, 1], "shape": "tet4"}
    bed = {"size": [17, 2, 1], "divisions": [17, 1, 1]}
    sim = simulate(
        [
            {"group": "bar", "box": bar, "rotate": {"axis": [1, 0, 0], "angle": "45 deg"},
             "translate": [0, 0, 0.002]},
            {"group": "bed", "box": bed, "translate": [-0.5, -1, -1]},
        ],
        {"bar": {"velocity": [0.3, 0.2, -3]}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={"default": WEAK | law}, model={"split": {"bar": "elements", "bed": "elements"}},
        rock={"young_modulus": "0.1 GPa"},
    )  # fmt: skip
    sim.step(150)
    assert sum(sim.broken.values()) > 0 and (sim.contacts["kind"] == 1).sum() > 3
    return sim


@pytest.fixture
def sim():
    """The same with the simplest law."""
    return fall()


@pytest.mark.parametrize("law", LAWS)
def test_ranks_make_the_whole_again_after_steps(law):
    """Laws with states have histories, and those that ask for areas have lists of acting faces."""
    sim = fall(**LAWS[law])
    state = sim.core.fields()
    assert (len(state["spring.history"]) > 0) == (law == "softening")
    assert (len(state["outer.faces_acting_on"]) > 0) == (law == "residual")
    rules = {"rebuild_interval": 1, "step_given": sim.core.scalars()["dt"]}
    slices = slices_of(sim.core, 3, seed=1)
    whole = merge(sim.core, slices, [kept.state() for kept in slices])
    assert differences(whole, sim.core.fields()) == []
    cores = [core_of(sim, kept, **rules) for kept in slices]
    set_rules(sim, sim.core, **rules)
    for core in [sim.core, *cores]:
        core.run(1)
    states = [core.fields() for core in cores]
    old_firsts = [core.rebuilt()["edge.old_first"] for core in cores]
    sent = [own_rows(*one) for one in zip(slices, states, old_firsts, strict=True)]
    by_wire = [pickle.loads(pickle.dumps(one)) for one in sent]
    assert differences(put_together(sim.core, by_wire), sim.core.fields()) == []
    without = merge(sim.core, slices, states)
    assert differences(without, sim.core.fields()) == ["edge.contact"]
    before = sim.core.fields()["edge.contact"].reshape(-1, 4)
    assert (before[:, 3] >= 0).any()
    assert (before[:, :3] == without["edge.contact"].reshape(-1, 4)[:, :3]).all()


def test_one_rank_has_all(sim):
    slices = slices_of(sim.core, 1, seed=1)
    assert differences(merge(sim.core, slices, [slices[0].state()]), sim.core.fields()) == []


def test_a_row_that_nobody_sends_is_told(sim):
    slices = slices_of(sim.core, 3, seed=1)
    sent = [own_rows(kept, kept.state()) for kept in slices]
    with pytest.raises(CdemError, match=r"ranks do not own every one of \d+ nodes once"):
        put_together(sim.core, sent[:2])
    with pytest.raises(CdemError, match=r"ranks do not own every one of"):
        put_together(sim.core, [*sent, sent[0]])


def test_slices_without_ghosts_do_not_make_the_whole(sim):
    part = np.arange(counts_of(sim.core)["elements"]) // 8 % 2
    nodes = node_parts(sim.core, part)
    slices = [Slice(sim.core, np.flatnonzero(part == rank), part, nodes, rank) for rank in (0, 1)]
    assert all("outer.slot_first" in lost(sim.core, kept) for kept in slices)
    with pytest.raises(CdemError, match=r"every one of \d+ triangles once: triangles.status"):
        merge(sim.core, slices, [kept.state() for kept in slices])


def test_a_pair_that_its_owner_lacks_is_told(sim):
    slices = slices_of(sim.core, 3, seed=1)
    sent = [own_rows(kept, kept.state()) for kept in slices]
    for one in sent:
        one.vertex_faces[:, 1] += 1  # of another node
    with pytest.raises(CdemError, match=r"ranks do not own every pair of vertex and face"):
        put_together(sim.core, sent)


def test_labels_join_what_any_rank_has_joined(sim):
    """A chain of bonded nodes of which every rank sees two."""
    slices = slices_of(sim.core, 3, seed=1)
    states = [kept.state() for kept in slices]
    count = counts_of(sim.core)["nodes"]
    for kept, state in zip(slices, states, strict=True):
        state["node.body"] = np.arange(len(kept.keep["nodes"]), dtype=np.int32)
    chain = []
    for kept, state in zip(slices, states, strict=True):
        own = np.flatnonzero(kept.own["nodes"])
        low, high = own[0], own[-1]
        state["node.body"][high] = low
        chain.append(kept.keep["nodes"][[low, high]])
    body = merge(sim.core, slices, states)["node.body"]
    for low, high in chain:
        assert body[low] == body[high] == low
    assert (np.delete(body, [high for _, high in chain]) ==
            np.delete(np.arange(count), [high for _, high in chain])).all()  # fmt: skip


def test_a_place_before_of_a_released_bond_stays_behind_all_others(sim):
    slices = slices_of(sim.core, 3, seed=1, layers=1)
    counts = counts_of(sim.core)
    states, old_firsts = [], []
    for kept in slices:
        state = kept.state()
        contacts = state["edge.contact"].reshape(-1, 4)
        contacts[:, 3] = np.arange(len(contacts))  # each goes on, but the last is new
        old_firsts.append(state["edge.first"].copy())
        states.append(state)
    whole = merge(sim.core, slices, states, old_firsts)["edge.contact"].reshape(-1, 4)
    assert (whole[:, 3] == np.arange(counts["edge_contacts"])).all()
    expected = np.zeros(len(whole))
    for kept, state in zip(slices, states, strict=True):
        own, count = kept.own["edge_contacts"], len(kept.own["edge_contacts"])
        state["edge.contact"].reshape(-1, 4)[:, 3] += count
        expected[kept.keep["edge_contacts"][own]] = len(whole) + np.flatnonzero(own)
    whole = merge(sim.core, slices, states, old_firsts)["edge.contact"].reshape(-1, 4)
    assert (whole[:, 3] == expected).all() and len(set(expected)) > 3


def test_labels_of_points_are_whole_though_a_rank_keeps_not_all_their_nodes():
    """Ghosts share a bond with own tets, which do not keep all tets around a point."""
    bar = {"size": [6, 2, 2], "divisions": [6, 2, 2], "shape": "tet4"}
    tough = {"friction_angle": 20, "cohesion": 1e9, "tensile_strength": 1e9}
    sim = simulate(
        [{"group": "bar", "box": bar}], {"bar": {"velocity": [1, 0, 0]}},
        interfaces={"default": tough}, model={"split": {"bar": "elements"}},
    )  # fmt: skip
    sim.step(2)
    model, label = sim.core.model(), sim.core.fields()["node.bonded_node"]
    sides = model["face.element"][model["triangles.faces"].reshape(-1, 2)]
    part, nodes = parts_of(sim.core, 3, seed=1)
    slices = []
    for rank in range(3):
        at_own = sides[(part[sides] == rank).any(axis=1)].ravel()
        present = np.unique(np.concatenate([np.flatnonzero(part == rank), at_own]))
        slices.append(Slice(sim.core, present, part, nodes, rank))
    without = 0
    for kept in slices:
        own = kept.keep["nodes"][kept.own["nodes"]]
        lacking = own[kept.local["nodes"][label[own]] < 0]
        lengths = np.diff(kept.state()["search.edge_star_first"])
        local = kept.state()["node.bonded_node"]
        without += (lengths[local[kept.local["nodes"][lacking]]] > 0).sum()
    assert without > 0
    whole = merge(sim.core, slices, [kept.state() for kept in slices])
    assert not {"node.bonded_node", "node.body"} & set(differences(whole, sim.core.fields()))
    is_label = label == np.arange(len(label))
    assert not np.diff(whole["search.edge_star_first"])[~is_label].any()
