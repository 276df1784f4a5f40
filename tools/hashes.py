"""Hashes of the pinned scenes and of the benchmark models, to compare devices.

`python tools/hashes.py --write FILE` on a CPU, `CDEM_ISA=cuda python tools/hashes.py --against FILE`
on a GPU: prints a line for each, and ends with status 1 if any differs, naming the first stored
arrays of the model that do. `tools/gpu_right.sh` calls it.
"""

import argparse
import hashlib
import json
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
import cdem
from cdem.tools import benchmark, benchmark_cases
from tests.regression import golden_scenes

MODELS = {
    "p1": lambda cells: benchmark_cases.bar(cells, "tet4"),
    "p2": lambda cells: benchmark_cases.bar(cells, "tet4", **benchmark_cases.breakable("1 GPa")),
    "p3": benchmark_cases.rubble,
    "p4": lambda _: benchmark_cases.wall(benchmark.WALL),
}
MOST = 5
"""Arrays that are named; more of them follow from the first."""


def arrays(sim: cdem.Simulation) -> dict[str, str]:
    """Hash of each array that a checkpoint keeps."""
    stored = [info["name"] for info in sim.core.describe() if info["origin"] == "stored"]
    return {
        name: hashlib.sha256(np.ascontiguousarray(sim.core.array(name)[0]).tobytes()).hexdigest()[
            :16
        ]
        for name in stored
    }


def result(name: str, steps: int, cells: int) -> tuple[str, dict[str, str]]:
    """Hash of a scene or of a model after some steps, and of the arrays of a model."""
    if name in golden_scenes.SCENES:
        return golden_scenes.digest(name, 1), {}
    sim, _ = benchmark_cases.start(MODELS[name](cells), 1)
    sim.step(steps)
    return golden_scenes.digest_of_results(sim), arrays(sim)


def given() -> argparse.Namespace:
    """What the command line says; `names` are scenes and models."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="golden, pinned scenes, p1 to p4; all by default")
    parser.add_argument("--steps", type=int, default=300, help="of p1 to p4")
    parser.add_argument("--cells", type=int, default=4, help="across p1 to p3: 48 tets times cube")
    parser.add_argument("--write", type=Path, help="file to write the hashes into")
    parser.add_argument("--against", type=Path, help="file with the hashes to compare with")
    args = parser.parse_args()
    if args.against and not args.against.is_file():
        sys.exit(f"{args.against}: no such file; --write makes it")
    names = args.names or ["golden", *MODELS]
    args.names = [
        scene for name in names for scene in (golden_scenes.SCENES if name == "golden" else [name])
    ]
    known = [*golden_scenes.SCENES, *MODELS]
    if unknown := [name for name in args.names if name not in known]:
        sys.exit(f"{unknown[0]}: no scene; there are: {', '.join(known)}")
    return args


def verdict(own: tuple[str, dict[str, str]], other: tuple[str, dict[str, str]] | None) -> str:
    """Is a result the same as another one, and if not, which arrays differ?"""
    if other is None:
        return "not in the file"
    if own[0] == other[0]:
        return "same"
    arrays = [name for name, value in own[1].items() if other[1].get(name) != value]
    return ": ".join(["DIFFERS", ", ".join(arrays[:MOST])][: 1 + bool(arrays)])


def main() -> None:
    """Print the hashes, and write or compare them."""
    args = given()
    known = json.loads(args.against.read_text()) if args.against else {}
    found, differ = {}, False
    for name in args.names:
        began = time.perf_counter()
        key = f"{name} {args.cells} {args.steps}" if name in MODELS else name
        found[key] = result(name, args.steps, args.cells)
        words = verdict(found[key], known.get(key)) if args.against else ""
        differ = differ or words not in ("", "same")
        seconds = time.perf_counter() - began
        print(f"{key:12s} {found[key][0]} {seconds:6.2f} s {words}".rstrip(), flush=True)
    if args.write:
        args.write.write_text(json.dumps(found, indent=1) + "\n")
    sys.exit(differ)


if __name__ == "__main__":
    main()
