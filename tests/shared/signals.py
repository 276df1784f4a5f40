"""Signals in closed form."""

import numpy as np

G = 9.81


def synthetic(step=0.005, duration=20.0):
    """Times [s] and acceleration [m/s2] of a synthetic earthquake: three sines in an envelope."""
    t = np.arange(round(duration / step) + 1) * step
    envelope = (t / 3) ** 2 * np.exp(2 * (1 - t / 3))
    sines = ((0.55, 1.1, 0.3), (0.35, 2.7, 1.1), (0.25, 5.3, 2.0))
    waves = sum(a * np.sin(2 * np.pi * f * t + phase) for a, f, phase in sines)
    return t, 0.35 * G * envelope * waves


def at2(acceleration, step):
    """Text of a PEER file of an acceleration [m/s2]."""
    values = [f"{a / G:.9e}" for a in acceleration]
    rows = [" ".join(values[i : i + 5]) for i in range(0, len(values), 5)]
    head = ["SYNTHETIC", "formula, 0 deg", "ACCELERATION TIME SERIES IN UNITS OF G"]
    return "\n".join([*head, f"NPTS=  {len(values)}, DT=   {step:.4f} SEC", *rows, ""])
