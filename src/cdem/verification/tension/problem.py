"""Tension failure of a bonded interface (Table 1)."""

import numpy as np


def theory(strength):
    """Traction at failure [Pa]: both sides carry springs of half the area (Fig. 14), so not 2 T."""
    return strength


def pull(simulation):
    """Traction at which the first bond breaks [Pa]."""
    traction = simulation.case.loads.tractions[0]
    while sum(simulation.broken.values()) == 0:
        simulation.step(1)
        if simulation.time > traction.history[-1][0]:
            return np.inf
    return traction.traction[2] * np.interp(simulation.time, *np.transpose(traction.history))


def run(study):
    """Meshes that match and do not match; both places for the bonds when full."""
    strength = study.case().interfaces.default.tensile_strength
    meshes = {"1:1": ([1, 1], [1, 1]), "1:2": ([1, 1], [2, 2]), "2:3": ([2, 2], [3, 3])}
    for name, (below, above) in meshes.items():
        divisions = [
            f"model.blocks.{i}.box.divisions=[{n[0]}, {n[1]}, 1]"
            for i, n in enumerate((below, above))
        ]
        for points in ("vertex", "quadrature") if study.full else ("vertex",):
            study.check(f"traction at failure, meshes {name}, bonds at {points}", unit="Pa",
                        theory=theory(strength), paper=10001 if name == "1:1" else None, within=2e-4,
                        ours=pull(study.simulate(*divisions, f"contact.bond_points={points}")))  # fmt: skip
