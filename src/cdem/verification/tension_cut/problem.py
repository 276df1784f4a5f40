"""Tension cut-off of Mohr-Coulomb rock, reached along one, two and three axes."""

import numpy as np

from cdem.run.fields import stress_of

PULLS = {"x": 0.0215, "x and y": 0.0415, "x, y and z": 0.062}  # time when each has ended [s]


def theory(rock, axes):
    """Principal stresses [Pa] after pulls along so many axes: the others stay elastic."""
    nu, strength = rock.poisson_ratio, rock.tensile_strength
    held = {1: nu / (1 - nu), 2: 2 * nu, 3: 1.0}[axes] * strength
    return [strength] * axes + [held] * (3 - axes)


def run(study):
    """One run through all three; ends of the pulls and of the whole."""
    simulation = study.simulate()
    rock, lines = simulation.case.materials["rock"], {axis: ([], []) for axis in "xyz"}
    for axes, (pull, time) in enumerate(PULLS.items(), start=1):
        while simulation.time < time:
            simulation.step(5)
            for axis, stress in zip("xyz", stress_of(simulation)[0], strict=False):
                lines[axis][0].append(simulation.time)
                lines[axis][1].append(stress / 1e6)
        for axis, exact in zip("xyz", theory(rock, axes), strict=True):
            study.check(f"stress along {axis} after pulls along {pull}", unit="Pa", theory=exact,
                        ours=lines[axis][1][-1] * 1e6, within=1e-9)  # fmt: skip
    study.check("energy error", theory=0, ours=simulation.energies["error"], absolute=True,
                within=1e-4)  # fmt: skip
    study.curve("Stress along the axes", "time [s]", "stress [MPa]",
                {axis: tuple(map(np.array, line)) for axis, line in lines.items()})  # fmt: skip
