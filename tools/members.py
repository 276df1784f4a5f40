"""Check that lists of more than three members name them where views and kernels are made.

Looks at core/**/*.cpp and core/**/views.hpp for `return {a, b, c, d}`, `Kernel{a, b, c, d}` and
`Kernel kernel{a, b, c, d}`. A structure with a base cannot name its members and is left out.
"""

import re
import sys
from pathlib import Path

MOST = 3
LIST = re.compile(r"(?:\breturn|\b([A-Z]\w*)(?:<[^;{}()]*>)?(?: \w+)?) ?(?=\{)")
DERIVED = re.compile(r"struct (\w+) : ")


def items(text: str, start: int) -> list[str]:
    """The contents of the braces that open at `start`, split at the outermost commas."""
    depth, found = 0, [""]
    for place in range(start, len(text)):
        mark = text[place]
        depth += (mark in "({[") - (mark in ")}]")
        if depth == 0:
            break
        if depth == 1 and mark == ",":
            found.append("")
        elif place > start:
            found[-1] += mark
    return [item.strip() for item in found]


def main() -> None:
    """Print every list of many members without names; end with status 1 if there is one."""
    headers = sorted(Path("core").rglob("*.hpp"))
    derived = {name for path in headers for name in DERIVED.findall(path.read_text())}
    problems = []
    for path in [*sorted(Path("core").rglob("*.cpp")), *sorted(Path("core").rglob("views.hpp"))]:
        if path.parent.name == "base":
            continue  # numbers, not members
        text = re.sub(r"//[^\n]*", "", path.read_text())
        for match in LIST.finditer(text):
            inside = items(text, match.end())
            statements = any(";" in item for item in inside)
            named = inside[0].startswith(".")
            if len(inside) > MOST and not (statements or named or match[1] in derived):
                line = text.count("\n", 0, match.start()) + 1
                problems.append(f"{path}:{line}: name the {len(inside)} members")
    sys.exit("\n".join(problems) or 0)


if __name__ == "__main__":
    main()
