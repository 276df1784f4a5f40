"""A rough joint by Barton, Bandis and Bakhtar: peak of the shear traction, and closure."""

import numpy as np

from cdem.rows import rows_of

AREA = 1.0
"""Of the cube of 1 m, whose vertices alone touch [m2]."""
PRESSURES = (0.1, 0.5, 1, 2, 5, 10, 50)  # [MPa]


def theory(law, pressure):
    """Peak shear traction [Pa], slip at the peak [m], initial stiffness [Pa/m], largest closure [m]."""
    jrc, jcs, length = law.jrc, law.jcs, law.joint_length
    long_jrc, long_jcs = (
        value * (length / 0.1) ** (-rate * jrc) for value, rate in ((jrc, 0.02), (jcs, 0.03))
    )
    rough = max(long_jrc * np.log10(long_jcs / pressure), 0)
    angle = min(rough + law.residual_friction_angle, 70)
    slip = length / 500 * (long_jrc / length) ** 0.33
    aperture = jrc / 5 * 0.1  # [mm], of rock as strong as its walls
    ratio = jcs / 1e6 / aperture
    stiffness = -7.15 + 1.75 * jrc + 0.02 * ratio  # [MPa/mm]
    closure = -0.296 - 0.0056 * jrc + 2.241 * ratio**-0.245  # [mm]
    return pressure * np.tan(np.radians(angle)), slip, 1e9 * stiffness, 1e-3 * closure


def tractions(simulation):
    """Shear and normal traction on the joint in the next step [Pa]."""
    bed = simulation.build.nodes_of("bed")
    simulation.step(1)
    force = rows_of(simulation.core, "node.reaction").force[bed].sum(axis=0)
    return -force[0] / AREA, abs(force[2]) / AREA


def near(moved, peak):
    """Displacements at which every step is evaluated."""
    return abs(moved / peak - 1) < 0.003


def shear(study, pressure):
    """Displacement [m] and shear traction [Pa], its peak, and energy error."""
    peak, slip, *_ = theory(study.case().interfaces.default, pressure)
    there = slip + peak / 100e9
    slow = 0.042 + 0.9 * there / 0.02  # a tenth of the speed from there on
    simulation = study.simulate(
        f"loads.tractions.0.traction=[0, 0, {-pressure * AREA}]",
        f"loads.velocities.0.history=[[0, 0], [0.04, 0], [0.044, 1], [{slow}, 1], [{slow + 1e-3}, 0.1]]")  # fmt: skip
    block, at, rows = simulation.build.nodes_of("block"), 0.0, []
    while at < 1.02 * there:
        at = simulation.fields["displacement"][block, 0].mean()
        rows.append((at, tractions(simulation)[0]))
        if not near(at, there):
            simulation.run_until(simulation.time + 2e-4)
    moved, traction = np.array(rows).T
    return moved, traction, traction[near(moved, there)].max(), simulation.energies["error"]


def close(study):
    """Closure [m] and normal traction [Pa] on the way down to 10 MPa and back; energy error."""
    simulation = study.simulate(
        f"loads.tractions.0.traction=[0, 0, {-10e6 * AREA}]",
        "loads.tractions.0.history=[[0, 0], [0.1, 1], [0.2, 0.02]]",
        "loads.velocities.0.velocity=[0, 0, 0]", "interfaces.default.stiffness_n=400 GPa/m",
        "stages.0.damping.contact=0")  # fmt: skip
    low, rows = simulation.build.nodes_of("block"), []
    low = low[simulation.fields["position"][low, 2] < 0.5]
    while simulation.time < 0.2:
        rows.append((-simulation.fields["displacement"][low, 2].mean(), tractions(simulation)[1]))
        simulation.run_until(simulation.time + 1e-3)
    return *np.array(rows).T, simulation.energies["error"]


def run(study):
    """Seven pressures, three when quick, and one way down and up."""
    law, curves = study.case().interfaces.default, {}
    for pressure in PRESSURES if study.full else PRESSURES[::3]:
        moved, traction, peak, error = shear(study, 1e6 * pressure)
        study.check(f"peak under {pressure:g} MPa", theory=theory(law, 1e6 * pressure)[0],
                    ours=peak, within=1e-4, unit="Pa")  # fmt: skip
        study.check(f"error of the energy ledger under {pressure:g} MPa", theory=0, within=1e-3,
                    ours=error, absolute=True)  # fmt: skip
        if pressure in (1, 2, 5):
            curves[f"{pressure} MPa"] = (moved, traction)
    study.curve("Shear", "displacement [m]", "shear traction [Pa]", curves)
    depth, pressure, error = close(study)
    _, _, stiffness, most = theory(law, 1e6)
    exact = stiffness * depth / (1 - depth / most)
    study.check("closure: largest error of the pressure over 10 MPa", theory=0, absolute=True,
                ours=abs(pressure - exact).max() / 10e6, within=1e-4)  # fmt: skip
    study.check("closure under 5 MPa", theory=5e6 / (stiffness + 5e6 / most), unit="m", within=1e-3,
                ours=np.interp(5e6, pressure[: depth.argmax()], depth[: depth.argmax()]))  # fmt: skip
    study.check("closure: error of the energy ledger", theory=0, within=1e-4, absolute=True,
                ours=error)  # fmt: skip
    study.curve("Closure", "closure [m]", "pressure [Pa]",
                {".cdem": (depth, pressure), "theory": (depth, exact)})  # fmt: skip
