"""A block on eight meshes: laws that ask for an area get the one that is in contact."""

import numpy as np

from cdem.rows import rows_of

MESHES = {  # divisions of bed and block, where the block lies, elements, and how far it is turned
    "the same": ([8, 4, 1], [1, 1, 1], [0, -0.5], "hex8", 0),
    "offset": ([8, 4, 1], [1, 1, 1], [0.37, 0.23], "hex8", 0),
    "a finer bed": ([32, 16, 1], [1, 1, 1], [0.37, 0.23], "hex8", 0),
    "a coarser bed": ([2, 1, 1], [1, 1, 1], [0.37, 0.23], "hex8", 0),
    "a finer block": ([2, 1, 1], [4, 4, 1], [0.37, 0.23], "hex8", 0),
    "a sliced bed": ([8, 1, 1], [2, 1, 1], [0.37, 0.23], "hex8", 0),
    "tets": ([8, 4, 1], [2, 2, 1], [0.37, 0.23], "tet4", 0),
    "a turned block": ([8, 4, 1], [2, 2, 1], [0.87, 0.23], "hex8", 30),
}
SPEED, WEIGHT = 3.0, 12262.5  # of the block [m/s], [N]
COHESION = 5e3  # [Pa]
LAWS = {
    "voellmy": "{law: voellmy, friction_angle: 0, turbulence: 200, flow_density: 2000}",
    "residual": "{law: residual, friction_angle: 0, cohesion: 5 kPa, residual_cohesion: 5 kPa}",
    "softening": "{law: softening, friction_angle: 0, cohesion: 10 kPa, tensile_strength: 5 kPa,"
                 " fracture_energy_1: 1, fracture_energy_2: 1, residual_cohesion: 5 kPa}",
    "barton-bandis": "{law: barton-bandis, jrc: 10, jcs: 20 MPa, residual_friction_angle: 25}",
}  # fmt: skip
SLAB = {  # cells of a bed of 150 m and 6 m
    "the same": ([150, 6, 1], [-5.0, 0.0]),
    "offset": ([150, 6, 1], [-4.63, 0.37]),
    "a finer bed": ([300, 12, 1], [-4.63, 0.37]),
    "a coarser bed": ([30, 1, 1], [-4.63, 0.37]),
    "a sliced bed": ([150, 1, 1], [-4.63, 0.37]),
}


def theory(law, slipped):
    """Force that draws the block of 1 m2 [N], after a slip [m].

    rho g v^2 / xi; c_r; sigma tan(phi_r + J JRC log10(JCS / sigma)), J of the slip by Barton,
    Bandis & Bakhtar (1985).
    """
    if law == "voellmy":
        return 2000 * 9.81 * SPEED**2 / 200
    if law != "barton-bandis":
        return COHESION
    peak = 0.1 / 500 * (10 / 0.1) ** 0.33
    part = np.interp(slipped / peak, [0.3, 0.6, 1, 2, 4, 10, 25, 100],
                     [0, 0.75, 1, 0.85, 0.70, 0.50, 0.40, 0])  # fmt: skip
    angle = 25 + min(part * 10 * np.log10(20e6 / WEIGHT), 45)
    return WEIGHT * np.tan(np.radians(angle))


def draw(study, law, mesh):
    """Mean force on the bed along the way over 0.2 s [N], slip in the middle [m], energy error."""
    bed, block, place, shape, angle = MESHES[mesh]
    speed = SPEED if law == "voellmy" else 0.02 if law == "barton-bandis" else 0.2
    simulation = study.simulate(
        f"model.blocks=[{{group: bed, box: {{size: [8, 4, 1], divisions: {bed}, shape: {shape}}},"
        " translate: [-2, -1.5, -1]}, "
        f"{{group: block, box: {{size: [1, 1, 0.5], divisions: {block}, shape: {shape}}},"
        f" rotate: {{axis: [0, 0, 1], angle: {angle}}}, translate: {[*place, 0]}}}]",
        f"loads.velocities.0.velocity=[{speed}, 0, 0]", f"interfaces.default={LAWS[law]}")  # fmt: skip
    nodes = [simulation.build.nodes_of(group) for group in ("bed", "block")]
    simulation.run_until(0.4)
    rows = []
    while simulation.time < 0.6:
        simulation.run_until(simulation.time + 0.005)
        force = rows_of(simulation.core, "node.reaction").force[nodes[0], 0].sum()
        rows.append((-force, simulation.fields["displacement"][nodes[1], 0].mean()))
    force, slipped = np.mean(rows, axis=0)
    return force, slipped, simulation.energies["error"]


def slide(study, mesh):
    """Speed [m/s] of a slab of 1 m after 12 s with Voellmy's friction, and the one that it nears.

    v = v_max tanh(a_0 t / v_max) with a_0 = g (sin 25 - tan phi cos 25), v_max = sqrt(xi h a_0 / g).
    """
    divisions, place = SLAB[mesh]
    simulation = study.simulate(
        f"model.blocks=[{{group: bed, box: {{size: [150, 6, 1], divisions: {divisions}}},"
        " translate: [-10, -1, -1]}, {group: block, box: {size: [4, 4, 1], divisions: [4, 4, 1]},"
        f" translate: {[*place, 0]}}}]",
        "interfaces.default={law: voellmy, friction_angle: 8.530765609948133, turbulence: 500,"
        " flow_density: 2000}",
        "materials.rock.density=2000", "materials.rock.young_modulus=20 MPa",
        "loads={gravity: [4.145885177, 0, -8.890879411]}",
        "stages=[{name: slide, mode: dynamic, duration: 12, damping: {stiffness: 0.2, contact: 0.1}}]",
    )  # fmt: skip
    simulation.run_until(12)
    start = 4.145885177 - 8.890879411 * 0.15
    most = np.sqrt(500 * start / 9.81)
    nodes = simulation.build.nodes_of("block")
    mass = simulation.fields["mass"][nodes]
    speed = mass @ simulation.fields["velocity"][nodes, 0] / mass.sum()
    return speed, most * np.tanh(start * 12 / most), simulation.energies["error"]


def run(study):
    """Each law on eight meshes, a slab on five; a mesh for each law and one slab when quick."""
    for k, law in enumerate(LAWS):
        for mesh in MESHES if study.full else [("a finer bed", "a turned block")[k % 2]]:
            force, slipped, error = draw(study, law, mesh)
            study.check(f"{law}, {mesh}", theory=theory(law, slipped), ours=force, unit="N",
                        within=0.05 if law == "barton-bandis" else 1e-3)  # fmt: skip
            study.check(f"energy, {law}, {mesh}", theory=0, within=1e-3, absolute=True, ours=error)
    for mesh in SLAB if study.full else ["a sliced bed"]:
        speed, most, error = slide(study, mesh)
        study.check(f"speed that a slab nears, {mesh}", theory=most, within=0.01, ours=speed,
                    unit="m/s")  # fmt: skip
        study.check(f"energy, slab, {mesh}", theory=0, within=3e-3, absolute=True, ours=error)
