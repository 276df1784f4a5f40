"""What rules the step is named, and what would help."""

from __future__ import annotations

import pytest
from scenes import case, irregular_tets

import cdem
from cdem.model.ruling_step import remedy, ruling_step

STRONG = {"friction_angle": 30, "cohesion": 1e12, "tensile_strength": 1e12}
BOX = {"size": [2, 2, 2], "divisions": [2, 2, 2], "shape": "tet4"}


def start(blocks, groups, **more):
    return cdem.Simulation(case(blocks, groups, **more), threads=1)


def test_elements_rule_where_nothing_holds_and_nothing_touches():
    sim = start([{"group": "rock", "box": BOX}], {"rock": {}})
    ruling = ruling_step(sim.build)
    assert ruling.rules == "element"
    assert ruling.shares["element"] > 0.99
    assert ruling.words().startswith("elements of rock at ")
    assert sim.audit.step["words"] == ruling.words()
    assert sim.audit.step["words"] in sim.audit.text()


def test_stiff_bonds_rule_and_may_be_softer():
    stiff = {"default": STRONG | {"stiffness_n": "100 E/h", "stiffness_s": "100 E/h"}}
    sim = start(
        [{"group": "rock", "box": BOX}],
        {"rock": {}},
        interfaces=stiff,
        model={"split": {"rock": "elements"}},
    )
    ruling = ruling_step(sim.build)
    assert ruling.rules == "bond"
    dt = float(sim.core.scalars()["dt"])
    # without bonds the step would be that of the elements
    assert remedy(sim.build, ruling, dt) == (
        f"softer bonds would make it up to {ruling.shares['element'] ** -0.5:.2g} times as long: "
        "stiffness_n, stiffness_s"
    )


def test_contacts_rule_and_may_be_softer():
    cube = {"size": [1, 1, 1]}
    sim = start(
        [{"group": "a", "box": cube}, {"group": "b", "box": cube, "translate": [0, 0, 1]}],
        {"a": {}, "b": {}},
    )
    ruling = ruling_step(sim.build)
    assert ruling.rules == "contact"
    assert ruling.place[2] == 1
    assert "contact_stiffness: {overlap: 1e-3}" in sim.audit.step["remedy"]


def test_a_little_mass_is_the_first_remedy_of_an_irregular_mesh(tmp_path):
    mesh = irregular_tets(tmp_path / "m.vtk", [4, 4, 4], [4, 4, 4])
    model = {**mesh, "split": {"default": "elements"}}
    more = {"defaults": True, "model": model, "interfaces": {"default": STRONG}}
    free = start([], {"default": {}}, **more)
    said = free.audit.step["remedy"]
    assert said.startswith("0.1 % more mass would make it ")
    promised = float(said.split("make it ")[1].split(" s")[0])
    scaled = start([], {"default": {}}, time={"mass_scaling": {"most": 0.001}}, **more)
    assert float(scaled.core.scalars()["dt"]) == pytest.approx(promised, rel=0.01)
    assert scaled.audit.step["remedy"] == ""
