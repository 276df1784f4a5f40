"""Tetrahedral wedge between two joints: factor of safety (Hoek & Bray)."""

import numpy as np

from cdem.output.render import snapshot
from cdem.study.critical import find_critical, strength_reduction


def theory(vertices, friction_angles):
    """Factor of safety, friction alone (Hoek & Bray 1981, wedge failure).

    Balance across the line of intersection fixes both normal forces; along it, friction
    N_a tan(phi_a) + N_b tan(phi_b) stands against W sin(plunge).

    Args:
        vertices: Toe, crest on joint a, crest on joint b, rear [m].
        friction_angles: Of joints a and b [deg].
    """
    toe, crest_a, crest_b, rear = np.asarray(vertices)
    normals = []
    for crest in (crest_a, crest_b):
        n = np.cross(rear - toe, crest - toe)
        normals.append(n * np.sign(n[2]) / np.linalg.norm(n))
    line = (toe - rear) / np.linalg.norm(toe - rear)
    weight = np.array([0, 0, -1.0])
    across = weight - (weight @ line) * line
    forces = np.linalg.lstsq(np.column_stack(normals), -across, rcond=None)[0]
    return forces @ np.tan(np.radians(friction_angles)) / (weight @ line)


def run(study):
    """Strength reduction, and the acceleration of the wedge with a quarter of its friction."""
    case = study.case()
    vertices = np.array(case.model.blocks[0].polyhedron.vertices)
    angles = [pair.friction_angle for pair in case.interfaces.pairs]
    found = find_critical(case, strength_reduction(), (0.3, 3.0), tolerance=0.01,
                          threads=study.threads)  # fmt: skip
    study.check("factor of safety", theory=theory(vertices, angles), ours=found.value, within=0.01)

    less = [0.25 * angle for angle in angles]
    simulation = study.simulate(
        "stages.1={name: slide, mode: dynamic, duration: 0.6, damping: {contact: 0.1, stiffness: 0.2},"
        f" set: {{interfaces.a.friction_angle: {less[0]}, interfaces.b.friction_angle: {less[1]}}}}}"
    )
    simulation.run_stage("load")
    start, shown, rows = simulation.time, [snapshot(simulation)], []
    line = (vertices[0] - vertices[3]) / np.linalg.norm(vertices[0] - vertices[3])
    nodes = simulation.build.nodes_of("wedge")
    mass = simulation.fields["mass"][nodes]
    while simulation.run_until(simulation.time + 0.01) == "running":
        if simulation.time > start + 0.1:
            speed = mass @ simulation.fields["velocity"][nodes] @ line / mass.sum()
            rows.append((simulation.time - start, speed))
    time, speed = np.array(rows).T
    exact = -9.81 * line[2] * (1 - theory(vertices, less))
    study.check("acceleration, a quarter of the friction angles", unit="m/s2", theory=exact,
                ours=np.polyfit(time, speed, 1)[0], within=5e-5)  # fmt: skip
    study.curve("Speed along the line of intersection", "time [s]", "speed [m/s]",
                {"theory": (time, speed[0] + exact * (time - time[0])), ".cdem": (time, speed)})  # fmt: skip
    study.picture("The wedge, and after 0.6 s", *shown, snapshot(simulation))
