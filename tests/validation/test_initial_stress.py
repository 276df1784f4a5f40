"""Rock that begins under stress: at rest, and when its joints slip and are released."""

import numpy as np
import pytest
from scenes import digest

import cdem

PULL = 8.0  # along the bed [m/s2]
FRICTION = 30  # [deg]


def slider(cells, bed, pull=PULL, friction=FRICTION, **more):
    """A cube on a held bed, pressed on it by its weight from the start, then pulled along."""
    boxes = {"bed": ([6, 3, 1], bed, [-2, -1, -1]), "cube": ([1, 1, 1], cells, [0, 0, 0])}
    return cdem.Simulation(
        cdem.Case.from_dict(
            {
                "model": {
                    "blocks": [
                        {
                            "group": name,
                            "box": {"size": size, "divisions": divisions},
                            "translate": place,
                        }
                        for name, (size, divisions, place) in boxes.items()
                    ]
                },
                "materials": {
                    "rock": {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.2}
                },
                "groups": {
                    "bed": {"material": "rock", "fix": ["x", "y", "z"]},
                    "cube": {"material": "rock"},
                },
                "interfaces": {"default": {"friction_angle": friction}},
                "loads": {"gravity": [pull, 0, -10]},
                "initial_stress": [
                    {"groups": ["cube"], "stress": [0, 0, -25e3, 0, 0, 0],
                     "gradient": {"z": [0, 0, 25e3, 0, 0, 0]}},
                    {"groups": ["bed"], "stress": [0, 0, -25e3, 0, 0, 0]},
                ],
                "stages": [{"name": "slide", "mode": "dynamic", "duration": 0.3}],
                "output": {"every": 0.1},
            }
        ),
        **{"threads": 1, **more},
    )  # fmt: skip


def crossed(bars):
    """A bar across a held one, pressed on it from the start by more than it weighs: it comes up."""
    return cdem.Simulation(
        cdem.Case.from_dict(
            {
                "model": {
                    "blocks": [
                        {"group": name, "box": {"size": size}, "translate": place}
                        for name, (size, place) in bars.items()
                    ]
                },
                "materials": {"rock": {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.2}},
                "groups": {
                    "low": {"material": "rock", "fix": ["x", "y", "z"]},
                    "high": {"material": "rock"},
                },
                "interfaces": {"default": {"friction_angle": 0}},
                "loads": {"gravity": [0, 8, -10]},
                "initial_stress": [
                    {"groups": ["high"], "stress": [0, 0, -75e3, 0, 0, 0],
                     "gradient": {"z": [0, 0, 75e3, 0, 0, 0]}},
                    {"groups": ["low"], "stress": [0, 0, -75e3, 0, 0, 0]},
                ],
                "stages": [{"name": "slide", "mode": "dynamic", "duration": 0.3}],
            }
        ),
        threads=1,
    )  # fmt: skip


def forces_about_a_release(sim, group, pull):
    """Force on a group one step before its bonds are released and one after [N], and the contacts.

    It is the change of momentum less the weight; that of the release has the change of masses in it.
    """
    nodes = sim.build.nodes_of(group)
    mass = sim.build.arrays["node.mass"][nodes]

    def force():
        before = mass @ sim.fields["velocity"][nodes]
        sim.step(1)
        change = mass @ sim.fields["velocity"][nodes] - before
        return change / sim.core.scalars()["dt"] + mass.sum() * np.array([-pull, 0, 10])

    def bonded():
        state = sim.core.fields()
        return state["quads.status"].sum() + state["overlaps.status"].sum()

    start, released = bonded(), force()
    while bonded() == start:
        before, released = released, force()
    contacts = sim.contacts
    after = force()
    assert abs(sim.energies["error"]) < 3e-4
    return before, after, contacts


