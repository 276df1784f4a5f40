"""Damping of rock by Rayleigh dashpots and Maxwell branches: ratio, energy, rotation, step, bits."""

import numpy as np
import pytest
from scenes import case, digest

import cdem
from cdem.errors import UnstableError
from cdem.model.compliance import bonded_interfaces
from cdem.model.damping import branches_of
from cdem.model.damping_report import rock_dampings
from cdem.rows import rows_of
from cdem.verification.ringing import frequency_and_ratio, size
from cdem.verification.runner import Study, problems

RAYLEIGH = {"rayleigh": {"ratio": 0.1, "frequency": 60}}
MAXWELL = {"maxwell": {"ratio": 0.1, "band": [10, 1000]}}
KINDS = pytest.mark.parametrize("damping", [RAYLEIGH, MAXWELL], ids=["rayleigh", "maxwell"])
SHAPES = ["tet4", "pyramid5", "wedge6", "hex8", "one-point"]
STRONG = {"friction_angle": 30, "cohesion": 1e9, "tensile_strength": 1e9}


def bar(damping, shape="hex8", stages=None, bonds=False, turned=0, **more):
    """A free bar of 4 x 1 x 1 m in one dynamic stage, turned about z by an angle [deg]."""
    box = {"size": [4, 1, 1], "divisions": [4, 1, 1], "shape": shape.replace("one-point", "hex8")}
    elements = {"hexahedra": "one-point"} if shape == "one-point" else {}
    stages = stages or [{"name": "ring", "mode": "dynamic", "duration": 0.1, "damping": damping}]
    return case(
        [{"group": "bar", "box": box, "rotate": {"axis": [0, 0, 1], "angle": turned}}],
        {"bar": {}},
        interfaces={"default": STRONG},
        elements=elements | more.pop("elements", {}),
        stages=stages,
        model={"split": {"bar": "elements" if bonds else "connected"}},
        **more,
    )


def strike(sim, speed=1e-3):
    """Give the nodes random velocities."""
    velocity = rows_of(sim.core, "node.motion").velocity
    velocity[:] = np.random.default_rng(1).uniform(-speed, speed, velocity.shape)


def ring(made, threads=1, steps=600):
    sim = cdem.Simulation(made, threads=threads)
    strike(sim)
    sim.step(steps)
    return sim


@pytest.mark.parametrize("name", ["rayleigh_ratio", "maxwell_ratio"])
def test_the_ratio_of_a_ringing_bar_is_as_asked(name):
    """The verification problems: decrement and frequency by formula."""
    (problem,) = problems([name])
    outcome = problem.run(threads=1)
    assert outcome.passed, [check.texts() for check in outcome.checks if not check.passed]


@pytest.mark.parametrize("shape", ["hex8", "tet4"])
def test_branches_damp_bonded_rock_by_the_share_that_is_told(shape):
    """A ringing bar whose elements are blocks; uniform stress, so 3 %."""
    (problem,) = problems(["maxwell_ratio"])
    study = Study(problem.folder, threads=1)
    split = ["model.split={bar: elements}", "interfaces={default: {cohesion: 1e9, "
             "tensile_strength: 1e9, friction_angle: 30}}"]  # fmt: skip
    sim = study.simulate(size(2000.0, 2.0, shape), *split)
    (told,) = rock_dampings(sim.build, bonded_interfaces(sim.build))
    moves, ratio = frequency_and_ratio(sim, 3, 10)
    branches = branches_of(sim.case.stages[0].damping.maxwell)
    assert told.share < 0.81
    assert ratio == pytest.approx(told.share * branches.ratio(moves), rel=0.03)


@KINDS
@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("bonds", [False, True], ids=["whole", "bonds"])
def test_the_energy_of_damped_rock_closes_at_a_constant_step(damping, shape, bonds):
    """Stored, lost and kinetic energy sum to what there was, but for the strain (1e-5)."""
    sim = ring(bar(damping, shape, bonds=bonds))
    energies = sim.energies
    assert energies["damping"] > 0.2 * energies["start"]
    assert abs(energies["error"]) < 3e-6


@KINDS
def test_the_energy_of_damped_rock_that_flows_closes(damping):
    """Tets with a nodal mean yield in Mohr-Coulomb's law, beside branches or dashpots."""
    soft = {"law": "mohr-coulomb", "cohesion": "20 kPa", "friction_angle": 20, "dilation_angle": 0}
    sim = cdem.Simulation(bar(damping, "tet4", rock=soft), threads=1)
    assert sim.core.model()["tet4.nodal_mean"].any()
    strike(sim, 0.1)
    sim.step(600)
    energies = sim.energies
    assert energies["plastic"] > 0.02 * energies["start"]
    assert energies["damping"] > 0.1 * energies["start"]
    assert abs(energies["error"]) < 1e-7


