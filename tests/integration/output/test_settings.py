"""Settings of libraries that lie in the current folder."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

pytest.importorskip("pyvista")
PROGRAM = [sys.executable, "-c", "from cdem.cli import main; main()"]
WORDS = [["plot", "cube.results"], ["render", "cube.results", "--time", "0"]]
MORE = [["check", "cube.yaml", "--picture", "model.png"], ["doctor"]]


def run(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*PROGRAM, *words], capture_output=True, text=True, timeout=120, check=False
    )


@pytest.mark.parametrize("commands", [WORDS, pytest.param(MORE, marks=pytest.mark.slow)])
def test_settings_of_a_stranger_s_folder_are_not_read(run_cli, cube_folder, commands):
    """What lies there never ends for whoever reads it; pictures are those of a folder without it."""
    assert run_cli("run", "cube.yaml", "--threads", "1", "--quiet")[0] == 0
    assert run_cli("plot", "cube.results")[0] == 0
    picture = cube_folder / "cube.results/energies.png"
    before = picture.read_bytes()
    picture.unlink()
    os.mkfifo(cube_folder / "matplotlibrc")
    for words in commands:
        done = run(*words)
        assert done.returncode == 0, done.stderr
    assert commands is MORE or picture.read_bytes() == before
