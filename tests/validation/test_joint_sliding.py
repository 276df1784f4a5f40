"""A body cut by a joint slides down the dip direction with the friction of the joint.

Acceleration on a plane of dip t: g (sin t - cos t tan phi).
"""

import numpy as np
import pytest
from scenes import simulate

G, DIP, FRICTION = 9.81, 35.0, 15.0


def upper_part(**joint):
    """A cube cut in two, its lower part fixed; the default interface would hold the upper one."""
    return simulate(
        [{"group": "rock", "box": {"size": [2, 2, 2]}}],
        {"rock": {}},
        defaults=True,
        rock={"young_modulus": "10 GPa"},
        model={"joints": [{"name": "bed", "origin": [1, 1, 1], **joint}]},
        interfaces={
            "default": {"friction_angle": 60},
            "pairs": [{"joint": "bed", "friction_angle": 60}],
        },
        loads={
            "gravity": [0, 0, -G],
            "supports": [{"box": {"min": [0, 0, 0], "max": [2, 2, 0.01]}, "fix": ["x", "y", "z"]}],
        },
        stages=[
            {"name": "settle", "mode": "static", "tolerance": 1e-6},
            {
                "name": "run",
                "mode": "dynamic",
                "duration": 1.0,
                "set": {"interfaces.pairs.0.friction_angle": FRICTION},
            },
        ],
    )


def velocity(sim):
    """Of the part that is not held [m/s]."""
    fields, t = sim.fields, sim.build.topology
    held = np.unique(t.node_block[sim.build.start_position[:, 2] < 0.01])
    free = ~np.isin(t.node_block, held)
    mass = fields["mass"][free]
    return mass @ fields["velocity"][free] / mass.sum()


@pytest.mark.parametrize("direction", [0.0, 90.0, 217.0])
def test_acceleration_on_a_joint_is_down_its_dip_direction(direction):
    """g (sin t - cos t tan phi) along the dip direction, 0 across it.

    Tolerance: the block of soft rock vibrates, which disturbs the fit by 9e-5.
    """
    sim = upper_part(dip=DIP, dip_direction=direction)
    assert len(sim.build.topology.block_group) == 2
    t, azimuth = np.radians(DIP), np.radians(direction)
    down = np.array([np.cos(t) * np.sin(azimuth), np.cos(t) * np.cos(azimuth), -np.sin(t)])
    assert sim.run_stage("settle") == "converged"
    start, times, speeds = sim.time, [], []
    while sim.run_until(start + 0.002 * (len(times) + 1)) == "running" and len(times) < 100:
        times.append(sim.time)
        speeds.append(velocity(sim))
    late = np.array(times) > start + 0.05
    slope = np.polyfit(np.array(times)[late], np.array(speeds)[late], 1)[0]
    exact = G * (np.sin(t) - np.cos(t) * np.tan(np.radians(FRICTION)))
    assert slope == pytest.approx(exact * down, abs=3e-4 * exact)
