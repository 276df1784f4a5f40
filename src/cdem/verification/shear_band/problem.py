"""Work spent in a band of rock that softens: per area, whatever the mesh."""

import numpy as np

from cdem.output.render import snapshot
from cdem.run.law_fields import state_of

SIDE = 0.125  # of the column [m]
WAYS = {
    "sheared": ("plastic_shear", ()),
    "pulled": (
        "plastic_tension",
        (
            "loads.supports.0.fix=[x, y]",
            "loads.velocities.0.velocity=[0, 0, 0.02]",
            "loads.velocities.0.components=[z]",
        ),
    ),
}
"""The yielding strength, and the settings of the drive."""


def theory(rock, way):
    """Work per area [J/m2] until the strength is residual.

    Of simple shear by an angle g the plastic shear strain is g / sqrt(3).
    """
    if way == "pulled":
        return rock.softening.fracture_energy
    (_, before), (slip, after) = rock.softening.cohesion
    return np.sqrt(3) * slip * (before + after) / 2


def drive(study, way, cells):
    """Slip across the worst element [m] and work per area [J/m2] on the way."""
    wide = cells // 8
    simulation = study.simulate(f"model.blocks.0.box.divisions=[{wide}, {wide}, {cells}]",
                                *WAYS[way][1])  # fmt: skip
    path = []
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(100)
        slip = state_of(simulation, WAYS[way][0]).max() / cells
        path.append((slip, simulation.energies["plastic"] / SIDE**2))
    return simulation, np.transpose(path)


def run(study):
    """Columns of 8 and 16 layers; 32 when full."""
    lines = {}
    for way in WAYS:
        for cells in (8, 16, 32) if study.full else (8, 16):
            simulation, path = drive(study, way, cells)
            rock = simulation.case.materials["rock"]
            end = 4e-3 if way == "pulled" else rock.softening.cohesion[-1][0]
            crooked = way == "sheared" and cells == 32  # README.md
            study.check(f"work per area, {way}, {cells} layers", unit="J/m2",
                        theory=theory(rock, way), ours=np.interp(end, *path),
                        within=0.2 if crooked else 0.03)  # fmt: skip
            study.check(f"energy error, {way}, {cells} layers", theory=0, absolute=True,
                        ours=simulation.energies["error"], within=1e-8)  # fmt: skip
            lines[f"{way}, {cells} layers"] = (1e3 * path[0], path[1])
    study.curve("Work per area", "slip across the band [mm]", "work [J/m2]", lines)
    study.picture("The band", snapshot(simulation), field="plastic_tension")
