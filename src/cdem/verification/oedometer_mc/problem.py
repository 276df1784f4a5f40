"""Oedometer test of Mohr-Coulomb rock: flow along an edge of the yield surface."""

import numpy as np

from cdem.run.fields import stress_of


def theory(rock, strain):
    """Axial and lateral stress [Pa] at axial strains; compression is positive."""
    e, nu = rock.young_modulus, rock.poisson_ratio
    lame, shear = e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))
    n, m = (ratio(np.radians(a)) for a in (rock.friction_angle, rock.dilation_angle))
    strength = 2 * rock.cohesion * np.sqrt(n)
    first = strength / (lame + 2 * shear - n * lame)  # strain at yield
    elastic, more = np.minimum(strain, first), np.maximum(strain - first, 0)
    # flow a along the axis and -a m / 2 to either side, such that d sz = n d sx
    flow = (2 * shear + lame * (1 - n)) / (2 * shear + n * m * shear + lame * (n - 1) * (m - 1))
    side = lame * (1 + (m - 1) * flow) + shear * m * flow
    lateral = lame * elastic + side * more
    return (lame + 2 * shear) * elastic + n * side * more, lateral


def ratio(angle):
    """(1 + sin) / (1 - sin) of an angle [rad]."""
    return (1 + np.sin(angle)) / (1 - np.sin(angle))


def press(simulation):
    """Strain, axial and lateral stress, compression positive, from before yield to far beyond."""
    path = []
    while simulation.time < simulation.case.stages[0].duration:
        simulation.step(20)
        stress = -stress_of(simulation)[0]
        path.append((-simulation.fields["displacement"][:, 2].min(), stress[2], stress[0]))
    return np.transpose(path)


def run(study):
    """Associated and without dilation."""
    lines = {}
    for dilation in (10, 0):
        simulation = study.simulate(f"materials.rock.dilation_angle={dilation}")
        strain, *ours = press(simulation)
        exact = theory(simulation.case.materials["rock"], strain)
        for what, mine, known in zip(("axial", "lateral"), ours, exact, strict=True):
            study.check(f"{what} stress, dilation {dilation} deg, largest error over the last",
                        theory=0, ours=np.abs(mine - known).max() / known[-1], absolute=True,
                        within=1e-9)  # fmt: skip
            slope = np.polyfit(strain[-5:], mine[-5:], 1)[0]
            slope_known = np.polyfit(strain[-5:], known[-5:], 1)[0]
            study.check(f"{what} stiffness in flow, dilation {dilation} deg", unit="Pa",
                        theory=slope_known, ours=slope, within=1e-6)  # fmt: skip
            lines[f"{what}, dilation {dilation} deg"] = (100 * strain, mine / 1e6)
        study.check(f"energy error, dilation {dilation} deg", theory=0, absolute=True,
                    ours=simulation.energies["error"], within=1e-5)  # fmt: skip
    study.curve("Stress, compression positive", "axial strain [%]", "stress [MPa]", lines)
