"""Blocks of tets that flow, with the dilatation averaged at their nodes: rest, energies, bits, the step."""

import numpy as np
import pytest
from scenes import case, digest, momentum, simulate

import cdem

ROCK = {
    "law": "mohr-coulomb",
    "young_modulus": "1 GPa",
    "cohesion": "1 MPa",
    "friction_angle": 30,
    "dilation_angle": 10,
}
FLOOR = {"surface": {"group": "rock", "normal": [0, 0, -1]}, "fix": ["z"]}
WALLS = [
    {"surface": {"group": "rock", "normal": [s * (a == "x"), s * (a == "y"), 0]}, "fix": [a]}
    for a in "xy" for s in (-1, 1)
]  # fmt: skip


def box(divisions=(2, 2, 2), shape="tet4", size=(1, 1, 1)):
    """A box in the group rock."""
    return [{"group": "rock", "box": {"size": size, "divisions": divisions, "shape": shape}}]


@pytest.mark.parametrize("water", [None, {"reservoir": {"level": 8}}], ids=["dry", "wet"])
def test_initial_stress_stays_in_equilibrium(water):
    """A column under its weight and k0, or the same with pores full of water, does not move."""
    pores = {"water": water} if water else {}
    sim = simulate(
        box((3, 3, 5), size=[4, 4, 8]),
        {"rock": {}},
        rock=ROCK | {"biot": 1, "cohesion": "10 MPa"} if water else ROCK | {"cohesion": "10 MPa"},
        loads={"gravity": [0, 0, -10], "supports": [FLOOR, *WALLS]},
        initial_stress=[{"vertical": "overburden", "k0": [0.5, 0.8]}],
        **pores,
    )
    sim.step(50)
    assert sim.core.unbalance_ratio() < 1e-10
    assert np.abs(sim.fields["displacement"]).max() < 1e-12


def test_a_spinning_block_that_flows_keeps_its_momentum_and_energy():
    sim = simulate(box((3, 3, 3)), {"rock": {}}, rock=ROCK)
    x = sim.fields["position"] - 0.5
    sim.motion[:, 4:7] = (
        np.cross([3.0, 5.0, -4.0], x) + x @ np.diag([-8.0, 3.0, 5.0]) + x[:, [1, 2, 0]] * [4, -6, 2]
    )
    p, spin = momentum(sim)
    sim.step(1000)
    e = sim.energies
    assert e["plastic"] > 0.05 * e["start"]
    assert abs(e["error"]) < 1e-3
    p_now, spin_now = momentum(sim)
    assert np.abs(p_now - p).max() < 1e-13 * np.abs(spin).max()
    assert np.abs(spin_now - spin).max() < 1e-12 * np.abs(spin).max()


def test_the_whole_stable_step_is_stable():
    """Rock far below its strength shakes for 3,000 steps of the bound: averaged tets are softer."""
    sim = simulate(box((3, 3, 3)), {"rock": {}}, rock=ROCK | {"cohesion": "1 GPa"},
                   time={"safety": 1.0})  # fmt: skip
    sim.motion[:, 4:7] = np.random.default_rng(1).uniform(-1e-3, 1e-3, (64, 3))
    sim.step(3000)
    e = sim.energies
    assert e["plastic"] == 0
    assert abs(e["error"]) < 1e-6


def pressed(tetrahedra, rock, divisions=(2, 2, 2), **more):
    """A cube whose top goes down."""
    sim = simulate(
        box(divisions), {"rock": {}}, rock=rock, elements={"tetrahedra": tetrahedra},
        loads={"supports": [FLOOR], "velocities": [
            {"surface": {"group": "rock", "normal": [0, 0, 1]}, "velocity": [0, 0, -1]}]},
        **more,
    )  # fmt: skip
    sim.step(300)
    return sim


