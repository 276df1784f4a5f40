"""Gravity dam on a joint with uplift: factor of safety against sliding by limit equilibrium."""

import numpy as np

from cdem.output.render import snapshot
from cdem.study.critical import find_critical, parameter, strength_reduction

HEIGHT, BASE = 50.0, 40.0  # [m]


def theory(uplift, friction=45.0, concrete=2400.0, water=1000.0, gravity=9.81):
    """Factor of safety F = (W - U) tan(phi) / P, and the friction angle [deg] at which F = 1.

    Args:
        uplift: Part of the full linear uplift in the joint.
    """
    weight = concrete * gravity * BASE * HEIGHT / 2
    push = water * gravity * HEIGHT**2 / 2
    lift = uplift * water * gravity * HEIGHT * BASE / 2
    factor = (weight - lift) * np.tan(np.radians(friction)) / push
    return factor, np.degrees(np.arctan(push / (weight - lift)))


def run(study):
    """Factors for no and full uplift, half of it when full, and the critical friction angle."""
    for uplift in (0.0, 0.5, 1.0) if study.full else (0.0, 1.0):
        case = study.case(f"water.fields.0.history=[[0, {uplift}]]")
        ours = find_critical(case, strength_reduction(), (0.7, 3.0), tolerance=5e-4,
                             threads=study.threads).value  # fmt: skip
        study.check(f"factor of safety, {uplift:g} of the full uplift", theory=theory(uplift)[0],
                    ours=ours, within=1e-3)  # fmt: skip
    angle = find_critical(study.case(), parameter("interfaces.base.friction_angle"), (30.0, 60.0),
                          tolerance=0.01, threads=study.threads).value  # fmt: skip
    study.check("friction angle at which it goes", unit="deg", theory=theory(1.0)[1], ours=angle,
                within=0.03, absolute=True)  # fmt: skip
    if not study.full:
        return
    simulation = study.simulate(
        "stages.0={name: flood, mode: dynamic, duration: 2, damping: {contact: 0.1, stiffness: 0.2}}",
        "interfaces.base.friction_angle=35",
    )
    simulation.run()
    study.picture("With 35 degrees: after 2 s", snapshot(simulation))
