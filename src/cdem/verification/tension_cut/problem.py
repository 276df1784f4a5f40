"""Tension cut-off of Mohr-Coulomb rock, reached along one, two and three axes."""

import numpy as np

from cdem.run.fields import stress_of

PULLS = {"x": 0.0215, "x and y": 0.0415, "x, y and z": 0.062}  # time when each has ended [s]


def theory(rock, axes):
    """Principal stresses [Pa] after tension along this number of axes: the others stay elastic."""
    nu, strength = rock.poisson_ratio, rock.tensile_strength
    held = {1: nu / (1 - nu), 2: 2 * nu, 3: 1.0}[axes] * strength
    return [strength] * axes + [held] * (3 - axes)


def run(study):
    """One run through all three; ends of the pulls and of the whole."""
    simulation = study.simulate()
    rock = simulation.case.materials["rock"]
    times, stresses = [], []
    for axes, (pull, time) in enumerate(PULLS.items(), start=1):
        while simulation.time < time:
            simulation.step(5)
            times.append(simulation.time)
            stresses.append(stress_of(simulation)[0, :3])
        for axis, exact, ours in zip("xyz", theory(rock, axes), stresses[-1], strict=True):
            study.check(f"stress along {axis} after pulls along {pull}", unit="Pa", theory=exact,
                        ours=ours, within=1e-9)  # fmt: skip
    study.check("energy error", theory=0, ours=simulation.energies["error"], absolute=True,
                within=1e-4)  # fmt: skip
    study.curve("Stress along the axes", "time [s]", "stress [MPa]",
                {axis: (times, np.array(stresses)[:, k] / 1e6) for k, axis in enumerate("xyz")})  # fmt: skip
