"""Supported nodes as the core gets them."""

import numpy as np
from scenes import simulate


def test_only_the_components_named_are_held():
    """The bottom is held along z, one corner along x and y as well; the top is driven along y."""
    sim = simulate(
        [{"group": "box", "box": {"size": [1, 1, 1]}}],
        {"box": {}},
        loads={
            "supports": [
                {"box": {"min": [-1, -1, -1], "max": [2, 2, 0]}, "fix": ["z"]},
                {"point": [0, 0, 0], "fix": ["x", "y"]},
            ],
            "velocities": [
                {
                    "box": {"min": [-1, -1, 1], "max": [2, 2, 2]},
                    "velocity": [7, 0.5, 7],
                    "components": ["y"],
                }
            ],
        },
    )
    x, arrays = sim.build.start_position, sim.build.arrays
    row = arrays["support.row"]
    assert (row >= 0).all()
    held = arrays["support.component"].reshape(-1, 3)[row].astype(bool)
    bottom, corner = x[:, 2] == 0, (x == 0).all(axis=1)
    assert np.array_equal(held, np.stack([corner, corner | ~bottom, bottom], axis=1))
    speed = arrays["support.velocity"].reshape(-1, 3)[row]
    assert np.array_equal(speed, np.where(~bottom[:, None], [0, 0.5, 0], 0))
