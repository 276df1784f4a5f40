"""The six contact types: which semi-springs and semi-edges act (Figs. 12, 13)."""

import numpy as np

from cdem.output.render import snapshot
from cdem.rows import rows_of

PAPER = "Figs. 12, 13"

LOWER = {  # the topmost face, edge (along y) or vertex at the origin
    "face": ["model.blocks.0.translate=[-0.5, -0.5, -1]"],
    "edge": ["model.blocks.0.rotate={axis: [0, 1, 0], angle: 45}",
             f"model.blocks.0.translate=[{-0.5**0.5}, -0.5, {-0.5**0.5}]"],
    "vertex": ["model.blocks.0.rotate={axis: [1, -1, 0], angle: 54.735610317245346}",
               f"model.blocks.0.translate=[0, 0, {-(3**0.5)}]"],
}  # fmt: skip
UPPER = {  # the lowest face, edge (along x) or vertex at the origin
    "face": ["model.blocks.1.translate=[-0.15, -0.15, 0]"],
    "edge": ["model.blocks.1.rotate={axis: [1, 0, 0], angle: 45}",
             "model.blocks.1.translate=[-0.15, 0, 0]"],
    "vertex": ["model.blocks.1.rotate={axis: [1, -1, 0], angle: 54.735610317245346}",
               "model.blocks.1.translate=[0, 0, 0]"],
}  # fmt: skip
MEETING = {"face": (4, 1), "edge": (2, 2), "vertex": (1, 3)}  # vertices, and faces at each


def theory(lower, upper, weight, stiffness, area):
    """Acting semi-springs, acting semi-edges, and penetration [m] (Feng et al. 2014, Eqs. 3 to 5).

    On a face, every vertex of the upper feature carries one semi-spring for each face that meets
    there, of stiffness k_n A / 4, halved because both blocks may have springs. Two edges that cross
    meet as two semi-edges (one for each face) of either block, of k_n A / 4 each.
    """
    if lower == "edge":
        return 0, 4, weight / (stiffness * area)
    vertices, faces = MEETING[upper]
    return vertices * faces, 0, weight / (0.5 * stiffness * area * vertices * faces / 4)


def run(study):
    """Five types at rest; the sixth, vertex on vertex, has no rest and is hit off-centre."""
    for lower, upper in (("face", "face"), ("face", "edge"), ("face", "vertex"), ("edge", "edge"),
                         ("edge", "vertex")):  # fmt: skip
        simulation = study.simulate(*LOWER[lower], *UPPER[upper])
        simulation.step(4000)
        contacts, law = simulation.contacts, simulation.case.interfaces.default
        topology, names = simulation.build.topology, simulation.build.group_names
        own = topology.face_group[contacts["mother_face"]] == names.index("upper")
        weight = 9.81 * simulation.fields["mass"][simulation.build.nodes_of("upper")].sum()
        carried = np.where(own, 1.0, -1.0) @ contacts["force"]
        study.check(f"{upper} on {lower}: carried over weight", theory=1.0, within=2e-8,
                    ours=carried[2] / weight)  # fmt: skip
        study.picture(f"{upper} on {lower}", snapshot(simulation), field="group")
        if upper == "vertex" and lower == "edge":
            continue  # which of the vertex's edges cross depends on how it leans
        springs, edges, depth = theory(lower, upper, weight, law.stiffness_n.value, 0.09)
        counts = [int((contacts["kind"] == kind).sum()) for kind in (0, 1)]
        study.check(f"{upper} on {lower}: semi-springs", theory=springs, ours=counts[0], within=0,
                    absolute=True)  # fmt: skip
        study.check(f"{upper} on {lower}: semi-edges", theory=edges, ours=counts[1], within=0,
                    absolute=True)  # fmt: skip
        core = simulation.core
        touch, edge = core.fields()["spring.target"] >= 0, rows_of(core, "edge.state")
        acting = (rows_of(core, "spring.state").penetration[touch] if springs
                  else edge.penetration[edge.force_n > 0])  # fmt: skip
        study.check(f"{upper} on {lower}: penetration", unit="m", theory=depth, ours=acting.mean(),
                    within=2e-8)  # fmt: skip
    simulation = study.simulate(*LOWER["vertex"], *UPPER["vertex"], "loads.gravity=[0, 0, 0]",
                                "model.blocks.1.translate=[0.01, 0.004, 0.001]", "time.safety=0.2",
                                "stages.0.damping={contact: 0}", "interfaces.default.friction_angle=0",
                                "groups.upper.velocity=[0, 0, -0.5]")  # fmt: skip
    simulation.step(20)
    before = simulation.energies["kinetic"]
    while simulation.time < 0.04:
        simulation.step(100)
    nodes = simulation.build.nodes_of("upper")
    mass = simulation.fields["mass"][nodes]
    away = mass @ simulation.fields["velocity"][nodes] / mass.sum()
    turned = np.hypot(away[0], away[1]) > 0.02  # m/s
    study.check("vertex on vertex: turned aside, energy after over before", theory=1.0,
                ours=simulation.energies["kinetic"] / before if turned else 0.0, within=2e-3)  # fmt: skip
    study.picture("vertex on vertex", snapshot(simulation), field="group")
