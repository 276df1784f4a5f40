"""Blast in a long cylindrical hole (plane strain)."""

import numpy as np

from cdem.case.blast_pulses import second_time
from cdem.verification.hexahedra import extruded, nearest, record, simulate, walls

INNER, OUTER = 0.1, 5.0  # radii [m]
AT = (0.1, 0.5, 1.0, 2.0, 3.0)  # where waves are recorded [m]
SPAN, COUNT = 8e-3, 1 << 13  # of the numerical inversion [s], times


def bessel(order, z):
    """Modified Bessel function K_0 or K_1(z), for complex z off the negative axis.

    DLMF 10.32.8 with t = x²; the trapezoidal rule converges exponentially.
    """
    x = np.linspace(-7, 7, 1401)
    inner = np.array([(np.exp(-x * x) * x ** (2 * order) * (1 + x * x / (2 * k)) ** (order - 0.5)).sum()
                      for k in z]) * (x[1] - x[0])  # fmt: skip
    return np.sqrt(np.pi / (2 * z)) * np.exp(-z) * inner * (1 + order) / np.sqrt(np.pi)


def theory(rock, blast, r):
    """Times from the blast [s], radial displacement [m] and velocity [m/s] at a radius.

    Laplace transform (Selberg 1952, Ark. Fys. 5, 97): u = A K1(k r), k = s / c_p, and the stress on
    the wall (lambda + 2 mu) u' + lambda u / r is -p(s). It is inverted by a Fourier sum.
    """
    e, nu, pulse = rock.young_modulus, rock.poisson_ratio, blast.pressure
    shear = e / (2 * (1 + nu))
    first = 2 * shear * nu / (1 - 2 * nu)
    c_p = np.sqrt((first + 2 * shear) / rock.density)
    fall, rise = 1 / pulse.fall, 1 / second_time(pulse.rise, pulse.fall)
    norm = np.exp(-fall * pulse.rise) - np.exp(-rise * pulse.rise)
    step = SPAN / COUNT
    shift = 10 / SPAN  # the sum repeats itself after SPAN, by then weaker by e^10
    s = shift + 2j * np.pi * np.fft.rfftfreq(COUNT, step)
    p = blast.peak / norm * (1 / (s + fall) - 1 / (s + rise))
    k = s / c_p
    k0, k1 = bessel(0, k * INNER), bessel(1, k * INNER)
    slope = -k * (k0 + k1 / (k * INNER))  # of K1(k r) on the wall
    u = -p * bessel(1, k * r) / ((first + 2 * shear) * slope + first * k1 / INNER)
    some = slice(0, COUNT // 4)  # the sum is off at the end of its span
    t = step * np.arange(COUNT)[some]
    back = np.exp(shift * t) / step
    return t, back * np.fft.irfft(u, COUNT)[some], back * np.fft.irfft(s * u, COUNT)[some]


def ring(wall, far, across):
    """Points, hexahedra, and faces of wall and far side; sizes of cells there, number along the wall."""
    rows = round(2 * (OUTER - INNER) / (wall + far))
    part = np.arange(rows + 1) / rows
    r = INNER + (OUTER - INNER) * (wall * part + (far - wall) / 2 * part**2) * 2 / (wall + far)
    for place in AT[1:-1]:  # a row of nodes at each
        r[np.abs(r - place).argmin()] = place
    r[np.abs(r - AT[-1]).argmin()] = AT[-1]
    angle = np.linspace(0, np.pi / 2, across + 1)
    plane = np.stack([np.outer(r, np.cos(angle)), np.outer(r, np.sin(angle))], axis=-1).reshape(
        -1, 2
    )
    i, k = (a.ravel() for a in np.meshgrid(range(rows), range(across), indexing="ij"))
    low = i * (across + 1) + k
    quads = np.column_stack([low, low + across + 1, low + across + 2, low + 1])
    points, cells = extruded(plane, quads, wall)
    k = np.arange(across)
    inner = walls(np.column_stack([k, k + 1]), len(plane))
    outer = walls(np.column_stack([k, k + 1]) + rows * (across + 1), len(plane))
    return points, cells, inner, outer


def run(study):
    """Peaks of the wave at five distances."""
    sizes = (0.005, 0.005, 16) if study.full else (0.005, 0.015, 12)
    points, cells, wall, far = ring(*sizes)
    simulation = simulate(study, points, {"rock": cells}, {"wall": wall, "far": far})
    nodes = nearest(simulation, [[r, 0, 0] for r in AT])
    times, u, v = record(simulation, nodes, 1.3e-3)
    rock, charge = simulation.case.materials["granite"], simulation.case.loads.blasts[0]
    shown: dict[str, tuple] = {}
    for k, r in enumerate(AT):
        t, *exact = theory(rock, charge, r)
        study.check(f"peak displacement at {r:g} m", unit="m", theory=exact[0].max(),
                    ours=u[:, k, 0].max(), within=0.01)  # fmt: skip
        study.check(f"peak velocity at {r:g} m", unit="m/s", theory=exact[1].max(),
                    ours=v[:, k, 0].max(), within=0.03)  # fmt: skip
        some = t < times[-1]
        shown |= {f"{r:g} m": (1e3 * t[some], exact[1][some]),
                  f".{r:g} m, cdem": (1e3 * times[::20], v[::20, k, 0])}  # fmt: skip
    study.curve("Velocity", "time [ms]", "radial velocity [m/s]", shown)
