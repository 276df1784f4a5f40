"""Flat ground between sides with a free field moves as a column of it does."""

import numpy as np

HEIGHT, CELLS = 60.0, 12
SPEED = 1e-3  # peak of the waves [m/s]
STEP = 2e-3  # of their samples [s]


def theory(wave, times, height, speed):
    """Velocity of uniform ground at a height above its base [m/s]: up-going wave and its echo.

    v(t - z/c) + v(t - (2H - z)/c), with the wave v at the base.
    """
    return wave(times - height / speed) + wave(times - (2 * HEIGHT - height) / speed)


def pulse(times, frequency):
    """A Ricker wavelet with its peak at 0.2 s [m/s]."""
    a = (np.pi * frequency * (times - 0.2)) ** 2
    return SPEED * (1 - 2 * a) * np.exp(-a)


def run(study):
    """Hexahedra in three models, wedges and tets; the free surface against the theory."""
    kinds = {
        "hexahedra": (1e-11, []),
        "wedges": (1e-11, ["model.blocks.0.box.shape=wedge6"]),
        "hexahedra that rotate": (1e-4, ["elements.formulation=corotational"]),
        "tets": (0.03, ["model.blocks.0.box.shape=tet4"]),
    }
    for name, (within, settings) in kinds.items():
        simulation = study.simulate(*records(study), *settings)
        times, worst, top = motion(simulation)
        study.check(f"{name}: largest difference to the column, of the motion", theory=0,
                    ours=worst, absolute=True, within=within)  # fmt: skip
        if name == "hexahedra":
            rock = simulation.case.materials["rock"]
            modulus = rock.young_modulus / (2 * (1 + rock.poisson_ratio))
            exact = theory(lambda t: pulse(t, 4.0), times, HEIGHT, np.sqrt(modulus / rock.density))
            study.check("velocity of the surface along x, largest error", theory=0, absolute=True,
                        ours=np.abs(top - exact).max() / (2 * SPEED), within=0.02)  # fmt: skip
            study.curve("Surface", "time [s]", "velocity [m/s]",
                        {"theory": (times, exact), ".cdem": (times, top)})  # fmt: skip


def records(study):
    """Settings of the two records."""
    times = np.arange(0, 0.5, STEP)
    for name, frequency in (("shear", 4.0), ("push", 5.0)):
        samples = pulse(times, frequency).tolist()
        yield f"records.{name}={{samples: {samples}, unit: m/s, step: {STEP}}}"


def motion(simulation):
    """Times [s], largest difference to the column over its largest speed, and the surface [m/s]."""
    position = simulation.build.start_position
    level = np.round(position[:, 2] / (HEIGHT / CELLS)).astype(int)
    corner = np.linalg.norm(position - [HEIGHT, HEIGHT, HEIGHT], axis=1).argmin()
    rows, worst, largest = [], 0.0, 0.0
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(1)
        velocity = simulation.fields["velocity"]
        column = simulation.core.fields()["columns.after"].reshape(-1, 4)[: CELLS + 1, :3]
        worst = max(worst, np.abs(velocity - column[level]).max())
        largest = max(largest, np.abs(column).max())
        half = 0.5 * simulation.core.scalars()["dt_last"]
        rows.append((simulation.time - half, velocity[corner, 0]))
    times, top = np.array(rows).T
    return times, worst / largest, top
