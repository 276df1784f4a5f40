"""Row of dominoes: speed of the wave (van Leeuwen)."""

import numpy as np

from cdem.output.render import snapshot

HEIGHT, THICKNESS, WIDTH = 0.05, 0.01, 0.025  # [m]
COUNT, SETTLED = 18, 12  # dominoes, and the first one for measuring the wave
SPIN = 13.0  # of the first domino at the start [rad/s]


def theory(spacing, gravity=9.81, parts=400):
    """Times [s] at which the tops of the dominoes have gone half their spacing, shape (COUNT,).

    Van Leeuwen (2010), The domino effect, Am. J. Phys. 78, 721-727: rigid dominoes turn over their
    front lower edges, which do not slip. A blow has no rebound, so all fallen ones lean on the next:

        h sin(a - b) = (s + d) cos(b) - d

    for a domino at the angle a that leans on one at b. Without friction between them the whole
    train moves by the angle of its first alone and keeps its energy between blows; a blow keeps
    sum(w^2) times the spin of the first, w = da/db ... being the spins of all in parts of it.

    Args:
        spacing: Gap s between dominoes [m].
    """
    pitch = spacing + THICKNESS
    front = np.linspace(0, np.arcsin(spacing / HEIGHT), parts)  # angle from blow to blow
    angle, way = front.copy(), np.ones(parts)
    inertia, drop = np.zeros(parts), np.zeros(parts)
    energy, began, times = SPIN**2, 0.0, []
    for _ in range(COUNT):
        inertia = inertia + way**2
        level = HEIGHT * np.cos(angle) + THICKNESS * np.sin(angle)
        drop = drop + level[0] - level
        won = 3 * gravity / (HEIGHT**2 + THICKNESS**2) * drop
        slowness = np.sqrt(inertia / (energy + won))
        passed = np.concatenate([[0], np.cumsum(np.diff(front) * (slowness[1:] + slowness[:-1]))])
        times.append(began + np.interp(np.arcsin(spacing / HEIGHT / 2), front, passed / 2))
        began += passed[-1] / 2
        energy = (energy + won[-1]) * inertia[-1] / (1 + inertia[-1])
        lean = np.arcsin((pitch * np.cos(angle) - THICKNESS) / HEIGHT)
        way = way * (1 - pitch * np.sin(angle) / (HEIGHT * np.cos(lean)))
        angle = angle + lean
    return np.array(times)


def settings(spacing, *, hinged):
    """The row as values of the case; hinges fix the front lower edges."""
    starts = [n * (spacing + THICKNESS) for n in range(COUNT)]
    length = starts[-1] + 0.2
    rows = [
        f"{{group: table, box: {{size: [{length:.9g}, 0.065, 0.01]}}, translate: [-0.05, -0.02, -0.01]}}"
    ]
    hinges = []
    for n, start in enumerate(starts):
        group, edge = "row" if n else "first", start + THICKNESS
        rows.append(f"{{group: {group}, box: {{size: [{THICKNESS}, {WIDTH}, {HEIGHT}]}}, "
                    f"translate: [{start:.9g}, 0, 0]}}")  # fmt: skip
        hinges.append(f"{{box: {{min: [{edge - 1e-4:.9g}, -1, -1e-4], max: [{edge + 1e-4:.9g}, 1, 1e-4]}}, "
                      f"group: {group}, fix: [x, y, z]}}")  # fmt: skip
    return [
        f"model.blocks=[{', '.join(rows)}]",
        f"groups.first.velocity=[{SPIN * HEIGHT / 2}, 0, {SPIN * THICKNESS / 2}]",
        f"groups.first.angular_velocity=[0, {SPIN}, 0]",
        f"loads.supports=[{', '.join(hinges) if hinged else ''}]",
    ]


def topple(study, spacing, modulus, *values, hinged=True):
    """Times as in `theory`, and the surface at the start, half way and at the end."""
    simulation = study.simulate(
        *settings(spacing, hinged=hinged), f"materials.plastic.young_modulus={modulus} MPa", *values
    )
    start = simulation.fields["position"].copy()
    edges = np.arange(COUNT) * (spacing + THICKNESS) + THICKNESS
    top, foot = (
        [np.flatnonzero(np.isclose(start[:, 0], x) & np.isclose(start[:, 2], z)) for x in edges]
        for z in (HEIGHT, 0)
    )
    times, shown = np.full(COUNT, np.nan), [snapshot(simulation)]
    gone, now = np.zeros(COUNT), 0.0
    while np.isnan(times[-1]) and simulation.run_until(now + 5e-4) == "running":
        before, then = gone, now
        x, now = simulation.fields["position"][:, 0], simulation.time
        gone = np.array([x[i].mean() - x[j].mean() for i, j in zip(top, foot, strict=True)])
        passed = (gone >= spacing / 2) & np.isnan(times)
        part = (spacing / 2 - before[passed]) / (gone - before)[passed]
        times[passed] = then + part * (now - then)
        if len(shown) == 1 and not np.isnan(times[COUNT // 2]):
            shown.append(snapshot(simulation))
    return times, [*shown, snapshot(simulation)]


def speed(times, spacing):
    """Speed of the wave once it has settled [m/s]."""
    return (spacing + THICKNESS) * (COUNT - 1 - SETTLED) / (times[-1] - times[SETTLED])


def run(study):
    """The wave at one spacing; when full, stiffer dominoes, other spacings and feet that are free."""
    spacing = 0.4 * HEIGHT
    exact = theory(spacing)
    moduli = [1, 10, 100] if study.full else [1]
    number = np.arange(COUNT - 1) + 1
    lines = {"theory": (number, (spacing + THICKNESS) / np.diff(exact))}
    errors = []
    for modulus in moduli:
        times, shown = topple(study, spacing, modulus)
        ours = speed(times, spacing)
        study.check(f"speed, gap 0.4 h, E = {modulus} MPa", unit="m/s", theory=speed(exact, spacing),
                    ours=ours, within=0.0025)  # fmt: skip
        errors.append(abs(ours / speed(exact, spacing) - 1))
        lines[f".E = {modulus} MPa"] = number, (spacing + THICKNESS) / np.diff(times)
    if study.full:
        times, free = topple(study, spacing, 10, "time.safety=0.2", hinged=False)
        lines[".feet free, friction 70 deg"] = number, (spacing + THICKNESS) / np.diff(times)
        study.curve("Error of the speed", "Young's modulus [Pa]", "error [1]",
                    {".cdem": (1e6 * np.array(moduli), errors)}, log=True)  # fmt: skip
        gaps, found = [0.2, 0.6], []
        for part, within in zip(gaps, (0.0025, 0.01), strict=True):
            gap = part * HEIGHT
            found.append(speed(topple(study, gap, 100)[0], gap))
            study.check(f"speed, gap {part} h, E = 100 MPa", unit="m/s", within=within,
                        theory=speed(theory(gap), gap), ours=found[-1])  # fmt: skip
        some = np.linspace(0.1, 0.7, 25)
        study.curve("Speed of the wave", "gap / height [1]", "speed [m/s]",
                    {"theory": (some, [speed(theory(g * HEIGHT), g * HEIGHT) for g in some]),
                     ".cdem": (gaps, found)})  # fmt: skip
        study.picture("Feet free on the table: start, half way, end", *free)
    study.curve("Speed from domino to domino", "domino", "speed [m/s]", lines)
    study.picture("The row at the start, half way and at the end", *shown)
