"""A slab slides over a kink in its bed: of one mesh, or of blocks that lie flush."""

from pathlib import Path
from tempfile import TemporaryDirectory

import meshio
import numpy as np

from cdem.output.render import snapshot

SPEED = 4.0  # of the slab at the start [m/s]
AHEAD = 1.5  # way from the slab to the kink [m]


def bed(angle):
    """Corners of two hexahedra that meet at x = 0: a plane that descends by `angle`, and a floor."""
    slope = np.radians(angle)
    top = np.array([(-5 * np.cos(slope), 5 * np.sin(slope)), (0, 0), (8, 0)])
    normals = np.array([(np.sin(slope), np.cos(slope)), (0, 1)])
    seam = normals.sum(axis=0) / (1 + normals[0] @ normals[1])
    low = top - 4 * np.array([normals[0], seam, normals[1]])
    rows = [(x, y, z) for line in (top, low) for x, z in line for y in (-1, 2)]
    cells = [[6 + k, 8 + k, 9 + k, 7 + k, k, 2 + k, 3 + k, 1 + k] for k in (0, 2)]
    return np.array(rows, float), np.array(cells)


def settings(kind, angle, folder):
    """Values of the case for a kind of bed and an angle [deg]; a mesh is written into the folder."""
    points, cells = bed(angle)
    c, s = float(np.cos(np.radians(angle))), float(np.sin(np.radians(angle)))
    start = [-(AHEAD + 0.4) * c, 0, (AHEAD + 0.4) * s]
    values = [
        f"model.blocks.0.rotate={{axis: [0, 1, 0], angle: {angle}}}",
        f"model.blocks.0.translate={start}",
        f"groups.slab.velocity=[{SPEED * c}, 0, {-SPEED * s}]",
    ]
    slab = "{group: slab, box: {size: [0.4, 0.5, 0.08]}}"
    if kind == "blocks of tets":
        blocks = [f"{{group: bed, polyhedron: {{vertices: {points[c].tolist()}}}}}" for c in cells]
        return [f"model.blocks=[{', '.join([slab, *blocks])}]", *values]
    if kind == "cut by a joint":
        top, seam = points[:6], points[8]  # below the crest
        foot = top[[0, 1, 4, 5]] * [1, 1, 0] - [0, 0, 5]
        rock = f"{{group: bed, polyhedron: {{vertices: {[*top.tolist(), *foot.tolist()]}}}}}"
        joint = f"{{name: seam, normal: {[float(seam[2]), 0, float(-seam[0])]}, origin: [0, 0, 0]}}"
        return [f"model.blocks=[{slab}, {rock}]", f"model.joints=[{joint}]", *values]
    groups = [1, 1] if kind == "one mesh" else [1, 2]
    if kind == "a wider floor":  # with corners of its own
        floor = points[cells[1]]
        floor[:, 1] = np.where(floor[:, 1] < 0, -2.5, 3)
        points, cells = np.concatenate([points, floor]), np.array([cells[0], 12 + np.arange(8)])
    mesh = meshio.Mesh(
        points,
        [("hexahedron", cells)],
        cell_data={"gmsh:physical": [np.array(groups)], "gmsh:geometrical": [np.array(groups)]},
        field_data={"bed": np.array([1, 3]), "floor": np.array([2, 3])},
    )
    file = Path(folder) / "bed.msh"
    meshio.write(file, mesh, file_format="gmsh22", binary=False)
    held = "groups.floor={material: rock, fix: [x, y, z]}"
    return [f"model.mesh={file}", *values, *([held] if groups[1] == 2 else [])]


def pass_kink(simulation):
    """Velocity along x past the kink, at the middle of the slab 0.4 m, over the speed before it."""
    nodes = simulation.build.nodes_of("slab")
    mass = simulation.fields["mass"][nodes] / simulation.fields["mass"][nodes].sum()
    before = shown = None
    while simulation.time < 1:
        simulation.step(50)
        place = mass @ simulation.fields["position"][nodes, 0]
        velocity = mass @ simulation.fields["velocity"][nodes]
        if place < -0.35:
            before = np.linalg.norm(velocity)
        if place > 0 and shown is None:
            shown = snapshot(simulation)
        if place > 0.4:
            return velocity[0] / before, shown
    return 0.0, shown


def strike(simulation):
    """Velocity of the slab in the plane, 0.4 s after its start and past a steep kink, over SPEED."""
    simulation.run_until(0.4)
    nodes = simulation.build.nodes_of("slab")
    mass = simulation.fields["mass"][nodes]
    return mass @ simulation.fields["velocity"][nodes][:, [0, 2]] / mass.sum() / SPEED


def theory(kept):
    """Blocks that lie flush have the surface of one mesh: the slab keeps as much of its speed."""
    return kept["one mesh"]


def run(study):
    """Concave and convex kinks; more angles when full."""
    pictures = []
    for angle in [5, 10, 20, 30, 40, 50, 60, -2, -5, -10] if study.full else [40, -10]:
        kept = {}
        kinds = ["one mesh", "two blocks", "a wider floor", "blocks of tets"]
        for kind in kinds + ["cut by a joint"] * (angle < 0):
            simulation = start(study, kind, angle)
            kept[kind], shown = pass_kink(simulation)
            study.check(f"energy, {angle} deg, {kind}", theory=0, within=3e-3, absolute=True,
                        ours=simulation.energies["error"])  # fmt: skip
        pictures.append(shown)
        for kind in list(kept)[1:]:
            study.check(f"speed kept, {angle} deg, {kind}", theory=theory(kept), within=0.02,
                        ours=kept[kind], unit="1")  # fmt: skip
    for angle in [70, 75, 80, 85, 90] if study.full else [80]:
        one = strike(start(study, "one mesh", angle))
        for kind in ("two blocks", "a wider floor", "blocks of tets"):
            study.check(f"velocity past the strike, {angle} deg, {kind}", within=0.02, unit="1",
                        theory=0, absolute=True,
                        ours=np.linalg.norm(strike(start(study, kind, angle)) - one))  # fmt: skip
    study.picture("At the kink, on blocks of tets and on one cut by a joint", *pictures[:2])


def start(study, kind, angle):
    """A simulation with a kind of bed."""
    with TemporaryDirectory() as folder:
        return study.simulate(*settings(kind, angle, folder))
