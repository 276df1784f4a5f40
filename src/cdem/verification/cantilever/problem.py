"""Deflection of a cantilever, by either integration of hexahedra, and cut into bonded cubes."""

import numpy as np

from cdem.output.render import snapshot

LENGTH, LOAD = 10.0, 1e4


def theory(young):
    """Deflection of the end [m]: P L^3 / 3 E I + P L / (5/6 G A), Timoshenko; nu = 0."""
    return LOAD * LENGTH**3 / (3 * young / 12) + LOAD * LENGTH / (5 / 6 * young / 2)


def joints(k_n, k_s, points):
    """Deflection from joints across the beam, one at each of its cubes of 1 m [m].

    Each turns by P (L - x) / (k_n I), which moves the end by (L - x) times as much, and slips by
    P / (k_s A). I is h^4 / 12 for bonds at Gauss points, and three times as much for four in the
    corners (see beam_strength).
    """
    arm = LENGTH - np.arange(1, LENGTH)
    inertia = (3 if points == "vertex" else 1) / 12
    return (LOAD * arm**2 / (k_n * inertia) + LOAD / k_s).sum()


def deflection(simulation):
    """Of the loaded end, after relaxation [m]."""
    simulation.run()
    end = simulation.build.start_position[:, 0] > LENGTH - 1e-6
    return -simulation.fields["displacement"][end, 2].mean()


def run(study):
    """Convergence of either hexahedron; then all cubes bonded."""
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
    study.picture("Deflection", snapshot(simulation))
    bonded(study, young)


def bonded(study, young):
    """The beam of ten cubes as blocks of their own: compliance against the stiffness of the bonds."""
    beam = ["model.blocks.0.box={size: [10, 1, 1], divisions: [10, 1, 1]}",
            "elements.hexahedra=one-point"]  # fmt: skip
    whole = deflection(study.simulate(*beam))
    lines = {}
    for points in ("vertex", "quadrature"):
        found = []
        for factor in (1, 3, 10) if study.full else (10,):
            k = factor * young  # over a cube of 1 m
            stiffness = [f"interfaces.default.stiffness_{c}={factor} E/h" for c in "ns"]
            ours = deflection(study.simulate(*beam, *stiffness, "model.split.beam=elements",
                                             f"contact.bond_points={points}")) - whole  # fmt: skip
            study.check(f"added by joints of {factor} E/h, bonds at {points}", unit="m",
                        theory=joints(k, k, points), ours=ours, within=1e-5)  # fmt: skip
            found.append((1 / factor, ours))
        softness, added = np.transpose(found)
        lines[f"theory, bonds at {points}"] = (
            softness, [joints(young / s, young / s, points) for s in softness])  # fmt: skip
        lines[f".cdem, bonds at {points}"] = softness, added
    if study.full:
        study.curve("Deflection from joints", "E / (k h) [1]", "deflection [m]", lines, log=True)
