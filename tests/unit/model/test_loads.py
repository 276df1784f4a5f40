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
