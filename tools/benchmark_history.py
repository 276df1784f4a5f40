"""Add a point to docs/benchmark_history.jsonl: speeds on this machine at this commit, on one thread.

The rows are P1, P2, P3 with its contact search, and P4 of `cdem benchmark` at their smallest size, and
the start-up of P2. Rates are those of processor time, which others who work at the same time change
less than those of the clock; start-up is by the clock. A point says machine, commit and set of
kernels. It is marked as busy if a step took more than 1.1 times its processor time. `make docs` draws
all points.
"""

from __future__ import annotations

import datetime
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent / "torture"))

from state import commit

from cdem._native import name as kernels
from cdem.tools import benchmark

FILE = Path(__file__).resolve().parent.parent / "docs/benchmark_history.jsonl"
BUSY = 1.1
"""Wall time of a step over its processor time above which others were at work, too."""
START = "start-up [s]"


def rows() -> Iterator[benchmark.Row]:
    """What is measured."""
    size = benchmark.SIZES["1e4"]
    yield benchmark.tets_shared(size, 1)
    yield benchmark.tets_bonded(size, 1)
    yield from benchmark.rubble(benchmark.RUBBLE, 1)
    yield benchmark.wall(benchmark.WALL, 1)


def point(measured: list[benchmark.Row], limits: dict[str, Any]) -> dict[str, Any]:
    """A line of the file: rates of the rows, searches under the name of their P3."""
    rates, slower, name = {}, [], ""
    for row in measured:
        if row.name.startswith("S"):
            name = name.replace("P3 tets, broken", "S search")
        else:
            name = row.name
            slower.append(row.more["wall [us/step]"] / row.more["CPU [us/step]"])
        rates[f"{name} [{row.unit}]"] = float(f"{row.rate * slower[-1]:.3g}")
    bonded = next(row for row in measured if row.name.startswith("P2"))
    return {
        "date": str(datetime.date.today()),
        "commit": commit(),
        "machine": limits["processor"],
        "kernels": kernels,
        "bandwidth [GB/s]": round(limits["bandwidth, 1 threads"] / 1e9, 1),
        "busy": max(slower) > BUSY,
        "rates": rates | {f"P2 {START}": float(f"{bonded.more[START]:.3g}")},
    }


def main() -> None:
    """Measure, and add the point."""
    measured = []
    for row in rows():
        measured.append(row)
        print(row.text(), flush=True)
    new = point(measured, benchmark.machine(1))
    with FILE.open("a") as file:
        file.write(json.dumps(new) + "\n")
    print(f"added to {FILE}: {'busy' if new['busy'] else 'quiet'} machine, commit {new['commit']}")


if __name__ == "__main__":
    main()
