"""Plant the faults of mutant_list one by one; each must fail a test.

Works on a copy of the tracked files in build/mutants, with its own build folder. For each fault it
builds what changed and runs the quickest test that should fail; a fault that passes it meets the
whole quick suite, pinned results last. Ends with status 1 if a fault survives, no longer fits the
code or runs into the time limit.

`python tools/mutants.py name...` plants only those; `--write` puts the table in docs/mutants.md;
`--check`, which is part of `make lint`, only looks whether all still fit the code.
"""

import argparse
import datetime
import os
import re
import shutil
import subprocess
import sys
import time
import venv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mutant_list import MUTANTS, Mutant

ROOT = Path(__file__).resolve().parent.parent
TREE = ROOT / "build" / "mutants"
PYTHON = str(TREE / ".venv" / "bin" / "python")
NINJA = ("ninja", "-C", "build/core")
MODULE = (PYTHON, "tools/build.py", "--native")
CORE_TESTS = ("build/core/core_tests", "--abort-after=1")
PYTEST = (
    PYTHON,
    "-m",
    "pytest",
    "-x",
    "-rfE",
    "--no-header",
    "-p",
    "no:cacheprovider",
    "--hypothesis-seed=1",
)
SUITE = ("tests/unit", "tests/integration", "tests/validation", "tests/regression")
PYTEST_FAILURE = r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$"
CORE_FAILURE = r"^\S*?(tests/core/\S+):\d+:\nTEST CASE: *(.+)$"
OWN_LAWS = "tests/validation/test_own_laws.py"  # skipped in the suite: another core, built last
LIMIT = 400  # of one test, and LIMIT_SUITE of all  [s]
LIMIT_SUITE = 7200


@dataclass
class Outcome:
    """What became of a mutant; `test` is empty where none failed."""

    mutant: Mutant
    test: str
    problem: str
    seconds: float


class Stale(Exception):
    """A mutant does not fit the code, or does not build."""