@KINDS
@pytest.mark.parametrize("shape", SHAPES)
def test_a_turning_block_is_not_damped(damping, shape):
    """Over two turns a block loses less than its centrifugal strain stores, 1e-4 of its energy."""
    sim = cdem.Simulation(bar(damping, shape), threads=1)
    sim.core.set_damping(
        0.0, 0.0, 0.0, 0.0
    )  # without Rayleigh's mass part, which brakes all motion
    x = sim.fields["position"] - sim.fields["position"].mean(axis=0)
    rows_of(sim.core, "node.motion").velocity[:] = np.cross([0, 0, 10.0], x)
    sim.step(int(4 * np.pi / 10 / sim.core.scalars()["dt"]))
    energies = sim.energies
    assert energies["damping"] < 1e-4 * energies["start"]
    assert energies["kinetic"] == pytest.approx(energies["start"], rel=1e-4)


@pytest.mark.parametrize(
    "damping",
    [
        {"rayleigh": {"ratio": 0.2, "frequency": 100}},
        {"maxwell": {"ratio": 0.1, "band": [0.1, 10]}},
    ],
    ids=["rayleigh", "maxwell"],
)
def test_the_limit_of_the_step_is_sharp(damping):
    """A cube of lumped masses rings on at 0.99 of it, and blows up at 1.05."""

    def made(step):
        return case(
            [{"group": "bar", "box": {"size": [1, 1, 1]}}],
            {"bar": {}},
            rock={"poisson_ratio": 0},
            elements={"mass": "lumped"},
            time={"step": step, "energy_error": "any"},
            stages=[{"name": "ring", "mode": "dynamic", "duration": 100, "damping": damping}],
        )

    limit = cdem.Simulation(made("auto")).core.step_limit()[0]
    ring(made(0.99 * limit), steps=20_000)
    with pytest.raises(UnstableError):
        ring(made(1.05 * limit), steps=20_000)


@KINDS
def test_damped_rock_has_the_same_bits_on_all_threads(damping):
    """Tets with bonds between two blocks, on one and on two threads."""
    made = case(
        [
            {"group": name, "box": {"size": [6, 6, 3], "divisions": [12, 12, 6], "shape": "tet4"},
             "translate": [0, 0, z]}
            for name, z in (("low", 0), ("high", 3))
        ],
        {"low": {}, "high": {}},
        interfaces={"default": STRONG},
        stages=[{"name": "ring", "mode": "dynamic", "duration": 1, "damping": damping}],
    )  # fmt: skip
    assert digest(ring(made, 1, 30)) == digest(ring(made, 2, 30))


@KINDS
@pytest.mark.parametrize("shape", ["tet4", "wedge6", "hex8"])
@pytest.mark.parametrize("bonds", [False, True], ids=["whole", "bonds"])
def test_a_bar_that_is_turned_moves_and_loses_as_before(damping, shape, bonds):
    """By 90 degrees about z; to round-off of positions of 4 m. The order of nodes may differ."""
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    found = []
    for turned in (0, 90):
        sim = cdem.Simulation(bar(damping, shape, turned=turned, bonds=bonds), threads=1)
        back = quarter if turned else np.eye(3)
        place, block = sim.fields["position"] @ back, sim.build.topology.node_block
        middle = np.stack([np.bincount(block, x) / np.bincount(block) for x in place.T], 1)[block]
        wave = 0.1 * np.sin((place + 0.3 * middle) @ [[3, 1, 2], [2, 4, 1], [1, 2, 5]])
        rows_of(sim.core, "node.motion").velocity[:] = wave @ back.T
        sim.step(400)
        order = np.lexsort(np.round(np.hstack([place, middle]), 6).T)
        found.append(((sim.fields["displacement"] @ back)[order], sim.energies["damping"]))
    (before, lost), (after, lost_turned) = found
    assert np.abs(before).max() > 1e-5
    # reached 6e-15, and 1.4e-12 with dashpots of bonds of tets
    assert np.abs(after - before).max() < (1e-11 if bonds else 4e-14)
    assert lost_turned == pytest.approx(lost, rel=1e-8 if bonds else 1e-9)


SHAKEN = [
    {"name": "rest", "mode": "static"},
    {"name": "shake", "mode": "dynamic", "duration": 0.03,
     "damping": {"maxwell": {"ratio": 0.05, "band": [1, 100], "reference": 10}}},
    {"name": "ring", "mode": "dynamic", "duration": 0.02, "damping": RAYLEIGH},
    {"name": "on", "mode": "dynamic", "duration": 0.02},
]  # fmt: skip


def shaken():
    """A column of bonded cubes under its weight whose foot shakes from the second stage on."""
    pulse = [[0, 0], [0.005, 1], [0.01, -1], [0.015, 0]]
    foot = {"group": "bar", "box": {"min": [-1, -9, -9], "max": [0.1, 9, 9]}}
    loads = {
        "gravity": [-9.81, 0, 0],
        "supports": [foot | {"fix": ["x", "y", "z"]}],
        "tractions": [
            {"surface": {"group": "bar", "normal": [1, 0, 0]}, "traction": [0, 1e5, 0],
             "history": pulse, "stage": "shake"}
        ],
    }  # fmt: skip
    return bar(None, bonds=True, stages=SHAKEN, loads=loads, output={"frames": False})


