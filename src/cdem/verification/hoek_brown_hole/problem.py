"""Circular hole in a rock mass after Hoek and Brown (Carranza-Torres and Fairhurst 1999)."""

import numpy as np

from cdem.output.render import snapshot
from cdem.verification.kirsch.problem import INNER, OUTER, polar_stress
from cdem.verification.salencon.problem import load, rim_of

QUICK = False
PRESSURE = 15e6  # far away [Pa]


def theory(rock, inside):
    """Radius of the plastic zone [m], and radial and hoop stress [Pa] by radius; compression positive.

    Of a = 1/2. With P = p / (m s_ci) + s / m^2, sqrt(P) grows by half the logarithm of the radius
    in the zone, and 4 sqrt(P) = sqrt(1 + 16 P0) - 1 at its rim.
    """
    scale, shift = rock.mb * rock.uniaxial_strength, rock.s / rock.mb**2

    def root(pressure):
        return np.sqrt(pressure / scale + shift)

    root_rim = (np.sqrt(1 + 16 * root(PRESSURE) ** 2) - 1) / 4
    rim = INNER * np.exp(2 * (root_rim - root(inside)))
    at_rim = scale * (root_rim**2 - shift)

    def stress(r):
        r = np.asarray(r, float)
        flows = root(inside) + np.log(np.minimum(r, rim) / INNER) / 2
        part = (PRESSURE - at_rim) * (rim / r) ** 2
        radial = np.where(r < rim, scale * (flows**2 - shift), PRESSURE - part)
        return radial, np.where(r < rim, radial + scale * flows, PRESSURE + part)

    return rim, stress


def run(study):
    """An empty hole and one under pressure; two meshes."""
    shown = {}
    for inside in (0.0, 2.5e6):
        for cells in (24, 48):
            within = 0.02 * 48 / cells
            simulation = load(
                study, cells, lambda rock, p=inside: (p, float(theory(rock, p)[1](OUTER)[0]))
            )
            rim, stress = theory(simulation.case.materials["rock"], inside)
            r, _, polar = polar_stress(simulation)
            exact = np.array(stress(r))
            name = f"{cells} cells, {inside / 1e6:g} MPa inside"
            study.check(f"radius of the plastic zone, {name}", theory=rim, unit="m",
                        ours=rim_of(simulation, r), within=within)  # fmt: skip
            errors = -polar[:2] - exact
            study.check(f"rms error of stress over the pressure, {name}", theory=0, absolute=True,
                        ours=np.sqrt((errors**2).mean()) / PRESSURE, within=within)  # fmt: skip
            study.check(f"energy error, {name}", theory=0, ours=simulation.energies["error"],
                        absolute=True, within=1e-9)  # fmt: skip
            order = np.argsort(r)
            for what, k in (("radial", 0), ("hoop", 1)):
                shown[f".{what}, {name}"] = (r[order], -polar[k][order] / 1e6)
                if cells == 48:
                    shown[f"{what}, {inside / 1e6:g} MPa inside"] = (
                        r[order],
                        exact[k][order] / 1e6,
                    )
    study.curve("Stress, compression positive", "radius [m]", "stress [MPa]", shown)
    study.picture("The plastic zone", snapshot(simulation), field="plastic_shear")
