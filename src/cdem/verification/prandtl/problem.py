"""Strip footing on soil without weight: bearing capacity (Prandtl 1920), also of tets."""

import tempfile
from pathlib import Path

import meshio
import numpy as np

from cdem.mesh.primitives import box
from cdem.output.render import snapshot

WAYS = {
    "hexahedra": ("hex8", "nodal-mean", 0.03),
    "tets, nodal-mean": ("tet4", "nodal-mean", 0.03),
}
"""Shape, `elements.tetrahedra` and the tolerance, twice as much at 30 degrees."""
LOCKED = {(0, 4): 0.128, (0, 8): 0.083, (10, 8): 0.110, (20, 8): 0.124, (30, 8): 0.146}
"""How much too strong tets of their own dilatation are, by friction angle and cells: they lock."""
SPEEDS = (0.05, 0.015, 0.0025)
"""Of the footing, over the speed at which the wave under it would carry the capacity: until it nears
failure, until it flows, and while the load is read."""
WAY = (3.0, 4.0, 0.4)  # how far it goes at each, over N_c c / E times half its width


def theory(friction):
    """N_c = (exp(pi tan phi) tan^2(45 deg + phi / 2) - 1) / tan phi; 2 + pi without friction."""
    if friction == 0:
        return 2 + np.pi
    t = np.tan(np.radians(friction))
    return (np.exp(np.pi * t) * np.tan(np.pi / 4 + np.radians(friction) / 2) ** 2 - 1) / t


def size_of_soil(friction):
    """Width from the middle and depth [m] of Prandtl's mechanism plus 15 %."""
    phi = np.radians(friction)
    angle = np.linspace(0, np.pi / 2, 100)
    spiral = np.exp(angle * np.tan(phi)) / np.cos(np.pi / 4 + phi / 2)
    deepest = (spiral * np.abs(np.sin(np.pi / 4 + phi / 2 + angle))).max()
    width = 1 + 2 * spiral[-1] * np.cos(np.pi / 4 - phi / 2)
    return 1.15 * width + 0.3, 1.15 * deepest + 0.3


def mesh(friction, cells, shape):
    """Soil below z = 0 in one layer of cells, all divided along the same diagonal, and their size.

    The footing ends in the middle of a cell: half of the last one counts as under it.
    """
    side = 1 / (cells + 0.5)
    counts = [round(size / side) for size in size_of_soil(friction)]
    soil = box(
        "soil", np.array([counts[0], 1, counts[1]]) * side, (counts[0], 1, counts[1]), shape=shape
    )
    x = np.array(soil.points)
    x[:, 2] -= counts[1] * side
    kind = {"hex8": "hexahedron", "tet4": "tetra"}[shape]
    tag = [np.ones(len(soil.cells[shape]), int)]
    made = meshio.Mesh(x, [(kind, soil.cells[shape])],
                       cell_data={"gmsh:physical": tag, "gmsh:geometrical": tag},
                       field_data={"soil": np.array([1, 3])})  # fmt: skip
    return made, side


def drive(rock, friction):
    """Speed of the footing by time [s, m/s]."""
    e, nu = rock.young_modulus, rock.poisson_ratio
    wave = np.sqrt(e * (1 - nu) / (1 + nu) / (1 - 2 * nu) / rock.density)
    capacity = theory(friction) * rock.cohesion
    fast, slow, last = (float(v) for v in np.array(SPEEDS) * capacity / (rock.density * wave))
    a, b, c = (float(t) for t in np.cumsum(np.array(WAY) * capacity / e / [fast, slow, last]))
    return [[0, 0], [0.1 * a, fast], [0.97 * a, fast], [1.03 * a, slow], [0.97 * b, slow],
            [1.03 * b, last], [c, last]]  # fmt: skip


def press(study, friction, cells, shape, tetrahedra):
    """Press the footing in until the soil flows; the simulation and load over cohesion by part of the time."""
    soil, side = mesh(friction, cells, shape)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "soil.msh"
        meshio.write(file, soil, "gmsh22", binary=False)
        settings = f"model.mesh={file}", f"elements.tetrahedra={tetrahedra}"
        rock = study.case(*settings).materials["soil"]
        history = drive(rock, friction)
        simulation = study.simulate(
            *settings,
            f"materials.soil.friction_angle={friction}",
            f"materials.soil.dilation_angle={friction}",
            f"loads.velocities.0.box.max.0={1 - side / 4}",
            f"loads.velocities.0.history={history}",
            f"stages.0.duration={history[-1][0]}",
        )
    start = simulation.build.start_position
    under = (start[:, 2] > -side / 4) & (start[:, 0] < 1 - side / 4)
    path = []
    while simulation.time < history[-1][0]:
        simulation.step(100)
        load = -simulation.fields["reaction"][under, 2].sum() / side
        path.append((simulation.time, load / rock.cohesion))
    return simulation, np.array(path) / [history[-1][0], 1]


def run(study):
    """Without friction; with 10, 20 and 30 degrees when full."""
    lines = {}
    for friction in (0, 10, 20, 30) if study.full else (0,):
        cells = 8 if study.full else 4
        exact, part = theory(friction), 2 if friction == 30 else 1
        locked = {"tets, full": ("tet4", "full", None)}
        for name, (shape, tetrahedra, within) in (WAYS | locked).items():
            simulation, path = press(study, friction, cells, shape, tetrahedra)
            ours = path[path[:, 0] > 0.85, 1].mean()
            if within is None:  # README.md
                study.check(f"excess of tets, full (they lock), {friction} deg", absolute=True,
                            theory=LOCKED[friction, cells], ours=ours / exact - 1, within=0.02)  # fmt: skip
            else:
                study.check(f"N_c, {name}, {friction} deg", theory=exact, ours=ours,
                            within=part * within)  # fmt: skip
            study.check(f"energy error, {name}, {friction} deg", theory=0, absolute=True,
                        ours=simulation.energies["error"], within=1e-10)  # fmt: skip
            lines[f"{name}, {friction} deg"] = (path[:, 0], path[:, 1] / exact)
            if tetrahedra == "nodal-mean":
                shown = simulation
    study.curve("Load over Prandtl's", "time over duration of the test [1]", "load [1]", lines)
    study.picture("The mechanism", snapshot(shown), field="plastic_shear")
