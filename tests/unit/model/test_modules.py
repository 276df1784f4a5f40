"""Modules: the same list on both sides, and what the build asks of each."""

from pathlib import Path

import numpy as np
import pytest
from scenes import case, simulate

import cdem
from cdem.errors import CaseError
from cdem.model.build import change
from cdem.model.modules import MODULES

ROOT = Path(__file__).parents[3]
BLOCKS = [
    {"group": "a", "box": {"size": [2, 2, 2]}},
    {"group": "b", "box": {"size": [2, 2, 2]}, "translate": [2, 0, 0]},
]
BOLT = {
    "bolt_types": {"bar": {"area": 5e-4, "young_modulus": 2e11, "yield_force": 2e5,
                           "grout": {"stiffness": 1e8, "strength": 2e5}}},
    "bolts": [{"name": "b", "type": "bar", "points": [[0.5, 1, 1], [3.5, 1, 1]]}],
}  # fmt: skip
WATER = {"water": {"reservoir": {"level": 1.5}}, "loads": {"gravity": [0, 0, -9.81]}}


@pytest.fixture(scope="module")
def dry():
    """Two blocks without any module."""
    return simulate(BLOCKS, {"a": {}, "b": {}})


@pytest.mark.parametrize("name", [kind.name for kind in MODULES])
def test_each_module_has_its_files(name):
    for path in (
        f"core/{name}/data.hpp", f"src/cdem/case/{name}_schema.py", f"src/cdem/model/{name}.py",
        f"docs/{name}.md", f"docs/theory/{name}.md", f"tests/validation/test_{name}.py",
    ):  # fmt: skip
        assert (ROOT / path).exists(), path


def test_the_core_has_the_same_modules_in_the_same_order():
    text = (ROOT / "core/model/modules.hpp").read_text()
    listed = text.partition("ModuleList<")[2].partition(">")[0]
    assert listed.lower().split(", ") == [kind.name for kind in MODULES]


def test_what_a_case_lacks_does_nothing(dry):
    nodes = len(dry.fields["mass"])
    for name, module in dry.build.modules.items():
        assert len(module.corner_nodes()) == len(module.joined_blocks()) == 0
        np.testing.assert_array_equal(module.node_stiffness(nodes), np.zeros(nodes))
        report = module.report(dry.build)
        assert not report and module.lines(report) == [] and dry.audit.as_dict()[name] == report
        assert not any(key.startswith(name) for key in dry.build.assembly.counts)


def test_bolts_have_corner_rows_after_those_of_pairs(dry):
    bolted = simulate(BLOCKS, {"a": {}, "b": {}}, **BOLT).build
    bolts, counts = bolted.modules["bolts"], bolted.assembly.counts
    nodes = bolts.corner_nodes()
    assert counts["bolts.corner_first"] == dry.build.assembly.counts["corner_rows"]
    assert counts["corner_rows"] - counts["bolts.corner_first"] == len(nodes)
    stiffness = bolts.node_stiffness(len(bolted.start_position))
    assert (np.flatnonzero(stiffness) == np.unique(nodes[nodes >= 0])).all()
    assert bolts.joined_blocks().tolist() == [[0, 1]]


@pytest.mark.parametrize("first, then", [(WATER, {}), ({}, WATER)], ids=["less", "more"])
def test_a_stage_does_not_make_other_faces_wet(first, then):
    """An error, not water that goes on where the case has none any more."""
    gravity = {"loads": WATER["loads"]}
    built = cdem.Simulation(case(BLOCKS, {"a": {}, "b": {}}, **(gravity | first)), threads=1).build
    other = case(BLOCKS, {"a": {}, "b": {}}, **(gravity | then))
    built.case = other
    with pytest.raises(
        CaseError, match=r"a stage cannot change the set of joints and faces that may be wet"
    ):
        change(built)
