"""The list of arrays is right: lengths, indices, and what a checkpoint keeps."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from golden_scenes import SCENES

from cdem._native import core as native
from cdem.run.restored import fault_of, references


@pytest.fixture(scope="module", params=["rubble", "hand_over", "elements", "bonded"])
def sims(request):
    """Simulations of one golden scene after their run."""
    done = SCENES[request.param](1)
    return done if isinstance(done, list) else [done]


def arrays_of(sim):
    """Every array, by where it comes from."""
    core = sim.core
    return {"given": core.model(), "stored": core.fields(), "rebuilt": core.rebuilt()}


def counts_of(sim):
    """How many rows there are of each kind."""
    return {kind["name"]: kind["count"] for kind in sim.core.describe_rows()}


def test_every_array_is_described_once_and_in_words(sims):
    infos = sims[0].core.describe()
    names = [info["name"] for info in infos]
    assert len(set(names)) == len(names)
    for info in infos:
        assert info["meaning"] and info["unit"], info["name"]
        assert (info["rebuilt_by"] != "") == (info["origin"] == "rebuilt"), info["name"]
    for origin, arrays in arrays_of(sims[0]).items():
        assert list(arrays) == [i["name"] for i in infos if i["origin"] == origin]


def test_every_length_is_rows_times_numbers_and_every_index_has_a_row(sims):
    checked = 0
    for sim in sims:
        counts, arrays = counts_of(sim), arrays_of(sim)
        for info in sim.core.describe():
            array = arrays[info["origin"]][info["name"]]
            assert fault_of(info, array, counts) == "", info["name"]
            if len(array):
                checked += sum(len(index) for _, index in references(info, array, counts))
    assert checked > 1000


def test_what_is_wrong_with_an_array_is_found(sims):
    """The same check guards what comes from a checkpoint."""
    sim = sims[0]
    counts, stored = counts_of(sim), sim.core.fields()
    found = {}
    for info in sim.core.describe():
        if info["origin"] != "stored" or not len(array := stored[info["name"]]):
            continue
        if info["rows"]:
            assert "numbers, not" in fault_of(info, array[:-1], counts)
        if any(info["refers_to"]):
            wrong = array.copy()
            wrong[-1] = 2**31 - 1
            found[info["name"]] = fault_of(info, wrong, counts)
    assert {"search.exposed_face", "outer.slot_first", "outer.vf_pairs"} <= set(found)
    padded = {name for name, fault in found.items() if not fault}
    assert padded <= {"outer.vf_pairs", "outer.ee_pairs", "edge.contact"}  # the last is a pad


def test_scalars_and_energies_are_described(sims):
    core = sims[0].core
    assert [info["name"] for info in core.describe_scalars()] == list(core.scalars())
    terms = [term["name"] for term in native.energy_terms()]
    assert [*terms, "start", "error"] == list(core.energies())
    counts = {
        "stored": lambda x: x,
        "lost": lambda x: x,
        "supplied": lambda x: -x,
        "hidden": lambda x: max(x, 0.0),
    }
    for sim in sims:
        energies = sim.energies
        total = sum(counts[term["kind"]](energies[term["name"]]) for term in native.energy_terms())
        largest = max(abs(energies[name]) for name in terms)
        assert abs(total - energies["start"]) < 0.01 * largest
