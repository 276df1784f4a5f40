"""Amplification of one layer of soil on rock."""

import numpy as np

HEIGHT = 30.0  # of the soil [m]
SPEED = 1e-4  # peak of the wave [m/s]
STEP = 2e-3  # of its samples [s]


def theory(frequency, soil, rock):
    """Motion of the surface over the motion of rock that crops out, Kramer (1996, Section 7.2.1.2).

    1 / sqrt(cos^2(kH) + a^2 sin^2(kH)), with the ratio a of the impedances of soil and rock.

    Args:
        frequency: [Hz].
        soil, rock: Density [kg/m3] and speed of shear waves [m/s].
    """
    phase = 2 * np.pi * frequency * HEIGHT / soil[1]
    ratio = soil[0] * soil[1] / (rock[0] * rock[1])
    return 1 / np.sqrt(np.cos(phase) ** 2 + ratio**2 * np.sin(phase) ** 2)


def pulse(times):
    """A Ricker wavelet of 4 Hz [m/s]."""
    a = (np.pi * 4.0 * (times - 0.4)) ** 2
    return SPEED * (1 - 2 * a) * np.exp(-a)


def run(study):
    """Ratio of Fourier amplitudes of surface and outcrop, which is twice the up-going wave."""
    samples = pulse(np.arange(0, 1.2, STEP))
    simulation = study.simulate(
        f"records.wave={{samples: {samples.tolist()}, unit: m/s, step: {STEP}}}"
    )
    rocks = {
        name: (m.density, np.sqrt(m.young_modulus / (2 * (1 + m.poisson_ratio)) / m.density))
        for name, m in simulation.case.materials.items()
    }
    z = simulation.build.start_position[:, 2]
    top, rows = z > HEIGHT - 1e-6, []
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(10)
        half = 0.5 * simulation.core.scalars()["dt_last"]
        rows.append((simulation.time - half, simulation.fields["velocity"][top, 0].mean()))
    times, surface = np.array(rows).T
    frequencies = np.array([1.0, 2.5, 5.0, 7.5])
    smooth = np.linspace(0.5, 9, 200)
    exact = theory(smooth, rocks["soil"], rocks["rock"])
    ours = amplification(smooth, times, surface, samples)
    for f in frequencies:
        study.check(f"surface over outcrop at {f:g} Hz", within=0.01,
                    theory=theory(f, rocks["soil"], rocks["rock"]),
                    ours=amplification(f, times, surface, samples)[0])  # fmt: skip
    study.curve("Amplification", "frequency [Hz]", "surface over outcrop [1]",
                {"theory": (smooth, exact), ".cdem": (smooth, ours)})  # fmt: skip


def amplification(frequencies, times, surface, samples):
    """Fourier amplitudes of the surface over twice those of the up-going wave."""

    def spectrum(t, v):
        phase = np.exp(-2j * np.pi * np.outer(np.atleast_1d(frequencies), t))
        return np.abs(phase @ v) * (t[1] - t[0])

    return spectrum(times, surface) / (2 * spectrum(STEP * np.arange(len(samples)), samples))
