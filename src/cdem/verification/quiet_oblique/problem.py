"""Energy of oblique shear waves that a quiet side sends back."""

import numpy as np

SIDE = 240.0  # of the slab [m]
SPEED = 2000.0  # of its shear waves [m/s]
LENGTH = 12.0  # of the waves [m]
WAVES = 3.0  # in the packet
SIZE = 1e-4  # of the motion [m]


def theory(angle):
    """Part of the energy of a plane SH wave that a dashpot rho c sends back: ((1-cos)/(1+cos))^2."""
    cosine = np.cos(np.radians(angle))
    return ((1 - cosine) / (1 + cosine)) ** 2


def packet(x, z, angle, time):
    """Displacement of a Gaussian packet on its way to the side x = SIDE [m]."""
    way = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    hit = np.array([SIDE, 0.5 * SIDE + 0.25 * SIDE * way[1]])
    dx, dz = np.array([x, z]) - (hit - 0.42 * SIDE * way)[:, None]
    along, across = dx * way[0] + dz * way[1] - SPEED * time, dz * way[0] - dx * way[1]
    wide, tall = 0.5 * WAVES * LENGTH, 0.9 * WAVES * LENGTH
    shape = np.exp(-(along**2) / (2 * wide**2) - across**2 / (2 * tall**2))
    return SIZE * np.cos(2 * np.pi / LENGTH * along) * shape


def energy_left(study, angle):
    """Energy after the packet has met the side, over the energy before."""
    simulation = study.simulate()
    simulation.step(1)  # nothing moves yet: finds the step
    dt = simulation.core.scalars()["dt"]
    x, _, z = simulation.build.start_position.T
    now, before = packet(x, z, angle, 0.0), packet(x, z, angle, -dt)
    simulation.motion[:, 1] += now
    simulation.motion[:, 5] = (now - before) / dt
    first = None
    while simulation.time < 0.735 * SIDE / SPEED:
        simulation.step(10)
        stored = simulation.energies["kinetic"] + simulation.energies["strain"]
        first = first or stored
    return stored / first


def run(study):
    """Two angles between the wave and the normal of the side; four when full."""
    allowed = {45: 0.012, 60: 0.02}
    if study.full:
        allowed |= {0: 0.003, 30: 0.005}
    for angle, within in allowed.items():
        study.check(f"energy left at {angle} deg", theory=theory(angle), absolute=True,
                    ours=energy_left(study, angle), within=within)  # fmt: skip
