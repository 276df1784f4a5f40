"""Plant the faults of mutant_list one by one; each must fail a test.

Works on a copy of the tracked files in build/mutants, with its own build folder. For each fault it
builds what changed and runs the quickest test that should fail; a fault that passes it meets the
whole quick suite, pinned results last, and then the slow tests. Ends with status 1 if a fault
survives, no longer fits the code or runs into the time limit.

With `--state FILE` it goes on where it was cut off: a fault is planted again only if its text, the
file that it is planted in, or its test with the helpers of tests has changed since.

`python tools/mutants.py name...` plants only those; `--write` puts the table of all that the state
knows in docs/mutants.md; `--check`, which is part of `make lint`, only looks whether all still fit
the code.
"""

import argparse
import hashlib
import os
import re
import shutil
import signal
import subprocess
import sys
import textwrap
import time
import venv
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parent / "torture"))

from mutant_list import MUTANTS, Mutant
from state import State, add_option

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
CRASHES = {
    -s for s in (signal.SIGSEGV, signal.SIGABRT, signal.SIGFPE, signal.SIGBUS, signal.SIGILL)
}
CRASHED_IN = r'File ".*(tests/\S+\.py)", line \d+ in (test_\w+)$'
"""A line of the stack that Python writes where pytest ends by one of these signals."""
OWN_LAWS = "tests/validation/test_own_laws.py"  # skipped in the suite: another core, built last
HELPERS = ("tests/conftest.py", "tests/scenes.py", "tests/shared/*.py", "tests/core/*.hpp")
"""What tests of a kind share: a change of it lets all faults of this kind be planted again."""
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
    for found in Path(sys.prefix, "lib").glob("*mpi*"):  # an MPI that pip has installed
        link = TREE / ".venv" / "lib" / found.name
        if not link.exists():
            link.symlink_to(found)
    shared = [path for path in sys.path if path.endswith("-packages")]
    (place / "shared.pth").write_text("\n".join(shared) + "\n")


def build(*commands: Sequence[str]) -> None:
    """Build in the copy."""
    for command in commands:
        done = run(command)
        if done.returncode:
            raise Stale("does not build:\n" + (done.stdout + done.stderr)[-3000:])


def is_compiled(mutant: Mutant) -> bool:
    """Is it planted in C++?"""
    return mutant.file.startswith(("core/", "bindings/"))


def is_core_test(test: str) -> bool:
    """Is it a test of core_tests?"""
    return test.endswith(".cpp")


def command_of(test: str) -> tuple[str, ...]:
    """The command that runs a test: a file of tests/core, or words for pytest."""
    if is_core_test(test):
        return (*CORE_TESTS, f"--source-file=*/{test}")
    return (*PYTEST, *test.split())


def failed(command: Sequence[str], limit: float) -> str:
    """Name of the first test that fails, or nothing.

    A crash is a failure, whether or not it says of which test. Other signals come from outside.
    """
    done = run(command, limit)
    if done.returncode == 0:
        return ""
    for pattern, said in (
        (PYTEST_FAILURE, done.stdout),
        (CORE_FAILURE, done.stdout),
        (CRASHED_IN, done.stderr),
    ):
        if found := re.search(pattern, said, re.MULTILINE):
            return "::".join(found.groups())
    if done.returncode in CRASHES:
        return command[-1]
    raise Stale(f"{command[-1]} ends with status {done.returncode}:\n{done.stdout[-3000:]}")


def fails_suite(mutant: Mutant) -> str:
    """The first test of the whole quick suite that fails, or nothing."""
    test = ""
    if is_compiled(mutant):
        build((*MODULE, "--tests"))
        test = failed(CORE_TESTS, LIMIT_SUITE)
    test = test or failed((*PYTEST, *SUITE), LIMIT_SUITE)
    if not test:
        build((*MODULE, "--own-laws"))
        test = failed((*PYTEST, OWN_LAWS), LIMIT_SUITE)
    return test or failed((*PYTEST, "-m", "slow", *SUITE), LIMIT_SUITE)


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
        elif is_compiled(mutant):
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


def key_of(mutant: Mutant, caught_by: str) -> str:
    """Digest of a fault and of the files that its outcome depends on.

    Args:
        mutant: The fault.
        caught_by: The test that has caught it, or nothing.
    """
    shared = [h for h in HELPERS if h.endswith(".hpp") == is_core_test(mutant.test)]
    tests = {word.partition("::")[0] for word in [*mutant.test.split(), caught_by]}
    paths = {ROOT / mutant.file, *(path for h in shared for path in ROOT.glob(h))}
    paths |= {ROOT / test for test in tests if test and (ROOT / test).is_file()}
    digest = hashlib.sha256(repr(tuple(mutant)).encode())
    for path in sorted(paths):
        digest.update(str(path.relative_to(ROOT)).encode() + path.read_bytes())
    return digest.hexdigest()[:16]