def test_branches_go_on_in_a_stage_with_the_same():
    """Two stages move as one of both lengths, to the bit."""

    def ringing(*durations):
        stages = [{"name": f"s{i}", "mode": "dynamic", "duration": duration, "damping": MAXWELL}
                  for i, duration in enumerate(durations)]  # fmt: skip
        sim = cdem.Simulation(bar(None, stages=stages), threads=1)
        strike(sim)
        sim.run()
        return sim

    halves, whole = ringing(0.02, 0.02), ringing(0.04)
    np.testing.assert_array_equal(halves.fields["position"], whole.fields["position"])
    assert halves.energies["error"] == whole.energies["error"]


def test_damping_that_comes_and_goes_keeps_stress_and_energy():
    """Other moduli, other damping and none at all: nothing jumps, and the balance stays closed."""
    sim = cdem.Simulation(shaken(), threads=1)
    sim.run_stage("rest")
    rested = sim.core.stress()["hex8"].copy()
    sim.run_until(sim.time + 1e-9)
    assert sim.core.fields()["rock.moduli"][0] < 0.95
    assert np.abs(sim.core.stress()["hex8"] - rested).max() < 1e-5 * np.abs(rested).max()
    assert sim.core.fields()["hex8.branch"].any()
    sim.run_stage("shake")
    sim.run_until(sim.time + 1e-9)
    assert len(sim.core.fields()["rock.moduli"]) == 0
    fields = sim.core.fields()
    assert len(fields["hex8.branch"]) == 0
    assert fields["hex8.dashpot"].any()
    assert fields["quads.dashpot"].any()
    sim.run()
    assert len(sim.core.fields()["hex8.dashpot"]) == 0
    assert abs(sim.energies["error"]) < 1e-3  # as steps become shorter between stages


@pytest.mark.parametrize("share", [0.2, 0.6, 0.9])
def test_a_run_that_is_stopped_in_a_damped_stage_goes_on_with_the_same_bits(tmp_path, share):
    """Branches, dashpots and moduli are in the checkpoint."""
    whole = cdem.Simulation(shaken(), threads=1, output=tmp_path / "whole run")
    whole.run_stage("rest")
    until = whole.time + share * 0.07
    whole.run()
    folder = tmp_path / "in two"
    first = cdem.Simulation(shaken(), threads=1, output=folder)
    assert first.run(should_stop=lambda: first.time > until) == "stopped"
    second = cdem.Simulation(shaken(), threads=1, output=folder, resume=True)
    assert second.run() == "finished"
    assert digest(second) == digest(whole)
    assert second.energies == whole.energies


@pytest.mark.parametrize("divisions", [2, 3], ids=["mates", "overlaps"])
def test_a_bond_rings_down_by_the_ratio_that_is_asked(divisions):
    """Two stiff cubes on a soft bond: w^2 = 2 k A / m, and a half swing leaves exp(-pi xi / s),
    s^2 = 1 - xi^2. The mass part alone would have half of the ratio.
    """
    k, xi = 1e9, 0.05
    w = np.sqrt(2 * k / 2600)
    blocks = [
        {"group": "bar", "box": {"size": [1, 1, 1], "divisions": [n] * 3}, "translate": [0, 0, z]}
        for n, z in ((2, 0), (divisions, 1))
    ]
    damping = {"rayleigh": {"ratio": xi, "frequency": w / 2 / np.pi}}
    made = case(
        blocks, {"bar": {}}, rock={"young_modulus": "200 GPa", "density": 2600},
        interfaces={"default": STRONG | {"stiffness_n": k, "stiffness_s": k}},
        stages=[{"name": "ring", "mode": "dynamic", "duration": 0.1, "damping": damping}],
    )  # fmt: skip
    sim = cdem.Simulation(made, threads=1)
    upper = sim.fields["position"][:, 2] > 1 + 1e-9
    upper |= np.isin(np.arange(len(upper)), np.flatnonzero(sim.build.topology.node_block == 1))
    velocity = rows_of(sim.core, "node.motion").velocity
    velocity[:, 2] = np.where(upper, 0.01, -0.01)
    mass, opening, turns = sim.fields["mass"], [0.0], []
    while len(turns) < 5:
        sim.step(1)
        z = mass * sim.fields["displacement"][:, 2]
        opening.append(z[upper].sum() / mass[upper].sum() - z[~upper].sum() / mass[~upper].sum())
        if len(opening) > 2 and (opening[-1] - opening[-2]) * (opening[-2] - opening[-3]) < 0:
            turns.append(abs(opening[-2]))
    decrement = np.log(turns[0] / turns[4]) / 4
    assert decrement == pytest.approx(np.pi * xi / np.sqrt(1 - xi**2), rel=0.03)
    assert abs(sim.energies["error"]) < 1e-6
