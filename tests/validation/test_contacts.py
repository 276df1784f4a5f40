"""The six contact types at rest, collisions, and the contact search against an all-pairs search."""

import numpy as np
import pytest
from scenes import case, mean_velocity, momentum, simulate, turn

import cdem

TIP = np.degrees(np.arctan(np.sqrt(2)))


def cube(kind, height=0.0, side=0.6):
    """A cube with a face, an edge or a vertex lowest, that lowest point at `height`."""
    turned = {
        "face": np.eye(3),
        "edge": turn([0, 1, 0], 45),
        "vertex": turn([0, 1, 0], TIP) @ turn([0, 0, 1], 45),
    }[kind]
    corners = side * (np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T - 0.5)
    corners = corners @ turned.T
    corners[:, 2] += height - corners[:, 2].min()
    return corners


def pair(lower, upper, gap=0.0):
    """Two bodies that meet at the origin: the lower's topmost and the upper's lowest feature."""
    below = cube(lower) * [1, 1, -1]
    if lower == "edge":
        below = below @ turn([0, 0, 1], 90).T  # edges cross instead of lying along each other
    return [
        {"group": "lower", "polyhedron": {"vertices": below.tolist()}},
        {"group": "upper", "polyhedron": {"vertices": (cube(upper) + [0, 0, gap]).tolist()}},
    ]


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
        pair(lower, upper),
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
    forces = 0.5 * share[exposed[slots // 4]] * state["spring.state"].reshape(-1, 8)[slots, 1]
    mothers = state["edge.contact"].reshape(-1, 4)[:, 0] // 4
    crossing = share[exposed[mothers]] * state["edge.state"].reshape(-1, 8)[:, 1]
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
    blocks = pair("vertex", "vertex")
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


def collide(kind, speed=0.5, phi=0.0, safety=0.2, spin=(0, 0, 0)):
    blocks = pair("edge" if kind == "edge" else "face", kind, gap=0.01)
    sim = simulate(
        blocks,
        {
            "lower": {"angular_velocity": [-spin[0], spin[1], -spin[2]]},
            "upper": {"velocity": [0, 0, -speed], "angular_velocity": list(spin)},
        },
        interfaces={"default": {"friction_angle": phi}},
        rock={"young_modulus": "1 GPa"},
        time={"safety": safety},
    )
    linear, angular = momentum(sim)
    while sim.time < 0.01 / speed + 0.1:
        sim.step(500)
    return sim, linear, angular


@pytest.mark.parametrize("kind", ["face", "edge", "vertex"])
def test_collisions_conserve_momentum_and_energy(kind):
    """Momenta are conserved to round-off. Energy: see the next test; here a fifth of the stable step."""
    sim, linear, angular = collide(kind)
    now, turned = momentum(sim)
    assert mean_velocity(sim, "upper")[2] > -0.1  # they did meet
    scale = np.abs(linear).max()
    np.testing.assert_allclose(now, linear, rtol=0, atol=5e-15 * scale)
    np.testing.assert_allclose(turned, angular, rtol=0, atol=3e-15 * scale)
    assert abs(sim.energies["error"]) < 1e-3


@pytest.mark.parametrize("kind", ["face", "edge", "vertex"])
def test_closing_error_of_a_collision_falls_with_the_time_step(kind):
    """Energy after a bounce is off by at most 0.6 % at 0.8 of the stable step and 1.1e-4 at 0.1.

    The first is the root of the mean square over speeds: the error of one bounce depends on where
    in a step the contact begins.
    """
    errors = [
        collide(kind, speed, safety=0.8)[0].energies["error"]
        for speed in (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.45, 1.6, 1.8)
    ]
    assert np.sqrt(np.mean(np.square(errors))) < 8e-3
    assert abs(collide(kind, safety=0.1)[0].energies["error"]) < 2e-4


@pytest.mark.parametrize("phi", [0.0, 26.0])
def test_momentum_and_energy_are_conserved_over_1e5_steps(phi):
    """A collision of crossed edges, then free flight of both bodies, tumbling.

    Momenta change by round-off that adds up over the steps, energy by the error of the collision.
    """
    sim, linear, angular = collide("edge", phi=phi, spin=(0.5, 0.2, 1.0))
    sim.step(100_000 - sim.step_count)
    now, turned = momentum(sim)
    np.testing.assert_allclose(now, linear, rtol=0, atol=5e-14 * np.abs(linear).max())
    np.testing.assert_allclose(turned, angular, rtol=0, atol=1e-12 * np.abs(angular).max())
    assert abs(sim.energies["error"]) < 1e-3


def test_spinning_collision_with_friction_conserves_momentum_and_energy():
    """The collision of the test above by itself: momenta to round-off."""
    sim, linear, angular = collide("edge", phi=26.0, spin=(0.5, 0.2, 1.0))
    now, turned = momentum(sim)
    np.testing.assert_allclose(now, linear, rtol=0, atol=1e-14 * np.abs(linear).max())
    np.testing.assert_allclose(turned, angular, rtol=0, atol=5e-14 * np.abs(angular).max())
    assert abs(sim.energies["error"]) < 5e-4


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


def tumble(steps, blocks_per_side, modulus="0.1 GPa", seed=7):
    """Random convex blocks fall and tumble in a box.

    Every step is compared with an all-pairs search; a missed contact stops the run. Gives the
    largest number of contacts in a step, and the simulation.
    """
    rng = np.random.default_rng(seed)
    n = blocks_per_side
    bodies = []
    for i, j, k in np.ndindex(n, n, n):
        size = rng.uniform(0.5, 0.8, 3)
        points = (np.array(np.meshgrid([0, 1], [0, 1], [0, 1])).reshape(3, -1).T - 0.5) * size
        if rng.random() < 0.5:  # a tetrahedron
            points = points[[0, 3, 5, 6]]
        points = points @ turn(rng.normal(size=3), rng.uniform(0, 180)).T
        place = np.array([i, j, k]) + 0.5 + rng.uniform(-0.03, 0.03, 3)
        bodies.append({"group": "blocks", "polyhedron": {"vertices": (points + place).tolist()}})
    side = float(n)
    walls = [
        {"group": "walls", "box": {"size": size}, "translate": at}
        for size, at in [
            ([side + 2, side + 2, 1], [-1, -1, -1]),
            ([1, side + 2, 3 * side], [-1, -1, 0]),
            ([1, side + 2, 3 * side], [side, -1, 0]),
            ([side + 2, 1, 3 * side], [-1, -1, 0]),
            ([side + 2, 1, 3 * side], [-1, side, 0]),
        ]
    ]
    sim = simulate(
        bodies + walls,
        {
            "blocks": {"velocity": [1.0, 2.0, -5.0], "angular_velocity": [0.5, 0.3, 2.0]},
            "walls": {"fix": ["x", "y", "z"]},
        },
        interfaces={"default": {"friction_angle": 20}},
        rock={"young_modulus": modulus},
        loads={"gravity": [0, 0, -9.81]},
        stages=[{"name": "fall", "mode": "dynamic", "duration": 9, "damping": {"contact": 0.1}}],
        contact={"check": True},
    )
    touching = 0
    for _ in range(steps):
        sim.step(1)
        touching = max(touching, len(sim.contacts["kind"]))
    return touching, sim


@pytest.mark.parametrize(
    ("modulus", "steps", "blocks_per_side", "seed"),
    [("0.1 GPa", 400, 2, 7), ("2 MPa", 300, 2, 7), ("3 MPa", 60, 3, 26)],
)
def test_contact_search_agrees_with_an_all_pairs_search(modulus, steps, blocks_per_side, seed):
    """No contact is missed among stiff blocks, soft blocks and blocks that overlap at the start.

    Soft blocks penetrate deeper than the entry depth, and their contacts change targets there. In
    the last case vertices begin deep inside a block.
    """
    touching, sim = tumble(steps, blocks_per_side, modulus, seed)
    assert sim.step_count == steps
    assert touching > 0


@pytest.mark.slow
def test_contact_search_agrees_with_an_all_pairs_search_for_343_blocks():
    touching, sim = tumble(steps=2000, blocks_per_side=7)
    assert touching > 100
    assert np.isfinite(sim.fields["position"]).all()


@pytest.mark.parametrize("velocity", [(0, 0, -0.5), (0, -0.5, -0.3)])
@pytest.mark.parametrize("turns", [(4, 8, 2), (4, 1, 1), (30, 1, 1)])
def test_edge_contacts_of_nearly_parallel_faces_conserve_energy(turns, velocity):
    """Two edges cross at a few degrees, their faces tilted by a few: the energy ledger closes.

    (With the normal of a face instead of V_mm x V_tt the first case gained 83 % of its energy.)
    """
    yaw, pitch, roll = turns
    rotation = turn([0, 0, 1], yaw) @ turn([0, 1, 0], pitch) @ turn([1, 0, 0], roll)
    corners = np.array(np.meshgrid([-0.5, 0.5], [0, 0.5], [0, 0.5])).reshape(3, -1).T
    sim = simulate(
        [
            {"group": "lower", "polyhedron": {"vertices": (corners * [1, -1, -1]).tolist()}},
            {
                "group": "upper",
                "polyhedron": {"vertices": (corners @ rotation.T + [0, 0, 0.002]).tolist()},
            },
        ],
        {"lower": {}, "upper": {"velocity": list(velocity)}},
        interfaces={"default": {"friction_angle": 0}},
        rock={"young_modulus": "1 GPa"},
        time={"safety": 0.2},
    )
    edges = 0
    while sim.time < 0.03:
        sim.step(20)
        edges += int((sim.contacts["kind"] == 1).sum())
    assert edges > 0
    assert abs(sim.energies["error"]) < 1e-3


def test_energy_ledger_closes_over_bounces_with_dashpots():
    """A tet bounces without friction; half of its energy goes into contact dashpots.

    The closing error falls with the square of the step: 0.10 % at a fifth of the stable step.
    """
    sim = simulate(
        [
            {"group": "bed", "box": {"size": [6, 6, 1]}, "translate": [-3, -3, -1]},
            {
                "group": "block",
                "polyhedron": {
                    "vertices": [[0, 0, 0.05], [1, 0.1, 0.05], [0.3, 0.9, 0.1], [0.4, 0.3, 0.75]]
                },
            },
        ],
        {
            "bed": {"fix": ["x", "y", "z"]},
            "block": {"velocity": [1, 0.2, -0.5], "angular_velocity": [0.5, -1, 2]},
        },
        interfaces={"default": {"friction_angle": 0}},
        rock={"young_modulus": "1 GPa"},
        loads={"gravity": [0, 0, -9.81]},
        time={"safety": 0.2},
        stages=[{"name": "fall", "mode": "dynamic", "duration": 0.2, "damping": {"contact": 0.1}}],
    )
    sim.run()
    e = sim.energies
    assert e["damping"] > 0.4 * (e["start"] + e["external"])
    assert abs(e["error"]) < 2e-3


def test_change_of_target_conserves_energy():
    """A block without friction slides over tiles of areas 5 : 1, whose stiffnesses are in that ratio.

    (With the penetration instead of the energy kept, changes of target made 2e-3 of its energy.)
    """
    bed, x = [], 0.0
    while x < 6:
        length, rows = [(0.5, 4), (0.2, 8)][len(bed) % 2]
        box = {"size": [length, 1.6, 0.5], "divisions": [1, rows, 1]}
        bed.append({"group": "bed", "box": box, "translate": [x, -0.8, -0.5]})
        x += length
    sim = simulate(
        [*bed, {"group": "block", "box": {"size": [1, 1, 0.5]}, "translate": [0.3, -0.5, 0]}],
        {"bed": {"fix": ["x", "y", "z"]}, "block": {"velocity": [3, 0, 0]}},
        rock={"young_modulus": "20 MPa"},
        loads={"gravity": [0, 0, -9.81]},
        stages=[{"name": "slide", "mode": "dynamic", "duration": 1.3, "damping": {"contact": 0.2}}],
    )
    assert sim.run() == "finished"
    assert mean_velocity(sim, "block")[0] == pytest.approx(3, abs=0.002)
    assert abs(sim.energies["error"]) < 1e-6
    assert sim.fields["position"][sim.build.nodes_of("block"), 2].min() > -1e-3


@pytest.mark.parametrize("phi", [0, 10])
def test_energy_ledger_counts_contacts_that_end_under_load(phi):
    """The vertices of a soft block slide over the rim of its bed and leave the face while pressed.

    The energy of their springs is counted as lost in the dashpot. (Without it the ledger is open by
    4.6e-4 and 8.4e-4 at any step.)
    """
    sim = simulate(
        [
            {"group": "bed", "box": {"size": [1, 2, 1]}, "translate": [-1, -1, -1]},
            {"group": "block", "box": {"size": [1, 1, 1]}, "translate": [-1.2, -0.5, 0]},
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "block": {"velocity": [3, 0, 0]}},
        interfaces={"default": {"friction_angle": phi}},
        rock={"young_modulus": "5 MPa"},
        loads={"gravity": [0, 0, -9.81]},
        time={"safety": 0.2},
        stages=[{"name": "slide", "mode": "dynamic", "duration": 0.6, "damping": {"contact": 0.2}}],
    )
    sim.run()
    assert mean_velocity(sim, "block")[2] < -1  # it fell
    assert abs(sim.energies["error"]) < 2e-5


@pytest.mark.parametrize(
    ("steps", "least"), [(250, 1000), pytest.param(800, 10_000, marks=pytest.mark.slow)]
)
def test_contact_search_in_fragmenting_rock_agrees_with_an_all_pairs_search(steps, least):
    """48 tets break at once and fly apart: neighbours share edges, vertices, and faces."""
    sim = simulate(
        [
            {"group": "rock", "box": {"size": [2, 2, 2], "divisions": [2, 2, 2], "shape": "tet4"}},
            {"group": "bed", "box": {"size": [8, 8, 1]}, "translate": [-3, -3, -1.001]},
        ],
        {
            "rock": {"velocity": [2, 1, -3], "angular_velocity": [1, 2, 3]},
            "bed": {"fix": ["x", "y", "z"]},
        },
        interfaces={"default": {"friction_angle": 20, "cohesion": 10, "tensile_strength": 10}},
        rock={"young_modulus": "0.1 GPa"},
        model={"split": {"rock": "elements"}},
        loads={"gravity": [0, 0, -9.81]},
        stages=[{"name": "fly", "mode": "dynamic", "duration": 9, "damping": {"contact": 0.1}}],
        contact={"check": True},
    )
    edges = 0
    for _ in range(steps):
        sim.step(1)  # stops if an all-pairs search finds anything else
        edges += int((sim.contacts["kind"] == 1).sum())
    assert edges > least


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
        contacts = sim.core.fields()["edge.contact"].reshape(-1, 4)
        if before is not start:
            assert len(contacts) == 4
            assert (contacts[:, 3] >= 0).all()
        targets |= {(m, e, f) for m, f, e, _ in contacts}
        before = now
    assert len(targets) > len({(m, e) for m, e, _ in targets})  # faces did change
