"""The compiled core: what it takes, what it says of its arrays, what type checkers see."""

import subprocess
import sys
from pathlib import Path

import pytest
from scenes import simulate

from cdem import _native

TOOL = Path(__file__).parents[2] / "tools/core_stub.py"


@pytest.mark.skipif(_native.device != "cpu", reason="the emulated device has functions of its own")
def test_the_stub_is_that_of_the_core():
    pytest.importorskip("nanobind", reason="needs the extra 'laws'")
    done = subprocess.run(
        [sys.executable, TOOL, "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def sims():
    """Two blocks: dry, and in water with a bolt through them."""
    blocks = [
        {"group": "a", "box": {"size": [2, 2, 2]}},
        {"group": "b", "box": {"size": [2, 2, 2]}, "translate": [2, 0, 0]},
    ]
    bolt = {
        "bolt_types": {"bar": {"area": 5e-4, "young_modulus": 2e11, "yield_force": 2e5,
                               "grout": {"stiffness": 1e8, "strength": 2e5}}},
        "bolts": [{"name": "b", "type": "bar", "points": [[0.5, 1, 1], [3.5, 1, 1]]}],
        "water": {"reservoir": {"level": 1.5}}, "loads": {"gravity": [0, 0, -9.81]},
    }  # fmt: skip
    return [simulate(blocks, {"a": {}, "b": {}}, **more) for more in ({}, bolt)]


def test_parts_of_a_row_are_all_its_numbers_with_a_unit_each(sims):
    described = [info for info in sims[1].core.describe() if info["parts"]]
    assert len(described) > 20
    for info in described:
        names = [name for name, _ in info["parts"]]
        assert info["numbers"] in (0, sum(numbers for _, numbers in info["parts"])), info["name"]
        assert len(info["unit"].split(", ")) in (1, len(names)), info["name"]
        named = [name for name in names if name]
        assert len(set(named)) == len(named) and "numbers" not in named, info["name"]


def given(sim, *without):
    """A fresh core, and the arrays that one has but those whose names begin so."""
    core = _native.core.Core()
    core.take_counts(sim.build.assembly.counts)
    arrays = {k: v.copy() for k, v in sim.core.model().items() if not k.startswith(without)}
    return core, arrays


def test_a_module_that_a_case_lacks_has_no_arrays(sims):
    dry, wet = sims
    assert not any(key.startswith(("bolts.", "wet_")) for key in dry.build.assembly.counts)
    lacking = [key for key in dry.build.arrays if key.startswith(("bolts.", "water.", "wet_"))]
    assert len(lacking) > 30 and not any(dry.build.arrays[key].size for key in lacking)
    core, arrays = given(wet, "water.", "wet_")
    core.take_model(arrays)
    assert core.model()["bolts.hosts"].size and not core.model()["water.fields"].size


@pytest.mark.parametrize("name", ["bolts.hosts", "water.fields", "face.area", "node.least_mass"])
def test_an_array_that_is_missing_is_our_own_mistake(sims, name):
    core, arrays = given(sims[1], name)
    with pytest.raises(KeyError, match=name):
        core.take_model(arrays)


def test_a_stage_hands_over_no_array_that_never_changes(sims):
    core, arrays = sims[0].core, sims[0].build.arrays
    core.update_model({"face.area": arrays["face.area"].copy()})
    for name in ("edge.nodes", "no.such"):
        with pytest.raises(KeyError, match=r"an array that no stage may change"):
            core.update_model({name: arrays["edge.nodes"].copy()})
