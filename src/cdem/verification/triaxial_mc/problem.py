"""Triaxial compression and extension of Mohr-Coulomb rock."""

import numpy as np

from cdem.output.render import snapshot
from cdem.run.fields import stress_of


def theory(rock, side, kind):
    """Axial stress [Pa] at yield under a pressure on the sides [Pa]; compression is positive."""
    t = np.tan(np.radians(rock.friction_angle))
    n = (t + np.sqrt(1 + t * t)) ** 2
    strength = 2 * rock.cohesion * np.sqrt(n)
    return n * side + strength if kind == "compression" else (side - strength) / n


def drive(study, side, kind, *settings):
    """The cube at the end, and its strain and axial stress on the way."""
    down = -0.05 if kind == "compression" else 0.05
    simulation = study.simulate(
        f"loads.velocities.0.velocity=[0, 0, {down}]",
        f"loads.tractions.0.traction=[{-side}, 0, 0]",
        f"loads.tractions.1.traction=[0, {-side}, 0]",
        *settings,
    )
    path = []
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(50)
        shortening = -simulation.fields["displacement"][:, 2].min()
        lengthening = simulation.fields["displacement"][:, 2].max()
        path.append((max(shortening, lengthening), -stress_of(simulation)[0, 2]))
    return simulation, np.transpose(path)


def run(study):
    """Both tests without and with pressure on the sides; every shape of one cell when full."""
    lines = {}
    shapes = ("hex8", "wedge6", "pyramid5", "tet4") if study.full else ("hex8",)
    for shape in shapes:
        box = f"model.blocks.0.box.shape={shape}"
        for kind in ("compression", "extension"):
            for side in (0.0, 5e6):
                simulation, path = drive(study, side, kind, box)
                exact = theory(simulation.case.materials["rock"], side, kind)
                study.check(f"{shape}: axial stress, {kind}, sides at {side / 1e6:g} MPa", unit="Pa",
                            theory=exact, ours=-stress_of(simulation)[:, 2].mean(),
                            within=1e-6 if shape == "hex8" else 1e-4)  # fmt: skip
                study.check(f"{shape}: energy error, {kind}, sides at {side / 1e6:g} MPa", theory=0,
                            ours=simulation.energies["error"], absolute=True, within=1e-4)  # fmt: skip
                if shape == "hex8":
                    lines[f"{kind}, sides at {side / 1e6:g} MPa"] = (100 * path[0], path[1] / 1e6)
    study.curve("Axial stress, compression positive", "axial strain [%]", "stress [MPa]", lines)
    study.picture("The cube after extension", snapshot(simulation))
