"""Runs that a signal stops."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time

import pytest

pytestmark = pytest.mark.usefixtures("cube_folder")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_stops_with_a_checkpoint_and_the_run_goes_on(run_cli, cube_folder, number):
    words = ["run", "cube.yaml", "--threads", "1", "--set", "stages.fall.duration=1000"]
    words += ["--set", "output.every=1000"]
    program = [sys.executable, "-c", "from cdem.cli import main; main()", *words]
    child = subprocess.Popen(program, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert child.stderr.readline().startswith("fall: t ")
    time.sleep(0.3)
    child.send_signal(number)
    out, err = child.communicate(timeout=20)
    assert child.returncode == 4
    assert "stopped; results are in cube.results" in out
    assert "go on with: cdem run cube.yaml -o cube.results --resume" in err
    assert (
        json.loads((cube_folder / "cube.results/summary.json").read_text())["status"] == "stopped"
    )

    steps = json.loads((cube_folder / "cube.results/summary.json").read_text())["steps"]
    words += ["--set", f"stages.fall.max_steps={steps + 100}"]
    assert run_cli(*words, "--resume", "--quiet")[0] == 0
    assert (
        json.loads((cube_folder / "cube.results/summary.json").read_text())["steps"] == steps + 100
    )
