"""The six contact types at rest, what contacts find and hold, and how they turn with bodies."""

import numpy as np
import pytest
from scenes import case, mean_velocity, meeting_cubes, simulate, turn

import cdem
from cdem.rows import rows_of

KINDS = [
    ("face", "face"),
    ("face", "edge"),
    ("face", "vertex"),
    ("edge", "edge"),
    ("edge", "vertex"),
]
K_N = 2e9


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("lower, upper", KINDS)
def test_contact_types_carry_the_weight(lower, upper, seed):
    """The upper body comes to rest on the lower one, in any orientation (it has no time to topple).

    Each semi-spring carries k_n A / (2 N) and each semi-edge k_n A / N times its penetration
    (Eq. 3-5, half because both sides see a contact): equal to round-off. Together they carry the
    weight. Tolerances: after 4,000 steps of local damping an oscillation of 3e-9 of the weight is
    left along the normal. Across it contacts chatter, which is chaotic: 1e-7 to 3e-6, by round-off.
    """
    down = np.array([0, 0, -1.0])
    more = {}
    if seed:
        rng = np.random.default_rng(seed)
        axis, angle = list(rng.normal(size=3)), float(rng.uniform(10, 350))
        down = turn(axis, angle) @ down
        more["model"] = {"rotate": {"axis": axis, "angle": angle}}
    sim = simulate(
        meeting_cubes(lower, upper),
        {"lower": {"fix": ["x", "y", "z"]}, "upper": {}},
        interfaces={"default": {"friction_angle": 45, "stiffness_n": K_N, "stiffness_s": K_N}},
        loads={"gravity": list(9.81 * down)},
        stages=[{"name": "rest", "mode": "dynamic", "duration": 1, "damping": {"local": 0.8}}],
        **more,
    )
    sim.step(4000)
    t, state = sim.build.topology, sim.core.fields()
    area, exposed = sim.build.arrays["face.area"], state["search.exposed_face"]
    share = area / (t.face_nodes >= 0).sum(axis=1) * K_N  # k_n A / N
    slots = np.flatnonzero(state["spring.target"] >= 0)
    forces = 0.5 * share[exposed[slots // 4]] * rows_of(sim.core, "spring.state").penetration[slots]
    mothers = rows_of(sim.core, "edge.contact").mother_side // 4
    crossing = share[exposed[mothers]] * rows_of(sim.core, "edge.state").penetration
    predicted = np.concatenate([forces, crossing])
    np.testing.assert_allclose(sim.contacts["force_n"], predicted, rtol=2e-15)
    if "edge" not in (lower, upper):  # one normal for all: the weight itself
        weight = 9.81 * sim.fields["mass"][sim.build.nodes_of("upper")].sum()
        np.testing.assert_allclose(predicted.sum(), weight, rtol=2e-8)
    upper_group = sim.build.group_names.index("upper")
    own = t.face_group[sim.contacts["mother_face"]] == upper_group
    carried = (np.where(own, 1.0, -1.0)[:, None] * sim.contacts["force"]).sum(axis=0)
    mass = sim.fields["mass"][sim.build.nodes_of("upper")].sum()
    np.testing.assert_allclose(carried, -9.81 * mass * down, rtol=0, atol=1e-5 * 9.81 * mass)


def test_vertex_on_vertex_deflects_a_falling_body():
    """The sixth contact type: a vertex comes down 11 mm beside another vertex at 0.5 m/s.

    The contact brakes the body and pushes it aside.
    """
    blocks = meeting_cubes("vertex", "vertex")
    blocks[1]["translate"] = [0.01, 0.004, 0.0]
    sim = simulate(
        blocks,
        {"lower": {"fix": ["x", "y", "z"]}, "upper": {"velocity": [0, 0, -0.5]}},
        interfaces={"default": {"friction_angle": 20}},
    )
    while sim.time < 0.05:
        sim.step(100)
    velocity = mean_velocity(sim, "upper")
    assert velocity[2] > -0.2
    assert np.linalg.norm(velocity[:2]) > 0.1


def test_penetration_is_weight_over_normal_stiffness():
    """Face on face: only the block has semi-springs, with half of k_n: 2 rho g h / k_n.

    (Its face lies inside the larger one, which has no vertex there.) Tolerance: the unbalance
    ratio of 1e-7 at which the stage ends.
    """
    k_n = 1e9
    sim = simulate(
        [
            {"group": "lower", "box": {"size": [3, 3, 1]}, "translate": [-1, -1, -1]},
            {"group": "upper", "box": {"size": [1, 1, 1]}},
        ],
        {"lower": {"fix": ["x", "y", "z"]}, "upper": {}},
        interfaces={"default": {"friction_angle": 30, "stiffness_n": k_n, "stiffness_s": k_n}},
        loads={"gravity": [0, 0, -9.81]},
        stages=[{"name": "rest", "mode": "static", "tolerance": 1e-7}],
    )
    assert sim.run() == "converged"
    nodes = sim.build.nodes_of("upper")[:]
    bottom = nodes[sim.build.start_position[nodes, 2] < 1e-9]
    expected = -2500 * 9.81 / (k_n / 2)
    np.testing.assert_allclose(sim.fields["displacement"][bottom, 2], expected, rtol=2e-7)


@pytest.mark.parametrize("speed", [1.0, 10.0, 50.0])
def test_fast_impact_is_detected(speed):
    """A block that falls on a bed at up to 50 m/s bounces with 0.91 of its speed.

    The rest of the speed is elastic vibration of the block.
    """
    sim = simulate(
        [
            {"group": "bed", "box": {"size": [3, 3, 1]}, "translate": [-1, -1, -1]},
            {"group": "block", "box": {"size": [1, 1, 1]}, "translate": [0, 0, 0.2]},
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "block": {"velocity": [0, 0, -speed]}},
    )
    while sim.time < 0.2 / speed + 0.01:
        sim.step(200)
    assert mean_velocity(sim, "block")[2] > 0.9 * speed


@pytest.mark.parametrize("depth", [1e-4, 0.01, 0.2])
def test_overlapping_blocks_are_reported_and_free_of_stress(depth):
    """Nothing acts, so velocities are round-off: 3e-12 m/s after 200 steps.

    (A compiler that got the depth limit wrong let deep blocks fall through.)
    """
    sim = simulate(
        [
            {"group": "lower", "box": {"size": [3, 3, 1]}, "translate": [-1, -1, -1]},
            {"group": "upper", "box": {"size": [1, 1, 1]}, "translate": [0, 0, -depth]},
        ],
        {"lower": {"fix": ["x", "y", "z"]}, "upper": {}},
        loads={"gravity": [0, 0, 0]},
    )
    assert f"up to {depth:g} m" in sim.audit.warnings[0]
    sim.step(200)
    assert np.abs(sim.fields["velocity"]).max() < 2e-11


@pytest.mark.parametrize("axis", [[0, 0, 1], [1, 0, 0], [1, 2, 3]])
def test_contact_force_rotates_with_a_loaded_pair(axis):
    """A pressed, sheared frictional pair is rotated by 90 degrees: its forces rotate with it.

    The motion is imposed on all nodes in 300 steps; the force is that of the semi-springs.
    Tolerance: round-off of coordinates, 1e-16 m, against a shear displacement of 3e-6 m, in every
    step.
    """
    sim = simulate(
        [
            {"group": "lower", "box": {"size": [1, 1, 1]}, "translate": [0, 0, -1]},
            {"group": "upper", "box": {"size": [0.6, 0.6, 0.6]}, "translate": [0.2, 0.2, 1e-6]},
        ],
        {"lower": {}, "upper": {}},
        interfaces={"default": {"friction_angle": 40}},
    )
    start = sim.build.start_position.copy()
    upper = sim.build.nodes_of("upper")

    def impose(now, before):
        dt = sim.core.scalars()["dt_last"]
        sim.motion[:, :3] = now
        sim.motion[:, 4:7] = (now - before) / dt
        sim.step(1)

    def contact_force():
        contacts = sim.contacts
        faces = contacts["mother_face"]
        own = sim.build.topology.face_group[faces] == sim.build.group_names.index("upper")
        return contacts["force"][own].sum(axis=0)

    loaded = start.copy()
    loaded[upper] += [3e-6, 1e-6, -1.1e-5]
    impose(start, start)
    impose(loaded, start)
    before = contact_force()
    assert before[2] > 0 and before[0] < 0
    steps, last = 300, loaded
    for n in range(1, steps + 1):
        now = loaded @ turn(axis, 90.0 * n / steps).T
        impose(now, last)
        last = now
    np.testing.assert_allclose(
        contact_force(), turn(axis, 90) @ before, rtol=0, atol=1e-9 * np.linalg.norm(before)
    )


def test_an_edge_may_cross_any_number_of_others():
    """A blade comes down across 40 small blocks, 80 edges, all of which it touches."""
    blade = [[x, y, z + 1e-4] for x in (0, 4.2) for y, z in ((0, 0), (-0.3, 0.5), (0.3, 0.5))]
    row = [
        {
            "group": "row",
            "box": {"size": [0.09, 0.4, 0.1]},
            "translate": [0.1 + 0.1 * i, -0.2, -0.1],
        }
        for i in range(40)
    ]
    sim = cdem.Simulation(
        case(
            [*row, {"group": "blade", "polyhedron": {"vertices": blade}}],
            {"row": {"fix": ["x", "y", "z"]}, "blade": {"velocity": [0, 0, -0.05]}},
        ),
        threads=1,
    )
    most = 0
    while sim.step_count < 200:
        sim.step()
        edges = sim.contacts["mother_face"][sim.contacts["kind"] == 1]
        most = max(most, np.bincount(edges).max() if len(edges) else 0)
    assert most == 80
    assert abs(sim.energies["error"]) < 0.2  # it is thrown back within a few steps
    assert sim.fields["velocity"][-6:, 2].mean() > 0.03


def test_an_edge_contact_keeps_its_history_from_face_to_face():
    """Two ridges of tets cross and are pressed; the upper one tips over the lower one's edge.

    On either side of that edge lies a face of another element. Which of them is the target changes
    as the ridge tips; the contact stays one, and keeps its place of one step ago.
    """
    ridge = [[x, y, z] for x in (-1, 1) for y, z in ((0, 0), (-0.5, 0.6), (0.5, 0.6))]
    below = [[y, x, -z] for x, y, z in ridge]
    sim = simulate(
        [
            {"group": "lower", "polyhedron": {"vertices": below}},
            {"group": "upper", "polyhedron": {"vertices": ridge}, "translate": [0, 0, 1e-4]},
        ],
        {"lower": {"fix": ["x", "y", "z"]}, "upper": {}},
    )
    start = sim.build.start_position.copy()
    upper = sim.build.nodes_of("upper")
    before, targets = start, set()
    for tip in np.linspace(-0.5, 0.5, 41):
        now = start.copy()
        now[upper] = (start[upper] - [0, 0, 1e-4]) @ turn([0, 1, 0], tip).T - [0, 0, 1e-4]
        sim.motion[:, :3] = now
        sim.motion[:, 4:7] = (now - before) / sim.core.scalars()["dt_last"]
        sim.step(1)
        contacts = rows_of(sim.core, "edge.contact")
        if before is not start:
            assert len(contacts.before) == 4
            assert (contacts.before >= 0).all()
        targets |= set(
            zip(contacts.mother_side, contacts.target_edge, contacts.target, strict=True)
        )
        before = now
    assert len(targets) > len({(m, e) for m, e, _ in targets})  # faces did change
