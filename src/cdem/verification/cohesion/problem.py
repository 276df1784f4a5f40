"""Shear failure of a bonded interface (Table 1)."""

import numpy as np


def theory(cohesion, friction_angle, height, side=1.0):
    """Traction at failure [Pa]; its moment P h pulls the rear bonds by 3 P h / side on average.

    c = P + 3 (P h / side) tan(phi): Mohr-Coulomb of a rear bond, in tension.
    """
    return cohesion / (1 + 3 * height / side * np.tan(np.radians(friction_angle)))


def push(simulation):
    """Traction at which the first bond breaks [Pa]."""
    traction = simulation.case.loads.tractions[0]
    while sum(simulation.broken.values()) == 0:
        simulation.step(5)
        if simulation.time > traction.history[-1][0]:
            return np.inf
    return traction.traction[0] * np.interp(simulation.time, *np.transpose(traction.history))


def run(study):
    """A block thin enough that the moment of the traction adds 0.15 %."""
    simulation = study.simulate()
    law, height = simulation.case.interfaces.default, simulation.case.model.blocks[1].box.size[2]
    study.check("traction at failure", unit="Pa", paper=29600, within=1e-3, ours=push(simulation),
                theory=theory(law.cohesion, law.friction_angle, height))  # fmt: skip