def done(state: State, mutant: Mutant) -> dict[str, Any] | None:
    """What the state knows of a fault, unless it or what it depends on has changed.

    One that was not caught is tried again at another commit.
    """
    known = state.known.get(mutant.name)
    if not known or (known["problem"] and known["commit"] != state.now):
        return None
    return known if known["key"] == key_of(mutant, known["test"]) else None


def keep(state: State, outcome: Outcome) -> None:
    """Put an outcome into the state."""
    state.known[outcome.mutant.name] = {
        "key": key_of(outcome.mutant, outcome.test),
        "test": outcome.test,
        "problem": outcome.problem,
        "seconds": outcome.seconds,
        "commit": state.now,
    }
    state.keep()


def check_sound(mutants: Iterable[Mutant]) -> None:
    """Without a fault all tests pass; end if they do not."""
    build((*MODULE, "--tests"))
    tests = {mutant.test for mutant in mutants if not is_core_test(mutant.test)}
    files = sorted({test for test in tests if " " not in test})
    sound = [CORE_TESTS, *(command_of(test) for test in sorted(tests.difference(files)))]
    sound += [(*PYTEST, *files)] if files else []
    for command in sound:
        test = failed(command, LIMIT_SUITE)
        if test:
            sys.exit(f"fails without any fault: {test}")


def short(test: str) -> str:
    """A test without its folder and its parameters."""
    file, _, name = test.partition("::")
    plain = re.split(r"[\[<]", name)[0]
    return f"{Path(file).name}::{plain}"


def table(state: State, mutants: Sequence[Mutant]) -> str:
    """The page of all faults that the state knows."""
    found = {m.name: known for m in mutants if (known := done(state, m))}
    commits = Counter(known["commit"] for known in found.values())
    caught = sum(bool(known["test"]) for known in found.values())
    at = ", ".join(f"{count} at {commit}" for commit, count in commits.items())
    lines = [
        "# Planted faults",
        "",
        "Written by `tools/mutants.py --write`. Each fault is planted alone, in one line of the code;",
        "the first test that fails has caught it. Seconds are those of build and test.",
        "",
        f"{len(found)} of {len(mutants)} faults planted since they, their file or their test changed, "
        f"{caught} caught;",
        *textwrap.wrap(f"by commit: {at or 'none'}.", 100),
        "",
        "| fault | file | caught by | s | commit |",
        "|---|---|---|--:|---|",
    ]
    for mutant in mutants:
        if known := found.get(mutant.name):
            by = f"`{short(known['test'])}`" if known["test"] else f"**{first_line(known)}**"
            row = (mutant.fault, f"`{mutant.file}`", by, f"{known['seconds']:.0f}", known["commit"])
            lines.append(f"| {' | '.join(row)} |")
    return "\n".join(lines) + "\n"


def first_line(known: dict[str, Any]) -> str:
    """Why a fault was not caught."""
    return known["problem"].splitlines()[0]


def plant(state: State, mutants: Sequence[Mutant]) -> None:
    """Plant faults, and keep what became of each."""
    TREE.mkdir(parents=True, exist_ok=True)
    copy_tree()
    make_environment()
    check_sound(mutants)
    for mutant in mutants:
        last = outcome_of(mutant)
        keep(state, last)
        print(f"{mutant.name}: {last.test or last.problem} ({last.seconds:.0f} s)", flush=True)


def main() -> None:
    """Plant the faults that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="only these faults")
    parser.add_argument("--write", action="store_true", help="put the table in docs/mutants.md")
    parser.add_argument("--check", action="store_true", help="only look whether they fit the code")
    add_option(parser)
    wants = parser.parse_args()
    if wants.check:
        sys.exit("".join(f"{m.name}: not once in {m.file}\n" for m in MUTANTS if not fits(m)) or 0)
    unknown = set(wants.names) - {mutant.name for mutant in MUTANTS}
    if unknown:
        sys.exit(f"no such faults: {', '.join(sorted(unknown))}")
    mutants = [m for m in MUTANTS if not wants.names or m.name in wants.names]
    state = State(wants.state, [], {})
    if left := [m for m in mutants if not done(state, m)]:
        plant(state, left)
    page = table(state, MUTANTS)
    print(f"\n{page}")
    if wants.write:
        (ROOT / "docs" / "mutants.md").write_text(page)
    sys.exit(any(state.known[m.name]["problem"] for m in mutants))


if __name__ == "__main__":
    main()
