"""The list of arrays is right: lengths, indices, and what a checkpoint keeps."""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from golden_scenes import SCENES

from cdem._native import core as native


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


def length_of(info, counts):
    """Numbers that an array holds as its description has it."""
    count = counts[info["rows"]]
    if info["layout"] == "starts":
        return count + 1
    if info["layout"] == "columns":
        count = native.padded_stride(count)
    return count * info["numbers"]


def table_of(info, array, counts):
    """An array as rows of numbers, without padding; starts have one row more."""
    numbers = info["numbers"]
    if info["layout"] == "columns":
        return array.reshape(numbers, -1)[:, : counts[info["rows"]]].T
    return array.reshape(-1, numbers)


def test_every_array_is_described_once_and_in_words(sims):
    infos = sims[0].core.describe()
    names = [info["name"] for info in infos]
    assert len(set(names)) == len(names)
    for info in infos:
        assert info["meaning"] and info["unit"], info["name"]
        assert (info["rebuilt_by"] != "") == (info["origin"] == "rebuilt"), info["name"]
    for origin, arrays in arrays_of(sims[0]).items():
        assert list(arrays) == [i["name"] for i in infos if i["origin"] == origin]


def test_every_length_is_rows_times_numbers(sims):
    for sim in sims:
        counts, arrays = counts_of(sim), arrays_of(sim)
        for info in sim.core.describe():
            length = len(arrays[info["origin"]][info["name"]])
            if not info["rows"]:
                continue  # a list with a length of its own
            may_be_empty = info["optional"] or info["origin"] == "rebuilt"
            if length > 0 or not may_be_empty:
                assert length == length_of(info, counts), info["name"]


def test_every_index_refers_to_a_row_that_exists(sims):
    checked = 0
    for sim in sims:
        counts, arrays = counts_of(sim), arrays_of(sim)
        for info in sim.core.describe():
            array = arrays[info["origin"]][info["name"]]
            kinds = [k for k in info["refers_to"] if k]
            if not kinds or len(array) == 0:
                continue
            table = table_of(info, array, counts) if info["rows"] else array[:, None]
            one_for_all = len(kinds) == 1 and info["refers_to"][0] == kinds[0]
            for column in range(table.shape[1]):
                kind = kinds[0] if one_for_all else info["refers_to"][column]
                index = table[:, column]
                checked += len(index)
                if not kind or len(index) == 0:
                    continue
                if info["layout"] == "starts":
                    assert index[0] == 0 and (np.diff(index) >= 0).all(), info["name"]
                    assert index[-1] == counts[kind], info["name"]
                    continue
                if info["opposite"]:
                    index = np.where(index < 0, ~index, index)
                least = 0 if info["opposite"] else -1
                assert index.min() >= least and index.max() < counts[kind], info["name"]
    assert checked > 1000


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
