"""A part of torture that is cut off goes on where it stopped."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

TOOLS = Path(__file__).parents[3] / "tools/torture"


@pytest.fixture
def state(monkeypatch):
    """The module of the state file."""
    monkeypatch.syspath_prepend(str(TOOLS))
    import state

    return state


def test_a_part_finds_its_results_again(state, tmp_path):
    """Results add up; a file of other options ends the program."""
    path = tmp_path / "new/part.json"
    first = state.State(path, ["cases", 9], {"done": 0})
    first.known["done"] += 4
    assert first.commits() == "" and not path.exists()
    first.keep()
    again = state.State(path, ["cases", 9], {"done": 0})
    assert again.known == {"done": 4} and again.commits() == first.commits() != ""
    with pytest.raises(SystemExit, match=r"part\.json is of \['cases', 9\], not of \['cases', 8\]"):
        state.State(path, ["cases", 8], {"done": 0})


FUZZ = """
import sys
sys.path.insert(0, {tools!r})
import fuzz

def read(path):
    '''In place of the readers: refuses every other file, as its bytes say.'''
    from cdem.errors import CdemError

    if sum(path.read_bytes()) % 2:
        raise CdemError("odd")

def write(folder):
    (folder / "seed-case.yaml").write_text("title: a case\\nstages: [1, 2, 3]\\n")

fuzz.read_case, fuzz.parts.write_cases, fuzz.__file__ = read, write, __file__
sys.exit(fuzz.main())
"""


def test_fuzzing_that_is_killed_goes_on_to_the_same_counts(tmp_path):
    """As many inputs of each kind as in one go; a third time nothing is left to do."""
    program = tmp_path / "program.py"
    program.write_text(FUZZ.format(tools=str(TOOLS)))
    words = [sys.executable, str(program), "cases", "400", "--seed", "5"]
    words += ["--corpus", str(tmp_path / "corpus")]
    whole = subprocess.run([*words, "--out", tmp_path / "a"], capture_output=True, text=True)
    path = tmp_path / "part.json"
    words += ["--out", str(tmp_path / "b"), "--state", str(path)]
    part = subprocess.Popen(words, stdout=subprocess.DEVNULL)
    until = time.monotonic() + 60
    while not path.exists() and time.monotonic() < until:
        time.sleep(0.02)
    part.send_signal(signal.SIGKILL)
    part.wait()
    done = sum(json.loads(path.read_text())["known"]["counts"].values())
    assert 0 < done < 400
    end, again = (subprocess.run(words, capture_output=True, text=True).stdout for _ in range(2))
    assert end == again and end.split("slowest")[0] == whole.stdout.split("slowest")[0]