def git(*words: str) -> str:
    """What git says of the checkout."""
    return subprocess.run(
        ("git", *words), cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout


def run(command: Sequence[str], limit: float = LIMIT_SUITE) -> subprocess.CompletedProcess:
    """Run a command in the copy, with the tools of this Python."""
    path = f"{Path(PYTHON).parent}:{Path(sys.executable).parent}:{os.environ['PATH']}"
    env = os.environ | {"PATH": path, "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run(
        command, cwd=TREE, env=env, capture_output=True, text=True, timeout=limit, check=False
    )


def copy_tree() -> None:
    """Make the copy what the checkout is; files that are equal keep their time."""
    shutil.rmtree(TREE / ".hypothesis", ignore_errors=True)  # draws that failed under a fault
    tracked = set(git("ls-files", "-z").split("\0")) - {""}
    for name in tracked:
        new, old = ROOT / name, TREE / name
        if not new.exists():
            continue
        if not old.exists() or old.read_bytes() != new.read_bytes():
            old.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(new, old)
    for folder in ("core", "bindings", "src", "tests", "tools"):
        for old in (TREE / folder).rglob("*.[chp]*"):
            if str(old.relative_to(TREE)) not in tracked:
                old.unlink()


def make_environment() -> None:
    """A Python that finds the copy of the package, and all others where this one finds them."""
    venv.create(TREE / ".venv", symlinks=True)
    place = next((TREE / ".venv" / "lib").glob("python*")) / "site-packages"
    package = place / "cdem"
    if not package.is_symlink():
        package.symlink_to(TREE / "src" / "cdem")
    shared = [path for path in sys.path if path.endswith("-packages")]
    (place / "shared.pth").write_text("\n".join(shared) + "\n")


def build(*commands: Sequence[str]) -> None:
    """Build in the copy."""
    for command in commands:
        done = run(command)
        if done.returncode:
            raise Stale("does not build:\n" + (done.stdout + done.stderr)[-3000:])


def is_in_core(mutant: Mutant) -> bool:
    """Is it planted in C++?"""
    return mutant.file.startswith("core/")


def is_core_test(test: str) -> bool:
    """Is it a test of core_tests?"""
    return test.endswith(".cpp")


def command_of(test: str) -> tuple[str, ...]:
    """The command that runs a test: a file of tests/core, or words for pytest."""
    if is_core_test(test):
        return (*CORE_TESTS, f"--source-file=*/{test}")
    return (*PYTEST, *test.split())


def failed(command: Sequence[str], limit: float) -> str:
    """Name of the first test that fails, or nothing."""
    done = run(command, limit)
    if done.returncode == 0:
        return ""
    for pattern in (PYTEST_FAILURE, CORE_FAILURE):
        if found := re.search(pattern, done.stdout, re.MULTILINE):
            return "::".join(found.groups())
    raise Stale(f"{command[-1]} ends with status {done.returncode}:\n{done.stdout[-3000:]}")


def fails_suite(mutant: Mutant) -> str:
    """The first test of the whole quick suite that fails, or nothing."""
    test = ""
    if is_in_core(mutant):
        build((*MODULE, "--tests"))
        test = failed(CORE_TESTS, LIMIT_SUITE)
    test = test or failed((*PYTEST, *SUITE), LIMIT_SUITE)
    if not test:
        build((*MODULE, "--own-laws"))
        test = failed((*PYTEST, OWN_LAWS), LIMIT_SUITE)
    return test


def fits(mutant: Mutant) -> bool:
    """Is the text that a fault replaces in its file, and once?"""
    return (ROOT / mutant.file).read_text().count(mutant.old) == 1


def try_mutant(mutant: Mutant) -> str:
    """Plant one fault, build, test; returns the test that fails."""
    path = TREE / mutant.file
    text = path.read_text()
    if not fits(mutant):
        raise Stale(f"its old text is not once in {mutant.file}")
    path.write_text(text.replace(mutant.old, mutant.new))
    try:
        if is_core_test(mutant.test):
            build((*NINJA, "core_tests"))
        elif is_in_core(mutant):
            build(MODULE)
        if test := failed(command_of(mutant.test), LIMIT):
            return test
        test = fails_suite(mutant)
    finally:
        path.write_text(text)
    if ".py" in test:  # core_tests as a whole are known to pass without a fault
        build(MODULE)
        if failed((*PYTEST, test), LIMIT):
            raise Stale(f"{test} fails without the fault too")
    return test


def outcome_of(mutant: Mutant) -> Outcome:
    """Plant one fault and say what became of it."""
    start, test, problem = time.monotonic(), "", ""
    try:
        test = try_mutant(mutant)
        problem = "" if test else "SURVIVES"
    except Stale as stale:
        problem = str(stale)
    except subprocess.TimeoutExpired:
        problem = "ran into the time limit"
    return Outcome(mutant, test, problem, time.monotonic() - start)


def check_sound(mutants: Iterable[Mutant]) -> None:
    """Without a fault all tests pass; end if they do not."""
    build((*MODULE, "--tests"))
    tests = {mutant.test for mutant in mutants if not is_core_test(mutant.test)}
    words = sorted({word for test in tests for word in test.split()})
    sound: list[tuple[str, ...]] = [CORE_TESTS]
    sound += [(*PYTEST, *words)] if words else []
    for command in sound:
        test = failed(command, LIMIT_SUITE)
        if test:
            sys.exit(f"fails without any fault: {test}")


def short(test: str) -> str:
    """A test without its folder and its parameters."""
    file, _, name = test.partition("::")
    plain = re.split(r"[\[<]", name)[0]
    return f"{Path(file).name}::{plain}"


def table(outcomes: Sequence[Outcome], commit: str) -> str:
    """The page of all faults."""
    caught = sum(bool(o.test) for o in outcomes)
    lines = [
        "# Planted faults",
        "",
        "Written by `tools/mutants.py --write`. Each fault is planted alone, in one line of the code;",
        "the first test that fails has caught it. Seconds are those of build and test.",
        "",
        f"Commit {commit}, {datetime.date.today()}: {len(outcomes)} of {len(MUTANTS)} faults planted, "
        f"{caught} caught.",
        "",
        "| fault | file | caught by | s |",
        "|---|---|---|--:|",
    ]
    for o in outcomes:
        by = f"`{short(o.test)}`" if o.test else f"**{o.problem.splitlines()[0]}**"
        lines.append(f"| {o.mutant.fault} | `{o.mutant.file}` | {by} | {o.seconds:.0f} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Plant the faults that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="only these faults")
    parser.add_argument("--write", action="store_true", help="put the table in docs/mutants.md")
    parser.add_argument("--check", action="store_true", help="only look whether they fit the code")
    wants = parser.parse_args()
    if wants.check:
        sys.exit("".join(f"{m.name}: not once in {m.file}\n" for m in MUTANTS if not fits(m)) or 0)
    unknown = set(wants.names) - {mutant.name for mutant in MUTANTS}
    if unknown:
        sys.exit(f"no such faults: {', '.join(sorted(unknown))}")
    mutants = [m for m in MUTANTS if not wants.names or m.name in wants.names]
    changed = " with changes" if git("status", "--porcelain", "-uno") else ""
    commit = git("rev-parse", "--short", "HEAD").strip() + changed
    TREE.mkdir(parents=True, exist_ok=True)
    copy_tree()
    make_environment()
    check_sound(mutants)
    outcomes = []
    for mutant in mutants:
        outcomes.append(outcome_of(mutant))
        last = outcomes[-1]
        print(f"{mutant.name}: {last.test or last.problem} ({last.seconds:.0f} s)", flush=True)
    page = table(outcomes, commit)
    print(f"\n{page}")
    if wants.write:
        (ROOT / "docs" / "mutants.md").write_text(page)
    sys.exit(any(o.problem for o in outcomes))


if __name__ == "__main__":
    main()
