"""Sliding across rails that are touched by edges alone (Fig. 18)."""

import numpy as np

from cdem.output.render import snapshot

PAPER = "Fig. 18"


def theory(gravity, friction_angle):
    """a = g (sin t - cos t tan phi), Feng et al. (2014), Eq. 15 [m/s2]."""
    return gravity[0] + gravity[2] * np.tan(np.radians(friction_angle))


def run(study):
    """The beam is followed for 0.7 s; contacts of both kinds are counted on the way."""
    simulation = study.simulate()
    nodes = simulation.build.nodes_of("beam")
    mass = simulation.fields["mass"][nodes]
    shown, rows, springs = [snapshot(simulation)], [], 0
    while simulation.time < 0.7:
        simulation.step(200)
        springs += int((simulation.contacts["kind"] == 0).sum())
        if simulation.time > 0.1:
            speed = mass @ simulation.fields["velocity"][nodes, 0] / mass.sum()
            rows.append((simulation.time, speed))
    time, speed = np.array(rows).T
    case = simulation.case
    exact = theory(case.loads.gravity, case.interfaces.default.friction_angle)
    study.check("sliding acceleration", unit="m/s2", theory=exact, paper=2.927,
                ours=np.polyfit(time, speed, 1)[0], within=2e-4)  # fmt: skip
    study.check("semi-springs that ever act", theory=0, ours=springs, within=0, absolute=True)
    study.curve("Speed of the beam", "time [s]", "speed [m/s]",
                {"theory": (time, speed[0] + exact * (time - time[0])), ".cdem": (time, speed)})  # fmt: skip
    study.picture("The beam across its rails, start and 0.7 s", *shown, snapshot(simulation))
