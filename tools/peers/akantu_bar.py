"""P1 of `cdem benchmark` in Akantu: elastic tets that share nodes, explicit steps, lumped masses.

`python3 -m venv peer; peer/bin/pip install akantu meshio`, then, with cells in the width of the bar:
`.venv/bin/python tools/peers/akantu_bar.py mesh 13; OMP_NUM_THREADS=1 peer/bin/python
tools/peers/akantu_bar.py run`. Prints million elements times steps a second of CPU time.
"""

import sys
import time
from pathlib import Path

MESH, MATERIAL = "bar.msh", "bar.dat"
STEPS = 40
REPEATS = 5
ROCK = "material elastic [\n  name = bar\n  rho = 2500\n  E = 10e9\n  nu = 0.25\n]\n"


def write_mesh(m: int) -> None:
    """The bar of `cdem.tools.benchmark_cases.bar`, as a file for Akantu."""
    import meshio
    import numpy as np

    from cdem.mesh.primitives import box

    size = [8 * m, m, m]
    bar = box("bar", [float(n) for n in size], size, shape="tet4")
    cells = bar.cells["tet4"]
    ones = [np.ones(len(cells), int)]
    data = {"gmsh:physical": ones, "gmsh:geometrical": ones}
    names = {"bar": np.array([1, 3])}
    mesh = meshio.Mesh(bar.points, [("tetra", cells)], cell_data=data, field_data=names)
    meshio.write(MESH, mesh, file_format="gmsh22", binary=False)


def run() -> None:
    """Time explicit steps."""
    import akantu

    Path(MATERIAL).write_text(ROCK)
    akantu.parseInput(MATERIAL)
    mesh = akantu.Mesh(3)
    mesh.read(MESH)
    model = akantu.SolidMechanicsModel(mesh)
    model.initFull(_analysis_method=akantu._explicit_lumped_mass)
    model.setTimeStep(0.8 * model.getStableTimeStep())
    model.getVelocity()[:, 0] = 1e-3
    model.solveStep()
    count = mesh.getNbElement(spatial_dimension=3)
    for _ in range(REPEATS):
        began = time.process_time()
        for _ in range(STEPS):
            model.solveStep()
        print(f"{count:,} tets: {count * STEPS / (time.process_time() - began) / 1e6:.2f} M")


if __name__ == "__main__":
    write_mesh(int(sys.argv[2])) if sys.argv[1] == "mesh" else run()
