"""What the host does between the launches of a step, counted by the emulated device: `make devices`.

Prints a table of launches, waits, transfers, and pages of arrays (4 kB) that host code touches in a
step outside of transfers, with the functions that touch them. docs/contributing/devices.md has it.
`make devices RUN="CASE FOLDER"` counts a run that goes on from the checkpoint of a folder of results.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from importlib.resources import files
from pathlib import Path

import cdem
from cdem import _native
from cdem.case.case import Case
from cdem.tools import benchmark, benchmark_cases

STEPS = 100
MOST = 6
"""Functions that are named; the others are summed up."""


def bonded() -> dict:
    """P2: a bar of bonded tets."""
    return benchmark_cases.bar(6, "tet4", **benchmark_cases.breakable("1 GPa"))


def landslide() -> Case:
    """The template without its first stage: a body of bonded tets that slides on its bed."""
    case = Case.load(str(files("cdem") / "templates" / "landslide.yaml"))
    del case.stages[0]
    return case


# Name, case, and steps before those that are counted.
SCENES = {
    "P1, tets that share nodes": (lambda: benchmark_cases.bar(6, "tet4"), 20),
    "P2, bonded tets": (bonded, 20),
    "P3, rubble": (lambda: benchmark_cases.rubble(2), 200),
    "P4, wall of cubes": (lambda: benchmark_cases.wall(benchmark.WALL), 200),
    "landslide, template": (landslide, 200),
}


def start(case: Case | dict, steps: int) -> cdem.Simulation:
    """A simulation after some steps; its first run has what no other step has."""
    sim = cdem.Simulation(case if isinstance(case, Case) else Case.from_dict(case), threads=1)
    sim.step(steps)
    return sim


def causes(host: list[tuple[int, int, int]]) -> Counter[str]:
    """Pages that were touched, by function of the core."""
    pages: Counter[str] = Counter()
    if not host:
        return pages
    command = ["addr2line", "-aCfie", _native.core.__file__, *(hex(place) for place, _, _ in host)]
    text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    frames = [part.splitlines()[1:] for part in re.split(r"^(?=0x)", text, flags=re.M)[1:]]
    for (_, reads, writes), lines in zip(host, frames, strict=True):
        pages[function(lines)] += reads + writes
    return pages


def function(frames: list[str]) -> str:
    """Name of the innermost function that is not of the base, of frames: a name and a place each.

    "views" where the compiler has left those out of line.
    """
    for name, place in zip(frames[::2], frames[1::2], strict=True):
        if "/core/" in place and "/base/" not in place and not name.startswith("operator"):
            return short(name)
    return "views"


def short(name: str) -> str:
    """Name of a function without namespaces, arguments and what the compiler made of it."""
    name = re.sub(r"\(anonymous namespace\)::|cdem::|emulated::", "", name)
    name = re.sub(r"::\{lambda.*|\(.*|\[.*|\._omp.*", "", name)
    while (less := re.sub(r"<[^<>]*>", "", name)) != name:
        name = less
    return name.split()[-1]


def row(name: str, sim: cdem.Simulation) -> str:
    """A line of the table."""
    _native.core.forget()
    sim.step(STEPS)
    seen, pages = _native.core.seen(), causes(_native.core.seen()["host"])
    total, named = sum(pages.values()), pages.most_common(MOST)
    by = [f"`{function}` {count / STEPS:.3g}" for function, count in named]
    rest = total - sum(count for _, count in named)
    by += [f"others {rest / STEPS:.3g}"] * (rest > 0)
    numbers = [seen[key] / STEPS for key in ("launches", "waits", "transfers")]
    counts = " | ".join(f"{number:.1f}" for number in [*numbers, total / STEPS])
    return f"| {name}, {sim.audit.counts['elements']:,} elements | {counts} | {', '.join(by)} |"


def main() -> None:
    """Print the table."""
    print("| a step of | launches | waits | transfers | pages | by |")
    print("|---|---|---|---|---|---|")
    if sys.argv[1:]:
        case, folder = (Path(word) for word in sys.argv[1:])
        for needed in (case, folder / "checkpoint.h5"):
            if not needed.is_file():
                sys.exit(f"{needed}: no such file; give a case, and the folder of a run of it")
        with tempfile.TemporaryDirectory() as copy:
            kept = shutil.ignore_patterns("frames*", "*.vtkhdf", "*.html", "*.png")
            shutil.copytree(folder, copy, ignore=kept, dirs_exist_ok=True)
            sim = cdem.Simulation(case, threads=1, output=copy, resume=True)
            sim.step(1)
            print(row(f"{case.stem} at {sim.time:.3g} s", sim))
        return
    for name, (case, before) in SCENES.items():
        print(row(name, start(case(), before)), flush=True)


if __name__ == "__main__":
    main()
