"""Mass added for a longer step: what each node needs, no more than was allowed, fixed at the start."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import case, irregular_tets

import cdem
from cdem.errors import CaseError
from cdem.model import assemble, mass_scaling
from cdem.model.interfaces import that_may_break
from cdem.model.masses import one_element_blocks

STRONG = {"friction_angle": 30, "cohesion": 1e12, "tensile_strength": 1e12}
WEAK = {"friction_angle": 30, "cohesion": 10, "tensile_strength": 10}
HEX = {"size": [2, 2, 2], "divisions": [2, 2, 2]}
JOINTS = [{"name": "flat", "dip": 30, "dip_direction": 90, "spacing": 0.7, "origin": [0, 0, 0.1]}]


def shaken(path, *, interface=STRONG, **more):
    """Bonded tets whose corners are shaken, in a cube of 4 cells; nothing damps."""
    model = {
        **irregular_tets(path / "m.vtk", [4, 4, 4], [4, 4, 4]),
        "split": {"default": "elements"},
    }
    stages = [{"name": "run", "mode": "dynamic", "duration": 1, "damping": {"contact": 0}}]
    return case(
        [],
        {"default": {}},
        model=model,
        interfaces={"default": interface},
        **{"stages": stages} | more,
    )


def jointed(**more):
    """Blocks of a few tets each, cut by joints."""
    block = {"group": "rock", "box": {"size": [1, 1, 3]}}
    return case(
        [block], {"rock": {}}, model={"joints": JOINTS}, interfaces={"default": STRONG}, **more
    )


def mixed():
    """Bonds of triangles, quadrilaterals and faces that do not conform."""
    return case(
        [
            {"group": "a", "box": HEX},
            {"group": "a", "box": HEX | {"shape": "tet4"}, "translate": [2, 0, 0]},
            {"group": "a", "box": {"size": [3, 2, 1]}, "translate": [0.5, 0, 2]},
        ],
        {"a": {}}, model={"split": {"a": "elements"}}, interfaces={"default": STRONG},
    )  # fmt: skip


def test_bonds_are_as_stiff_as_the_core_has_them(monkeypatch):
    found = []
    whole = mass_scaling.bond_stiffness
    monkeypatch.setattr(
        mass_scaling, "bond_stiffness", lambda *of: found.append(whole(*of)) or found[-1]
    )
    sim = cdem.Simulation(mixed(), threads=1)
    assert all(sim.build.assembly.counts[f"{k}.count"] for k in ("triangles", "quads", "overlaps"))
    np.testing.assert_allclose(found[0], sim.core.fields()["node.bond_stiffness"], rtol=1e-13)


@pytest.mark.parametrize(
    ("defaults", "joint", "a", "b"), [(False, 20, 10, 20), (True, 4 / 3, 1, 2)]
)
def test_contacts_of_faces_that_touch_and_of_others(monkeypatch, defaults, joint, a, b):
    """Two cubes on each other, b twice as stiff. A corner has three faces of which each may have four
    contacts on a quarter of its area, and as many that act on it: 2 k / 4. The joint has k of its
    stiffer side, where bonds are given, or of both in series, the other faces that of a contact with their like.
    """
    found = []
    whole = mass_scaling.contact_stiffness
    monkeypatch.setattr(
        mass_scaling, "contact_stiffness", lambda *of: found.append(whole(*of)) or found[-1]
    )
    sim = cdem.Simulation(
        case(
            [
                {"group": "a", "box": {"size": [1, 1, 1]}},
                {"group": "b", "box": {"size": [1, 1, 1]}, "translate": [0, 0, 1]},
            ],
            {"a": {}, "b": {"material": "hard"}}, defaults=defaults,
            materials={"rock": {"density": 2500, "young_modulus": 1e10, "poisson_ratio": 0.2},
                       "hard": {"density": 2500, "young_modulus": 2e10, "poisson_ratio": 0.2}},
        ),
        threads=1,
    )  # fmt: skip
    at_joint = sim.build.start_position[:, 2] == 1
    below = sim.build.node_groups() == sim.build.group_names.index("a")
    np.testing.assert_allclose(found[0][at_joint & below], 0.5e10 * (joint + 2 * a), rtol=1e-12)
    np.testing.assert_allclose(found[0][at_joint & ~below], 0.5e10 * (joint + 2 * b), rtol=1e-12)
    core = sim.core.fields()["node.contact_stiffness"]  # of the faces on its list alone
    np.testing.assert_allclose(core[at_joint], 0.5e10 * joint, rtol=1e-12)


@pytest.mark.parametrize("defaults", [False, True])
def test_the_step_asked_for_is_reached(tmp_path, defaults):
    free = cdem.Simulation(shaken(tmp_path, defaults=defaults), threads=1)
    dt = 1.5 * float(free.core.scalars()["dt"])
    sim = cdem.Simulation(
        shaken(tmp_path, defaults=defaults, time={"mass_scaling": {"step": dt}}), threads=1
    )
    # faces at the surface count as if they touched something
    assert dt * (1 - 1e-9) < float(sim.core.scalars()["dt"]) < 1.15 * dt
    added = sim.build.assembly.added_mass
    assert 0 < added.sum() < 0.05 * sim.build.arrays["node.gravity_mass"].sum()
    np.testing.assert_allclose(
        sim.build.arrays["node.mass"], free.build.arrays["node.mass"] + added, rtol=1e-12
    )


def test_blocks_of_a_few_elements_reach_the_step_too():
    free = cdem.Simulation(jointed(), threads=1)
    blocks = free.build.topology
    assert not one_element_blocks(blocks).any()
    assert (free.build.arrays["node.mass_row_first"] >= 0).all()
    dt = 1.5 * float(free.core.scalars()["dt"])
    sim = cdem.Simulation(jointed(time={"mass_scaling": {"step": dt}}), threads=1)
    assert float(sim.core.scalars()["dt"]) >= dt * (1 - 1e-9)


def test_the_step_asked_for_holds_in_rubble(tmp_path):
    """All bonds break at once: every face then has contacts, and every tet its exact inertia."""
    free = cdem.Simulation(shaken(tmp_path, defaults=True), threads=1)
    dt = 2.5 * float(free.core.scalars()["dt"])
    sim, intact = (
        cdem.Simulation(
            shaken(
                tmp_path, defaults=True, interface=interface, time={"mass_scaling": {"step": dt}}
            ),
            threads=1,
        )
        for interface in (WEAK, STRONG)
    )
    assert sim.build.assembly.added_mass.sum() > 1.5 * intact.build.assembly.added_mass.sum()
    velocity = sim.motion[:, 4:7]
    velocity += np.random.default_rng(1).uniform(-0.5, 0.5, velocity.shape)
    steps = []
    while sum(sim.broken.values()) < 0.95 * 3 * sim.audit.counts["bonded_pairs"]:
        sim.step(20)
        steps.append(float(sim.core.scalars()["dt"]))
        assert len(steps) < 100
    sim.step(20)
    assert float(sim.core.scalars()["dt"]) >= dt * (1 - 1e-9)
    assert min(steps) >= dt * (1 - 1e-9)


def test_bonds_break_that_any_stage_weakens():
    def breaks(**stage):
        interfaces = {"default": STRONG, "pairs": [{"between": ["rock", "rock"], **STRONG}]}
        stages = [{"name": "a", "mode": "dynamic", "duration": 1, **stage}]
        made = jointed()
        made.interfaces = interfaces
        made.stages = stages
        return that_may_break(made).tolist()

    assert breaks() == [False, False]
    assert breaks(set={"interfaces.default.cohesion": "1 MPa"}) == [False, True]
    assert breaks(set={"interfaces.pairs.0.tensile_strength": "99 MPa"}) == [True, False]


@pytest.mark.parametrize("of", ["single elements", "blocks of several"])
def test_a_step_that_mass_allows_is_the_longest_for_which_it_suffices(monkeypatch, tmp_path, of):
    found = []
    monkeypatch.setattr(
        assemble, "Scaling", lambda *of: found.append(mass_scaling.Scaling(*of)) or found[-1]
    )
    made = shaken(tmp_path, defaults=True) if of == "single elements" else jointed()
    sim = cdem.Simulation(made, threads=1)
    scaling, intact = found[0], found[0]._states[0]
    for mass in (0.0, 1.0):  # of what 1.3 times the step needs
        added = mass * scaling.added(1.3 * sim.build.assembly.limits[0])
        limit = scaling.limit_at_the_start(added)
        assert (intact.added(0.9999999 * limit) <= added).all()
        assert not (intact.added(1.0000001 * limit) <= added).all()
    assert limit > 1.2 * sim.build.assembly.limits[0]


def test_no_more_mass_is_added_than_was_allowed(tmp_path):
    free = cdem.Simulation(shaken(tmp_path, defaults=True), threads=1)
    sim = cdem.Simulation(
        shaken(tmp_path, defaults=True, time={"mass_scaling": {"most": 0.001}}), threads=1
    )
    whole = free.build.arrays["node.mass"].sum()
    assert sim.build.assembly.added_mass.sum() == pytest.approx(0.001 * whole, rel=1e-6)
    dt, before = (float(s.core.scalars()["dt"]) for s in (sim, free))
    assert dt / before == pytest.approx(
        free.build.assembly.limits[1] / free.build.assembly.limits[0]
    )
    assert dt > 1.4 * before
    both = shaken(
        tmp_path, defaults=True, time={"mass_scaling": {"most": 0.001, "step": 1.2 * before}}
    )
    assert float(cdem.Simulation(both, threads=1).core.scalars()["dt"]) == pytest.approx(
        1.2 * before
    )


def test_a_stage_that_changes_bonds_keeps_the_masses(tmp_path):
    stages = [
        {"name": "a", "mode": "dynamic", "duration": 1e-5},
        {"name": "b", "mode": "dynamic", "duration": 1e-5,
         "set": {"interfaces.default.stiffness_n": "20 E/h"}},
    ]  # fmt: skip
    sim = cdem.Simulation(
        shaken(tmp_path, stages=stages, time={"mass_scaling": {"most": 0.001}}), threads=1
    )
    masses = sim.build.arrays["node.mass"].copy()
    least = sim.build.arrays["node.least_mass"].copy()
    sim.run()
    np.testing.assert_array_equal(sim.build.arrays["node.mass"], masses)
    np.testing.assert_array_equal(sim.build.arrays["node.least_mass"], least)
    assert abs(sim.energies["error"]) < 1e-9


def test_scaling_that_asks_for_nothing_is_refused(tmp_path):
    with pytest.raises(CaseError, match="give a step to reach, or the most mass to add"):
        shaken(tmp_path, time={"mass_scaling": {}})


def test_a_step_that_takes_boundless_mass_is_refused(tmp_path):
    """5,000 s asked for 1e18 times the mass, whose matrices had no eigenvalues left."""
    case = shaken(tmp_path, defaults=True, time={"mass_scaling": {"step": 5000}})
    with pytest.raises(CaseError, match="is more than 100 times the stable step"):
        cdem.Simulation(case, threads=1)
    bounded = shaken(tmp_path, defaults=True, time={"mass_scaling": {"step": 5000, "most": 0.001}})
    assert cdem.Simulation(bounded, threads=1).core.scalars()["dt"] < 1
