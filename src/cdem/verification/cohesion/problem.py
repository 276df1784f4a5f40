"""Shear failure of a bonded interface (Table 1)."""

import numpy as np

from cdem.verification.runner import break_factor

PAPER = "Fig. 15, Table 1"

MESHES = {"1:1": (1, 1), "1:2": (1, 2), "2:3": (2, 3)}  # faces along each side, below and above


def theory(cohesion, slope=0.0, friction_angle=0.0):
    """Traction at failure [Pa]; `slope` is height over side for a push on the top alone, else 0.

    The moment P h of a push on the top pulls the rear row of bonds (half the area, b from the front
    row) by 2 P h / b: c = P + 2 (P h / b) tan(phi), Mohr-Coulomb in tension.
    """
    return cohesion / (1 + 2 * slope * np.tan(np.radians(friction_angle)))


def run(study):
    """A cube in pure shear, and plates that are pushed along their top; all influences when full."""

    def shear(*settings, file="case.yaml"):
        """Traction at which the first bond breaks [Pa]."""
        simulation = study.simulate(*settings, file=file)
        return simulation.case.loads.tractions[0].traction[0] * break_factor(simulation)

    law = study.case().interfaces.default
    for name, cells in MESHES.items():
        divisions = [f"model.blocks.{i}.box.divisions=[{n}, {n}, 1]" for i, n in enumerate(cells)]
        for points in ("vertex", "quadrature") if study.full else ("vertex",):
            study.check(f"traction at failure, meshes {name}, bonds at {points}", unit="Pa",
                        theory=theory(law.cohesion), paper=29600 if name == "1:1" else None,
                        within=5e-5, ours=shear(*divisions, f"contact.bond_points={points}"))  # fmt: skip
    for height in (0.001, 0.01, 0.05) if study.full else (0.001,):
        ours = shear(f"model.blocks.1.box.size=[1, 1, {height}]", file="plate.yaml")
        study.check(f"push on the top at failure, plate of {1e3 * height:g} mm", unit="Pa",
                    theory=theory(law.cohesion, height, law.friction_angle), ours=ours,
                    within=2e-4 if height < 0.005 else 1e-3)  # fmt: skip
    if study.full:
        study.influences("traction at failure", shear, theory=theory(law.cohesion), within=5e-5,
                         unit="Pa")  # fmt: skip
