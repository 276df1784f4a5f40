"""Deflection of a cantilever, by either integration of hexahedra."""

import numpy as np

from cdem import view

LENGTH, LOAD = 10.0, 1e4


def theory(young):
    """Deflection of the end [m]: P L^3 / 3 E I + P L / (5/6 G A), Timoshenko; nu = 0."""
    return LOAD * LENGTH**3 / (3 * young / 12) + LOAD * LENGTH / (5 / 6 * young / 2)


def deflection(simulation):
    """Of the loaded end, after relaxation [m]."""
    simulation.run()
    end = simulation.build.start_position[:, 0] > LENGTH - 1e-6
    return -simulation.fields["displacement"][end, 2].mean()


def run(study):
    """Convergence of either hexahedron."""
    young = study.case().materials["rock"].young_modulus
    cells = (1, 2, 4) if study.full else (1, 2)
    within = {"full": {1: 0.08, 2: 0.037, 4: 0.011}, "one-point": {1: 4e-3, 2: 2e-3, 4: 1e-3}}
    for kind, tolerances in within.items():
        errors = []
        for n in cells:
            box = f"{{size: [10, 1, 1], divisions: [{10 * n}, {n}, {n}]}}"
            simulation = study.simulate(f"model.blocks.0.box={box}", f"elements.hexahedra={kind}")
            ours = deflection(simulation)
            study.check(f"deflection, {kind} hexahedra, {n} in the height", unit="m",
                        theory=theory(young), ours=ours, within=tolerances[n])  # fmt: skip
            errors.append((1 / n, abs(ours / theory(young) - 1)))
        if study.full:
            h, error = np.transpose(errors)
            study.curve(f"Error of {kind} hexahedra", "element over height [1]", "error [1]",
                        {".cdem": (h, error), "second order": (h, error[-1] * (h / h[-1]) ** 2)},
                        log=True)  # fmt: skip
    study.picture("Deflection", view.snapshot(simulation))
