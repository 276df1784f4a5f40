"""Pull-out of a grouted bolt: stiffness, slip that runs along it, yield."""

import numpy as np


def theory(case):
    """Force [N] against displacement of the mouth [m], while slip runs from 0 to the toe; stiffness.

    Elastic: P = E A lambda tanh(lambda L) u, lambda^2 = K / (E A). Slip over x from the mouth:
    P = s x + E A lambda tanh(lambda (L - x)) s / K.
    """
    kind, length = case.bolt_types["cable"], 3.0
    axial = kind.area * kind.young_modulus
    stiffness, strength = kind.grout.stiffness, kind.grout.strength
    decay = np.sqrt(stiffness / axial)
    x = np.linspace(0, length, 3001)
    rest = axial * decay * np.tanh(decay * (length - x)) * strength / stiffness
    force = strength * x + rest
    moved = strength / stiffness + (strength * x**2 / 2 + rest * x) / axial
    return moved, force, axial * decay * np.tanh(decay * length)


def pull(study, *settings):
    """Rows of displacement of the mouth [m] and force of the plate [N]; and the simulation."""
    simulation = study.simulate(*settings)
    case = simulation.case
    kind, speed = case.bolt_types["cable"], 0.05
    spring = 0.1 / (kind.area * kind.young_modulus) + 1 / case.bolts[0].plate.stiffness
    rows = [(0.0, 0.0)]
    while simulation.time < case.stages[0].duration and simulation.run_until(
        simulation.time + 1e-3
    ):
        force = simulation.core.fields()["bolts.end_force"][0]
        way = speed * (simulation.time - case.time.step)  # when the forces were found
        rows.append((way - spring * force, force))
    return np.array(rows).T, simulation


def run(study):
    """From the first pull to yield of the steel."""
    (moved, force), simulation = pull(study)
    u, p, stiffness = theory(simulation.case)
    at = 0.5e-3
    study.check("stiffness", theory=stiffness, ours=np.interp(at, moved, force) / at, within=5e-3,
                unit="N/m")  # fmt: skip
    study.check("force at the first slip", theory=p[0], ours=np.interp(u[0], moved, force),
                within=5e-3, unit="N")  # fmt: skip
    study.check("force when 1.5 m have slipped", theory=p[1500], ours=np.interp(u[1500], moved, force),
                within=5e-4, unit="N")  # fmt: skip
    kind = simulation.case.bolt_types["cable"]
    study.check("largest force: the steel yields", theory=kind.yield_force, ours=force.max(),
                within=1e-4, unit="N")  # fmt: skip
    study.check("error of the energy ledger", theory=0, ours=simulation.energies["error"],
                within=1e-9, absolute=True)  # fmt: skip
    study.curve("Force of a bolt that is pulled out", "displacement of the mouth [m]", "force [N]", {
        "theory": (u, np.minimum(p, kind.yield_force)), ".cdem": (moved, force)})  # fmt: skip
