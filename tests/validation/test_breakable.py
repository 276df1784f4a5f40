"""Rock of bonded elements: elastic while intact, at rest without load, an energy ledger that closes."""

import numpy as np
import pytest
from scenes import case, simulate

import cdem


def cube(divisions, side=1.0):
    box = {"size": [side] * 3, "divisions": [divisions] * 3, "shape": "tet4"}
    return [{"group": "body", "box": box}]


def test_intact_bonded_cube_has_the_stated_compliance():
    """Unconfined compression: compliance 1/E and that of the bonds, which `cdem check` states."""
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
    stated = sim.audit.interfaces[0]["compliance_along_xyz"][2]
    # stated for a uniform stress, which is an upper bound: this mesh carries past its soft bonds
    assert 0.85 * stated < added < stated


def test_unloaded_bonded_cube_stays_at_rest():
    """Nothing acts, and displacements are measured from the start: velocities are 0 exactly."""
    sim = simulate(
        cube(3),
        {"body": {}},
        interfaces={
            "default": {"friction_angle": 40, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
        },
        model={"split": {"body": "elements"}},
    )
    sim.step(500)
    assert not sim.fields["velocity"].any()
    assert sum(sim.broken.values()) == 0


def dropped(divisions, steps_safety, time, friction_angle=30):
    """A cube of bonded tets after its fall on a bed at 4 m/s."""
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


def test_energy_ledger_closes_for_a_cube_that_breaks():
    """48 tets break at all 216 bond points; friction takes 60 % of the energy.

    Tolerance: the closing error at 0.4 of the stable step.
    """
    sim = dropped(2, 0.4, 0.05)
    assert sum(sim.broken.values()) == 216
    assert np.isfinite(sim.fields["position"]).all()
    assert abs(sim.energies["error"]) < 5e-4


@pytest.mark.slow  # quick: the test before
@pytest.mark.parametrize("friction_angle", [0, 30])
def test_closing_error_of_breaking_rock_falls_with_the_time_step(friction_angle):
    """The cube above: the closing error falls from 1.4e-4 at 0.4 of the stable step to 2e-5.

    How the cube breaks is chaotic: at small steps the error of one run lies between 5e-7 and 4e-5,
    so the mean of three steps counts. The ledger has the energy of released bonds and of contacts
    that end under load or change targets. (Without it it is open by 0.2 to 0.3 % at any step.)
    """
    errors = [
        abs(dropped(2, safety, 0.05, friction_angle).energies["error"])
        for safety in (0.13, 0.1, 0.07)
    ]
    assert np.mean(errors) < 3e-5, errors


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
def test_repeated_contact_of_fragments_conserves_energy(speed):
    """Each new contact cuts the step to an 18th, and then the step grows again by 1 % a step.

    (Growth at once, with w dt = 1.6 for the fastest mode, made 2, 24, 15 and 2 % of the energy.)
    Tolerance: the closing error at 0.8 of the stable step grows with the speed to 7e-4.
    """
    sim = beam_on_a_post(speed)
    sim.run_until(0.1)
    assert sum(sim.broken.values()) == 28  # all
    assert abs(sim.energies["error"]) < 3e-3


def test_time_step_drops_at_once_and_grows_by_one_percent():
    """A new contact drops the step to half at once; from step to step it grows by at most 1 %."""
    sim = beam_on_a_post()
    steps = []
    for _ in range(3000):
        sim.step()
        steps.append(sim.core.scalars()["dt_last"])
    change = np.divide(steps[1:], steps[:-1])
    assert change.min() < 1.01**-60  # at once, and more than 60 steps to grow back
    assert change.max() == pytest.approx(1.01, abs=5e-16)


@pytest.mark.parametrize("seed", [pytest.param(1, marks=pytest.mark.slow), 3])
def test_many_contacts_on_one_node_stay_stable(seed):
    """48 tets are thrown at a meshed bed at 0.8 of the stable step, four throws a seed.

    More contacts press on a node than two for each of its faces, so the stable step is found in
    every step. (Found every 100 steps, it made 1.5 % of the energy with seed 1 and 70 % with
    seed 3.) Tolerance: the closing error at this step is up to 1.4e-3.
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
def test_energy_ledger_closes_for_a_cube_of_2058_tets():
    """A cube that falls at 4 m/s breaks, tumbles and comes to rest within 0.3 s."""
    sim = dropped(7, 0.4, 0.3)
    assert sum(sim.broken.values()) > 500
    assert np.isfinite(sim.fields["position"]).all()
    assert abs(sim.energies["error"]) < 0.001


def test_open_bond_that_breaks_transfers_no_force():
    """Vertices far apart from their bond partner carry no bond force to the face they lie on.

    The second of two bonded cubes is rotated by 90 degrees onto the top of the first, and all bond
    points are broken. The new contacts are free of stress: their friction force is 0.
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
    sim.motion[second, :3] = np.column_stack([0.95 - y, x - 1e-4, z])
    for name, value in {"bond": 0, "jump": 1, "jump_at_break": 0}.items():
        state[f"quads.{name}"][:] = value
    sim.step(5)
    state = sim.core.fields()
    assert state["quads.status"][0] == 0 and (state["spring.target"] >= 0).any()
    assert not state["spring.friction"].any()


OVER = {"a bed": ([3, 3, 1], [1, 1, 0.5]), "a rail": ([0.4, 3, 1], [1, 0.3, 0.5])}


@pytest.mark.parametrize(
    "over, share, within", [("a bed", 0.5, (1e-3, 1e-2)), ("a rail", 1, (0.2, 0.2))]
)
def test_bonds_of_nonconforming_faces_transfer_their_force_to_contacts(over, share, within):
    """A block whose bonds break under it stays pressed on its bed, by vertices or by edges alone.

    Edges carry the whole force of the bonds. On a bed, whose own semi-springs meet no vertex, the
    contacts have half of the bonds' stiffness and carry half. (Contacts that begin free of stress
    carry nothing, and 0.07 % and 0.7 % of the energy are missing.) Tolerances: the pressure on the
    rail falls by 6 % in each of two steps; on the bed the drag is 0.6 % below friction when the
    last bond breaks; the closing error at a tenth of the stable step.
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
        time={"safety": 0.1},
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

    def pressure_and_drag():
        weight = 7 * 2500 * length * width * height
        reaction = sim.fields["reaction"].sum(axis=0)
        return reaction[2] - weight, -reaction[1] - weight

    sim.run_until(sim.time + 1e-9)
    bonds = sim.core.fields()["overlaps.status"]
    while bonds[0] > 0:
        before = np.array(pressure_and_drag())
        sim.step()
    assert (before > 0).all()
    for after, carried, part in zip(pressure_and_drag(), before, within, strict=True):
        assert after == pytest.approx(share * carried, rel=part)


def test_overlaps_released_in_one_step_hand_over_to_their_own_contacts():
    """Three blocks of different height let go of their rails at once, each with its own force.

    Their bonds are torn off at rest, so each rail goes on bearing the weight of its block.
    """
    heights = {"low": 0.25, "middle": 0.5, "high": 1.0}
    blocks, groups = [], {}
    for x, (name, height) in zip((0, 5, 10), heights.items(), strict=True):
        blocks += [
            {
                "group": f"{name}_rail",
                "box": {"size": [0.4, 3, 1]},
                "translate": [x - 0.2, -1.5, -1],
            },
            {
                "group": f"{name}_block",
                "box": {"size": [1, 0.3, height]},
                "translate": [x - 0.5, -0.15, 0],
            },
        ]
        groups |= {f"{name}_rail": {"fix": ["x", "y", "z"]}, f"{name}_block": {}}
    sim = simulate(
        blocks,
        groups,
        interfaces={
            "default": {"friction_angle": 30, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
        },
        rock={"young_modulus": "0.1 GPa"},
        loads={"gravity": [0, 7, -7]},
        time={"safety": 0.1},
        stages=[
            {"name": "hold", "mode": "static", "tolerance": 1e-6},
            {"name": "slide", "mode": "dynamic", "duration": 0.2},
        ],
    )
    assert sim.run_stage("hold") == "converged"

    def pressures():
        reaction = sim.fields["reaction"]
        weight = 7 * 2500 * 0.4 * 3 * 1
        return np.array(
            [reaction[sim.build.nodes_of(f"{name}_rail"), 2].sum() - weight for name in heights]
        )

    sim.run_until(sim.time + 1e-9)
    before = pressures()
    assert before[1] > 1.3 * before[0] and before[2] > 1.3 * before[1]
    state = sim.core.fields()
    for name, value in {"bond": 0, "jump": 1, "jump_at_break": 0}.items():  # they are torn off
        state[f"overlaps.{name}"][:] = value
    sim.step()
    assert not sim.core.fields()["overlaps.status"][:3].any()
    assert set(sim.contacts["kind"]) == {1}
    assert pressures() == pytest.approx(before, rel=2e-3)
    sim.step(4000)
    assert abs(sim.energies["error"]) < 2e-4


def test_contact_search_finds_the_faces_of_an_open_hinge():
    """A lid stands open on two of its four bond points: a stone thrown in hits both faces.

    Tolerance: the stone penetrates base and lid by up to 9e-5 m in the impact.
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
    sim.motion[lid, :3] = np.column_stack([-z, y, x])
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
    assert least[2] == pytest.approx(0, abs=2e-4)  # hit the base
    assert least[0] == pytest.approx(0, abs=2e-4)  # and the lid
    assert sim.core.fields()["quads.status"][0] == 2


@pytest.mark.parametrize("base", ["beside", "below"])
def test_a_lid_turned_aside_on_its_last_bond_point_falls_or_is_borne(base):
    """Faces that do not conform: a broken point carries nothing, and the search has both faces.

    The lid, a cube, is turned by 90 degrees about the bond point at its corner. If it then lies
    beside the base, it hangs by that point and swings: after a time t its centre is at least 0.3 g
    t2 / 2 lower. Three broken points whose two sides are up to 1.4 m apart held it up. If the base
    is below it, contacts bear it; it sinks by its settlement, 2 rho g h / k_n = 1e-5 m at most.
    """
    g, t, low = 9.81, 0.2, {"beside": 0, "below": -1.5}[base]
    sim = simulate(
        [
            {"group": "base", "box": {"size": [2 - low, 1, 0.5]}, "translate": [low, 0, -0.5]},
            {"group": "lid", "box": {"size": [1, 1, 1]}},
        ],
        {"base": {"fix": ["x", "y", "z"]}, "lid": {}},
        rock={"young_modulus": "1 GPa"},
        loads={"gravity": [0, 0, -g]},
        interfaces={"default": {"friction_angle": 30, "cohesion": 1e15, "tensile_strength": 1e15}},
        stages=[{"name": "hang", "mode": "dynamic", "duration": t}],
        contact={"check": True},
    )
    lid, topology = sim.build.nodes_of("lid"), sim.build.topology
    x, y, z = sim.fields["position"][lid].T
    sim.motion[lid, :3] = np.column_stack([-y, x, z])
    corners = topology.node_position[topology.face_nodes[topology.overlap_faces[0, 0]]]
    points = topology.overlap_weights_a @ corners
    state = sim.core.fields()
    state["overlaps.bond"][: len(points)][np.linalg.norm(points, axis=1) > 1e-9] = 0
    sim.run()
    fallen = 0.5 - sim.fields["position"][lid, 2].mean()
    if base == "beside":
        assert fallen > 0.3 * g * t**2 / 2
        assert abs(sim.energies["error"]) < 1e-3
    else:
        assert 0 < fallen < 3e-5
        assert (sim.contacts["kind"] == 0).sum() > 3
    assert sim.core.fields()["overlaps.status"][0] == 2
