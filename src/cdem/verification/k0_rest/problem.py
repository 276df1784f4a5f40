"""A column at rest under initial stress: nothing moves."""

import numpy as np

from cdem.run.fields import stress_of

STEPS = 200  # long enough for a wave to run through the column a few times
WHOLE = "model.split={rock: connected}"
CUT = ["model.joints=[{name: bedding, dip: 20, dip_direction: 100, spacing: 2},"
       " {name: cross, dip: 75, dip_direction: 280, spacing: 2.5}]"]  # fmt: skip


def theory(depth, density=2500.0, gravity=9.81, k0=(0.5, 0.8)):
    """Stress xx, yy, zz [Pa] at a depth: the weight above, and its k0-th parts (Jaky, Terzaghi)."""
    vertical = -density * gravity * depth
    return np.array([k0[0] * vertical, k0[1] * vertical, vertical])


def box(shape):
    """The column of these elements."""
    return f"model.blocks.0.box={{size: [4, 4, 8], divisions: [3, 3, 5], shape: {shape}}}"


def run(study):
    """Elements of all shapes, whole and each a block, bonded and loose; and cut by joints."""
    loose = "interfaces.default={friction_angle: 40}"
    scenes = {"hex8, each a block, loose": [box("hex8"), loose]}
    for shape in ("tet4", "wedge6", "hex8", "pyramid5"):
        scenes[f"{shape}, one block"] = [box(shape), WHOLE]
        if shape in ("tet4", "wedge6"):  # of the others the mean dilatation has a say; README.md
            scenes[f"{shape}, bonded"] = [box(shape)]
            scenes[f"{shape}, loose"] = [box(shape), loose]
    scenes["joints of two sets, loose"] = [WHOLE, *CUT, loose]
    settlement = 2500 * 9.81 * 8**2 / 2 / 10e9
    for name, settings in scenes.items():
        simulation = study.simulate(*settings)
        simulation.core.run(1)
        exact = "hex8, each" not in name
        if exact:
            study.check(f"unbalanced force over loads, {name}", theory=0.0,
                        ours=simulation.core.unbalance_ratio(), within=1e-10,
                        absolute=True)  # fmt: skip
        simulation.core.run(STEPS)
        moved = np.abs(simulation.fields["position"] - simulation.build.start_position).max()
        study.check(f"way over settlement under its weight, {name}", theory=0.0,
                    ours=moved / settlement, within=1e-9 if exact else 0.005,
                    absolute=True)  # fmt: skip
        if name == "tet4, bonded":
            stress = stress_of(simulation)
            t = simulation.build.topology
            middle = t.node_position[t.element_nodes["tet4"]].mean(axis=1)
            lowest = int(np.argmin(middle[:, 2]))
            for axis, value in zip("xyz", theory(8 - middle[lowest, 2]), strict=True):
                study.check(f"stress {axis}{axis} of the lowest element", unit="Pa", theory=value,
                            ours=stress[lowest]["xyz".index(axis)], within=1e-9)  # fmt: skip
