"""Check the includes of core/: folders in one order, no cycles, no deep nesting, kernels without model.

And every test_*.cpp of tests/core/ mirrors a file of core/.
"""

import re
import sys
from functools import cache
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

# Folders, lowest first: a file includes its own folder and those before it.
FOLDERS = [
    "base",
    "records",
    "materials",
    "interfaces",
    "model",
    "contact/geometry",
    "elements",
    "nodes",
    "water",
    "surface",
    "contact/narrow_phase",
    "contact/force",
    "bonds",
    "bolts",
    "contact/broad_phase",
    "contact/pair_list",
    "contact",
    "diagnostics",
    ".",
    "run",
    "kernels",
]
MODULES = ["bolts", "water", "surface"]
"""Nobody outside of them names them, but core/model/modules.hpp."""
DEEPEST = 8

problems: list[str] = []


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


sources = [str(path) for path in sorted(Path("core").rglob("*.[hc]pp"))]
units: dict[str, set[str]] = {unit(path): set() for path in sources}
for path in sources:
    height = FOLDERS.index(folder(path))
    for other in includes(path):
        room = str(Path(other).relative_to("core").parent)
        may_name = (f"core/{room}/", "core/kernels/", "core/model/modules.hpp")
        if room in MODULES and not path.startswith(may_name):
            problems.append(f"{path} may not name the module {room}")
        if FOLDERS.index(folder(other)) > height:
            problems.append(
                f"{path} may not include {other}, which lies above it{hint(path, other)}"
            )
        if unit(other) != unit(path):
            units[unit(path)].add(unit(other))
    own = path.endswith(".cpp") and folder(path) != "kernels"
    owner = path.removesuffix(".cpp") + ".hpp" if own else None
    if owner and next(iter(includes(path)), "") != owner:
        problems.append(f"{path} must include its own header first")
    if folder(path) == "kernels":
        for other in sorted(closure(path)):
            if other.startswith("core/model/"):
                problems.append(f"{path} is a kernel and may not reach {other}")

try:
    TopologicalSorter(units).prepare()
except CycleError as cycle:
    problems.append("units include each other: " + " -> ".join(cycle.args[1]))

for path in sorted(Path("tests/core").rglob("test_*.cpp")):
    mirrored = (
        Path("core") / path.relative_to("tests/core").parent / path.stem.removeprefix("test_")
    )
    if not any(mirrored.parent.glob(f"{mirrored.name}.[hc]pp")):
        problems.append(f"{path} mirrors nothing: there is no {mirrored}.hpp or .cpp")

deepest = max(sources, key=depth) if not problems else ""
if deepest and depth(deepest) > DEEPEST:
    problems.append(f"{deepest}: includes are {depth(deepest)} deep, more than {DEEPEST}")
sys.exit("\n".join(problems) or 0)
