"""Histories: each column is what its name says."""

import numpy as np
import pytest
from scenes import simulate

from cdem.run.histories import tracks


def test_columns_of_a_box_in_free_flight():
    """Velocity (1, 2, 4) m/s, no force: the mass centre moves on, nothing else happens."""
    velocity = np.array([1.0, 2.0, 4.0])
    sim = simulate(
        [{"group": "box", "box": {"size": [1, 2, 3]}}],
        {"box": {"velocity": list(velocity)}},
        histories=[
            {
                "name": "all",
                "group": "box",
                "quantities": ["centroid", "displacement", "velocity", "force", "energy"],
            },
            {"name": "corner", "point": [0.9, 1.9, 2.9], "quantities": ["displacement"]},
        ],
    )
    sim.step(3)
    row = {
        name: value
        for track in tracks(sim)
        for name, value in zip(track.names, track.values(), strict=True)
    }
    way = sim.time * velocity
    expected = {"all.kinetic_energy [J]": 0.5 * 6 * 2500 * 21.0}
    for axis, start, moved, speed in zip("xyz", (0.5, 1, 1.5), way, velocity, strict=True):
        expected |= {
            f"all.centroid_{axis} [m]": start + moved,
            f"all.displacement_{axis} [m]": moved,
            f"all.velocity_{axis} [m/s]": speed,
            f"all.force_{axis} [N]": 0,
            f"corner.displacement_{axis} [m]": moved,
        }
    assert row == pytest.approx(expected, rel=1e-12, abs=1e-15)
