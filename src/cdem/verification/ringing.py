"""A free bar that rings in its first mode: decrement and frequency from its extremes."""

from __future__ import annotations

import numpy as np

from cdem.rows import rows_of
from cdem.run.simulation import Simulation

CELLS = 20
"""Cubes along the bar."""
SPEED = 1e-3
"""Largest velocity of the mode at the start [m/s]."""


def length(speed: float, frequency: float) -> float:
    """Length of a bar of lumped cubes whose first mode has a frequency [m].

    Args:
        speed: Of waves along it [m/s].
        frequency: Wanted, undamped [Hz].
    """
    # springs k = E h and masses rho h^3: w = 2 c / h sin(pi / 2n)
    return float(CELLS * speed * np.sin(0.5 * np.pi / CELLS) / (np.pi * frequency))


def size(speed: float, frequency: float, shape: str) -> str:
    """Setting of the bar: `CELLS` cubes of elements of a shape."""
    whole = length(speed, frequency)
    side = whole / CELLS
    return (
        f"model.blocks.0.box={{size: [{whole!r}, {side!r}, {side!r}], divisions: [{CELLS}, 1, 1], "
        f"shape: {shape}}}"
    )


def extremes(simulation: Simulation, halves: int) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and values [m] of so many extremes of the mode, which starts with a velocity."""
    x = simulation.build.start_position[:, 0]
    mode = np.cos(np.pi * (x - x.min()) / (x.max() - x.min()))
    rows_of(simulation.core, "node.motion").velocity[:, 0] = SPEED * mode
    weight = simulation.fields["mass"] * mode
    time, value, found = [0.0], [0.0], 0
    while found < halves:
        simulation.step(1)
        time.append(simulation.time)
        value.append(float(weight @ simulation.fields["displacement"][:, 0]))
        a, b, *c = value[-3:]
        found += bool(c) and (b - a) * (c[0] - b) < 0
    t, u = np.array(time), np.array(value) / (weight @ mode)
    at = np.flatnonzero((u[1:-1] - u[:-2]) * (u[2:] - u[1:-1]) < 0) + 1
    before, after = u[at] - u[at - 1], u[at + 1] - u[at]
    place = 0.5 * (before + after) / (before - after)  # of the parabola through three rows
    step = t[at + 1] - t[at]
    return t[at] + place * step, u[at] + 0.25 * place * (before + after)


def frequency_and_ratio(simulation: Simulation, skip: int, halves: int) -> tuple[float, float]:
    """Frequency [Hz] and fraction of critical damping of the mode.

    From the way between extremes: slow branches shift the middle.

    Args:
        simulation: Before its first step.
        skip: Half periods left out.
        halves: Half periods that count.
    """
    time, value = (rows[skip:] for rows in extremes(simulation, skip + halves + 2))
    way = np.abs(np.diff(value))
    decrement = np.log(way[0] / way[halves]) / halves  # of half a period
    return halves / (time[halves] - time[0]) / 2, float(decrement / np.hypot(np.pi, decrement))
