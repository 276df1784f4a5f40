"""Reflection of a wave at a quiet end."""

import numpy as np

CELLS = 10  # length of the bar, in wavelengths
PERIODS = 8  # of the burst
SPEED = 1e-4  # of the wave [m/s]; strains stay small


def theory(n, courant):
    """Amplitude that comes back from a dashpot rho c at the end of a lumped column.

    R = |cos(kh/2) - cos(w dt/2)| / (cos(kh/2) + cos(w dt/2)), with the wave number k of the column:
    sin(w dt/2) = (c dt/h) sin(kh/2).

    Args:
        n: Cells a wavelength.
        courant: c dt / h.
    """
    half_step = np.pi / n * courant  # w dt / 2
    half_cell = np.arcsin(np.sin(half_step) / courant)  # k h / 2
    return abs(np.cos(half_cell) - np.cos(half_step)) / (np.cos(half_cell) + np.cos(half_step))


def burst(period):
    """A sine under a raised cosine: samples of the velocity [m/s], and the time between them [s]."""
    time = np.linspace(0, PERIODS * period, 200 * PERIODS + 1)
    wave = np.sin(2 * np.pi * time / period) * 0.5 * (1 - np.cos(2 * np.pi * time / time[-1]))
    return SPEED * wave, time[1]


def run(study):
    """P and S waves; hexahedra, and tets and wedges when full."""
    for shape in ("hex8", "tet4", "wedge6") if study.full else ("hex8",):
        for kind, axis in (("P", 0), ("S", 1)):
            for n in (10, 20):
                ours, courant, seen = reflection(study, shape, kind, axis, n)
                study.check(f"{kind}, {shape}, {n} cells a wavelength", theory=theory(n, courant),
                            ours=ours, absolute=True, within=1e-3 if shape == "hex8" else 4e-3)  # fmt: skip
                if shape == "hex8" and n == 10:
                    study.curve(f"{kind} wave in the middle of the bar", "time [periods]",
                                "velocity [m/s]", {"velocity": seen})  # fmt: skip


def reflection(study, shape, kind, axis, n):
    """Amplitude that comes back over the one sent, and c dt / h."""
    cells = CELLS * n
    rock = study.case().materials["rock"]
    nu, modulus = rock.poisson_ratio, rock.young_modulus / (2 * (1 + rock.poisson_ratio))
    if kind == "P":
        modulus *= (2 - 2 * nu) / (1 - 2 * nu)
    c = np.sqrt(modulus / rock.density)
    samples, step = burst(n / c)
    others = [a for a in "xyz" if a != "xyz"[axis]]
    direction = [float(a == axis) for a in range(3)]
    simulation = study.simulate(
        f"model.blocks.0.box={{size: [{cells}, 1, 1], divisions: [{cells}, 1, 1], shape: {shape}}}",
        f"groups.bar.fix=[{', '.join(others)}]",
        f"records.burst={{samples: {samples.tolist()}, unit: m/s, step: {step}}}",
        f"boundaries.near.input.direction={direction}",
        f"stages.pass.duration={30 * n / c}",
    )  # fmt: skip
    middle = np.abs(simulation.build.start_position[:, 0] - cells // 2) < 1e-6
    rows = []
    while simulation.time < 29 * n / c:
        simulation.step(1)
        rows.append((simulation.time, simulation.fields["velocity"][middle, axis].mean()))
    time, velocity = np.array(rows).T
    arrival, back = cells // 2 / c, (cells + cells - cells // 2) / c
    windows = [(time > t - n / c) & (time < t + (PERIODS + 1) * n / c) for t in (arrival, back)]
    sent, returned = (np.abs(velocity[w]).max() for w in windows)
    return returned / sent, c * simulation.core.scalars()["dt"], (time * c / n, velocity)
