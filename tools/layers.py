"""Check the includes of core/: folders in one order, no cycles, no deep nesting, kernels without model.

And every test_*.cpp of tests/core/ mirrors a file of core/.
"""

import re
import sys
from collections.abc import Iterator
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

FOLDERS = {
    "base": "numbers, loops of each device, exact sums",
    "records": "rows of the arrays",
    "materials": "block laws, one file each",
    "interfaces": "joint laws, one file each",
    "model": "all arrays, described; the modules",
    "ranks": "decisions and rows that ranks share",
    "contact/geometry": "faces and edges as they are now",
    "elements": "forces of elements",
    "nodes": "sums, motion, time step, supports",
    "water": "module: pressures in open joints",
    "surface": "module: surface laws, one file each",
    "columns": "module: ground beside sides",
    "contact/narrow_phase": "targets of vertices and edges",
    "contact/force": "semi-springs and semi-edges",
    "bonds": "bonded pairs, failure, release",
    "bolts": "module: anchors",
    "contact/broad_phase": "pairs that may touch soon",
    "contact/pair_list": "when and how pairs are listed",
    "contact": "one header for all of contact",
    "diagnostics": "energies, unbalanced force, health",
    ".": "step.cpp: the method on one page",
    "rest": "equilibrium by a solve: tangent, multigrid, Newton",
    "run": "time loop, rebuilds, excavation",
    "kernels": "kernels, compiled for every device",
}
"""Folders with their contents, lowest first: a file includes its own folder and those before it."""
HEIGHT = {name: height for height, name in enumerate(FOLDERS)}
MODULES = ["bolts", "water", "surface", "columns"]
"""Nobody outside of them names them, but core/model/modules.hpp."""
DEEPEST = 8


def folder(path: str) -> str:
    """Folder of a file of core/, as FOLDERS names it; the data of a module are part of `model`."""
    name = str(Path(path).relative_to("core").parent)
    if name in MODULES and Path(path).name in ("data.hpp", "states.hpp"):
        return "model"
    if name not in FOLDERS:
        sys.exit(f"{path}: give its folder a place in FOLDERS of tools/layers.py")
    return name


@cache
def includes(path: str) -> tuple[str, ...]:
    """Files of core/ that a file includes."""
    return tuple(re.findall(r'#include "(core/[^"]+)"', Path(path).read_text()))


@cache
def depth(path: str) -> int:
    """Length of the longest chain of includes from a file down."""
    return 1 + max(map(depth, includes(path)), default=0)


@cache
def closure(path: str) -> frozenset[str]:
    """All files that a file includes, directly or not."""
    below = includes(path)
    return frozenset(below).union(*map(closure, below))


def unit(path: str) -> str:
    """A header and the .cpp that it owns are one unit; but the .cpp of a module sees the whole model."""
    return path if path.endswith("/data.cpp") else path.rsplit(".", 1)[0]


def hint(path: str, other: str) -> str:
    """Why a file that counts as part of `model` may not include another, where that is no module yet."""
    if folder(path) != "model":
        return ""
    if Path(path).parent == Path(other).parent:
        return (
            ": the data of a module are part of core/model, so include it in the .cpp of the module"
        )
    if Path(other).name == "data.hpp":
        return ": if its folder is a module, add it to MODULES of tools/layers.py"
    return ""


def sources() -> list[str]:
    """Files of core/."""
    return [str(path) for path in sorted(Path("core").rglob("*.[hc]pp"))]


def problems_of(path: str) -> Iterator[str]:
    """Includes of a file that break a rule."""
    for other in includes(path):
        room = str(Path(other).relative_to("core").parent)
        may_name = (f"core/{room}/", "core/kernels/", "core/model/modules.hpp")
        if room in MODULES and not path.startswith(may_name):
            yield f"{path} may not name the module {room}"
        if HEIGHT[folder(other)] > HEIGHT[folder(path)]:
            yield f"{path} may not include {other}, which lies above it{hint(path, other)}"
    owner = path.removesuffix(".cpp") + ".hpp"
    if path.endswith(".cpp") and folder(path) != "kernels" and includes(path)[:1] != (owner,):
        yield f"{path} must include its own header first"
    if folder(path) == "kernels":
        for other in sorted(closure(path)):
            if other.startswith("core/model/"):
                yield f"{path} is a kernel and may not reach {other}"


def cycles() -> Iterator[str]:
    """Units that include each other."""
    units: dict[str, set[str]] = {unit(path): set() for path in sources()}
    for path in sources():
        units[unit(path)] |= {unit(other) for other in includes(path)} - {unit(path)}
    try:
        TopologicalSorter(units).prepare()
    except CycleError as cycle:
        yield "units include each other: " + " -> ".join(cycle.args[1])


def tests_without_file() -> Iterator[str]:
    """Tests that mirror no file of core/."""
    for path in sorted(Path("tests/core").rglob("test_*.cpp")):
        place = Path("core") / path.relative_to("tests/core").parent
        mirrored = place / path.stem.removeprefix("test_")
        if not any(place.glob(f"{mirrored.name}.[hc]pp")):
            yield f"{path} mirrors nothing: there is no {mirrored}.hpp or .cpp"


def main() -> None:
    """Print what is wrong and fail, or say nothing."""
    problems = [problem for path in sources() for problem in problems_of(path)]
    problems += [*cycles(), *tests_without_file()]
    deepest = max(sources(), key=depth) if not problems else ""
    if deepest and depth(deepest) > DEEPEST:
        problems.append(f"{deepest}: includes are {depth(deepest)} deep, more than {DEEPEST}")
    sys.exit("\n".join(problems) or 0)


if __name__ == "__main__":
    main()
