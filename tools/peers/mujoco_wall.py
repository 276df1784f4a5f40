"""P4 of `cdem benchmark` in MuJoCo: the wall of loose cubes, at rest under gravity.

`python3 -m venv peer; peer/bin/pip install mujoco`, then, with rows of cubes, on an idle machine:
`OMP_NUM_THREADS=1 peer/bin/python tools/peers/mujoco_wall.py 26`. Prints CPU time a step and a
simulated second, after as much time for the wall to settle, and the deepest overlap. MuJoCo's
cubes are rigid and its contacts soft: nothing of the rock is elastic.
"""

import sys
import time
from math import radians, tan

import mujoco

COLUMNS = 20
FRICTION = tan(radians(30))
SETTLE, TIMED = 100, 200  # steps


def wall(rows: int) -> str:
    """The wall of `cdem.tools.benchmark_cases.wall`, as MJCF."""
    cubes = "".join(
        f'<body pos="{i + 0.5 * (j % 2) + 0.5} 0.5 {j + 0.5}"><freejoint/>'
        f'<geom type="box" size="0.5 0.5 0.5" density="2500"/></body>'
        for j in range(rows)
        for i in range(COLUMNS)
    )
    return (
        f'<mujoco><option gravity="0 0 -9.81" cone="elliptic"/><size memory="4G"/>'
        f'<default><geom friction="{FRICTION} 0 0" condim="3"/></default>'
        f'<worldbody><geom type="plane" size="50 50 1"/>{cubes}</worldbody></mujoco>'
    )


def main() -> None:
    """Time steps."""
    rows = int(sys.argv[1])
    model = mujoco.MjModel.from_xml_string(wall(rows))
    data = mujoco.MjData(model)
    for _ in range(SETTLE):
        mujoco.mj_step(model, data)
    began, at = time.process_time(), data.time
    for _ in range(TIMED):
        mujoco.mj_step(model, data)
    spent, blocks = time.process_time() - began, rows * COLUMNS
    print(
        f"{blocks} cubes: {1e3 * spent / TIMED:.3g} ms a step of {1e3 * model.opt.timestep:g} ms, "
        f"{blocks * TIMED / spent / 1e3:.3g} k block-steps/s, "
        f"{spent / (data.time - at):.3g} CPU s a simulated second, "
        f"deepest overlap {-1e3 * min(data.contact.dist):.2g} mm"
    )


if __name__ == "__main__":
    main()
