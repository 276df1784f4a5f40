"""What a rank keeps of a model: rows of every kind, in order, with numbers of its own."""

import numpy as np
import pytest
from scenes import simulate
from shared.shares import core_of, counts_of, differences, lost, slices_of, with_ghosts

from cdem.ranks import slices as module
from cdem.ranks.slices import Slice, filled
from cdem.rows import rows_of

BAR = {"size": [20, 1, 1], "divisions": [20, 1, 1], "shape": "tet4"}
TOUGH = {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}


def everything(sim, rank=0):
    """A slice of all elements."""
    counts = counts_of(sim.core)
    parts = np.zeros(counts["elements"], int), np.zeros(counts["nodes"], int)
    return Slice(sim.core, np.arange(counts["elements"]), *parts, rank)


@pytest.fixture(scope="module")
def sim():
    """A bar of bonded tets on a bed of cubes, after some steps."""
    bed = {"size": [21, 2, 1], "divisions": [21, 1, 1]}
    sim = simulate(
        [{"group": "bar", "box": BAR}, {"group": "bed", "box": bed, "translate": [-0.5, -0.5, -1]}],
        {"bar": {"velocity": [0.1, 0, -1]}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={"default": {"friction_angle": 20}, "pairs": [{"between": ["bar", "bar"], **TOUGH}]},
        model={"split": {"bar": "elements", "bed": "elements"}},
    )  # fmt: skip
    sim.step(20)
    return sim


@pytest.fixture(scope="module")
def slices(sim):
    """Its slices for four ranks."""
    return slices_of(sim.core, 4, seed=3, layers=1)


def test_a_slice_of_everything_is_the_model(sim):
    kept = everything(sim)
    assert differences(kept.model(), sim.core.model()) == ["node.place"]  # any label will do
    assert differences(kept.state(), sim.core.fields()) == []
    counts = kept.counts()
    assert {name: counts[name] for name in sim.build.assembly.counts} == sim.build.assembly.counts


def test_labels_of_places_stay_apart_and_together(sim):
    place = everything(sim).model()["node.place"]
    before = sim.core.model()["node.place"]
    assert (place[place] == place).all() and (place <= np.arange(len(place))).all()
    same, was = place[:, None] == place, before[:, None] == before
    assert (same == was).all()


def test_elements_that_share_nodes_stay_in_their_blocks_of_eight():
    blocks = [
        {"group": "a", "box": {"size": [7, 1, 1], "divisions": [7, 1, 1], "shape": "tet4"}},
        {"group": "b", "box": {"size": [7, 1, 1], "divisions": [7, 1, 1], "shape": "tet4"},
         "translate": [0, 0, 1]},
    ]  # fmt: skip
    sim = simulate(blocks, {"a": {}, "b": {}}, model={"split": {"a": "elements"}})
    counts = counts_of(sim.core)
    parts = np.zeros(counts["elements"], int), np.zeros(counts["nodes"], int)
    kept = Slice(sim.core, np.array([3, 50]), *parts, 0).keep["tet4"]
    assert 3 in kept and kept[8:].tolist() == list(range(48, 56))


@pytest.mark.parametrize("seed", range(20))
def test_others_fill_gaps_only(seed):
    random = np.random.default_rng(seed)
    joined = np.repeat(random.random(12) < 0.4, 8)[: 96 - seed % 8]
    some = np.flatnonzero(random.random(len(joined)) < random.choice([0.05, 0.5]))
    kept = filled(some, joined)
    assert np.isin(some, kept).all() and (np.diff(kept) > 0).all()
    place = np.flatnonzero(joined[kept])
    assert (kept[place] % 8 == place % 8).all()
    blocks = np.unique(some[joined[some]] // 8)
    assert (np.unique(kept[place] // 8) == blocks).all()
    assert len(kept) - len(place) - (~joined[some]).sum() < 8 * (1 + len(joined) // 16)


def test_every_row_has_one_owner_who_keeps_it(sim, slices):
    counts = counts_of(sim.core)
    for kind in slices[0].keep:
        rows = np.concatenate([kept.keep[kind][kept.own[kind]] for kept in slices])
        count = counts[kind]
        if kind == "outer_vertex_faces":  # the last ones are pads
            count = len(np.unique(sim.core.fields()["outer.slot_pairs"]))
        assert (np.sort(rows) == np.arange(count)).all(), kind
        for kept in slices:
            assert (np.diff(kept.keep[kind]) > 0).all() or kind == "star_ends", kind
            assert (kept.local[kind][kept.keep[kind]] == np.arange(len(kept.keep[kind]))).all()


def test_rows_speak_of_kept_rows(sim, slices):
    whole, state = sim.core.model(), sim.core.fields()
    for kept in slices:
        model, own = kept.model(), kept.state()
        nodes, faces = kept.keep["nodes"], kept.keep["faces"]
        corners = model["face.nodes"].reshape(-1, 4)
        before = whole["face.nodes"].reshape(-1, 4)[faces]
        assert (np.where(corners < 0, -1, nodes[corners]) == before).all()
        assert (kept.keep["elements"][model["face.element"]] == whole["face.element"][faces]).all()
        across = own["search.across"]
        before = state["search.across"][kept.keep["slots"]]
        assert (faces[across[across >= 0]] == before[across >= 0]).all()
        assert (kept.local["faces"][before[(across < 0) & (before >= 0)]] == -1).all()


def test_labels_are_the_lowest_kept_node(sim, slices):
    label = sim.core.fields()["node.bonded_node"]
    assert (np.bincount(label) > 1).any()
    fewer = 0
    for kept in slices:
        nodes, own = kept.keep["nodes"], kept.state()["node.bonded_node"]
        of_whole = [nodes[label[nodes] == label[node]].min() for node in nodes]
        assert (nodes[own] == of_whole).all()
        fewer += (nodes[own] != label[nodes]).sum()
    assert fewer > 0


def test_blocks_are_counted_as_far_as_they_are_kept(sim):
    counts = counts_of(sim.core)
    parts = np.zeros(counts["elements"], int), np.zeros(counts["nodes"], int)
    tets = counts["tet4"]
    kept = Slice(sim.core, np.arange(8), *parts, 0)
    assert (kept.model()["node.block_count"] == 4).all()
    assert kept.counts()["hex8.count"] == 0 and kept.counts()["tet4.count"] == 8
    assert (kept.model()["node.block"] == np.repeat(np.arange(8), 4)).all()
    bed = Slice(sim.core, np.array([tets]), *parts, 0)
    assert (bed.model()["node.block_count"] == 8).all() and bed.counts()["tet4.count"] == 0
    assert not len(bed.state()["outer.edge_first"]) and len(bed.state()["outer.vf_pairs"]) == 16


def test_nodes_of_a_block_that_is_cut_are_counted():
    box = {"size": [20, 1, 1], "divisions": [20, 1, 1]}
    sim = simulate([{"group": "bar", "box": box}], {"bar": {"fix": []}})
    parts = np.zeros(20, int), np.zeros(84, int)
    model = Slice(sim.core, np.array([19]), *parts, 0).model()
    assert (
        model["node.block_count"].tolist() == [20] * 20
    )  # 4 elements fill the last block of eight
    assert model["node.block_first"].tolist() == [0] * 20


def test_a_pair_needs_both_faces_and_has_its_corner_rows(sim, slices):
    faces = sim.core.model()["triangles.faces"].reshape(-1, 2)
    for kept in slices:
        both = (kept.local["faces"][faces] >= 0).all(axis=1)
        assert (kept.keep["triangles"] == np.flatnonzero(both)).all()
        rows = 3 * len(kept.keep["triangles"])
        assert kept.counts()["corner_rows"] == rows and kept.counts()["quads.corner_first"] == rows
        pairs, place = np.divmod(kept.keep["corner_rows"][:rows], 3)
        assert (pairs == np.repeat(kept.keep["triangles"], 3)).all() and (
            place[:3] == [0, 1, 2]
        ).all()
        assert kept.keep["corner_rows"][-1] == counts_of(sim.core)["corner_rows"] - 1
        assert len(kept.state()["corner.force"]) == 4 * (rows + 1)


def test_an_unknown_kind_of_rows_is_told(sim, monkeypatch):
    monkeypatch.setattr(module, "ALL", module.ALL - {"materials"})
    with pytest.raises(LookupError, match=r"material.lambda: no rule for rows of kind materials"):
        everything(sim)


def test_what_a_free_kind_refers_to_must_be_known(sim, monkeypatch):
    monkeypatch.setattr(module, "ALL", module.ALL - {"interfaces"})
    with pytest.raises(LookupError, match=r"triangles.interface refers to rows of kind interfaces"):
        everything(sim)


class Told:
    """A core that describes an array in another way."""

    def __init__(self, core, name, **other):
        self._core, self._name, self._other = core, name, other

    def __getattr__(self, name):
        return getattr(self._core, name)

    def describe(self):
        infos = self._core.describe()
        return [i | self._other if i["name"] == self._name else i for i in infos]


@pytest.mark.parametrize("name, told, fault", [
    ("node.mass", {"rows": "", "refers_to": ["nodes", "", "", ""]}, "refers to rows, but has none"),
    ("node.mass", {"rows": "tet4/8"}, "no rule for rows of kind tet4/8"),
    ("face.nodes", {"refers_to": ["nodes/8", "", "", ""]}, "no rule for rows of kind nodes/8"),
    ("flush.first", {"rows": "tet4/8"}, "has rows of kind tet4/8"),
])  # fmt: skip
def test_an_array_that_no_rule_covers_is_told(sim, name, told, fault):
    counts = counts_of(sim.core)
    parts = np.zeros(counts["elements"], int), np.zeros(counts["nodes"], int)
    with pytest.raises(LookupError, match=f"{name}:? {fault}"):
        Slice(Told(sim.core, name, **told), np.arange(8), *parts, 0)


def test_a_rank_may_keep_nothing(sim):
    counts = counts_of(sim.core)
    parts = np.ones(counts["elements"], int), np.ones(counts["nodes"], int)
    kept = Slice(sim.core, np.zeros(0, int), *parts, 1)
    assert not any(len(kept.keep[kind]) for kind in ("nodes", "faces", "slots", "outer_faces"))
    assert core_of(sim, kept).run(1)[0] == "steps_done"


@pytest.fixture(scope="module")
def bolted():
    """Two rows of bonded cubes in water, each with a bolt."""
    box = {"size": [4, 1, 1], "divisions": [16, 1, 1]}
    bar = {"area": 5e-4, "young_modulus": 2e11, "yield_force": 6e3, "dowel": True,
           "grout": {"stiffness": 1e8, "strength": 3e3}}  # fmt: skip
    lines = [[[0.1, 0.5, 0.5], [0.6, 0.5, 0.6]], [[3.4, 0.5, 0.5], [3.9, 0.5, 0.4]]]
    bolts = [{"name": f"b{k}", "type": "bar", "points": p} for k, p in enumerate(lines)]
    sim = simulate(
        [{"group": "rock", "box": box}], {"rock": {}}, interfaces={"default": TOUGH},
        model={"split": {"rock": "elements"}}, bolt_types={"bar": bar}, bolts=bolts,
        water={"reservoir": {"level": 2.0}}, loads={"gravity": [0, 0, -9.81]},
    )  # fmt: skip
    sim.step(2)
    return sim


def test_a_bolt_needs_all_its_rock(bolted):
    counts = counts_of(bolted.core)
    assert counts["bolts"] == 2 and counts["bolt_crossings"] > 0
    part, node_part = np.zeros(counts["elements"], int), np.zeros(counts["nodes"], int)
    one, none = (
        Slice(bolted.core, np.array(elements, int), part, node_part, 0)
        for elements in (range(8, 16), [])
    )
    assert one.keep["bolts"].tolist() == [1] and not len(none.keep["bolts"])
    own, whole = one.state()["bolts.axial_force"], bolted.core.fields()["bolts.axial_force"]
    assert (own == whole[one.keep["bolt_nodes"]]).all() and 0 < len(own) < len(whole)
    hosts = one.model()["bolts.hosts"]
    assert len(hosts) == 8 * len(one.keep["bolt_points"]) and (hosts < len(one.keep["nodes"])).all()
    assert one.counts()["bolts.corner_first"] == 4 * len(one.keep["quads"])
    assert core_of(bolted, one).run(1)[0] == "steps_done"


def test_wet_faces_keep_their_pairs(bolted):
    counts = counts_of(bolted.core)
    parts = np.zeros(counts["elements"], int), np.zeros(counts["nodes"], int)
    kept = Slice(bolted.core, np.arange(8, 16), *parts, 0)
    pair, whole = kept.model()["wet_quads.pair"], bolted.core.model()["wet_quads.pair"]
    before = whole[kept.keep["wet_quads.pairs"]]
    assert len(pair) and (pair % 3 == before % 3).all()
    assert (kept.keep["quads"][pair // 3] == before // 3).all() and (pair != before).any()


def test_references_that_own_rows_lose_are_counted(sim, slices):
    assert all(lost(sim.core, kept) == {} for kept in slices)
    along = rows_of(sim.core, "node.motion").position[:, 0] > 10
    counts = counts_of(sim.core)
    right = along[rows_of(sim.core, "tet4.nodes").numbers].all(axis=1)
    part = np.concatenate([right, np.zeros(counts["hex8"], bool)]).astype(int)
    own = part == 1
    assert own.sum() < len(with_ghosts(sim.core, own, 1)) < len(with_ghosts(sim.core, own, 2))
    node_part = along.astype(int)
    found = lost(sim.core, Slice(sim.core, np.flatnonzero(own), part, node_part, 1))
    assert {"corner.first", "search.across", "outer.slot_first"} <= set(found)
    assert min(found.values()) > 0 and not {"face.nodes", "edge.nodes", "tet4.nodes"} & set(found)
