"""Circular hole in Mohr-Coulomb rock under equal pressure from all sides (Salencon)."""

import tempfile
from pathlib import Path

import meshio
import numpy as np

from cdem.output.render import snapshot
from cdem.run.law_fields import state_of
from cdem.verification.kirsch.problem import INNER, OUTER, polar_stress, ring

QUICK = False
PRESSURE = 30e6  # far away [Pa]


def theory(rock):
    """Radius of the plastic zone [m], radial and hoop stress [Pa] and inward displacement [m] by radius.

    Salencon (1969), compression positive; the displacement is that from the rock without stress, the
    integral of du/dr + M u/r = e_r + M e_t, elastic strains on the right, from the zone's rim inwards.
    """
    sine = np.sin(np.radians([rock.friction_angle, rock.dilation_angle]))
    n, m = (1 + sine) / (1 - sine)
    strength = 2 * rock.cohesion * np.sqrt(n)
    inside = strength / (n - 1)
    rim = INNER * (2 / (n + 1) * (PRESSURE + inside) / inside) ** (1 / (n - 1))
    at_rim = (2 * PRESSURE - strength) / (n + 1)
    shear, nu = rock.young_modulus / (2 * (1 + rock.poisson_ratio)), rock.poisson_ratio

    def stress(r):
        r = np.asarray(r, float)
        flows = inside * ((r / INNER) ** (n - 1) - 1)
        part = (PRESSURE - at_rim) * (rim / r) ** 2
        radial = np.where(r < rim, flows, PRESSURE - part)
        return radial, np.where(r < rim, n * flows + strength, PRESSURE + part)

    def strain(radial, hoop):
        return ((1 - nu) * radial - nu * hoop) / (2 * shear)

    def displacement(r):
        outer = rim * strain(*stress(rim)[::-1])
        x = np.linspace(r, rim, 4001)
        radial, hoop = stress(x)
        slope = x**m * (strain(radial, hoop) + m * strain(hoop, radial))
        return (rim**m * outer - np.trapezoid(slope, x)) / r**m

    return rim, stress, displacement


def load(study, cells, pressures, *settings):
    """The ring under pressures on its inner and outer rim [Pa], brought up slowly.

    `pressures` gives both for the rock of the case.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "ring.msh"
        meshio.write(path, ring(cells), "gmsh22", binary=False)
        settings = f"model.mesh={path}", *settings
        inner, outer = pressures(study.case(*settings).materials["rock"])
        entries = []
        for rim, pressure in (("inner", inner), ("outer", -outer)):
            for k in range(cells if pressure else 0):
                angle = (k + 0.5) * np.pi / 2 / cells
                x, y = pressure * np.cos(angle), pressure * np.sin(angle)
                entries.append(f"{{surface: {rim}{k}, traction: [{x:.9g}, {y:.9g}, 0], "
                               "history: [[0, 0], [0.01, 0.9], [0.02, 1]]}")  # fmt: skip
        simulation = study.simulate(*settings, f"loads.tractions=[{', '.join(entries)}]")
    simulation.run()
    return simulation


def rim_of(simulation, r):
    """Radius where plastic shear ends, by a line in 1 / r^2 through the outermost plastic rows."""
    shear = state_of(simulation, "plastic_shear")
    radii = np.unique(r.round(6))
    means = np.array([shear[np.abs(r - one) < 1e-5].mean() for one in radii])
    last = np.flatnonzero(means > 0.02 * means.max())[-3:]
    slope, offset = np.polyfit(1 / radii[last] ** 2, means[last], 1)
    return np.sqrt(-slope / offset)


def run(study):
    """Two meshes, with associated flow and without dilation."""
    shown = {}
    for dilation in (30, 0):
        for cells in (24, 48):
            within = 0.02 * 48 / cells
            simulation = load(study, cells, lambda rock: (0.0, float(theory(rock)[1](OUTER)[0])),
                              f"materials.rock.dilation_angle={dilation}")  # fmt: skip
            rim, stress, displacement = theory(simulation.case.materials["rock"])
            r, _, polar = polar_stress(simulation)
            exact = np.array(stress(r))
            errors = -polar[:2] - exact
            name = f"{cells} cells, dilation {dilation} deg"
            wall = np.hypot(*simulation.build.start_position[:, :2].T) < INNER + 1e-6
            moved = np.linalg.norm(simulation.fields["displacement"][wall], axis=1).mean()
            study.check(f"radius of the plastic zone, {name}", theory=rim, unit="m",
                        ours=rim_of(simulation, r), within=within)  # fmt: skip
            study.check(f"displacement of the wall, {name}", theory=displacement(INNER), unit="m",
                        ours=moved, within=within)  # fmt: skip
            study.check(f"rms error of stress over the pressure, {name}", theory=0, absolute=True,
                        ours=np.sqrt((errors**2).mean()) / PRESSURE, within=within)  # fmt: skip
            study.check(f"energy error, {name}", theory=0, ours=simulation.energies["error"],
                        absolute=True, within=1e-9)  # fmt: skip
            order = np.argsort(r)
            for what, k in (("radial", 0), ("hoop", 1)):
                shown[f".{what}, {name}"] = (r[order], -polar[k][order] / 1e6)
                if cells == 48 and dilation == 0:
                    shown[what] = (r[order], exact[k][order] / 1e6)
    study.curve("Stress, compression positive", "radius [m]", "stress [MPa]", shown)
    study.picture("The plastic zone", snapshot(simulation), field="plastic_shear")
