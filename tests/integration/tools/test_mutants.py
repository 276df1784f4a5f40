"""Planting faults that is cut off goes on, and plants again only what has changed."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

TOOLS = Path(__file__).parents[3] / "tools"
WORKER = """
import os, signal, sys
from pathlib import Path
sys.path.insert(0, {tools!r})
import mutants
from mutant_list import Mutant

root = mutants.ROOT = Path({root!r})
mutants.TREE = root / "build/mutants"
mutants.MUTANTS = [
    Mutant(f"fault{{k}}", f"line {{k}} is wrong", "src/code.py", f"line{{k}}", f"wrong{{k}}", f"tests/test_{{k}}.py")
    for k in (1, 2, 3)
]
mutants.make_environment = lambda: None
mutants.build = lambda *commands: None

def failed(command, limit):
    '''In place of pytest: fails where a fault is planted; the program is killed at the second.'''
    text, (test,) = (mutants.TREE / "src/code.py").read_text(), command[-1:]
    if "wrong" not in text:
        return ""
    with open(root / "planted", "a") as file:
        file.write(test[-4])
    if "wrong2" in text and not (root / "killed").exists():
        (root / "killed").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return f"{{test}}::test_it"

mutants.failed = failed
mutants.main()
"""


@pytest.fixture
def root(tmp_path):
    """A checkout with three lines of code and a test for each, and a program that plants faults."""
    root = tmp_path / "checkout"
    for name in ("src", "tests", "docs"):
        (root / name).mkdir(parents=True)
    (root / "src/code.py").write_text("line1 = 1\nline2 = 2\nline3 = 3\n")
    for k in (1, 2, 3):
        (root / f"tests/test_{k}.py").write_text(f"# test {k}\n")
    (root / "worker.py").write_text(WORKER.format(tools=str(TOOLS), root=str(root)))
    git = ["git", "-C", root, "-c", "user.name=n", "-c", "user.email=e"]
    for words in (["init", "-q"], ["add", "src", "tests"], ["commit", "-qm", "code"]):
        subprocess.run([*git, *words], check=True)
    return root


def plant(root: Path, *words: str) -> tuple[int, str]:
    """Plant the faults; exit status, and numbers of those that were planted."""
    (root / "planted").write_text("")
    command = [sys.executable, root / "worker.py", "--state", root / "build/mutants/faults.json"]
    done = subprocess.run([*command, *words], capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr, done.stderr
    return done.returncode, (root / "planted").read_text()


def test_planting_that_is_killed_goes_on(root):
    assert plant(root) == (-signal.SIGKILL, "12")
    assert "wrong2" in (root / "build/mutants/src/code.py").read_text()  # the fault is still there
    assert plant(root, "--write") == (0, "23")
    page = (root / "docs/mutants.md").read_text()
    assert "3 of 3 faults planted" in page and "3 caught" in page
    assert page.count("| `test_") == 3 and "by commit: 3 at " in page
    assert plant(root) == (0, "")
    (root / "tests/test_3.py").write_text("# another test 3\n")
    assert plant(root, "fault1", "--write") == (0, "")
    assert "2 of 3 faults planted" in (root / "docs/mutants.md").read_text()
    assert plant(root) == (0, "3")
    with (root / "src/code.py").open("a") as file:
        file.write("line4 = 4\n")
    assert plant(root) == (0, "123")


@pytest.fixture
def mutants(monkeypatch, tmp_path):
    """The program, whose copy is an empty folder."""
    monkeypatch.syspath_prepend(str(TOOLS))
    import mutants

    monkeypatch.setattr(mutants, "TREE", tmp_path)
    return mutants


def test_a_crash_is_a_failure_of_the_test_that_crashed(mutants, tmp_path):
    """A wrong access ends pytest before it names a test; Python still writes where it was."""
    file = tmp_path / "tests/unit/test_access.py"
    file.parent.mkdir(parents=True)
    file.write_text("import ctypes\n\n\ndef test_it():\n    ctypes.string_at(0)\n")
    command = (sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests")
    assert mutants.failed(command, 60) == "tests/unit/test_access.py::test_it"


def test_a_crash_without_a_name_is_of_the_command(mutants):
    """Unless the signal comes from outside: then nothing is known of the fault."""
    assert mutants.failed(("sh", "-c", "kill -ABRT $$"), 60) == "kill -ABRT $$"
    with pytest.raises(mutants.Stale, match="ends with status -15"):
        mutants.failed(("sh", "-c", "kill -TERM $$"), 60)
