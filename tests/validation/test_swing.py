"""The paper's Figs. 4 and 5: a 10 m square hung by its bottom left corner swings as a pendulum."""

import numpy as np
import pytest
from scenes import simulate

GRAVITY, SIDE = 9.81, 10.0
ARM = SIDE / np.sqrt(2)  # from the corner to the centre of mass
START = np.radians(135)  # the centre starts up on the right, counted from straight down
RATE2 = GRAVITY * ARM / (SIDE**2 / 6 + ARM**2)  # m g d / I, I = m a^2 / 6 + m d^2


def pendulum(time, parts=400):
    """theta'' = -(m g d / I) sin theta from rest at START (Runge-Kutta): angles at `time`."""
    state, now, angles = np.array([START, 0.0]), 0.0, []

    def rate(y):
        return np.array([y[1], -RATE2 * np.sin(y[0])])

    for then in time:
        h = (then - now) / parts
        for _ in range(parts):
            k1 = rate(state)
            k2 = rate(state + h / 2 * k1)
            k3 = rate(state + h / 2 * k2)
            k4 = rate(state + h * k3)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        now = then
        angles.append(state[0])
    return np.array(angles)


def period():
    """4 sqrt(I / (m g d)) K(sin(START / 2)), K by the arithmetic-geometric mean."""
    a, b = 1.0, np.cos(START / 2)
    for _ in range(8):
        a, b = (a + b) / 2, np.sqrt(a * b)
    return 2 * np.pi / (a * np.sqrt(RATE2))


def volume(sim):
    """Of the whole block [m3], by the divergence theorem over its outer faces."""
    topology, x = sim.build.topology, sim.fields["position"]
    total = 0.0
    for face in topology.face_nodes:
        corners = x[face[face >= 0]]
        for i in range(1, len(corners) - 1):
            total += np.linalg.det(corners[[0, i, i + 1]]) / 6
    return total


@pytest.mark.parametrize("shape, divisions", [("hex8", 1), ("hex8", 4), ("wedge6", 2), ("pyramid5", 2), ("tet4", 2)])  # fmt: skip
def test_a_square_swings_as_a_pendulum(shape, divisions):
    """Angle within 0.1 % of the amplitude over three periods; volume and energy kept."""
    box = {"size": [SIDE, 1, SIDE], "divisions": [divisions, 1, divisions], "shape": shape}
    sim = simulate(
        [{"group": "square", "box": box}],
        {"square": {}},
        rock={"young_modulus": "20 GPa"},
        loads={
            "gravity": [0, 0, -GRAVITY],
            "supports": [
                {"box": {"min": [-1e-6, -1, -1e-6], "max": [1e-6, 2, 1e-6]}, "fix": ["x", "y", "z"]}
            ],
        },
    )
    mass = sim.fields["mass"]
    times, angles, volumes, errors = [], [], [], []
    while sim.time < 3 * period():
        sim.step(100)
        center = mass @ sim.fields["position"] / mass.sum()
        times.append(sim.time)
        angles.append(np.arctan2(center[0], -center[2]))
        volumes.append(volume(sim))
        errors.append(sim.energies["error"])
    exact = pendulum(times, parts=20)
    print(
        shape,
        divisions,
        np.abs(np.array(angles) - exact).max() / START,
        np.ptp(volumes) / 100,
        np.abs(errors).max(),
        sim.step_count,
    )
    assert np.abs(np.array(angles) - exact).max() < 1e-3 * START
    assert np.abs(np.array(volumes) / SIDE**2 - 1).max() < 4e-5  # breathing, about rho g a / E
    assert np.abs(errors).max() < 1e-6
