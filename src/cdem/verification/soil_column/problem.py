"""Amplification of one layer of soil on rock."""

import numpy as np

from cdem.model.damping import branches_of, rayleigh_factors, stiffer_in_waves

HEIGHT, ROCK = 30.0, 10.0  # of the soil, and of the rock in the model [m]
SPEED = 1e-4  # peak of the wave [m/s]
STEP = 2e-3  # of its samples [s]
JOINT = 5e9  # stiffness of soft bonds between soil and rock [Pa/m]
FREQUENCIES = (1.0, 2.5, 5.0, 7.5)  # [Hz]
LAWS = {
    "rayleigh": "{ratio: 0.05, frequency: 4 Hz}",
    "maxwell": "{ratio: 0.05, band: [0.5 Hz, 20 Hz]}",
}
SOFT = [
    "model.blocks.0.box.divisions=[1, 1, 20]",
    "model.blocks.1.box.divisions=[1, 1, 2]",
    f"interfaces.default.stiffness_n={JOINT}",
    f"interfaces.default.stiffness_s={JOINT}",
]  # a step that Rayleigh's dashpots do not make too short


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


def damped_theory(frequency, soil, rock, damping):
    """The same of damped soil and rock in the model, on rock without damping below it.

    The rock below has the impedance z of the rock in the model in the middle of its band.

    Displacement u and shear stress t go down from the surface, where they are 1 and 0, through the
    soil, the bonds, and the rock. There the wave that comes up is (u + t / (i w z)) / 2.

    Args:
        frequency: [Hz].
        soil, rock: Density [kg/m3] and speed of shear waves [m/s].
        damping: Of a stage.
    """
    w = 2 * np.pi * np.asarray(frequency)
    rayleigh, branches = rayleigh_factors(damping.rayleigh), branches_of(damping.maxwell)
    # of the modulus and of the mass; branches do not act on bonds
    stiffer, heavier = 1 + 1j * w * rayleigh.stiffness, 1 - 1j * rayleigh.mass / w
    bond = JOINT * stiffer
    for weight, rate in zip(branches.weight, branches.rate, strict=True):
        stiffer = stiffer + weight * 1j * w / (rate + 1j * w)
    u, t = np.ones_like(w), np.zeros_like(w)
    for height, (density, speed) in ((HEIGHT, soil), (ROCK, rock)):
        modulus = density * speed**2 * stiffer
        k = w * np.sqrt(density * heavier / modulus)
        c, s = np.cos(k * height), np.sin(k * height)
        u, t = u * c + t * s / (modulus * k), t * c - u * modulus * k * s
        u = u + t / bond if height == HEIGHT else u
    z = rock[0] * rock[1] * np.sqrt(stiffer_in_waves(damping.maxwell))
    return 1 / np.abs(u + t / (1j * w * z))


def pulse(times):
    """A Ricker wavelet of 4 Hz [m/s]."""
    a = (np.pi * 4.0 * (times - 0.4)) ** 2
    return SPEED * (1 - 2 * a) * np.exp(-a)


def run(study):
    """Without damping; and both laws of damping with soft bonds."""
    samples = pulse(np.arange(0, 1.2, STEP))
    smooth = np.linspace(0.5, 9, 200)
    simulation, ours = measured(study, samples)
    soil, rock = rocks_of(simulation.case)
    for f in FREQUENCIES:
        study.check(f"surface over outcrop at {f:g} Hz", within=0.01,
                    theory=theory(f, soil, rock), ours=ours(f)[0])  # fmt: skip
    lines = {"theory": (smooth, theory(smooth, soil, rock)), ".cdem": (smooth, ours(smooth))}
    for law, numbers in LAWS.items():
        simulation, ours = measured(study, samples, *SOFT, f"stages.0.damping={{{law}: {numbers}}}")
        damping = simulation.case.stages[0].damping
        for f in FREQUENCIES:
            study.check(f"{law}, surface over outcrop at {f:g} Hz", within=0.01,
                        theory=damped_theory(f, soil, rock, damping), ours=ours(f)[0])  # fmt: skip
        lines[f"{law}, theory"] = smooth, damped_theory(smooth, soil, rock, damping)
        lines[f".{law}, cdem"] = smooth, ours(smooth)
    study.curve("Amplification", "frequency [Hz]", "surface over outcrop [1]", lines)


def measured(study, samples, *settings):
    """The run, and a function of frequencies: amplitudes of the surface over those of outcrops.

    These are twice the amplitudes of the up-going wave.
    """
    simulation = study.simulate(
        f"records.wave={{samples: {samples.tolist()}, unit: m/s, step: {STEP}}}", *settings
    )
    top, rows = simulation.build.start_position[:, 2] > HEIGHT - 1e-6, []
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(10)
        half = 0.5 * simulation.core.scalars()["dt_last"]
        rows.append((simulation.time - half, simulation.fields["velocity"][top, 0].mean()))
    times, surface = np.array(rows).T

    def spectrum(frequencies, t, v):
        phase = np.exp(-2j * np.pi * np.outer(np.atleast_1d(frequencies), t))
        return np.abs(phase @ v) * (t[1] - t[0])

    wave = STEP * np.arange(len(samples))
    return simulation, lambda f: spectrum(f, times, surface) / (2 * spectrum(f, wave, samples))


def rocks_of(case):
    """Density [kg/m3] and speed of shear waves [m/s] of soil and rock."""
    return [
        (m.density, np.sqrt(m.young_modulus / (2 * (1 + m.poisson_ratio)) / m.density))
        for m in (case.materials["soil"], case.materials["rock"])
    ]
