"""Rock in which every interface may break: elastic while intact, quiet at rest, a ledger that closes."""

import numpy as np
import pytest
from scenes import case, simulate

import cdem


def cube(divisions, side=1.0):
    box = {"size": [side] * 3, "divisions": [divisions] * 3, "shape": "tet4"}
    return [{"group": "body", "box": box}]


def test_intact_cube_has_the_stated_compliance():
    """Unconfined compression: 1/E + what the interfaces add; `cdem check` states the latter."""
    sim = simulate(
        cube(3),
        {"body": {}},
        interfaces={
            "default": {"friction_angle": 40, "cohesion": "1 GPa", "tensile_strength": "1 GPa"}
        },
        rock={"poisson_ratio": 0.0},
        loads={
            "supports": [{"box": {"min": [-1, -1, -1e-6], "max": [2, 2, 1e-6]}, "fix": ["z"]}],
            "tractions": [
                {"surface": {"group": "body", "normal": [0, 0, 1]}, "traction": [0, 0, -1e6]}
            ],
        },
        stages=[{"name": "press", "mode": "static", "tolerance": 1e-4}],
        model={"split": {"body": "elements"}},
    )
    assert sim.run() == "converged"
    assert sum(sim.broken.values()) == 0
    top = sim.build.start_position[:, 2] > 1 - 1e-9
    strain = -sim.fields["displacement"][top, 2].mean()
    added = 100 * (strain / (1e6 / 10e9) - 1)
    stated = sim.audit.interfaces[0]["compliance_percent"]
    # the statement is a mean over directions, and this mesh is not the same in all of them
    assert added == pytest.approx(stated, rel=0.2)


