"""The answer does not depend on frame, hand, threads, noise, and hardly on the step."""

import numpy as np

from cdem import view
from cdem.simulation import Simulation

VERTICES = np.array([[0, 0, 0.05], [1, 0.1, 0.05], [0.3, 0.9, 0.1], [0.4, 0.3, 0.75]])
GRAVITY, VELOCITY, SPIN = map(np.array, ([0, 0, -9.81], [1, 0.2, -0.5], [0.5, -1, 2]))


def theory():
    """Newton's laws know no frame, no hand, and no computer: every difference should be zero."""
    return 0.0


def rotation(axis, degrees):
    """Rotation matrix, right-handed."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    a = np.radians(degrees)
    return np.eye(3) + np.sin(a) * k + (1 - np.cos(a)) * k @ k


def settings(vertices, gravity=GRAVITY, velocity=VELOCITY, spin=SPIN):
    """The scene with another block or other vectors."""

    def plain(v):
        return np.asarray(v, float).tolist()

    return [
        f"model.blocks.1.polyhedron.vertices={plain(vertices)}",
        f"loads.gravity={plain(gravity)}",
        f"groups.block.velocity={plain(velocity)}",
        f"groups.block.angular_velocity={plain(spin)}",
    ]


def tumble(simulation):
    """Displacement of the four vertices of the block [m]."""
    simulation.run()
    nodes = simulation.build.nodes_of("block")
    moved = simulation.fields["position"][nodes] - simulation.build.start_position[nodes]
    return moved[np.argsort(nodes)]


def run(study):
    """Each change against the same run without it, relative to the way of the block."""
    simulation = study.simulate(*settings(VERTICES))
    before = view.snapshot(simulation)
    reference = tumble(simulation)
    way = np.linalg.norm(reference, axis=1).mean()
    study.picture("Start and 0.06 s", before, view.snapshot(simulation))

    def compare(what, moved, within):
        study.check(what, theory=theory(), ours=np.abs(moved - reference).max() / way,
                    within=within, absolute=True)  # fmt: skip

    rng = np.random.default_rng(7)
    for _ in range(3 if study.full else 1):
        axis, degrees = rng.normal(size=3), float(rng.uniform(20, 340))
        r = rotation(axis, degrees)
        turned = settings(VERTICES, r @ GRAVITY, r @ VELOCITY, r @ SPIN)
        turn = f"model.rotate={{axis: {axis.tolist()}, angle: {degrees}}}"
        compare(
            f"rotated by {degrees:.0f} degrees", tumble(study.simulate(*turned, turn)) @ r, 1e-10
        )
    mirror = np.array([1.0, -1.0, 1.0])
    mirrored = settings(VERTICES * mirror, GRAVITY, VELOCITY * mirror, -SPIN * mirror)
    compare("mirrored", tumble(study.simulate(*mirrored)) * mirror, 1e-10)
    noise = rng.uniform(-1e-12, 1e-12, (4, 3))
    compare("vertices moved by 1e-12 m", tumble(study.simulate(*settings(VERTICES + noise))), 1e-9)
    for threads in (1, 2):
        same = Simulation(study.case(*settings(VERTICES)), threads=threads)
        compare(f"threads: {threads}", tumble(same), 0.0)
    compare(
        "half the time step", tumble(study.simulate(*settings(VERTICES), "time.safety=0.4")), 0.01
    )
