"""Tractions and initial velocities as the core gets them."""

import numpy as np
import pytest
from scenes import simulate


@pytest.mark.parametrize("shape", ["hex8", "tet4"])
def test_a_traction_is_shared_by_the_vertices_of_each_face(shape):
    """Force of the top: its area times the traction, at the centroid of the top."""
    sim = simulate(
        [{"group": "box", "box": {"size": [2, 3, 1], "divisions": [2, 2, 1], "shape": shape}}],
        {"box": {}},
        loads={
            "tractions": [
                {"surface": {"group": "box", "normal": [0, 0, 1]}, "traction": [10, 20, -40]}
            ]
        },
    )
    arrays, x = sim.build.arrays, sim.build.start_position
    force = arrays["load.force"].reshape(-1, 4)[:, :3]
    owner = np.repeat(np.arange(len(x)), np.diff(arrays["load.first"]))
    assert (x[owner, 2] == 1).all()
    np.testing.assert_allclose(force.sum(axis=0), [60, 120, -240], rtol=1e-14)
    np.testing.assert_allclose(force[:, 2] @ x[owner, :2] / -240, [1, 1.5], rtol=1e-14)


def test_a_group_starts_with_its_velocity_and_spin():
    """v = v_c + omega x (x - c), c the mass centre of the group."""
    velocity, spin = [1, 2, 3], [0.5, -1, 2]
    sim = simulate(
        [{"group": "box", "box": {"size": [2, 3, 1]}, "translate": [5, 6, 7]}],
        {"box": {"velocity": velocity, "angular_velocity": spin}},
    )
    arm = sim.build.start_position - [6, 7.5, 7.5]
    np.testing.assert_allclose(sim.fields["velocity"], velocity + np.cross(spin, arm), atol=1e-14)


def test_supported_nodes_begin_with_the_velocity_of_their_support():
    """Held at the base, driven on top by a curve that begins at half: no jolt, and a warning."""
    base = {"min": [-9, -9, -0.01], "max": [9, 9, 0.01]}
    top = {"min": [-9, -9, 0.99], "max": [9, 9, 1.01]}
    sim = simulate(
        [{"group": "box", "box": {"size": [1, 1, 1], "divisions": [1, 1, 2]}}],
        {"box": {"velocity": [1, 2, 3]}},
        loads={
            "supports": [{"box": base, "fix": ["x", "z"]}],
            "velocities": [
                {
                    "box": top,
                    "velocity": [0, 0, 4],
                    "components": ["z"],
                    "history": [[0, 0.5], [1, 1]],
                }
            ],
        },
    )
    z, v = sim.build.start_position[:, 2], sim.fields["velocity"]
    assert (v[z == 0] == [0, 2, 0]).all()
    assert (v[z == 0.5] == [1, 2, 3]).all()
    assert (v[z == 1] == [1, 2, 2]).all()
    assert any("group box: 8 of its 12 nodes are supported" in w for w in sim.audit.warnings)


@pytest.mark.parametrize("mass", ["exact", "lumped"])
def test_a_held_node_with_a_velocity_makes_no_jolt(mass):
    """A cube flies with its base held: the support does no work, and the energy is that of the rest.

    It took 25 % of the energy of the cube in the first step.
    """
    base = {"min": [-9, -9, -0.01], "max": [9, 9, 0.01]}
    sim = simulate(
        [{"group": "box", "box": {"size": [1, 1, 1]}}],
        {"box": {"velocity": [0, 0, 1]}},
        elements={"mass": mass},
        loads={"supports": [{"box": base, "fix": ["x", "y", "z"]}]},
    )
    start = sim.build.arrays["node.mass"][4:].sum() / 2 if mass == "lumped" else 2500 / 6
    sim.step(1)
    assert sim.energies["external"] == 0
    assert sim.energies["kinetic"] + sim.energies["strain"] == pytest.approx(start, rel=1e-6)
    sim.step(200)
    assert abs(sim.energies["external"]) < 1e-9 * start
    assert abs(sim.energies["error"]) < 1e-3
