"""What ranks cost: rates beside threads, ghosts of many parts, the start of a large model.

    python tools/rank_costs.py rate P3 13 400                  two threads of one process
    mpiexec -n 2 python tools/rank_costs.py rate P3 13 400     two ranks of a thread: compare
    python tools/rank_costs.py ghosts 36 27                    a cube of 36^3 cells in 27 parts
    mpiexec -n 4 python tools/rank_costs.py start 28           P2 with 48 * 28^3 tets

A rate is the best of three times 40 steps after so many steps; P2 and P3 are cases of `cdem
benchmark`, P2 a bar and P3 rubble with 48 n^3 tets.
"""

import argparse
import ctypes
import resource
import time

import numpy as np

import cdem
from cdem.ranks.launch import launched
from cdem.ranks.mpi import world
from cdem.ranks.parts import Fences, Mesh, divide, needed
from cdem.ranks.shared_core import SharedCore
from cdem.tools import benchmark_cases

STEPS, TIMES = 40, 3
NO_FRAMES = {"output": {"frames": False}}


def case_of(row: str, size: int) -> cdem.Case:
    """A case of the benchmark."""
    if row == "P3":
        return cdem.Case.from_dict(benchmark_cases.rubble(size) | NO_FRAMES)
    bar = benchmark_cases.bar(size, "tet4", **benchmark_cases.breakable("1 GPa"))
    return cdem.Case.from_dict(bar | NO_FRAMES)


def cube(cells: int) -> cdem.Case:
    """Bonded tets, six in each cell of a cube."""
    strong = {"friction_angle": 30, "cohesion": 1e9, "tensile_strength": 1e9}
    box = {"size": [cells] * 3, "divisions": [cells] * 3, "shape": "tet4"}
    return cdem.Case.from_dict({
        "model": {"blocks": [{"group": "rock", "box": box}], "split": {"rock": "elements"}},
        "materials": {"m": {"density": 2700, "young_modulus": 1e10, "poisson_ratio": 0.25}},
        "groups": {"rock": {"material": "m"}},
        "interfaces": {"default": strong},
        "stages": [{"name": "move", "mode": "dynamic", "duration": 1}],
    } | NO_FRAMES)  # fmt: skip


def rate(row: str, size: int, after: int) -> None:
    """Print the rate of two threads, or of the ranks of this launch."""
    exchange = world() if launched() > 1 else None
    threads = 1 if exchange else 2
    simulation = cdem.Simulation(case_of(row, size), threads=threads, exchange=exchange)
    simulation.core.run(after)
    best = np.inf
    for _ in range(TIMES):
        begin = time.perf_counter()
        simulation.core.run(STEPS)
        best = min(best, time.perf_counter() - begin)
    if not exchange or exchange.rank == 0:
        tets = 48 * size**3
        print(f"{row}, {tets:,} tets, {1000 * simulation.time:.3g} ms: "
              f"{launched()} ranks, {tets * STEPS / best / 1e6:.3g} M tets/s")  # fmt: skip


def ghosts(cells: int, count: int) -> None:
    """Print the ghosts of parts of a cube; inner parts are those with most neighbours."""
    core = cdem.Simulation(cube(cells), threads=2).core
    mesh = Mesh.of(core)
    parts, fences = divide(core, mesh, count, np.ones(mesh.count)), Fences.around(core, mesh)
    boxes, rows = fences.of_elements(mesh), []
    for rank in range(count):
        own = parts.of_element == rank
        found = needed(core, mesh, parts, fences, rank)
        acting = boxes.near(boxes.some(own))
        nodes = np.unique(mesh.corner_node[found[mesh.corner_element]])
        ranks = parts.of_node[nodes]
        received, neighbours = (ranks != rank).sum(), len(np.unique(ranks)) - 1
        rows.append((own.sum(), found.sum(), acting.sum(), 48 * received, neighbours))
    table = np.array(rows)
    inner = table[np.argsort(table[:, 4])[-max(count // 8, 1) :]]
    own, found, acting, received, _ = inner.T
    layers = 0.5 * (own / 6) ** (1 / 3) * ((found / own) ** (1 / 3) - 1)
    print(f"{mesh.count:,} tets in {count} parts, inner ones: ghosts {(found / own - 1).mean():.2f} "
          f"of own, {layers.mean():.2f} layers; acting {(acting / own - 1).mean():.2f}; "
          f"{received.mean() / 1e6:.2f} MB a step; neighbours {table[:, 4].max()}")  # fmt: skip


def start(size: int) -> None:
    """Print times and memory of each rank; models are built one after the other, to save memory."""
    exchange = world()
    for rank in range(exchange.count):
        if rank == exchange.rank:
            begin = time.perf_counter()
            simulation = cdem.Simulation(case_of("P2", size), threads=1)
            built = time.perf_counter() - begin
            ctypes.CDLL(None).malloc_trim(0)
        exchange.share_text("")
    core = SharedCore(simulation.core, exchange)
    times = []
    for steps in (1, 100):
        begin = time.perf_counter()
        core.run(steps)
        times.append(time.perf_counter() - begin)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(f"rank {exchange.rank}: built in {built:.0f} s, cut and first step {times[0]:.1f} s, "
          f"100 steps {times[1]:.1f} s, {peak:.2f} GB", flush=True)  # fmt: skip


def main() -> None:
    """Measure what the command line names."""
    parser = argparse.ArgumentParser(description=__doc__)
    kinds = parser.add_subparsers(required=True)
    for act, words in (
        (rate, ("row", "size", "after")), (ghosts, ("cells", "count")), (start, ("size",)),
    ):  # fmt: skip
        one = kinds.add_parser(act.__name__)
        for word in words:
            one.add_argument(word, type=str if word == "row" else int)
        one.set_defaults(act=act)
    given = vars(parser.parse_args())
    given.pop("act")(**given)


if __name__ == "__main__":
    main()
