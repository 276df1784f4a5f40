"""Friction that weakens with slip: stable or not by the stiffness that loads it."""

import numpy as np

from cdem.rows import rows_of

SPEED = 0.002
"""At which the top of the cube is drawn while the joint slips [m/s]."""


def theory(law, pressure, stiffness):
    """Fracture energy [J/m2], critical stiffness [Pa/m], and slip over loading rate or infinity.

    The traction falls by sigma (mu_p - mu_r) / Dc per slip; the loading system unloads by its
    stiffness. If that is larger the slip follows at K / (K - K_c) times the speed of loading; else
    it runs away.
    """
    peak, left = np.tan(np.radians([law.friction_angle, law.residual_friction_angle]))
    critical = pressure * (peak - left) / law.slip_distance
    rate = stiffness / (stiffness - critical) if stiffness > critical else np.inf
    return critical * law.slip_distance**2 / 2, critical, rate


def draw(simulation):
    """Rows of time, slip and shear traction until the slip is a little more than the slip distance."""
    low = simulation.build.nodes_of("block")
    low = low[simulation.fields["position"][low, 2] < 0.5]
    start = simulation.fields["position"][low, 0].mean()
    rows = [(0.0, 0.0, 0.0)]
    while rows[-1][1] < 0.0105 and rows[-1][0] < 6 and simulation.run_until(rows[-1][0] + 0.002):
        moved = simulation.fields["position"][low, 0].mean() - start
        rows.append((simulation.time, moved, -simulation.contacts["force"].sum(axis=0)[0]))
    return np.array(rows).T


def mean_slip(core):
    """Mean slip of the vertices that carry the cube [m]."""
    carries = rows_of(core, "spring.state").force_n > 0
    return rows_of(core, "spring.history").numbers[carries, 0].mean()


def run(study):
    """A cube stiffer than the critical stiffness, and one softer."""
    curves = {}
    for name, young in (("stiff", 60e6), ("soft", 30e6)):
        stiffness = 1 / (2 / young + 1 / 0.5e10)  # the cube's springs have half of k_s
        slow = 0.15 + 0.9 * 0.7e6 / stiffness / (10 * SPEED)  # before it slips
        simulation = study.simulate(
            f"materials.soft.young_modulus={young}",
            f"loads.velocities.1.history=[[0.1, 0], [0.2, 1], [{slow}, 1], [{slow + 0.05}, 0.1]]")  # fmt: skip
        law = simulation.case.interfaces.default
        energy, critical, rate = theory(law, 1e6, stiffness)
        time, slip, shear = draw(simulation)
        curves[f".{name}"] = (slip, shear)
        inside = (slip > 0.002) & (slip < 0.008)
        rate_most = np.gradient(slip, time)[inside].max() / SPEED
        if np.isfinite(rate):
            slipped = mean_slip(simulation.core)
            left = np.tan(np.radians(law.residual_friction_angle))
            study.check("stable: loading over critical stiffness", theory=1.5, within=0.01,
                        ours=stiffness / critical)  # fmt: skip
            study.check("stable: fracture energy", theory=energy, within=1e-4, unit="J/m2",
                        ours=simulation.energies["friction"] - left * 1e6 * slipped)  # fmt: skip
            study.check("stable: slip rate over loading rate", theory=rate, within=0.02,
                        ours=np.polyfit(time[inside], slip[inside], 1)[0] / SPEED)  # fmt: skip
            study.check("stable: error of the energy ledger", theory=0, within=1e-4,
                        ours=simulation.energies["error"], absolute=True)  # fmt: skip
        else:
            study.check("unstable: slip rate above ten times the loading rate", theory=1, within=0,
                        ours=float(rate_most > 10), absolute=True)  # fmt: skip
    line = np.linspace(0, 0.0105)
    study.curve("Traction against slip", "slip [m]", "traction [Pa]", curves | {
        "theory": (line, 1e6 * (0.5 + 0.2 * np.maximum(1 - line / 0.01, 0)))})  # fmt: skip
