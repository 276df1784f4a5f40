"""Motion of a semicircular canyon under SH waves (Trifunac)."""

import numpy as np
from scipy.special import h2vp, hankel2, jv, jvp

from cdem.verification.hexahedra import simulate

RADIUS, SPEED = 100.0, 2000.0  # of the canyon [m], of shear waves [m/s]
WIDE, DEEP = 4.0, 4.0  # distance of sides and base from its centre, in radii
SIZE = 1e-3  # peak of the wave [m/s]
STEP = 2e-3  # of its samples [s]
FREQUENCY = 10.0  # of the wave [Hz]; eta = 2 RADIUS f / SPEED is 1
AT = (0.0, 0.5, 1.0, 1.5, 2.0)  # x over the radius


def theory(x, eta, terms=60):
    """Amplitude of the surface at x over that of a vertical incident wave.

    Trifunac (1973, Earthquake Eng. Struct. Dyn. 1, 267): waves of the flat half space and waves from
    the canyon, Hankel functions whose shear stress on its wall cancels.

    Args:
        x: Distance from the axis, over the radius.
        eta: Diameter over the length of the wave.
    """
    k = np.pi * eta
    r, angle = (1.0, np.arcsin(x)) if x <= 1 else (x, np.pi / 2)
    total = 0.0
    for m in range(0, 2 * terms, 2):  # a vertical wave is even
        wave = jv(m, k * r) - jvp(m, k) / h2vp(m, k) * hankel2(m, k * r)
        total += (2 if m == 0 else 4) * (-1j) ** m * np.cos(m * angle) * wave
    return abs(total)


def pulse(times):
    """A Ricker wavelet with its peak at 0.15 s [m/s]."""
    a = (np.pi * FREQUENCY * (times - 0.15)) ** 2
    return SIZE * (1 - 2 * a) * np.exp(-a)


def canyon(around, out):
    """Points, hexahedra and surfaces: rays from the wall of the canyon to the sides and the base."""
    edge = np.arctan2(DEEP, WIDE)
    steps = [round(around * part / np.pi) for part in (edge, np.pi - 2 * edge, edge)]
    angle = np.concatenate([
        np.linspace(0, edge, steps[0] + 1)[:-1],
        np.linspace(edge, np.pi - edge, steps[1] + 1)[:-1],
        np.linspace(np.pi - edge, np.pi, steps[2] + 1),
    ])  # fmt: skip
    ray = np.stack([np.cos(angle), -np.sin(angle)], axis=1)
    tiny = 1e-12
    reach = np.minimum(WIDE / np.maximum(abs(ray[:, 0]), tiny), DEEP / np.maximum(-ray[:, 1], tiny))
    way = 1 + np.linspace(0, 1, out + 1)[:, None] * (reach - 1)
    plane = RADIUS * way[:, :, None] * ray
    x, z = plane[:, :, 0], plane[:, :, 1]
    count, thick = x.size, RADIUS / out
    flat = np.stack([x.ravel(), np.zeros(count), z.ravel()], axis=1)
    points = np.concatenate([flat, flat + [0, thick, 0]])
    one = np.arange(count).reshape(x.shape)
    feet = np.stack([one[:-1, :-1], one[1:, :-1], one[1:, 1:], one[:-1, 1:]], axis=-1)
    a, b, c, d = feet.reshape(-1, 4).T
    cells = np.stack([a, d, d + count, a + count, b, c, c + count, b + count], axis=1)
    rim, ends = one[-1], np.cumsum(steps)

    def faces(first, last):
        side = rim[first : last + 1]
        return np.stack([side[:-1], side[1:], side[1:] + count, side[:-1] + count], axis=1)

    return points, cells, {
        "east": faces(0, ends[0]), "base": faces(ends[0], ends[1]), "west": faces(ends[1], ends[2])
    }  # fmt: skip


def run(study):
    """Amplitudes at two frequencies, by the transform of a pulse."""
    samples = pulse(np.arange(0, 0.5, STEP))
    record = f"records.wave={{samples: {samples.tolist()}, unit: m/s, step: {STEP}}}"
    points, cells, surfaces = canyon(96, 48)
    simulation = simulate(study, points, {"rock": cells}, surfaces, record)
    start = simulation.build.start_position
    places = [(x, -np.sqrt(max(1 - x**2, 0))) for x in AT]
    nodes = [
        np.linalg.norm(start[:, [0, 2]] - RADIUS * np.array(at), axis=1).argmin() for at in places
    ]
    rows = []
    until = simulation.case.stages[0].duration or 0.0
    while simulation.time < until:
        simulation.step(2)
        rows.append((simulation.time, *simulation.fields["velocity"][nodes, 1]))
    times, *motion = np.array(rows).T
    for eta in (0.5, 1.0):
        frequency = eta * SPEED / (2 * RADIUS)
        ours = [spectrum(times, v, frequency) for v in motion]
        sent = spectrum(STEP * np.arange(len(samples)), samples, frequency)
        for node, x, amplitude in zip(nodes, AT, ours, strict=True):
            seat = np.hypot(start[node, 0], start[node, 2]) / RADIUS
            at = start[node, 0] / RADIUS if seat < 1.01 else seat
            study.check(f"eta {eta:g}: amplitude at x/a = {x:g}", theory=theory(min(at, at), eta),
                        ours=amplitude / sent, within=0.1, absolute=True)  # fmt: skip
        smooth = np.linspace(0, 3, 121)
        study.curve(f"Amplitude, eta {eta:g}", "x over the radius [1]", "amplitude [1]",
                    {"theory": (smooth, [theory(x, eta) for x in smooth]),
                     ".cdem": (AT, np.array(ours) / sent)})  # fmt: skip


def spectrum(times, values, frequency):
    """Fourier amplitude at a frequency."""
    step = times[1] - times[0]
    return abs(np.exp(-2j * np.pi * frequency * times) @ values) * step
