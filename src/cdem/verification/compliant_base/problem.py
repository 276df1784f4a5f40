"""A wave that comes up through a compliant or a rigid base."""

import numpy as np

HEIGHT = 60.0  # [m]
SPEED = 1e-3  # peak of the wave [m/s]
STEP = 2e-3  # of its samples [s]


def theory(wave, times, speed, *, rigid=False, at="surface"):
    """Velocity of the surface, or of the base, of a column with shear waves of this speed [m/s].

    The free surface doubles a wave v(t). A compliant base lets what comes down out: the surface moves
    with 2 v(t - H/c), the base with v(t) + v(t - 2H/c). A rigid base moves with v and sends the wave
    back: 2 v(t - H/c) - 2 v(t - 3H/c) + ...
    """
    way = HEIGHT / speed
    if at == "base":
        return wave(times) + wave(times - 2 * way)
    count = 8 if rigid else 1
    return sum(2 * (-1) ** k * wave(times - (2 * k + 1) * way) for k in range(count))


def pulse(frequency, times):
    """A Ricker wavelet with its peak at 1.5 periods [m/s]."""
    a = (np.pi * (frequency * times - 1.5)) ** 2
    return SPEED * (1 - 2 * a) * np.exp(-a)


def run(study):
    """Largest error over time, of the peak."""
    rock = study.case().materials["rock"]
    speed = np.sqrt(rock.young_modulus / (2 * (1 + rock.poisson_ratio)) / rock.density)
    frequency = speed / 50  # 20 cells a wavelength at 2.5 times this frequency
    samples = pulse(frequency, np.arange(0, 3 / frequency, STEP))
    record = f"records.wave={{samples: {samples.tolist()}, unit: m/s, step: {STEP}}}"

    def wave(times):
        return np.interp(times, STEP * np.arange(len(samples)), samples, 0.0, 0.0)

    kinds = {"compliant": [], "rigid": ["boundaries.base.quiet=false",
             "boundaries.base.input={record: wave, direction: [1, 0, 0], kind: rigid}"]}  # fmt: skip
    for kind, settings in kinds.items():
        times, surface, base = motion(study.simulate(record, *settings))
        exact = theory(wave, times, speed, rigid=kind == "rigid")
        within = 0.04 if kind == "rigid" else 0.02
        early = times < 6 * HEIGHT / speed  # two echoes of a rigid base
        study.check(f"{kind} base: error of the surface, of the peak", theory=0, absolute=True,
                    ours=np.abs(surface - exact)[early].max() / (2 * SPEED), within=within)  # fmt: skip
        study.curve(f"Surface above a {kind} base", "time [s]", "velocity [m/s]",
                    {".cdem": (times, surface), "theory": (times, exact)})  # fmt: skip
        if kind == "compliant":
            exact = theory(wave, times, speed, at="base")
            study.check("compliant base: error of the base, of the peak", theory=0, absolute=True,
                        ours=np.abs(base - exact).max() / SPEED, within=within)  # fmt: skip
            late = times > 2 * HEIGHT / speed + 4 / frequency
            study.check("compliant base: left when the wave has gone", theory=0, absolute=True,
                        ours=np.abs(base[late]).max() / SPEED, within=0.01)  # fmt: skip


def motion(simulation):
    """Times of velocities [s], and velocity of surface and base along x [m/s]."""
    z = simulation.build.start_position[:, 2]
    top, foot = z > HEIGHT - 1e-6, z < 1e-6
    rows = []
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(1)
        v = simulation.fields["velocity"][:, 0]
        half = 0.5 * simulation.core.scalars()["dt_last"]  # velocities lag half a step
        rows.append((simulation.time - half, v[top].mean(), v[foot].mean()))
    return np.array(rows).T
