"""Check the imports of src/cdem: folders in one order, and no module that imports itself by others.

Every import counts: at the top, inside functions, and for type checkers only.
"""

import ast
import sys
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).parent.parent / "src"

FOLDERS = {
    "_version errors named units whole_files _instruction_sets _core_choice own_laws _core _native rows": "",
    "seismic": "records of earthquakes: processing, measures, layered ground",
    "case": "the input: keys, types, checks, errors",
    "mesh": "elements, blocks, faces, edges; mesh files",
    "joints": "joint sets cut bodies into blocks",
    "terrain": "maps and grids to a meshed site",
    "outcrop": "point clouds of rock faces to facets and joints",
    "model": "from a case to the arrays of the core",
    "ranks": "a model shared out to processes, its parts, and the whole again",
    "run": "stages, progress, result folder, resume",
    "output": "text, plots, pictures, files, viewer",
    "study": "sweeps, factor of safety, tests of laws",
    "rockfall": "blocks that fall over terrain, their statistics",
    "fit": "observations against runs, parameters that fit",
    "screening": "closed-form factors of safety over maps",
    "verification": "problems with a known answer",
    "tools": "doctor, benchmark, build of own laws",
    "cli": "the commands",
    "__init__ __main__": "",
}
"""Folders with their contents, lowest first: a module imports from its own folder and earlier ones.

The modules of the package itself stand where they belong.
"""


def name_of(path: Path) -> str:
    """Dotted name of a module below src; a package's own module ends in __init__."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts)


def height(module: str) -> int:
    """Place in FOLDERS of a module."""
    part = module.split(".")[1]
    for number, folders in enumerate(FOLDERS):
        if part in folders.split():
            return number
    sys.exit(f"{module}: give {part} a place in FOLDERS of {Path(__file__).name}")


def imports(module: str, path: Path, modules: dict[str, Path]) -> Iterator[str]:
    """Modules of cdem that a module imports."""
    for node in ast.walk(ast.parse(path.read_text(), str(path))):
        if isinstance(node, ast.ImportFrom) and node.level:
            sys.exit(f"{path}:{node.lineno}: write the import in full, from cdem")
        if isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        else:
            continue
        for name in names:
            if name.split(".")[0] == "cdem":
                yield resolve(name, modules)


def resolve(name: str, modules: dict[str, Path]) -> str:
    """The module that a dotted name is, or lies in."""
    while name not in modules:
        if f"{name}.__init__" in modules:
            return f"{name}.__init__"
        name = name.rpartition(".")[0]
    return name


def graph_of_imports() -> dict[str, set[str]]:
    """Every module of cdem with those that it imports."""
    sources = [*(ROOT / "cdem").rglob("*.py"), *(ROOT / "cdem").rglob("*.pyi")]
    modules = {name_of(path): path for path in sorted(sources)}
    return {module: set(imports(module, path, modules)) for module, path in modules.items()}


def main() -> None:
    """Print what is wrong and fail, or say nothing."""
    graph = graph_of_imports()
    problems = [
        f"{module} may not import {other}, which lies above it"
        for module, others in graph.items()
        for other in sorted(others)
        if height(other) > height(module)
    ]
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as cycle:
        problems.append("modules import each other: " + " -> ".join(cycle.args[1]))
    sys.exit("\n".join(problems) or 0)


if __name__ == "__main__":
    main()
