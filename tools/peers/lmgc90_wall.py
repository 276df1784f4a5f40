"""P4 of `cdem benchmark` in LMGC90: the wall of loose cubes, at rest under gravity.

`python3 -m venv peer; peer/bin/pip install compas_lmgc90`, then, with rows of cubes, on an idle
machine: `OMP_NUM_THREADS=1 peer/bin/python tools/peers/lmgc90_wall.py 26`. Prints CPU time a step
and a simulated second. LMGC90's cubes are rigid, and so are its contacts (non-smooth contact
dynamics): nothing of the rock is elastic.
"""

import sys
import time
from math import radians, tan

from compas.datastructures import Mesh
from compas.geometry import Box, Frame
from compas_lmgc90.solver import Solver

COLUMNS = 20
STEP = 2e-3  # s
SETTLE, TIMED = 20, 50  # steps


def box(size: tuple[float, float, float], centre: tuple[float, float, float]) -> Mesh:
    """A block."""
    frame = Frame(centre, [1, 0, 0], [0, 1, 0])
    return Mesh.from_shape(Box(*size, frame=frame))


def main() -> None:
    """Time steps of the wall of `cdem.tools.benchmark_cases.wall`."""
    rows = int(sys.argv[1])
    cubes = [
        box((1, 1, 1), (i + 0.5 * (j % 2) + 0.5, 0.5, j + 0.5))
        for j in range(rows)
        for i in range(COLUMNS)
    ]
    solver = Solver(dt=STEP, density=2500.0)
    solver.geometry_from_mesh([*cubes, box((COLUMNS + 4, 3, 1), (COLUMNS / 2, 0.5, -0.5))])
    solver.set_supports(z_threshold=0)
    solver.contact_law("IQS_CLB", tan(radians(30)))
    solver.preprocess()
    for _ in range(SETTLE):
        solver.lmgc90.compute_one_step()
    began = time.process_time()
    for _ in range(TIMED):
        solver.lmgc90.compute_one_step()
    spent, blocks = time.process_time() - began, len(cubes)
    print(
        f"{blocks} cubes: {1e3 * spent / TIMED:.3g} ms a step of {1e3 * STEP:g} ms, "
        f"{blocks * TIMED / spent / 1e3:.3g} k block-steps/s, "
        f"{spent / (TIMED * STEP):.3g} CPU s a simulated second"
    )


if __name__ == "__main__":
    main()
