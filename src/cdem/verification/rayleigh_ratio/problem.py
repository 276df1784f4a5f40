"""Ratio of Rayleigh damping at its frequency and away from it, of elements and of bonds."""

import numpy as np

from cdem.verification.ringing import frequency_and_ratio, size

ASKED, PEAK = 0.05, 2.0  # ratio, and its frequency [Hz]
STRONG = "{friction_angle: 30, cohesion: 1e9, tensile_strength: 1e9}"
BONDS = ["model.split={bar: elements}", f"interfaces={{default: {STRONG}}}"]


def theory(frequency, part):
    """Ratio at a frequency [Hz]: alpha / 2w + beta w / 2 with alpha = xi w0, beta = xi / w0."""
    both = PEAK / frequency + (frequency / PEAK if part == "both" else 0)
    return 0.5 * ASKED * both


def decrement(ratio):
    """Logarithm of the fall of the motion in a period."""
    return 2 * np.pi * ratio / np.sqrt(1 - ratio**2)


def run(study):
    """Half, once and twice the frequency; bonds; all shapes."""
    cases = [("hex8", f, "both", False) for f in (0.5 * PEAK, PEAK, 2 * PEAK)]
    cases += [("hex8", PEAK, "mass", False), *((s, PEAK, "both", True) for s in ("hex8", "tet4"))]
    cases += [(s, PEAK, "both", False) for s in ("one-point", "wedge6", "pyramid5", "tet4")]
    for shape, frequency, part, bonds in cases:
        ours, moves = ring(study, shape, frequency, part, bonds)
        name = f"{shape}, {frequency:g} Hz" + (", bonds" if bonds else "") + f", {part}"
        # bonds soften the bar: the ratio belongs to the frequency at which it moves
        exact = decrement(theory(moves if bonds else frequency, part))
        study.check(f"log decrement, {name}", theory=exact, ours=decrement(ours), within=0.01)


def ring(study, shape, frequency, part, bonds):
    """Measured ratio, and frequency of the motion [Hz]."""
    mesh = "hex8" if shape == "one-point" else shape
    settings = [size(2000.0, frequency, mesh), f"stages.0.damping.rayleigh.part={part}"]
    settings += ["elements.hexahedra=one-point"] if shape == "one-point" else []
    simulation = study.simulate(*settings, *(BONDS if bonds else []))
    moves, ratio = frequency_and_ratio(simulation, 1, 8)
    return ratio, moves / np.sqrt(1 - ratio**2)
