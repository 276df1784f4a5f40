"""A slope in an earthquake: sides with a free field against a wide model."""

import numpy as np

from cdem.verification.hexahedra import simulate

CELL, HIGH, LOW = 5.0, 12, 6  # [m], cells
SPEED = 1e-3  # peak of the wave [m/s]
STEP = 2e-3  # of its samples [s]
FREQUENCY = 5.0  # of the wave [Hz]; shear waves are 84 m long
NEAR, WIDE = 28, 90  # cells from the crest to a side


def theory():
    """Peak velocity of crest and toe over the peak of the wave.

    By a separate finite element program: plane strain, square elements, lumped masses, a model with
    sides 450 m from the crest.
    """
    return {"crest": 2.154, "toe": 1.636}


def pulse(times):
    """A Ricker wavelet with its peak at 0.25 s [m/s]."""
    a = (np.pi * FREQUENCY * (times - 0.25)) ** 2
    return SPEED * (1 - 2 * a) * np.exp(-a)


def slope(half):
    """Points, hexahedra and surfaces of the slope; the crest is this many cells from each side."""
    across = 2 * half + HIGH - LOW
    tops = [HIGH if i < half else max(HIGH - (i - half) - 1, LOW) for i in range(across)]
    number: dict[tuple[int, int, int], int] = {}

    def at(i, k):
        return [number.setdefault((i, j, k), len(number)) for j in (0, 1)]

    cells = []
    for i, top in enumerate(tops):
        for k in range(top):
            feet = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)]
            low, high = ([f[j] for f in feet] for j in (0, 1))
            cells.append([low[0], low[1], high[1], high[0], low[3], low[2], high[2], high[3]])
    points = CELL * np.array(list(number), float)

    def faces(i, tall):
        return [[*at(i, k), *at(i, k + 1)[::-1]] for k in range(tall)]

    base = [[*at(i, 0), *at(i + 1, 0)[::-1]] for i in range(across)]
    surfaces = {"base": base, "behind": faces(0, HIGH), "before": faces(across, LOW)}
    return points, np.array(cells), {name: np.array(some) for name, some in surfaces.items()}


def shaken(study, half, *settings):
    """Times [s], and velocities of crest and toe along x over the peak of the wave."""
    points, cells, surfaces = slope(half)
    samples = pulse(np.arange(0, 0.6, STEP)).tolist()
    record = f"records.wave={{samples: {samples}, unit: m/s, step: {STEP}}}"
    simulation = simulate(study, points, {"rock": cells}, surfaces, record, *settings)
    place = simulation.build.start_position
    nodes = [
        np.linalg.norm(place - CELL * np.array(at, float), axis=1).argmin()
        for at in ((half, 0, HIGH), (half + HIGH - LOW, 0, LOW))
    ]
    rows = []
    until = simulation.case.stages[0].duration or 0.0
    while simulation.time < until:
        simulation.step(2)
        rows.append((simulation.time, *simulation.fields["velocity"][nodes, 0] / SPEED))
    times, crest, toe = np.array(rows).T
    return times, crest, toe


def run(study):
    """Peaks with sides 1.7 wavelengths away; against a wide model when full."""
    times, *ours = shaken(study, NEAR)
    for name, motion in zip(("crest", "toe"), ours, strict=True):
        study.check(f"peak velocity of the {name}", theory=theory()[name], within=0.015,
                    ours=np.abs(motion).max())  # fmt: skip
    if study.full:
        far, *wide = shaken(study, WIDE)
        quiet = ["boundaries.1={name: behind, surface: behind, quiet: true}",
                 "boundaries.2={name: before, surface: before, quiet: true}"]  # fmt: skip
        _, *drained = shaken(study, NEAR, *quiet)
        for name, near, bare, exact in zip(("crest", "toe"), ours, drained, wide, strict=True):
            known = np.interp(times, far, exact)
            size = np.sqrt((known**2).mean())
            study.check(f"{name}: rms difference to the wide model, free field", theory=0,
                        ours=np.sqrt(((near - known) ** 2).mean()) / size, absolute=True,
                        within=0.02)  # fmt: skip
            study.check(f"{name}: rms difference to the wide model, quiet sides", absolute=True,
                        theory=0.17 if name == "crest" else 0.12, within=0.05,
                        ours=np.sqrt(((bare - known) ** 2).mean()) / size)  # fmt: skip
        study.curve("Crest", "time [s]", "velocity over peak of the wave [1]",
                    {"wide model": (far, wide[0]), ".free field": (times, ours[0]),
                     "quiet sides": (times, drained[0])})  # fmt: skip
