"""Tension failure of a bonded interface (Table 1)."""

from cdem.verification.runner import break_factor

PAPER = "Fig. 15, Table 1"

MESHES = {"1:1": (1, 1), "1:2": (1, 2), "2:3": (2, 3)}  # faces along each side, below and above


def theory(strength):
    """Traction at failure [Pa]: both sides carry springs of half the area (Fig. 14), so not 2 T."""
    return strength


def run(study):
    """Meshes that match and do not match; both places for the bonds and all influences when full."""

    def pull(*settings):
        """Traction at which the first bond breaks [Pa]."""
        simulation = study.simulate(*settings)
        return simulation.case.loads.tractions[0].traction[2] * break_factor(simulation)

    exact = theory(study.case().interfaces.default.tensile_strength)
    for name, cells in MESHES.items():
        divisions = [f"model.blocks.{i}.box.divisions=[{n}, {n}, 1]" for i, n in enumerate(cells)]
        for points in ("vertex", "quadrature") if study.full else ("vertex",):
            study.check(f"traction at failure, meshes {name}, bonds at {points}", unit="Pa",
                        theory=exact, paper=10001 if name == "1:1" else None, within=5e-5,
                        ours=pull(*divisions, f"contact.bond_points={points}"))  # fmt: skip
    if study.full:
        study.influences("traction at failure", pull, theory=exact, within=5e-5, unit="Pa")
