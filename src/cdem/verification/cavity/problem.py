"""Blast in a spherical cavity (Sharpe, Blake)."""

import itertools

import numpy as np

from cdem.case.blast_pulses import second_time
from cdem.verification.hexahedra import record, simulate

INNER, OUTER = 1.0, 10.0  # radii [m]
AT = (1.0, 2.0, 3.0, 5.0)  # where waves are recorded [m]


def speeds(rock):
    """Speeds of P and S waves [m/s]."""
    e, nu = rock.young_modulus, rock.poisson_ratio
    return np.sqrt(e * np.array([(1 - nu) / (1 - 2 * nu), 0.5]) / ((1 + nu) * rock.density))


def theory(rock, blast, r, t):
    """Radial displacement [m] and velocity [m/s] at a radius, the time counted from the wave's front.

    u = d(f / r)/dr with f'' + 2 a f' + w² f = -R p / rho, w = 2 c_s / R, a = 2 c_s² / (R c_p); Sharpe
    (1942, Geophysics 7, 144), Blake (1952, J. Acoust. Soc. Am. 24, 211). The pressure is a sum of
    exponentials, and so is f.
    """
    c_p, c_s = speeds(rock)
    w, a = 2 * c_s / INNER, 2 * c_s**2 / (INNER * c_p)
    pulse = blast.pressure
    fall, rise = 1 / pulse.fall, 1 / second_time(pulse.rise, pulse.fall)
    norm = np.exp(-fall * pulse.rise) - np.exp(-rise * pulse.rise)
    root = -a + 1j * np.sqrt(w**2 - a**2)
    f = np.zeros((3, len(t)))  # with its derivatives
    for sign, k in ((1, fall), (-1, rise)):
        forced = -INNER * blast.peak * sign / (norm * rock.density * (k * k - 2 * a * k + w * w))
        free = -forced * (-k - np.conj(root)) / (root - np.conj(root))  # f = f' = 0 at t = 0
        for order in range(3):
            f[order] += forced * (-k) ** order * np.exp(-k * t)
            f[order] += 2 * np.real(free * root**order * np.exp(root * t))
    return -f[0] / r**2 - f[1] / (r * c_p), -f[1] / r**2 - f[2] / (r * c_p)


def octant(per_metre, across):
    """Points, hexahedra, and faces of wall and far side; cells a metre of radius, and an edge."""
    radii = np.linspace(INNER, OUTER, round((OUTER - INNER) * per_metre) + 1)
    tangent = np.tan(np.linspace(0, np.pi / 4, across + 1))
    u, v = (grid.ravel() for grid in np.meshgrid(tangent, tangent, indexing="ij"))
    patch = np.stack([np.ones_like(u), u, v], axis=1)
    patch /= np.linalg.norm(patch, axis=1)[:, None]
    every = np.concatenate([np.roll(patch, k, axis=1) for k in range(3)])
    unique, place = np.unique(every.round(9), axis=0, return_inverse=True)
    cell = np.arange((across + 1) ** 2).reshape(across + 1, across + 1)
    quad = np.stack([cell[:-1, :-1], cell[1:, :-1], cell[1:, 1:], cell[:-1, 1:]], axis=-1)
    quads = place.ravel()[np.concatenate([quad.reshape(-1, 4) + k * cell.size for k in range(3)])]
    points = (radii[:, None, None] * unique).reshape(-1, 3)
    layers = [quads + i * len(unique) for i in range(len(radii))]
    hexes = np.concatenate([np.hstack(pair) for pair in itertools.pairwise(layers)])
    return points, hexes, layers[0], layers[-1]


def blast(study, per_metre, across):
    """Peaks of displacement and velocity at the places of `AT`, and the curves."""
    points, hexes, wall, far = octant(per_metre, across)
    simulation = simulate(study, points, {"rock": hexes}, {"wall": wall, "far": far})
    start = simulation.build.start_position
    radius = np.linalg.norm(start, axis=1)
    levels = [np.flatnonzero(np.abs(radius - r) < 1e-6) for r in AT]
    nodes = np.concatenate(levels)
    times, *moved = record(simulation, nodes, 1.7e-3)
    along = start[nodes] / radius[nodes, None]
    ends = np.cumsum([len(level) for level in levels])[:-1]
    u, v = ([part.mean(axis=1) for part in np.split((q * along).sum(axis=2), ends, axis=1)]
            for q in moved)  # fmt: skip
    return times, u, v, simulation


def run(study):
    """Peaks of the wave at four distances; a finer mesh when full."""
    meshes = {17: (6, 0.02, 0.07), 34: (12, 0.007, 0.03)}
    for per_metre in meshes if study.full else (17,):
        across, within_u, within_v = meshes[per_metre]
        times, u, v, simulation = blast(study, per_metre, across)
        rock, charge = simulation.case.materials["granite"], simulation.case.loads.blasts[0]
        fine = np.linspace(0, 1.5e-3, 15001)
        shown: dict[str, tuple] = {}
        for k, r in enumerate(AT):
            exact = theory(rock, charge, r, fine)
            study.check(f"peak displacement at {r:g} m, {per_metre} cells a metre", unit="m",
                        theory=exact[0].max(), ours=u[k].max(), within=within_u)  # fmt: skip
            study.check(f"peak velocity at {r:g} m, {per_metre} cells a metre", unit="m/s",
                        theory=exact[1].max(), ours=v[k].max(), within=within_v)  # fmt: skip
            arrival = fine + (r - INNER) / speeds(rock)[0]
            some = arrival < times[-1]
            shown |= {f"{r:g} m": (1e3 * arrival[some], 1e3 * exact[0][some]),
                      f".{r:g} m, cdem": (1e3 * times[::4], 1e3 * u[k][::4])}  # fmt: skip
        study.curve(
            f"Displacement, {per_metre} cells a metre",
            "time [ms]",
            "radial displacement [mm]",
            shown,
        )
