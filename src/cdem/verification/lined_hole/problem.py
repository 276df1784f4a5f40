"""A hole excavated in rock under equal pressure, and lined before the release (Lamé)."""

import tempfile
from pathlib import Path

import meshio
import numpy as np

from cdem.output.render import snapshot
from cdem.run.simulation import Simulation
from cdem.verification.runner import problems

PRESSURE = 1e6  # far away [Pa]
ROWS = 8  # cells along the hole for one row of cells across the lining


def theory(case, inside, outside):
    """Inward displacement of the unlined wall, and of both with the lining [m]; Lamé (1852).

    Rock moves by C times the released pressure; a lining under pressure p moves by
    D p, the bond between them by p / k_n. The later release, (1 - s) P, is shared by both:
    p (C + D + 1 / k_n) = C (1 - s) P.

    Args:
        case: The case.
        inside: Inner radius of the lining [m].
        outside: Outer radius of the rock [m]; the radius of the hole is 1 m.
    """
    rock, concrete = case.materials["rock"], case.materials["concrete"]
    nu, e = rock.poisson_ratio, rock.young_modulus
    of_rock = (1 + nu) / e * (1 - 2 * nu + outside**2) / (outside**2 - 1)
    nu, e = concrete.poisson_ratio, concrete.young_modulus
    of_lining = (1 + nu) / e * (1 - 2 * nu + inside**2) / (1 - inside**2)
    share = case.stages[1].release.to
    of_bond = 1 / case.interfaces.default.stiffness_n.value
    p = of_rock * (1 - share) * PRESSURE / (of_rock + of_lining + of_bond)
    return of_rock * share * PRESSURE, of_rock * (PRESSURE - p), of_lining * p


def mesh(cells):
    """The plate of the problem kirsch_excavate, the outer rows of its core another group; and their
    inner radius."""
    known = {problem.name: problem.module for problem in problems(["kirsch", "kirsch_excavate"])}
    kirsch = known["kirsch"]
    plate = known["kirsch_excavate"].plate(kirsch.ring(cells), cells)
    inside = np.exp(-np.pi / 2 / ROWS)
    middle = np.hypot(*plate.points[plate.cells[0].data].mean(axis=1)[:, :2].T)
    tags = [np.array(t) for t in plate.cell_data["gmsh:physical"]]
    core = plate.field_data["core"][0]
    lining = (tags[0] == core) & (middle > inside)
    tags[0][lining] = core + 2
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    names = plate.field_data | {"lining": np.array([core + 2, 3])}
    return meshio.Mesh(plate.points, plate.cells, cell_data=data, field_data=names), inside, kirsch


def run(study):
    """Lined after a release of 40 %; a finer mesh if full."""
    for cells in (8, 16) if study.full else (8,):
        plate, inside, kirsch = mesh(cells)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "plate.msh"
            meshio.write(path, plate, "gmsh22", binary=False)
            case = study.case(f"model.mesh={path}")
            angle = (np.arange(cells) + 0.5) * np.pi / 2 / cells
            case.set("loads.tractions", [
                {"surface": f"outer{n}",
                 "traction": [-PRESSURE * np.cos(a), -PRESSURE * np.sin(a), 0]}
                for n, a in enumerate(angle)
            ])  # fmt: skip
            simulation = Simulation(case, threads=study.threads)
        alone, wall, lining = theory(case, inside, kirsch.OUTER)
        start = simulation.build.start_position
        on_rim = np.abs(np.hypot(*start[:, :2].T) - kirsch.INNER) < 1e-6

        def way(group, sim=simulation, on_rim=on_rim):
            nodes = sim.build.nodes_of(group)
            nodes = nodes[on_rim[nodes]]
            return np.linalg.norm(sim.fields["displacement"][nodes], axis=1).mean()

        simulation.run_stage("dig")
        study.check(f"way of the wall at 40 %, {cells} cells", unit="m", theory=alone,
                    ours=way("ring"), within=1.5 / cells**2)  # fmt: skip
        before = way("ring")
        simulation.run_stage("line")
        study.check(f"way while it is lined over that before, {cells} cells", theory=0,
                    ours=way("ring") / before - 1, within=1e-6, absolute=True)  # fmt: skip
        simulation.run()
        study.check(f"way of the wall, {cells} cells", unit="m", theory=wall, ours=way("ring"),
                    within=1.5 / cells**2)  # fmt: skip
        study.check(f"way of the lining since it was placed, {cells} cells", unit="m",
                    theory=lining, ours=way("lining"), within=3 / cells**2)  # fmt: skip
        study.check(f"energy error, {cells} cells", theory=0, ours=simulation.energies["error"],
                    absolute=True, within=1e-6)  # fmt: skip
    study.picture("The lined hole", snapshot(simulation), field="group")
