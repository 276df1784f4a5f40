"""Motion of the crest of a wedge-shaped ridge under SH waves."""

import numpy as np

from cdem.verification.hexahedra import simulate

SPEED = 2000.0  # of shear waves [m/s]
LENGTH = 120.0  # of the wave at its dominant frequency [m]
DEPTH, HALF, CELL = 200.0, 300.0, 2.5  # base below the crest, half width, cell [m]
SIZE = 1e-3  # peak of the wave [m/s]
STEP = 1e-3  # of its samples [s]
DELAY = 1.2 * LENGTH / SPEED  # peak of the wave at the base [s]


def theory(angle):
    """Crest over the incident wave, at every frequency: 2 pi over the angle of the wedge.

    Sanchez-Sesma (1985, Bull. Seism. Soc. Am. 75, 263); flat ground moves twice as far as the wave.
    """
    return 360.0 / angle


def pulse(times):
    """A Ricker wavelet [m/s]."""
    a = (np.pi * SPEED / LENGTH * (times - DELAY)) ** 2
    return SIZE * (1 - 2 * a) * np.exp(-a)


def ridge(angle):
    """Points, hexahedra and base of the ridge: columns of cells under flanks of one slope."""
    across, tall = round(2 * HALF / CELL), round(DEPTH / CELL)
    x = np.linspace(-HALF, HALF, across + 1)
    top = -np.abs(x) * np.tan(np.radians((180 - angle) / 2))
    z = -DEPTH + (top[:, None] + DEPTH) * np.linspace(0, 1, tall + 1)
    plane = np.stack([np.broadcast_to(x[:, None], z.shape), np.zeros_like(z), z], axis=2)
    points = np.concatenate([plane.reshape(-1, 3), plane.reshape(-1, 3) + [0, CELL, 0]])
    one = np.arange(z.size).reshape(z.shape)
    feet = np.stack([one[:-1, :-1], one[1:, :-1], one[1:, 1:], one[:-1, 1:]], axis=-1)
    a, b, c, d = feet.reshape(-1, 4).T
    cells = np.stack([a, b, b + z.size, a + z.size, d, c, c + z.size, d + z.size], axis=1)
    foot = one[:, 0]
    base = np.stack([foot[:-1], foot[1:], foot[1:] + z.size, foot[:-1] + z.size], axis=1)
    return points, cells, {"base": base}


def crest(study, angle):
    """Times [s] and velocity of the crest [m/s]."""
    samples = pulse(np.arange(0, 2.4 * DELAY, STEP)).tolist()
    record = f"records.wave={{samples: {samples}, unit: m/s, step: {STEP}}}"
    points, cells, surfaces = ridge(angle)
    simulation = simulate(study, points, {"rock": cells}, surfaces, record)
    node = np.linalg.norm(simulation.build.start_position, axis=1).argmin()
    rows = []
    until = simulation.case.stages[0].duration or 0.0
    while simulation.time < until:
        simulation.step(2)
        rows.append((simulation.time, simulation.fields["velocity"][node, 1]))
    return np.array(rows).T


def run(study):
    """Ridges of 150 and 120 degrees over flat ground, until waves from the ends of the model come."""
    times, flat = crest(study, 180)
    arrival = DEPTH / SPEED + DELAY
    window = (times > arrival - LENGTH / SPEED) & (times < arrival + 90.0 / SPEED)
    for angle in (150, 120):
        seen, motion = crest(study, angle)
        ours, known = np.interp(times, seen, motion)[window], flat[window]
        ratio = theory(angle) / theory(180)
        study.check(f"crest of {angle} deg over flat ground", theory=ratio, within=0.015,
                    ours=ours @ known / (known @ known))  # fmt: skip
        largest = np.abs(ratio * known).max()
        study.check(f"crest of {angle} deg, largest difference, of the peak", theory=0,
                    ours=np.abs(ours - ratio * known).max() / largest, absolute=True, within=0.015)  # fmt: skip
        study.curve(f"Crest of {angle} deg", "time [s]", "velocity [m/s]",
                    {"theory": (times[window], ratio * known), ".cdem": (times[window], ours)})  # fmt: skip
