"""Triaxial compression and tension of a rock mass after Hoek and Brown."""

import numpy as np

from cdem.run.fields import stress_of
from cdem.verification.triaxial_mc.problem import drive


def constants(rock):
    """m, s and a of the rock mass."""
    m = rock.mi * np.exp((rock.gsi - 100) / (28 - 14 * rock.disturbance))
    s = np.exp((rock.gsi - 100) / (9 - 3 * rock.disturbance))
    return m, s, 0.5 + (np.exp(-rock.gsi / 15) - np.exp(-20 / 3)) / 6


def theory(rock, side):
    """Axial stress [Pa] at yield under a pressure on the sides [Pa]; compression is positive."""
    m, s, a = constants(rock)
    return side + rock.uniaxial_strength * (m * side / rock.uniaxial_strength + s) ** a


def tensile_strength(rock):
    """Strength without lateral pressure [Pa]: s1 = 0 at s3 = -t, by bisection."""
    m, s, a = constants(rock)
    low, high = 0.0, s / m
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if (s - m * middle) ** a > middle else (low, middle)
    return low * rock.uniaxial_strength


def run(study):
    """Compression under four pressures, and tension."""
    lines = {}
    for side in (0.0, 1e6, 5e6, 20e6):
        simulation, path = drive(study, side, "compression", "materials.rock.dilation_angle=10")
        exact = theory(simulation.case.materials["rock"], side)
        study.check(f"axial stress, sides at {side / 1e6:g} MPa", unit="Pa", theory=exact,
                    ours=-stress_of(simulation)[0, 2], within=1e-6)  # fmt: skip
        study.check(f"energy error, sides at {side / 1e6:g} MPa", theory=0, absolute=True,
                    ours=simulation.energies["error"], within=1e-4)  # fmt: skip
        lines[f"sides at {side / 1e6:g} MPa"] = (100 * path[0], path[1] / 1e6)
    simulation, _ = drive(study, 0.0, "extension")
    rock = simulation.case.materials["rock"]
    study.check("tensile strength", unit="Pa", theory=tensile_strength(rock),
                ours=stress_of(simulation)[0, 2], within=1e-6)  # fmt: skip
    study.curve("Axial stress, compression positive", "axial strain [%]", "stress [MPa]", lines)
