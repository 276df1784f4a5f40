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
            }
        ),
        **{"threads": 1, **more},
    )  # fmt: skip


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
    """a = g_x - g_z tan(phi) from 0.1 to 0.3 s; its release is no jolt."""
    sim = slider(cells, bed)
    sim.run_until(0.1)
    start, (_, before) = sim.time, motion(sim)
    sim.run()
    away, now = motion(sim)
    exact = PULL - 10 * np.tan(np.radians(FRICTION))
    assert (now - before)[0] / (sim.time - start) == pytest.approx(exact, rel=0.05)
    assert abs(away[2]) < 5e-4
    assert abs(sim.energies["error"]) < 3e-4


def test_a_release_hands_over_what_presses_the_faces():
    """Without friction nothing rocks the cube: contacts press with its weight at once, less what
    vertices bore that have left the footprint (a quarter)."""
    sim = slider([1, 1, 1], [6, 3, 1], friction=0)
    pairs = sim.build.assembly.counts["quads.count"]
    while sim.core.fields()["quads.status"][:pairs].any():
        sim.step(1)
    sim.step(1)
    assert sim.contacts["force_n"].sum() == pytest.approx(25e3, rel=0.3)


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
