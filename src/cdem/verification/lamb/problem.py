"""Vertical force on a half space (Lamb, Pekeris)."""

import numpy as np

from cdem.verification.hexahedra import nearest, record, simulate

FORCE, PERIOD = 1e9, 0.2  # [N], [s]
AT = (200.0, 400.0)  # distances on the ground [m]
ROOT = 0.5 * np.sqrt(3 + np.sqrt(3))  # S speed over Rayleigh speed, for Poisson's ratio 1/4


def bell(t):
    """(1 - cos(2 pi t / PERIOD)) / 2 for one period, else 0."""
    return np.where((t > 0) & (t < PERIOD), 0.5 * (1 - np.cos(2 * np.pi * t / PERIOD)), 0.0)


def slope(t):
    """Derivative of the bell [1/s]."""
    inside = (t > 0) & (t < PERIOD)
    return np.where(inside, np.pi / PERIOD * np.sin(2 * np.pi * t / PERIOD), 0.0)


def theory(rock, r, t):
    """Settlement of the ground under FORCE times the bell, Poisson's ratio 1/4 [m].

    Pekeris (1955, Proc. Natl. Acad. Sci. 41, 469): a step of F gives F / (pi mu r) W(c_s t / r); W has
    three ranges, until S, until the Rayleigh wave, and 3/8. Duhamel's integral of W with the slope of
    the bell by Gauss points, those before the Rayleigh wave in x of tau = ROOT - x².
    """
    shear = rock.young_modulus / (2 * (1 + rock.poisson_ratio))
    arrive = r / np.sqrt(shear / rock.density)  # of S
    point, weight = np.polynomial.legendre.leggauss(200)
    out = 3 / 8 * bell(t - ROOT * arrive)
    s = np.sqrt(3)
    for low, high, early in ((1 / s, 1.0, True), (0.0, np.sqrt(ROOT - 1), False)):
        x = low + (high - low) * (point + 1) / 2
        tau = x if early else ROOT - x * x
        w = 6 - np.sqrt(3 * s + 5) / np.sqrt(ROOT**2 - tau**2)
        if early:
            w = (
                w
                - s / np.sqrt(tau**2 - 1 / 4)
                + np.sqrt(3 * s - 5) / np.sqrt(tau**2 + s / 4 - 3 / 4)
            ) / 32
        else:
            w = w / 16 * 2 * x
        w *= weight * (high - low) / 2
        out += arrive * (slope(t[:, None] - arrive * tau) * w).sum(axis=1)
    return FORCE / (np.pi * shear * r) * out


def spread(rock, r, half, t):
    """The same of FORCE spread over a square of 2 half [m], by 4 x 4 Gauss points."""
    point, weight = np.polynomial.legendre.leggauss(4)
    return sum(
        a * b / 4 * theory(rock, np.hypot(r + half * x, half * y), t)
        for x, a in zip(point, weight, strict=True) for y, b in zip(point, weight, strict=True)
    )  # fmt: skip


def box(cells, size):
    """Points, hexahedra, the loaded face and the far faces of a box, its corner below the force."""
    axes = [size * np.arange(n + 1) for n in cells]
    x, y, z = (g.ravel() for g in np.meshgrid(*axes, indexing="ij"))
    points = np.column_stack([x, y, -z])
    number = np.arange(len(points)).reshape([n + 1 for n in cells])
    plane = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], axis=-1)
    low, high = plane[:, :, 1:].reshape(-1, 4), plane[:, :, :-1].reshape(-1, 4)
    hexes = np.hstack([low, high])
    bottom = plane[:, :, -1].reshape(-1, 4)
    sides = [
        np.stack([a[:-1, :-1], a[1:, :-1], a[1:, 1:], a[:-1, 1:]], axis=-1).reshape(-1, 4)
        for a in (number[-1], number[:, -1])
    ]
    return points, hexes, plane[:1, :1, 0].reshape(-1, 4), np.concatenate([bottom, *sides])


def run(study):
    """The ground at two distances."""
    size, cells = (10.0, (90, 80, 70)) if study.full else (40 / 3, (60, 50, 40))
    points, hexes, spot, far = box(cells, size)
    times = np.linspace(0, PERIOD, 201)
    rows = ", ".join(f"[{t:.9g}, {f:.9g}]" for t, f in zip(times, bell(times), strict=True))
    push = f"{{surface: spot, traction: [0, 0, {-FORCE / (2 * size) ** 2}], history: [{rows}]}}"
    simulation = simulate(study, points, {"rock": hexes}, {"spot": spot, "far": far},
                          f"loads.tractions=[{push}]")  # fmt: skip
    nodes = nearest(simulation, [[r, 0, 0] for r in AT])
    t, u, _ = record(simulation, nodes, 0.42)
    rock = simulation.case.materials["granite"]
    shown: dict[str, tuple] = {}
    for k, r in enumerate(AT):
        exact, ours = spread(rock, r, size, t), -u[:, k, 2]
        peak = exact.max()
        what = f"at {r:g} m, cells of {size:.3g} m"
        study.check(f"largest settlement {what}", unit="m", theory=peak, ours=ours.max(),
                    within=0.03)  # fmt: skip
        study.check(f"largest difference over its peak {what}", theory=0,
                    ours=np.abs(ours - exact).max() / peak, within=0.04, absolute=True)  # fmt: skip
        shown |= {f"{r:g} m": (t, 1e3 * exact), f".{r:g} m, cdem": (t[::2], 1e3 * ours[::2])}
    study.curve("Settlement of the ground", "time [s]", "settlement [mm]", shown)
