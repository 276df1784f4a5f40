"""Rates of the benchmark models by size: `python tools/rates.py p3 4 13 28`, cells across them.

Prints a row for each size: elements, time of a step and its parts, elements per second. Rubble is
measured 5 ms after its bonds are released. `tools/gpu_rates.sh` calls it.
"""

import statistics
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from cdem import _native
from cdem.tools import benchmark_cases
from cdem.tools.benchmark import PHASES
from tools.hashes import MODELS

REPEATS, STEPS = 3, 100
MET = 5e-3
"""When the tets of rubble have met [s]."""


def main() -> None:
    """Print the table."""
    words = sys.argv[1:]
    if len(words) < 2 or words[0] not in MODELS or not all(word.isdigit() for word in words[1:]):
        sys.exit(f"usage: rates.py {{{','.join(MODELS)}}} CELLS...")
    print(f"{_native.name}: {words[0]}\n| elements | start | a step | elements/s | parts |")
    print("|---|---|---|---|---|")
    for cells in map(int, words[1:]):
        sim, start = benchmark_cases.start(MODELS[words[0]](cells), 1)
        if words[0] == "p3":
            sim.run_until(MET)
        before, walls = sim.core.seconds(), []
        for _ in range(REPEATS):
            began = time.perf_counter()
            sim.step(STEPS)
            walls.append((time.perf_counter() - began) / STEPS)
        spent = [now - then for now, then in zip(sim.core.seconds(), before, strict=True)]
        parts = [
            f"{name} {100 * part / sum(spent):.0f} %"
            for name, part in zip(PHASES, spent, strict=True)
        ]
        wall, count = statistics.median(walls), sim.audit.counts["elements"]
        print(
            f"| {count:,} | {start:.1f} s | {1e6 * wall:,.0f} us | {count / wall:.3g} "
            f"| {', '.join(parts)} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