def motion(sim):
    """Mean displacement and velocity of the cube."""
    nodes = sim.build.nodes_of("cube")
    mass = sim.build.arrays["node.mass"][nodes] / sim.build.arrays["node.mass"][nodes].sum()
    moved = sim.fields["position"][nodes] - sim.build.start_position[nodes]
    return mass @ moved, mass @ sim.fields["velocity"][nodes]


@pytest.mark.parametrize(
    ("cells", "bed"),
    [([1, 1, 1], [6, 3, 1]), ([2, 2, 2], [6, 3, 1]), ([2, 2, 2], [5, 4, 1])],
    ids=["conforming", "finer", "overlapping"],
)
def test_a_joint_that_begins_loaded_slips_and_becomes_contacts(cells, bed):
    """a = g_x - (g_z + a_z) tan(phi) from 0.1 to 0.3 s; its release is no jolt."""
    sim = slider(cells, bed)
    sim.run_until(0.1)
    start, (_, before) = sim.time, motion(sim)
    sim.run()
    away, now = motion(sim)
    gained = (now - before) / (sim.time - start)
    exact = PULL - (10 + gained[2]) * np.tan(np.radians(FRICTION))
    assert gained[0] == pytest.approx(exact, rel=0.05)
    assert abs(away[2]) < 5e-4
    assert abs(sim.energies["error"]) < 3e-4


@pytest.mark.parametrize("friction", [0, 20])
@pytest.mark.parametrize(
    ("cells", "bed"),
    [
        ([1, 1, 1], [6, 3, 1]),
        ([2, 2, 2], [6, 3, 1]),
        ([2, 2, 2], [5, 4, 1]),
        ([1, 1, 1], [5, 4, 1]),
    ],
    ids=["conforming", "finer", "overlapping", "coarse"],
)
def test_a_release_hands_over_what_presses_the_faces(cells, bed, friction):
    """Contacts bear at once what the bonds did, pressure and friction, and no energy comes of it.

    The force on the cube is the change of its momentum. Where the cube swings it changes by 3 %, or
    with friction by 8 %, from step to step.
    """
    before, after, _ = forces_about_a_release(slider(cells, bed, friction=friction), "cube", PULL)
    assert after[2] == pytest.approx(before[2], rel=0.03 if friction == 0 else 0.06)
    assert -after[0] == pytest.approx(np.tan(np.radians(friction)) * after[2], rel=1e-4, abs=0.02)


def test_edges_of_crossed_bars_take_what_their_bond_bore():
    """Two bars that cross have no vertex on each other: their contacts are four pairs of edges.

    They are a little apart when they are released.
    """
    bars = {"low": ([1.3, 1, 1], [-0.65, -0.5, -1]), "high": ([1, 1.3, 1], [-0.5, -0.65, 0])}
    before, after, contacts = forces_about_a_release(crossed(bars), "high", 0)
    assert set(contacts["kind"]) == {1}
    assert len(contacts["kind"]) == 8
    # bars that swing: the force falls by 3 % from step to step
    assert contacts["force_n"].sum() == pytest.approx((before + after)[2] / 2, rel=0.05)


def test_nothing_slips_below_the_friction_angle():
    """At a sixth of the pull that friction bears the cube stays, and no energy is lost."""
    sim = slider([2, 2, 2], [6, 3, 1], pull=1)
    sim.run()
    assert np.abs(motion(sim)[0]).max() < 1e-4
    assert sim.energies["friction"] < 1e-3


def test_threads_and_a_stop_give_identical_results(tmp_path):
    whole = slider([2, 2, 2], [5, 4, 1], output=tmp_path / "whole")
    whole.run()
    other = slider([2, 2, 2], [5, 4, 1], threads=3)
    other.run()
    assert digest(other) == digest(whole)
    asked = iter([False, True])
    broken = slider([2, 2, 2], [5, 4, 1], output=tmp_path / "broken")
    assert broken.run(should_stop=lambda: next(asked)) == "stopped"
    resumed = slider([2, 2, 2], [5, 4, 1], output=tmp_path / "broken", resume=True)
    resumed.run()
    assert digest(resumed) == digest(whole)
