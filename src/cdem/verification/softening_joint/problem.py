"""Softening of a joint in opening, in shear and in any mix of both."""

import numpy as np

from cdem.rows import rows_of
from cdem.run.law_fields import state_of

ANGLES = (0, 20, 45, 70, 90)
PRESSURE = 2e6  # [Pa]


def theory(law, slip, moved, released):
    """Shear force in the end [N], fracture and friction [J] of a joint sheared under pressure.

    Friction falls in a straight line from its peak to its residual value over the slip distance; the
    part c - c_r of the cohesion is lost over 2 G2 / (c - c_r). Its remainder acts on the area
    of the joint, 1 m by 1 m less the displacement of the block [m] once the pair is released.
    """
    peak, left = np.tan(np.radians([law.friction_angle, law.residual_friction_angle]))
    end = law.residual_cohesion * (1 - moved) + PRESSURE * left
    friction = law.residual_cohesion * (slip - (moved**2 - released**2) / 2) + PRESSURE * (
        left * slip + (peak - left) * law.slip_distance / 2
    )
    return end, law.fracture_energy_2, friction


def lead(simulation, end):
    """Rows of displacement and traction along x and z until the joint breaks or until a time."""
    bed, block = (simulation.build.nodes_of(group) for group in ("bed", "block"))
    rows = []
    while simulation.time < end - 1e-9 and sum(simulation.broken.values()) == 0:
        moved = simulation.fields["displacement"][block].mean(axis=0)
        simulation.step(1)  # its forces belong to its initial position
        force = -rows_of(simulation.core, "node.reaction").force[bed].sum(axis=0)
        rows.append((moved[0], moved[2], force[0], force[2]))
    return np.array(rows).T


def run(study):
    """Straight paths in all directions; shear under pressure down to the residual strength."""
    energies = {}
    for angle in ANGLES:
        x, z = 0.004 * np.sin(np.radians(angle)), 0.004 * np.cos(np.radians(angle))
        z = 0 if angle == 90 else z
        simulation = study.simulate(f"loads.velocities.0.velocity=[{x}, 0, 0]",
                                    f"loads.velocities.1.velocity=[0, 0, {z}]")  # fmt: skip
        law = simulation.case.interfaces.default
        along, up, shear, pull = lead(simulation, 0.1)
        work = [np.trapezoid(pull, up), np.trapezoid(shear, along)]
        parts = np.array(work) / (law.fracture_energy_1, law.fracture_energy_2)
        study.check(f"{angle} degrees: G_I / G_1 + G_II / G_2", theory=1, ours=parts.sum(),
                    within=1e-4)  # fmt: skip
        study.check(f"{angle} degrees: fracture energy over the work done", theory=1,
                    ours=simulation.energies["fracture"] / sum(work), within=1e-4)  # fmt: skip
        study.check(f"{angle} degrees: error of the energy ledger", theory=0, within=1e-4,
                    ours=simulation.energies["error"], absolute=True)  # fmt: skip
        energies[angle] = parts
        if angle == 0:
            study.curve("Opening", "opening [m]", "traction [Pa]", {
                "cdem": (up, pull),
                "theory": ([0, 1e-6, 200 / 3e6], [0, 3e6, 0])})  # fmt: skip
    study.curve("Energies of both modes", "G_I / G_1 [1]", "G_II / G_2 [1]", {
        "theory": ([1, 0], [0, 1]), ".cdem": tuple(np.array(list(energies.values())).T)})  # fmt: skip

    depth = PRESSURE / 3e12
    simulation = study.simulate(
        "interfaces.default.friction_angle=40", "interfaces.default.residual_friction_angle=30",
        "interfaces.default.residual_cohesion=1 MPa", "interfaces.default.slip_distance=2 mm",
        "loads.velocities.0.velocity=[0.05, 0, 0]",
        "loads.velocities.0.history=[[0, 0], [0.001, 0], [0.002, 1], [0.1, 1]]",
        f"loads.velocities.1.velocity=[0, 0, {-depth / 0.0005}]",
        "loads.velocities.1.history=[[0, 0], [0.0005, 1], [0.001, 0]]")  # fmt: skip
    law, rows = simulation.case.interfaces.default, []
    bed, block = (simulation.build.nodes_of(group) for group in ("bed", "block"))
    while simulation.time < 0.1 - 1e-9 and simulation.run_until(simulation.time + 1e-4):
        force = rows_of(simulation.core, "node.reaction").force[bed].sum(axis=0)
        bonded = simulation.core.fields()["quads.status"][0]
        rows.append((simulation.fields["displacement"][block, 0].mean(), -force[0], bonded))
    moved, shear, bonded = np.array(rows).T
    end, fracture, friction = theory(law, state_of(simulation, "joint_slip").max(), moved[-1],
                                     moved[bonded > 0][-1])  # fmt: skip
    study.check("shear under 2 MPa: force in the end", theory=end, ours=shear[-1], within=1e-4,
                unit="N")  # fmt: skip
    study.check("shear under 2 MPa: fracture", theory=fracture, within=1e-4, unit="J",
                ours=simulation.energies["fracture"])  # fmt: skip
    study.check("shear under 2 MPa: friction", theory=friction, within=1e-4, unit="J",
                ours=simulation.energies["friction"])  # fmt: skip
    study.check("shear under 2 MPa: error of the energy ledger", theory=0, within=1e-4,
                ours=simulation.energies["error"], absolute=True)  # fmt: skip
    study.curve("Shear under 2 MPa", "displacement [m]", "force [N]", {"cdem": (moved, shear)})
