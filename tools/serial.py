"""What of a step runs on one thread only, and how far threads could speed it up: `make serial`.

Puts a clock before `GOMP_parallel` and runs the cases of `cdem benchmark` on two threads, in seven
minutes. Time outside of parallel regions is serial. With S of it and P inside, one thread would
take S + 2 P, and no number of threads less than S; barriers come on top. docs/benchmark.md has the
table.
"""

import ctypes
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import cdem
from cdem.tools import benchmark, benchmark_cases

ROOT = Path(__file__).resolve().parent.parent
CLOCK = ROOT / "build" / "serial.so"
THREADS = 2


def cases() -> Iterator[tuple[str, cdem.Simulation, int]]:
    """Name, simulation at the moment, and steps that are counted."""
    size = benchmark.SIZES["1e5"]
    yield "P1, 105,456 tets", start(benchmark_cases.bar(size, "tet4")), 400
    bonded = benchmark_cases.bar(size, "tet4", **benchmark_cases.breakable("1 GPa"))
    yield "P2, 105,456 tets", start(bonded), 200
    rubble = start(benchmark_cases.rubble(8))
    for moment in benchmark.MOMENTS:
        rubble.run_until(moment / 1e3)
        yield f"P3, 24,576 tets, at {moment} ms", rubble, 150
    for rows in (benchmark.WALL, 8 * benchmark.WALL):
        wall = start(benchmark_cases.wall(rows))
        wall.step(200)
        yield f"P4, {rows * benchmark_cases.COLUMNS:,} cubes", wall, 300


def start(data: dict) -> cdem.Simulation:
    """A simulation after some steps; its first run has what no other step has."""
    return benchmark_cases.start(data, THREADS)[0]


def main() -> None:
    """Print a line a case."""
    if os.environ.get("LD_PRELOAD") != str(CLOCK):
        source = ROOT / "tools" / "serial.cpp"
        flags = ["-std=c++20", "-O2", "-shared", "-fPIC", "-o", CLOCK]
        subprocess.run(["g++", *flags, source, "-ldl"], check=True)
        os.environ |= {"LD_PRELOAD": str(CLOCK), "OMP_WAIT_POLICY": "active"}
        os.execv(sys.executable, [sys.executable, __file__])
    clock = ctypes.CDLL(str(CLOCK))
    print("case, wall [us a step], serial [us], serial [%], regions a step, ceiling")
    for name, sim, steps in cases():
        seconds, regions = (ctypes.c_double * 2)(), ctypes.c_long()
        clock.begin_serial()
        sim.step(steps)
        clock.end_serial(seconds, ctypes.byref(regions))
        outside, inside = (1e6 * part / steps for part in seconds)
        wall, one = outside + inside, outside + THREADS * inside
        print(
            f"{name}, {wall:,.0f}, {outside:.3g}, {100 * outside / wall:.2f}, "
            f"{regions.value / steps:.1f}, {one / outside:.0f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
