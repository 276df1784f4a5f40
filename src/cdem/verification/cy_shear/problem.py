"""A joint that yields continuously by Cundall and Hart: wear, and stiffness after a turn."""

import numpy as np

from cdem.rows import rows_of
from cdem.run.law_fields import state_of

AREA = 0.5
"""Of the contacts of a cube of 1 m whose vertices alone touch [m2]."""
SIGMA = 1e6  # [Pa]


def theory(law, stiffness, moved):
    """Shear traction [Pa] and slip [m] along a way, by Cundall and Hart's equations in small parts.

    dtau = F k_s du, F = (1 - tau / tau_m) / (1 - r), ds = (1 - F) |du|, tau_m = sigma tan(phi_m)
    with phi_m = phi + (phi_0 - phi) exp(-s / R); tau and tau_m are along the way.
    """
    low, high = law.friction_angle, law.initial_friction_angle
    tau = slip = r = 0.0
    before, rows = 0.0, []
    for way in np.diff(moved, prepend=moved[0]):
        for part in np.full(50, way / 50):
            angle = low + (high - low) * np.exp(-slip / law.roughness)
            ratio = np.sign(part) * tau / (SIGMA * np.tan(np.radians(angle)))
            if part * before < 0:
                r = min(ratio, 0.75)
            f = (1 - ratio) / (1 - r)
            tau += f * stiffness * part
            slip += (1 - f) * abs(part)
            before = part or before
        rows.append((tau, slip))
    return np.array(rows).T


def shear(simulation):
    """Time [s], displacement [m], shear and normal traction [Pa], slip [m] in rows of 0.5 ms."""
    bed, block = (simulation.build.nodes_of(group) for group in ("bed", "block"))
    rows = []
    while simulation.time < 0.39 - 1e-3:
        simulation.run_until(simulation.time + 5e-4)
        moved = simulation.fields["displacement"][block, 0].mean()
        slip = state_of(simulation, "joint_slip").max()
        simulation.step(1)
        force = rows_of(simulation.core, "node.reaction").force[bed].sum(axis=0)
        rows.append((simulation.time, moved, -force[0] / AREA, abs(force[2]) / AREA, slip))
    return np.array(rows).T


def run(study):
    """A way of 20 mm and a little back."""
    simulation = study.simulate()
    law = simulation.case.interfaces.default
    time, moved, traction, pressure, slip = shear(simulation)
    exact, expected = theory(law, 300e9, moved)
    forth = time < 0.34
    worn = np.interp(law.roughness, slip[forth], (traction / pressure)[forth])
    study.check("friction angle after the slip R", theory=30 + 15 * np.exp(-1), unit="deg", within=1e-4,
                ours=np.degrees(np.arctan(worn)))  # fmt: skip
    study.check("peak of the shear traction", theory=exact.max(), ours=traction.max(), within=1e-4,
                unit="Pa")  # fmt: skip
    study.check("slip in the end", theory=expected[-1], ours=slip[-1], within=1e-4, unit="m")
    study.check("shear traction after the turn", theory=exact[-1], ours=traction[-1], within=3e-3,
                unit="Pa")  # fmt: skip
    study.check("error of the energy ledger", theory=0, within=1e-3, absolute=True,
                ours=simulation.energies["error"])  # fmt: skip
    study.curve("Shear", "displacement [m]", "shear traction [Pa]",
                {".cdem": (moved, traction), "theory": (moved, exact)})  # fmt: skip
