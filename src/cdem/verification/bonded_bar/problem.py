"""Bar under its own weight, whole and cut into bonded elements."""

import numpy as np

LENGTH, CELLS, GRAVITY = 10.0, 10, 9.81


def theory(rock, stiffness=np.inf):
    """Sag of the lower end [m]: rho g L^2 / 2 E, and stress over stiffness at every joint."""
    joints = np.arange(1, CELLS) * LENGTH / CELLS  # height of rock that hangs on each
    weight = rock.density * GRAVITY
    return weight * LENGTH**2 / (2 * rock.young_modulus) + (weight * joints / stiffness).sum()


def run(study):
    """All shapes when full; with joints at every element where these lie across the bar."""
    for shape in ("hex8", "wedge6", "pyramid5", "tet4") if study.full else ("hex8", "tet4"):
        box = f"{{size: [1, 1, {LENGTH}], divisions: [1, 1, {CELLS}], shape: {shape}}}"
        splits = {"one": ""}
        if shape in ("hex8", "wedge6"):
            splits["elements"] = ", every element a block"
        for split, name in splits.items():
            simulation = study.simulate(f"model.blocks.0.box={box}", f"model.split.bar={split}")
            simulation.run()
            rock, law = simulation.case.materials["rock"], simulation.case.interfaces.default
            low = simulation.build.start_position[:, 2] < 1e-6 - LENGTH
            sag = -simulation.fields["displacement"][low, 2].mean()
            exact = theory(rock) if split == "one" else theory(rock, law.stiffness_n.value)
            study.check(f"sag, {shape}{name}", unit="m", theory=exact, ours=sag,
                        within=3e-4 if shape in ("tet4", "pyramid5") else 1e-6)  # fmt: skip
