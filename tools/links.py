"""Check the Markdown files: links, paths in backticks, and line lengths."""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WIDTH = 100
PROSE = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "docs", "src")
MADE = ROOT / "docs/problems"  # pages that `make docs` makes of READMEs


def documents() -> list[Path]:
    """The Markdown files to check, in order."""
    found: set[Path] = set()
    for place in map(ROOT.joinpath, PROSE):
        found |= {place} if place.is_file() else set(place.rglob("*.md"))
    return sorted(path for path in found if MADE not in path.parents)


def without_code(lines: list[str]) -> list[str]:
    """The lines of a Markdown file with fenced blocks, formulas and `code` made empty."""
    out, fence = [], ""
    for line in lines:
        mark = next((m for m in ("```", "$$") if line.lstrip().startswith(m)), "")
        if fence or mark:
            ends = mark == fence if fence else line.count("$$") == 2
            fence = "" if ends else fence or mark
            out.append("")
        else:
            out.append(re.sub(r"`[^`]*`", "``", line))
    return out


def exists(name: str, folder: Path) -> bool:
    """Whether a path is a file or folder of the repository, from its root or from a folder."""
    return (ROOT / name).exists() or (folder / name).exists()


def check_links(path: Path, line: str) -> list[str]:
    """Links of a line that lead to no file."""
    problems = []
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", line):
        here = (path.parent / target).resolve()
        known = not here.is_relative_to(ROOT) or exists(str(here.relative_to(ROOT)), ROOT)
        if not re.match(r"[a-z]+:", target) and not known:
            problems.append(f"link to {target}: no such file")
    return problems


def check_paths(path: Path, line: str) -> list[str]:
    """Names in backticks that look like paths of the repository but are not."""
    tops = "|".join(("core", "bindings", "docs", "src", "tests", "tools", "examples", r"\.ci"))
    names = re.findall(rf"`((?:{tops})/[\w./-]*)`", line)
    return [f"{name}: no such file" for name in names if not exists(name, path.parent)]


def check_document(path: Path) -> list[str]:
    """All problems of a Markdown file, with their lines."""
    problems = []
    lines = path.read_text().splitlines()
    for number, (line, prose) in enumerate(zip(lines, without_code(lines), strict=True), 1):
        found = check_links(path, prose) + check_paths(path, line)
        if len(line) > WIDTH and not line.startswith("|") and "](" not in line:
            found.append(f"{len(line)} characters, more than {WIDTH}")
        problems += [f"{path.relative_to(ROOT)}:{number}: {problem}" for problem in found]
    return problems


def main() -> None:
    """Print all problems; fail if there are any."""
    sys.exit("\n".join(p for path in documents() for p in check_document(path)) or 0)


if __name__ == "__main__":
    main()
