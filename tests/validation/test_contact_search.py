"""The contact search finds what an all-pairs search finds, in every step."""

import numpy as np
import pytest
from scenes import simulate, turn


def tumble(steps, blocks_per_side, modulus="0.1 GPa", seed=7, spacing=1.0):
    """Random convex blocks fall and tumble in a box. `spacing` is that of their centres [m].

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
        place = spacing * (np.array([i, j, k]) + 0.5) + rng.uniform(-0.03, 0.03, 3)
        bodies.append({"group": "blocks", "polyhedron": {"vertices": (points + place).tolist()}})
    side = spacing * n
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
    """None of them begins too deep in another."""
    touching, sim = tumble(steps=2000, blocks_per_side=7, spacing=1.2)
    assert touching > 100
    assert np.isfinite(sim.fields["position"]).all()


@pytest.mark.parametrize(
    ("high", "steps", "least"),
    [(1, 120, 1000), pytest.param(2, 800, 10_000, marks=pytest.mark.slow)],
)
def test_contact_search_in_fragmenting_rock_agrees_with_an_all_pairs_search(high, steps, least):
    """24 or 48 tets break at once and fly apart: neighbours share edges, vertices, and faces."""
    cells = [2, 2, high]
    sim = simulate(
        [
            {"group": "rock", "box": {"size": cells, "divisions": cells, "shape": "tet4"}},
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


SHAPES = ["tet4", "wedge6", "pyramid5", "hex8"]


@pytest.mark.slow
@pytest.mark.parametrize("other", SHAPES)
@pytest.mark.parametrize("one", SHAPES)
def test_contact_search_among_thrown_shapes_agrees_with_an_all_pairs_search(one, other):
    """Two bodies of elements that come apart, one thrown at the other, on one large face.

    In every second throw the bodies overlap at the start, as deep as contacts take.
    """
    throw = len(SHAPES) * SHAPES.index(one) + SHAPES.index(other)
    rng = np.random.default_rng(throw)
    lift = -0.008 if throw % 2 else 0.01
    cells = {shape: [2, 2, 1] if shape != "pyramid5" else [1, 1, 1] for shape in SHAPES}
    sim = simulate(
        [
            {
                "group": "one",
                "box": {"size": [1, 1, 1], "divisions": cells[one], "shape": one},
                "translate": [*rng.uniform(-0.3, 0.3, 2).tolist(), 1 + lift],
            },
            {
                "group": "other",
                "box": {"size": [1, 1, 1], "divisions": cells[other], "shape": other},
                "translate": [0, 0, 0.001 if throw % 3 else -0.004],
            },
            {"group": "bed", "box": {"size": [10, 10, 1]}, "translate": [-4.5, -4.5, -1]},
        ],
        {
            "one": {
                "velocity": [*rng.uniform(-2, 2, 2).tolist(), -4],
                "angular_velocity": rng.uniform(-3, 3, 3).tolist(),
            },
            "other": {},
            "bed": {"fix": ["x", "y", "z"]},
        },
        interfaces={"default": {"friction_angle": 20, "cohesion": 10, "tensile_strength": 10}},
        rock={"young_modulus": "0.05 GPa"},
        model={"split": {"one": "elements", "other": "elements"}},
        loads={"gravity": [0, 0, -9.81]},
        stages=[{"name": "fly", "mode": "dynamic", "duration": 9, "damping": {"contact": 0.1}}],
        contact={"check": True},
    )
    touching = 0
    for _ in range(300):
        sim.step(1)  # stops if an all-pairs search finds anything else
        touching = max(touching, len(sim.contacts["kind"]))
    assert sim.step_count == 300
    assert touching > 50
