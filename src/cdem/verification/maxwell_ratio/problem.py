"""Frequency and ratio of a bar with Maxwell branches, by the roots of its equation of motion."""

import numpy as np

from cdem.model.damping import branches_of
from cdem.verification.ringing import frequency_and_ratio, size

FREQUENCIES = (0.2, 2.0, 20.0)  # [Hz], of the bar without branches


def theory(frequency, peaks, weights):
    """Frequency [Hz] and ratio of free vibration.

    The root near i w0 of s^2 + w0^2 (1 + sum g s / (s + w)) = 0, by Newton's method.

    Args:
        frequency: Without branches [Hz].
        peaks: Frequencies of the branches [Hz].
        weights: Their moduli over the modulus of the bar.
    """
    stiff, w = (2 * np.pi * frequency) ** 2, 2 * np.pi * np.array(peaks)
    s = 2j * np.pi * frequency
    for _ in range(60):
        value = s * s + stiff * (1 + np.sum(weights * s / (s + w)))
        s -= value / (2 * s + stiff * np.sum(weights * w / (s + w) ** 2))
    return s.imag / (2 * np.pi), -s.real / abs(s)


def run(study):
    """The middle and both ends of the band; all shapes."""
    branches = branches_of(study.case().stages[0].damping.maxwell)
    weights = np.array(branches.weight)
    f = np.geomspace(0.2, 20, 101)
    x = f[:, None] / branches.frequency
    loss, more = (weights * x / (1 + x**2)).sum(1), (weights * x**2 / (1 + x**2)).sum(1)
    ratio = loss / (2 * (1 + more))
    for kind, most in (("smallest", ratio.min()), ("largest", ratio.max())):
        study.check(
            f"{kind} ratio of the branches in the band", theory=0.05, ours=most, within=0.03
        )
    cases = [("hex8", f) for f in FREQUENCIES]
    cases += [(shape, 2.0) for shape in ("one-point", "wedge6", "pyramid5", "tet4")]
    for shape, frequency in cases:
        exact, damped = theory(frequency, branches.frequency, weights)
        mesh = "hex8" if shape == "one-point" else shape
        more = ["elements.hexahedra=one-point"] if shape == "one-point" else []
        simulation = study.simulate(size(2000.0, frequency, mesh), *more)
        moves, ours = frequency_and_ratio(simulation, 3, 10)
        name = f"{shape}, {frequency:g} Hz without branches"
        study.check(f"frequency, {name}", unit="Hz", theory=exact, ours=moves, within=3e-3)
        study.check(f"ratio, {name}", theory=damped, ours=ours, within=4e-3)
