"""Amplification of three layers on rock."""

import numpy as np

SPEED = 1e-4  # peak of the wave [m/s]
STEP = 2e-3  # of its samples [s]
ORDER = ("upper", "middle", "lower", "rock")  # downward
THICKNESS = (10.0, 20.0, 30.0)  # of the first three [m]


def theory(frequency, density, speed):
    """Surface over the up-going wave in the rock, Kramer (1996, Section 7.2.1.3), without damping.

    Args:
        frequency: [Hz], shape (frequencies,).
        density, speed: Of layers and rock, downward [kg/m3, m/s].
    """
    w = 2 * np.pi * np.asarray(frequency, float)
    up = down = np.ones_like(w, complex)
    for m, h in enumerate(THICKNESS):
        ratio = density[m] * speed[m] / (density[m + 1] * speed[m + 1])
        turn = np.exp(1j * w * h / speed[m])
        up, down = (
            0.5 * up * (1 + ratio) * turn + 0.5 * down * (1 - ratio) / turn,
            0.5 * up * (1 - ratio) * turn + 0.5 * down * (1 + ratio) / turn,
        )
    return 2 / up


def pulse(times):
    """A Ricker wavelet of 4 Hz [m/s]."""
    a = (np.pi * 4.0 * (times - 0.5)) ** 2
    return SPEED * (1 - 2 * a) * np.exp(-a)


def exact_surface(density, speed):
    """Times [s] and velocity of the surface [m/s], by the transform of the wave."""
    times = STEP * np.arange(16384)
    frequency = np.fft.rfftfreq(len(times), STEP)
    above = np.fft.rfft(pulse(times)) * theory(frequency, density, speed)
    return times, np.fft.irfft(above, len(times))


def run(study):
    """Spectra and peak of the surface."""
    samples = pulse(np.arange(0, 1.0, STEP))
    simulation = study.simulate(
        f"records.wave={{samples: {samples.tolist()}, unit: m/s, step: {STEP}}}"
    )
    rocks = [simulation.case.materials[name] for name in ORDER]
    density = [m.density for m in rocks]
    speed = [np.sqrt(m.young_modulus / (2 * (1 + m.poisson_ratio)) / m.density) for m in rocks]
    z = simulation.build.start_position[:, 2]
    top, rows = z > sum(THICKNESS) - 1e-6, []
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(4)
        half = 0.5 * simulation.core.scalars()["dt_last"]
        rows.append((simulation.time - half, simulation.fields["velocity"][top, 0].mean()))
    times, surface = np.array(rows).T
    known, exact = exact_surface(density, speed)
    # the wave begins at the base of the model, the theory at the top of the rock
    late = 10.0 / speed[-1]
    study.check("peak velocity over the peak of the wave", theory=np.abs(exact).max() / SPEED,
                ours=np.abs(surface).max() / SPEED, within=0.003)  # fmt: skip
    frequencies = np.array([2.0, 3.183, 5.0, 6.727, 9.966])
    ours = amplification(frequencies, times, surface, samples)
    for f, a in zip(frequencies, ours, strict=True):
        study.check(f"surface over outcrop at {f:g} Hz", ours=a, within=0.01,
                    theory=abs(theory(f, density, speed)) / 2)  # fmt: skip
    study.curve("Velocity of the surface", "time [s]", "velocity over peak of the wave [1]",
                {"theory": (known[known < 4] + late, exact[known < 4] / SPEED),
                 ".cdem": (times, surface / SPEED)})  # fmt: skip


def amplification(frequencies, times, surface, samples):
    """Fourier amplitudes of the surface over twice those of the up-going wave."""

    def spectrum(t, v):
        phase = np.exp(-2j * np.pi * np.outer(np.atleast_1d(frequencies), t))
        return np.abs(phase @ v) * (t[1] - t[0])

    return spectrum(times, surface) / (2 * spectrum(STEP * np.arange(len(samples)), samples))
