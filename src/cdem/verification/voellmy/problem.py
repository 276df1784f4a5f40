"""A slab that slides with Voellmy's friction: it nears a speed that it never passes."""

import numpy as np


def theory(time, law, height, gravity):
    """Speed [m/s] of a slab of this height [m] under gravity along and into the bed [m/s2].

    rho h dv/dt = rho h (g_x - mu g_z) - rho g v^2 / xi, so v = v_max tanh(a_0 t / v_max) with
    a_0 = g_x - mu g_z and v_max = sqrt(xi h a_0 / g).
    """
    along, into = gravity
    start = along - into * np.tan(np.radians(law.friction_angle))
    most = np.sqrt(law.turbulence * height * start / 9.81)
    return most * np.tanh(start * np.asarray(time) / most), most


def run(study):
    """Speed over 10 s, and energy."""
    simulation = study.simulate()
    law, gravity = simulation.case.interfaces.default, simulation.case.loads.gravity
    nodes = simulation.build.nodes_of("slab")
    mass = simulation.fields["mass"][nodes] / simulation.fields["mass"][nodes].sum()
    rows = [(0.0, 0.0)]
    while simulation.time < 10 - 1e-9 and simulation.run_until(min(10, simulation.time + 0.25)):
        rows.append((simulation.time, mass @ simulation.fields["velocity"][nodes, 0]))
    time, speed = np.array(rows).T
    exact, most = theory(time, law, 10, (gravity[0], -gravity[2]))
    study.check("speed that it nears", theory=37.8597, within=1e-5, ours=most, unit="m/s")
    study.check("speed after 5 s", theory=exact[20], within=0.002, ours=speed[20], unit="m/s")
    study.check("speed after 10 s", theory=23.8834, within=0.002, ours=speed[-1], unit="m/s")
    study.check("error of the energy ledger", theory=0, within=1e-3, absolute=True,
                ours=simulation.energies["error"])  # fmt: skip
    study.curve("Speed of the slab", "time [s]", "speed [m/s]", {
        "theory": (time, exact), ".slab": (time, speed),
        "Coulomb's friction alone": (time, exact[1] / time[1] * time)})  # fmt: skip