def test_at_rest_it_stays_at_rest():
    sim = simulate(
        cube(3),
        {"body": {}},
        interfaces={
            "default": {"friction_angle": 40, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
        },
        model={"split": {"body": "elements"}},
    )
    sim.step(500)
    assert np.abs(sim.fields["velocity"]).max() < 1e-9
    assert sum(sim.broken.values()) == 0


def dropped(divisions, steps_safety, time, friction_angle=30):
    sim = cdem.Simulation(
        case(
            [
                {
                    "group": "body",
                    "box": {"size": [1] * 3, "divisions": [divisions] * 3, "shape": "tet4"},
                    "translate": [0, 0, 0.01],
                },
                {"group": "bed", "box": {"size": [6, 6, 1]}, "translate": [-2.5, -2.5, -1]},
            ],
            {"body": {"velocity": [0.3, 0.1, -4]}, "bed": {"fix": ["x", "y", "z"]}},
            interfaces={
                "default": {
                    "friction_angle": friction_angle,
                    "cohesion": "20 kPa",
                    "tensile_strength": "10 kPa",
                }
            },
            rock={"young_modulus": "0.2 GPa"},
            loads={"gravity": [0, 0, -9.81]},
            time={"safety": steps_safety},
            stages=[
                {
                    "name": "drop",
                    "mode": "dynamic",
                    "duration": time,
                    "damping": {"contact": 0.2, "stiffness": 0.1},
                }
            ],
            model={"split": {"body": "elements"}},
        ),
        threads=2,
    )
    sim.run()
    return sim


def test_dropped_it_breaks_and_the_ledger_closes():
    """48 tets: all 216 bond points break, friction takes 60 % of the energy."""
    sim = dropped(2, 0.4, 0.05)
    assert sum(sim.broken.values()) > 200
    assert np.isfinite(sim.fields["position"]).all()
    assert abs(sim.energies["error"]) < 5e-4


@pytest.mark.parametrize("friction_angle", [0, 30])
def test_the_ledger_of_broken_rock_converges_with_the_step(friction_angle):
    """What released pairs and contacts that end under load or turn corners held is lost, and counted.

    It was not, and 0.2 to 0.3 % were missing with any step.
    """
    sim = dropped(2, 0.1, 0.05, friction_angle)
    assert abs(sim.energies["error"]) < 3e-5


def beam_on_a_post(speed=3.0):
    """Six bonded hexahedra fall on a post, break apart and fly on, vibrating, with few contacts."""
    return simulate(
        [
            {
                "group": "beam",
                "box": {"size": [3, 0.5, 0.5], "divisions": [6, 1, 1]},
                "translate": [0, 0, 0.3],
            },
            {"group": "post", "box": {"size": [0.4, 0.8, 0.3]}, "translate": [1.3, -0.15, 0]},
        ],
        {"beam": {"velocity": [0, 0, -speed]}, "post": {"fix": ["x", "y", "z"]}},
        interfaces={
            "default": {"friction_angle": 35, "cohesion": "0.5 MPa", "tensile_strength": "0.2 MPa"}
        },
        rock={"density": 2600, "young_modulus": "2 GPa", "poisson_ratio": 0.2},
        loads={"gravity": [0, 0, -9.81]},
        model={"split": {"beam": "elements"}},
    )


@pytest.mark.parametrize("speed", [2, 3, 4, 5])
def test_faces_that_come_near_and_part_make_no_energy(speed):
    """Each time they do, the step falls to an 18th and may grow again. At once, with w dt = 1.6 for the
    fastest mode, it made 2, 24, 15 and 2 % of the energy here.
    """
    sim = beam_on_a_post(speed)
    sim.run_until(0.1)
    assert sum(sim.broken.values()) == 28  # all
    assert abs(sim.energies["error"]) < 5e-3


def test_the_step_shrinks_at_once_and_grows_slowly():
    sim = beam_on_a_post()
    steps = []
    for _ in range(3000):
        sim.step()
        steps.append(sim.core.scalars()["dt_last"])
    change = np.divide(steps[1:], steps[:-1])
    assert change.min() < 1.01**-60  # at once, by what takes more than 60 steps to come back
    assert 1.01 - 1e-12 < change.max() < 1.01 + 1e-12


@pytest.mark.parametrize("seed", [1, 3])
def test_contacts_crowded_on_a_node_do_not_break_the_step(seed):
    """48 tets are thrown at a meshed bed at 0.8 of the stable step.

    More contacts press on a node than two for each of its faces. The step saw that after up to 100
    steps: it was unstable for some, and made 1.5 % of the energy in a throw of seed 1, 70 % of seed 3.
    """
    rng = np.random.default_rng(seed)
    for throw in range(4):
        velocity = rng.normal(size=3) * [1, 1, 0.5] + [0, 0, -3]
        spin, friction_angle = rng.normal(size=3) * 3, float(rng.uniform(0, 45))
        sim = simulate(
            [
                {
                    "group": "body",
                    "box": {"size": [1, 1, 1], "divisions": [2, 2, 2], "shape": "tet4"},
                    "translate": [0, 0, 0.01],
                },
                {
                    "group": "bed",
                    "box": {"size": [4, 4, 1], "divisions": [3, 3, 1]},
                    "translate": [-1.5, -1.5, -1],
                },
            ],
            {
                "body": {"velocity": velocity.tolist(), "angular_velocity": spin.tolist()},
                "bed": {"fix": ["x", "y", "z"]},
            },
            interfaces={
                "default": {
                    "friction_angle": friction_angle,
                    "cohesion": "20 kPa",
                    "tensile_strength": "10 kPa",
                }
            },
            rock={"young_modulus": "0.05 GPa"},
            loads={"gravity": [0, 0, -9.81]},
            stages=[
                {"name": "d", "mode": "dynamic", "duration": 0.05, "damping": {"contact": 0.1}}
            ],
            model={"split": {"body": "elements"}},
        )
        sim.run()
        assert abs(sim.energies["error"]) < 5e-3, throw


@pytest.mark.slow
def test_a_cube_of_2058_tets_breaks_tumbles_and_settles():
    sim = dropped(7, 0.4, 0.3)
    assert sum(sim.broken.values()) > 500
    assert np.isfinite(sim.fields["position"]).all()
    assert abs(sim.energies["error"]) < 0.001


def test_a_hinge_that_breaks_hands_over_no_force():
    """Vertices that hung far apart on a last bond point bring no force to what they lie on then.

    The second of two bonded cubes is turned by 90 degrees onto the top of the first, all points broken.
    """
    sim = simulate(
        [
            {"group": "rock", "box": {"size": [1, 1, 1]}},
            {"group": "rock", "box": {"size": [1, 1, 1]}, "translate": [1, 0, 0]},
        ],
        {"rock": {}},
        model={"split": {"rock": "elements"}},
        interfaces={"default": {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}},
        stages=[{"name": "part", "mode": "dynamic", "duration": 1}],
    )
    state, second = sim.core.fields(), sim.build.topology.node_block == 1
    x, y, z = sim.fields["position"][second].T
    sim.fields["position"][second] = np.column_stack([0.95 - y, x - 1e-4, z])
    for name, value in {"bond": 0, "jump": 1, "jump_at_break": 0}.items():
        state[f"quads.{name}"][:] = value
    sim.step(5)
    state = sim.core.fields()
    assert state["quads.live"][0] == 0 and (state["spring.target"] >= 0).any()
    assert np.abs(state["spring.friction"]).max() < 1  # found inside, so free of stress


OVER = {"a bed": ([3, 3, 1], [1, 1, 0.5]), "a rail": ([0.4, 3, 1], [1, 0.3, 0.5])}


@pytest.mark.parametrize("over", OVER)
def test_bonds_of_faces_that_do_not_conform_hand_over_their_force(over):
    """A block that slides off its broken bonds stays pressed as it was, by vertices or by edges alone.

    It was let go free of stress, and its bonds' energy was lost to no account (0.07 % and 0.7 %). The
    vertices on a bed see half the stiffness of the bonds: the bed's semi-springs meet no vertex.
    """
    (length, width, height), size = OVER[over]
    sim = simulate(
        [
            {
                "group": "bed",
                "box": {"size": [length, width, height]},
                "translate": [-length / 2, -width / 2, -height],
            },
            {"group": "block", "box": {"size": size}, "translate": [-0.5, -0.15, 0]},
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
        interfaces={
            "default": {"friction_angle": 30, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
        },
        rock={"young_modulus": "0.1 GPa"},
        loads={"gravity": [0, 7, -7]},
        stages=[
            {"name": "hold", "mode": "static", "tolerance": 1e-6},
            {
                "name": "slide",
                "mode": "dynamic",
                "duration": 0.2,
                "set": {"interfaces.default.cohesion": 0, "interfaces.default.tensile_strength": 0},
            },
        ],
    )
    assert sim.run_stage("hold") == "converged"

    def pressure():
        return sim.fields["reaction"][:, 2].sum() - 7 * 2500 * length * width * height

    sim.run_until(sim.time + 1e-9)
    bonds = sim.core.fields()["overlaps.live"]
    while bonds[0] > 0:
        before = pressure()
        sim.step()
    assert before > 0
    assert pressure() > 0.4 * before
    sim.step(500)
    assert abs(sim.energies["error"]) < 2e-4


def test_an_open_hinge_stops_what_falls_into_it():
    """A lid that stands open by two of its bond points: a stone thrown in must meet both faces.

    They belong to a pair that still holds, and were hidden from the search.
    """
    sim = simulate(
        [
            {"group": "base", "box": {"size": [1, 1, 0.5]}, "translate": [0, 0, -0.5]},
            {"group": "lid", "box": {"size": [1, 1, 0.2]}},
            {"group": "stone", "box": {"size": [0.3, 0.3, 0.3]}, "translate": [0.3, 0.35, 0.3]},
        ],
        {
            "base": {"fix": ["x", "y", "z"]},
            "lid": {"fix": ["x", "y", "z"]},
            "stone": {"velocity": [-2, 0, 0]},
        },
        loads={"gravity": [0, 0, -9.81]},
        interfaces={"default": {"friction_angle": 0, "cohesion": 1e15, "tensile_strength": 1e15}},
        stages=[{"name": "throw", "mode": "dynamic", "duration": 1, "damping": {"contact": 0.1}}],
    )
    state, lid = sim.core.fields(), sim.build.nodes_of("lid")
    x, y, z = sim.fields["position"][lid].T
    sim.fields["position"][lid] = np.column_stack([-z, y, x])
    nodes = np.reshape(sim.build.arrays["quads.nodes"], (8, -1))[:, 0]
    jump = sim.fields["position"][nodes[4:]] - sim.fields["position"][nodes[:4]]
    apart = np.linalg.norm(jump, axis=1) > 0.5
    assert apart.sum() == 2
    np.reshape(state["quads.bond"], (4, -1))[apart, 0] = 0
    least = np.full(3, np.inf)
    while sim.time < 0.6:
        sim.step(50)
        stone = sim.fields["position"][sim.build.nodes_of("stone")]
        least = np.minimum(least, stone.min(axis=0))
    assert least[2] == pytest.approx(0, abs=2e-4)  # met the base
    assert least[0] == pytest.approx(0, abs=2e-4)  # and the lid
    assert sim.core.fields()["quads.live"][0] == 2
