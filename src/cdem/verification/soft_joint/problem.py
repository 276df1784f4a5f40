"""Two equal cubes with a soft joint, sheared until corners have passed the rim."""

import numpy as np

from cdem.rows import rows_of

STIFFNESS, FRICTION, PRESSURE = 1e8, np.tan(np.radians(60)), 1e6  # [Pa/m], [1], [Pa]
ONWARD, RETURN = [[0, 0], [0.2, 0], [0.21, 1]], [[0, 0], [0.2, 0], [0.21, 1], [0.36, 1], [0.37, -1]]
WAYS = {  # divisions, speed, its history, times
    "along a side": (1, [0.1, 0, 0], ONWARD, [0.25, 0.27, 0.29, 0.35, 0.45]),
    "askew": (1, [0.06, 0.08, 0], ONWARD, [0.25, 0.27, 0.29, 0.35, 0.45]),
    "there and back": (1, [0.1, 0, 0], RETURN, [0.36, 0.42, 0.45, 0.55, 0.6]),
    "nine faces": (3, [0.1, 0, 0], ONWARD, [0.25, 0.27, 0.29, 0.35, 0.45]),
}


def theory(way):
    """Force on 1 m2 of the joint [N], after a way [m]: k_s u, at most p tan phi."""
    return min(STIFFNESS * way, PRESSURE * FRICTION)


def shear(study, way):
    """Ways made [m] and forces on the lower cube [N] at the times, in the plane; energy error."""
    divisions, speed, history, times = WAYS[way]
    simulation = study.simulate(
        *(f"model.blocks.{i}.box.divisions=[{divisions}, {divisions}, 1]" for i in (0, 1)),
        f"loads.velocities.0.velocity={speed}", f"loads.velocities.0.history={history}")  # fmt: skip
    lower, upper = (simulation.build.nodes_of(group) for group in ("lower", "upper"))
    rows = []
    for time in times:
        simulation.run_until(time)
        reaction = rows_of(simulation.core, "node.reaction").force[lower, :2]
        rows.append(
            (simulation.fields["displacement"][upper, :2].mean(axis=0), -reaction.sum(axis=0))
        )
    return *(np.array(column) for column in zip(*rows, strict=True)), simulation.energies["error"]


def run(study):
    """T = min(k_s u, p tan phi) A along the way, to 25 mm; more meshes and ways when full."""
    for way in WAYS if study.full else ["along a side", "askew"]:
        moved, force, error = shear(study, way)
        for u, found in zip(moved, force, strict=True):
            length = np.hypot(*u)
            study.check(f"{way}, {1e3 * length:.1f} mm", theory=theory(length), within=0.01,
                        unit="N", ours=found @ u / length)  # fmt: skip
        study.check(f"energy, {way}", theory=0, within=1e-6, absolute=True, ours=error)
