"""Bending stiffness and strength of a bonded interface, for both places of the bonds."""

import numpy as np

from cdem.verification.runner import break_factor

SIDE, COUPLE = 1.0, 1e4  # [m]; moment at the end of the history [N m]


def theory(points, divisions):
    """Bending stiffness and strength relative to the section's values, b^4 / 12 and T b^3 / 6.

    Bonds at the vertices are a trapezoidal rule: both are 1 + 2 / n^2 for n faces. Bonds at the
    Gauss points integrate bending exactly, and the outermost sits (1 - 1 / sqrt 3) b / 2n inside.
    """
    if points == "vertex":
        return 1 + 2 / divisions**2, 1 + 2 / divisions**2
    return 1.0, 1 / (1 - (1 - 1 / np.sqrt(3)) / divisions)


def bend(simulation):
    """Bending stiffness before, and moment at the first broken bond [N m]."""
    start, nodes = simulation.build.start_position, simulation.build.nodes_of("block")
    low = nodes[start[nodes, 2] < 1e-6]
    right, left = low[start[low, 0] > SIDE - 1e-6], low[start[low, 0] < 1e-6]
    moment = COUPLE * break_factor(simulation, every=5)
    up = simulation.fields["displacement"][:, 2]
    return moment / ((up[left].mean() - up[right].mean()) / SIDE), moment


def run(study):
    """Two faces across (one and four when full), bonds at the vertices and at Gauss points."""
    for points in ("vertex", "quadrature"):
        for n in (1, 2, 4) if study.full else (2,):
            faces = [f"model.blocks.{i}.box.divisions=[{n}, 1, 1]" for i in (0, 1)]
            simulation = study.simulate(*faces, f"contact.bond_points={points}")
            law, rock = simulation.case.interfaces.default, simulation.case.materials["rock"]
            stiffness, moment = bend(simulation)
            exact = theory(points, n)
            k_n = law.stiffness_n.value * rock.young_modulus / SIDE
            study.check(f"bending stiffness over k_n b^4 / 12, bonds at {points}, {n} faces",
                        theory=exact[0], ours=stiffness / (k_n / 12), within=0.01)  # fmt: skip
            study.check(f"breaking moment over T b^3 / 6, bonds at {points}, {n} faces",
                        theory=exact[1], ours=moment / (law.tensile_strength / 6), within=0.01)  # fmt: skip
