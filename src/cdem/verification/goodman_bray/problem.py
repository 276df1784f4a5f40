"""Toppling of 16 columns on a stepped base (Goodman & Bray)."""

import numpy as np

from cdem.output.render import snapshot
from cdem.study.critical import find_critical, parameter

QUICK = False  # about a minute
WIDTH, STEP, COUNT, CREST = 10.0, 1.0, 16, 10  # of a column, of the base [m]
BELOW, ABOVE = 5.0, 5.2  # fall of the tops from column to column below and above the crest [m]
DIP = np.radians(30)  # of the base; the columns dip 60 degrees the other way


def heights():
    """Heights of the columns from the toe upwards [m]."""
    y = [(n + 1) * (BELOW - STEP) for n in range(CREST)]
    while len(y) < COUNT:
        y.append(y[-1] - ABOVE - STEP)
    return np.array(y)


def support(friction):
    """Force over the unit weight that the toe column needs, at a tangent of friction [m3/m].

    From the top down, column n must be held from below by the larger of the forces that stop it
    from toppling about its lower edge and from sliding on its base, when the column above pushes
    with P at the height M and rubs with P tan(phi); it is held at the height L.
    """
    push, y = 0.0, heights()
    for n in range(COUNT - 1, -1, -1):
        upper = y[n] if n + 1 < CREST else y[n] - ABOVE  # M
        lower = y[n] - BELOW if n < CREST else y[n]  # L
        weight = y[n] * WIDTH
        topple = push * (upper - friction * WIDTH)
        topple += weight / 2 * (y[n] * np.sin(DIP) - WIDTH * np.cos(DIP))
        slide = push - weight * (friction * np.cos(DIP) - np.sin(DIP)) / (1 - friction**2)
        if n == 0:  # the toe column is held by its base alone
            lower = np.inf
        push = max(topple / lower if np.isfinite(lower) else 0.0, slide, 0.0)
    return push


def theory(low=0.5, high=1.2):
    """Friction angle [deg] at which the toe needs no support (Goodman & Bray 1976)."""
    while high - low > 1e-9:
        friction = 0.5 * (low + high)
        low, high = (friction, high) if support(friction) > 0 else (low, friction)
    return np.degrees(np.arctan(high))


def settings():
    """Columns and base as the blocks of the case, x up the base."""
    blocks = []
    for n, height in enumerate(heights()):
        blocks.append(f"{{group: columns, box: {{size: [{WIDTH}, 10, {height:.9g}]}}, "
                      f"translate: [{n * WIDTH}, 0, {n * STEP}]}}")  # fmt: skip
        blocks.append(f"{{group: base, box: {{size: [{WIDTH}, 14, {5 + n * STEP}]}}, "
                      f"translate: [{n * WIDTH}, -2, -5]}}")  # fmt: skip
    blocks.append("{group: base, box: {size: [20, 14, 5]}, translate: [-20, -2, -5]}")
    return f"model.blocks=[{', '.join(blocks)}]"


def run(study):
    """The friction angle is lowered until the slope goes; then it is seen to topple."""
    found = find_critical(study.case(settings()), parameter("interfaces.default.friction_angle"),
                          (34.0, 42.0), tolerance=0.1, threads=study.threads)  # fmt: skip
    study.check("friction angle at which the slope goes", unit="deg", theory=theory(),
                ours=found.value, within=0.25, absolute=True)  # fmt: skip
    simulation = study.simulate(
        settings(),
        "stages.1={name: fall, mode: dynamic, duration: 3, damping: {contact: 0.2, stiffness: 0.2},"
        " set: {interfaces.default.friction_angle: 33}}",
    )
    simulation.run_stage("load")
    shown = [snapshot(simulation)]
    start = simulation.time
    for time in (1.5, 3):
        simulation.run_until(start + time)
        shown.append(snapshot(simulation))
    study.picture("With 33 degrees of friction: start, 1.5 s, 3 s", *shown)
