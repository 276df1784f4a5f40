"""Cases with and without `cdem:`, and what `cdem: 1` stood for as keys."""

from __future__ import annotations

import pytest
from scenes import plain

from cdem import Case
from cdem.case.stored import MARKER, renewed
from cdem.errors import CaseError

CASE = {
    "model": {"blocks": [{"group": "a", "box": {"size": [1, 1, 1]}}]},
    "materials": {"rock": {"density": 2500, "young_modulus": 1e10, "poisson_ratio": 0.2}},
    "groups": {"a": {"material": "rock"}},
    "interfaces": {"default": {"friction_angle": 30}},
    "stages": [
        {"name": "rest", "mode": "static"},
        {"name": "fall", "mode": "dynamic", "duration": 1},
        {"name": "own", "mode": "static", "relax": "kinetic", "damping": {"contact": 0.3}},
    ],
}
TETS = {"model": {"blocks": [{"group": "a", "box": {"size": [1, 1, 1], "shape": "tet4"}}]}}
PAIR = {"between": ["a", "a"], "friction_angle": 20}
FILE = """\
title: old
cdem: 1
model: {blocks: [{group: a, box: {size: [1, 1, 1], shape: tet4}}]}
materials: {rock: {density: 2500, young_modulus: 1e10, poisson_ratio: 0.2}}
groups: {a: {material: rock}}
interfaces: {pairs: [{between: [a, a], friction_angle: 30}]}
stages:
  - {name: rest, mode: static}
  - {name: fall, mode: dynamic, duration: 1}
"""


@pytest.mark.parametrize("version", [{"cdem": 2}, {}])
def test_what_a_case_leaves_out_does_not_depend_on_its_version(version):
    case = Case.from_dict(CASE | version)
    rest, fall, own = case.stages
    assert (rest.relax, rest.damping.local, rest.damping.contact) == ("solve", 0.0, 0.0)
    assert (fall.relax, fall.damping.local, fall.damping.contact) == (None, 0.0, 0.1)
    assert (own.relax, own.damping.local, own.damping.contact) == ("kinetic", 0.0, 0.3)
    assert case.moved_masses == "lumped-while-bonded"


def test_an_old_case_is_told_once_which_keys_it_has_to_write(tmp_path):
    (tmp_path / "slope.yaml").write_text(FILE)
    with pytest.raises(CaseError) as error:
        Case.load(tmp_path / "slope.yaml")
    assert str(error.value) == (
        f"{tmp_path}/slope.yaml:2:1: cdem: 1 is no longer supported; remove it, and for the same results write "
        "stages.0.relax: local; stages.1.damping.contact: 0; elements.mass: exact; "
        "interfaces.pairs.0.stiffness_n: 10.0 E/h; interfaces.pairs.0.stiffness_s: 10.0 E/h; "
        "model.blocks.0.box.cells: alike"
    )


def test_an_old_case_that_says_all_itself_has_nothing_to_write():
    with pytest.raises(
        CaseError, match=r"^case: cdem: 1 is no longer supported; remove it; the case gives all"
    ):
        Case.from_dict(plain(CASE) | {"cdem": 1})


@pytest.mark.parametrize("old", ["stages:", "title: old", "model: {", "groups: {a"])
def test_an_old_case_that_is_wrong_besides_is_told_both(tmp_path, old):
    (tmp_path / "slope.yaml").write_text(FILE.replace(old, "elements: 5\nwater: x\n" + old))
    with pytest.raises(CaseError, match=r"cdem: 1 is no longer supported") as error:
        Case.load(tmp_path / "slope.yaml")
    assert "elements: must be a mapping" in str(error.value)


@pytest.mark.parametrize(
    "more",
    [
        {},
        TETS,
        {"interfaces": {"pairs": [PAIR]}},
        {"interfaces": {"default": {"friction_angle": 5}, "pairs": [PAIR]}},
        {"elements": {"hexahedra": "one-point"}},
        {"elements": {"mass": "lumped"}},
    ],
)
def test_an_old_case_is_the_plain_one_of_the_tests(more):
    written = Case.from_dict(renewed(CASE | more | {"cdem": 1}))
    assert written.model_dump() == Case.from_dict(plain(CASE | more)).model_dump()


@pytest.mark.parametrize(
    ("interfaces", "written"),
    [
        ({"default": {"stiffness_n": "5 E/h"}}, {"default": {"stiffness_n": "5 E/h"}}),
        (
            {"default": {"stiffness_n": 1e9}, "pairs": [{"stiffness_n": "auto"}]},
            {
                "default": {"stiffness_n": 1e9},
                "pairs": [{"stiffness_n": "10.0 E/h", "stiffness_s": "10.0 E/h"}],
            },
        ),
        ({}, {}),
    ],
)
def test_stiffness_is_written_where_it_was_left_to_the_program(interfaces, written):
    """One that is given alone leaves 10 E/h to the other in any case."""
    assert renewed({"cdem": 1, "interfaces": interfaces})["interfaces"] == written


def test_the_case_beside_results_is_read_as_it_was_run(tmp_path):
    path = tmp_path / "case.yaml"
    path.write_text(FILE)
    (tmp_path / MARKER).touch()
    case = Case.load(path)
    assert (case.cdem, case.stages[0].relax, case.moved_masses) == (2, "local", "exact")
    assert case.model.blocks[0].box.cells == "alike"


def test_cells_are_of_tets():
    box = {"size": [1, 1, 1], "cells": "alike"}
    with pytest.raises(CaseError, match="cells is of shape: tet4; other shapes have one division"):
        Case.from_dict(CASE | {"model": {"blocks": [{"group": "a", "box": box}]}})
