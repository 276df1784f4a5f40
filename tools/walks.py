"""Count the files that a reader opens on each walk of docs/contributing/walks.md.

From one file of a walk's table to the next a reader follows imports and includes, in either
direction. `python tools/walks.py` writes the files between under each walk; `--check` compares.
"""

import re
import sys
from collections import deque
from itertools import pairwise
from pathlib import Path

import layers
import package_layers

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/contributing/walks.md"
LINE = re.compile(r"\n<!-- opened -->\n.*?\n<!-- end -->\n", re.DOTALL)
Graph = dict[str, set[str]]


def neighbours() -> Graph:
    """Every file with those that it includes or imports, and those that do so with it."""
    graph: Graph = {}

    def join(one: str, other: str) -> None:
        graph.setdefault(one, set()).add(other)
        graph.setdefault(other, set()).add(one)

    bindings = [str(path.relative_to(ROOT)) for path in (ROOT / "bindings").glob("*.?pp")]
    for path in [*layers.sources(), *bindings]:
        for other in layers.includes(path):
            join(path, other)
        for other in re.findall(r'#include "(bindings/[^"]+)"', (ROOT / path).read_text()):
            join(path, other)
    for module, others in package_layers.graph_of_imports().items():
        for other in others:
            join(file_of(module), file_of(other))
    return graph


def file_of(module: str) -> str:
    """The file of a Python module; the compiled one is bindings/core.cpp."""
    return "bindings/core.cpp" if module == "cdem._core" else f"src/{module.replace('.', '/')}.py"


def between(graph: Graph, start: str, end: str) -> list[str]:
    """Files on the shortest way from one file to another, without both.

    Raises:
        SystemExit: No way leads there.
    """
    came: dict[str, str] = {start: ""}
    queue = deque([start])
    while queue and end not in came:
        at = queue.popleft()
        for other in sorted(graph.get(at, ()) - came.keys()):
            came[other] = at
            queue.append(other)
    if end not in came:
        sys.exit(f"{PAGE.name}: no imports lead from {start} to {end}")
    way = [came[end]]
    while way[-1]:
        way.append(came[way[-1]])
    return way[-3::-1]


def opened(graph: Graph, walk: str) -> str:
    """How many files a walk needs."""
    rows = re.findall(r"^\| \d+ \| `([^`]+)`", walk, re.MULTILINE)
    if missing := [name for name in rows if not (ROOT / name).is_file()]:
        sys.exit(f"{PAGE.name}: there is no {missing[0]}")
    more = {name for a, b in pairwise(rows) for name in between(graph, a, b)} - set(rows)
    return f"{len(set(rows))} files, and {len(more)} that lie between them by imports and includes."


def main() -> None:
    """Write the sentences; with --check, only fail where one is out of date."""
    graph = neighbours()
    head, *walks = re.split(r"^(?=## )", PAGE.read_text(), flags=re.MULTILINE)
    new = head
    for walk in walks:
        sentence = f"\n<!-- opened -->\n{opened(graph, walk)}\n<!-- end -->\n"
        new += LINE.sub(lambda _, s=sentence: s, walk)
    if "--check" in sys.argv and new != PAGE.read_text():
        sys.exit(f"{PAGE.relative_to(ROOT)} is out of date; run tools/walks.py")
    PAGE.write_text(new)


if __name__ == "__main__":
    main()
