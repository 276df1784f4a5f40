"""Check the prose: words that the glossary does not have, line lengths, links and paths.

`python tools/words.py` checks the Markdown files. `--all` also lists the words in comments and
texts of core/, bindings/, src/ and tests/, and in names of tests.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WIDTH = 100
PROSE = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "docs", "src")
CODE = ("core", "bindings", "src", "tests", "tools")
MADE = ROOT / "docs/problems"  # pages that `make docs` makes of READMEs

DENIED = {
    r"anew": "again",
    r"foresee\w*|foresaw|foreseen": "predict, allow for",
    r"in turns": "interleaved, alternately",
    r"what is picked": "selected items",
    r"go(?:es)? apart": "fused, separate",
    r"stray\w*": "leave its skin, deviate",
    r"s[aiu]nks?|sinks? in(?:to)?|sinking": "penetrate, penetration, settle",
    r"close lists?|closeness": "inner list",
    r"hand-?over": "transfer, change of target",
    r"glued?": "bonded",
    r"free blocks?": "fused blocks",
    r"dice": "chaotic",
}
"""Words of the private dialect, and what to write instead."""

RIDDLE = re.compile(
    r"(?:^|[.:;] |\*\*)(?:What|Who|Those that|That which) (?:is|are|has|have|was|were|does|do|can|"
    r"cannot|may|lies?|stands?|nothing|something|of)\b"
)
"""A sentence whose subject is a clause: name the thing."""


def files(places: tuple[str, ...], *suffixes: str) -> list[Path]:
    """Files below some places with one of these endings, in order."""
    found: set[Path] = set()
    for place in map(ROOT.joinpath, places):
        found |= {place} if place.is_file() else {p for s in suffixes for p in place.rglob(f"*{s}")}
    return sorted(path for path in found if MADE not in path.parents)


def denied(text: str) -> list[str]:
    """Words of the private dialect in a text, with what to write instead."""
    return [
        f"{match.group()!r}: write {instead}"
        for word, instead in DENIED.items()
        for match in re.finditer(rf"\b(?:{word})\b", text, re.IGNORECASE)
    ]


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
    """Names in backticks that look like paths of the repository and are none."""
    tops = "|".join(("core", "bindings", "docs", "src", "tests", "tools", "examples", r"\.ci"))
    names = re.findall(rf"`((?:{tops})/[\w./-]*)`", line)
    return [f"{name}: no such file" for name in names if not exists(name, path.parent)]


def check_document(path: Path) -> list[str]:
    """Everything that is wrong with a Markdown file."""
    problems = []
    lines = path.read_text().splitlines()
    for number, (line, prose) in enumerate(zip(lines, without_code(lines), strict=True), 1):
        table = line.startswith("|")
        found = denied(re.sub(r"\]\([^)]*\)", "]", prose))
        found += check_links(path, prose) + check_paths(path, line)
        if RIDDLE.search(prose):
            found.append("the subject is a clause: name the thing")
        if len(line) > WIDTH and not table and "](" not in line:
            found.append(f"{len(line)} characters, more than {WIDTH}")
        problems += [f"{path.relative_to(ROOT)}:{number}: {what}" for what in found]
    return problems


def check_code(path: Path) -> list[str]:
    """Words of the private dialect in a source file: comments, texts, names of tests."""
    problems = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        text = line
        if path.suffix in (".hpp", ".cpp"):
            text = line.partition("//")[2]
        elif name := re.match(r"\s*def (test_\w+)", line):
            text = name.group(1).replace("_", " ")
        elif path.suffix == ".py" and not re.search(r"[\"'#]|^\s+[A-Z]\w+ |^[A-Z]\w+ ", line):
            continue
        problems += [f"{path.relative_to(ROOT)}:{number}: {what}" for what in denied(text)]
    return problems


def main() -> None:
    """Print what is found; fail for the documents, only list the code."""
    problems = [p for path in files(PROSE, ".md") for p in check_document(path)]
    if "--all" in sys.argv:
        sources = [f for f in files(CODE, ".hpp", ".cpp", ".py") if f != Path(__file__).resolve()]
        listed = [p for path in sources for p in check_code(path)]
        print("\n".join([*listed, f"{len(listed)} in code"]))
    sys.exit("\n".join(problems) or 0)


if __name__ == "__main__":
    main()