def test_rock_that_cannot_flow_and_blocks_of_one_tet_keep_their_bits():
    elastic = {"young_modulus": "1 GPa"}
    assert digest(pressed("full", elastic)) == digest(pressed("nodal-mean", elastic))
    digests = []
    for tetrahedra in ("full", "nodal-mean"):  # every tet a block, bonded
        sim = simulate(
            box(), {"rock": {}}, rock=ROCK, model={"split": {"rock": "elements"}},
            interfaces={"default": {"friction_angle": 40, "cohesion": 9e6, "tensile_strength": 9e6}},
            elements={"tetrahedra": tetrahedra},
        )  # fmt: skip
        sim.motion[:, 6] = -30 * sim.fields["position"][:, 2]
        sim.step(100)
        assert sim.energies["plastic"] > 0
        digests.append(digest(sim))
    assert digests[0] == digests[1]
    assert digest(pressed("full", ROCK)) != digest(pressed("nodal-mean", ROCK))


def test_sampling_changes_nothing():
    """Averaged tets beside blocks of one tet: looked at in every step or at the end."""

    def run(steps):
        blocks = box((1, 1, 2)) + [
            {"group": "rock", "polyhedron": {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]},
             "translate": [2 + 2 * i, 0, 0]} for i in range(5)
        ]  # fmt: skip
        sim = simulate(blocks, {"rock": {}}, rock=ROCK)
        sim.motion[:, 6] = -60 * sim.fields["position"][:, 2]
        for _ in range(60 // steps):
            sim.step(steps)
            assert sim.energies
        assert sim.energies["plastic"] > 0
        return digest(sim)

    assert run(1) == run(60)


def test_the_same_bits_on_any_number_of_threads_and_after_resuming(tmp_path):
    """1,296 tets that flow, enough for several threads."""

    def hit(**more):
        data = case(
            box((6, 6, 6)),
            {"rock": {"velocity": [5, 0, -30]}},
            rock=ROCK,
            loads={"supports": [FLOOR]},
            stages=[{"name": "hit", "mode": "dynamic", "duration": 0.004}],
            output={"frames": False},
        )
        return cdem.Simulation(data, **more)

    whole = hit(threads=1, output=tmp_path / "one")
    whole.run()
    assert whole.energies["plastic"] > 0.3 * whole.energies["start"]
    two = hit(threads=2, output=tmp_path / "two")
    two.run_until(0.002)
    two.checkpoint()
    two.close()
    again = hit(threads=3, output=tmp_path / "two", resume=True)
    again.run()
    assert digest(again) == digest(whole)


def test_a_fill_begins_free_of_stress():
    """Dug out under stress and filled again: the column settles as of tets of their own dilatation."""
    settled = []
    for tetrahedra in ("full", "nodal-mean"):
        blocks = [
            {"group": g, "box": {"size": [2, 2, 2], "divisions": [3, 3, 3], "shape": "tet4"},
             "translate": [0, 0, z]} for g, z in (("low", 0), ("up", 2))
        ]  # fmt: skip
        walls = [
            {"surface": {"group": g, "normal": wall["surface"]["normal"]}, "fix": wall["fix"]}
            for g in ("low", "up")
            for wall in WALLS
        ]
        sim = simulate(
            blocks,
            {"low": {}, "up": {}},
            rock=ROCK | {"cohesion": "10 MPa"},
            loads={"gravity": [0, 0, -10], "supports": [
                {"surface": {"group": "low", "normal": [0, 0, -1]}, "fix": ["z"]}, *walls]},
            initial_stress=[{"vertical": "overburden", "k0": 1 / 3}],
            elements={"tetrahedra": tetrahedra},
            stages=[
                {"name": "situ", "mode": "static"},
                {"name": "dig", "mode": "static", "tolerance": 1e-7, "remove": ["up"]},
                {"name": "fill", "mode": "static", "tolerance": 1e-7, "add": ["up"]},
            ],
        )  # fmt: skip
        sim.run()
        assert abs(sim.energies["error"]) < 3e-4
        up = sim.build.nodes_of("up")
        settled.append(sim.fields["displacement"][up, 2].min())
    assert settled[0] < 0
    assert settled[1] == pytest.approx(settled[0], rel=0.05)
