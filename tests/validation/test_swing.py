"""The paper's Figs. 4 and 5: a 10 m square hung by its bottom left corner swings as a pendulum."""

import numpy as np
import pytest
from scenes import simulate

from cdem.verification.runner import problems

PROBLEM = problems(["swing"])[0].module  # pendulum, volume, and how the square is followed
SIDE = PROBLEM.SIDE


@pytest.mark.parametrize(
    "shape, divisions, periods",
    [
        ("hex8", 1, 1),
        pytest.param("hex8", 1, 3, marks=pytest.mark.slow),
        pytest.param("tet4", 2, 3, marks=pytest.mark.slow),
        pytest.param("hex8", 4, 3, marks=pytest.mark.slow),
        pytest.param("wedge6", 2, 3, marks=pytest.mark.slow),
        pytest.param("pyramid5", 2, 3, marks=pytest.mark.slow),
    ],
)
def test_a_square_swings_as_a_pendulum(shape, divisions, periods):
    """Angle within 0.1 % of the amplitude over the periods; volume and energy are conserved.

    Angle: the elastic square bends. Volume: it breathes by about rho g a / E. Energy: the closing
    error is 4e-8.
    """
    box = {"size": [SIDE, 1, SIDE], "divisions": [divisions, 1, divisions], "shape": shape}
    sim = simulate(
        [{"group": "square", "box": box}],
        {"square": {}},
        rock={"young_modulus": "20 GPa"},
        loads={
            "gravity": [0, 0, -PROBLEM.GRAVITY],
            "supports": [
                {"box": {"min": [-1e-6, -1, -1e-6], "max": [1e-6, 2, 1e-6]}, "fix": ["x", "y", "z"]}
            ],
        },
    )
    (times, angles, volumes, errors), _ = PROBLEM.swing(sim, periods)
    exact = PROBLEM.theory(times)
    assert np.abs(angles - exact).max() < 1e-3 * PROBLEM.START
    assert np.abs(volumes - 1).max() < 4e-5
    assert np.abs(errors).max() < 2e-7
