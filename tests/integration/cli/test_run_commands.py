"""Runs that a signal stops."""

from __future__ import annotations

import base64
import gzip
import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import pytest
from shared.cases import ENDLESS

sys.path.insert(0, str(Path(__file__).parents[3] / "tools/torture"))
from runs import CASE, run_words

pytestmark = pytest.mark.usefixtures("cube_folder")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_stops_with_a_checkpoint_and_the_run_goes_on(run_cli, cube_folder, number):
    (cube_folder / "cube.yaml").write_text(ENDLESS)
    words = ["run", "cube.yaml", "--threads", "1", "--set", "output.every=1000"]
    program = [sys.executable, "-c", "from cdem.cli import main; main()", *words]
    child = subprocess.Popen(program, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    lines = iter(child.stderr.readline, "")
    assert any(line.startswith("fall: t ") for line in lines)  # behind a warning
    time.sleep(0.3)
    child.send_signal(number)
    out, err = child.communicate(timeout=20)
    assert child.returncode == 4
    assert "stopped; results are in cube.results" in out
    assert "continue with: cdem run cube.yaml -o cube.results --resume" in err
    assert (
        json.loads((cube_folder / "cube.results/summary.json").read_text())["status"] == "stopped"
    )

    steps = json.loads((cube_folder / "cube.results/summary.json").read_text())["steps"]
    words += ["--set", f"stages.fall.max_steps={steps + 100}"]
    assert run_cli(*words, "--resume", "--quiet")[0] == 0
    assert (
        json.loads((cube_folder / "cube.results/summary.json").read_text())["steps"] == steps + 100
    )


@pytest.mark.parametrize(
    "mode", ["mode: dynamic, duration: 10000", "mode: static, tolerance: 1e-12"]
)
def test_ctrl_c_leaves_the_last_frame_and_the_report(cube_folder, mode):
    """Both of the moment of the stop, which comes long before the next frame is due."""
    text = ENDLESS.replace("mode: dynamic, duration: 10000", mode)
    text = text.replace('every: "1 ms"', "every: 1000")
    slow = "divisions: [16, 16, 16]"  # a stage of a minute
    text = text.replace("size: [1, 1, 1]", f"size: [1, 1, 1], {slow}")
    assert mode in text and "every: 1000" in text and slow in text
    (cube_folder / "cube.yaml").write_text(text)
    program = [sys.executable, "-c", "from cdem.cli import main; main()"]
    child = subprocess.Popen([*program, "run", "cube.yaml", "--threads", "1"],
                             stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)  # fmt: skip
    lines = iter(child.stderr.readline, "")
    assert any(line.startswith("fall: t ") for line in lines)  # behind warnings
    time.sleep(0.3)
    child.send_signal(signal.SIGINT)
    _, err = child.communicate(timeout=60)
    assert child.returncode == 4, err
    assert "Traceback" not in err and "no report" not in err
    results = cube_folder / "cube.results"
    summary = json.loads((results / "summary.json").read_text())
    assert summary["status"] == "stopped"
    for name in ("frames", "surface"):
        with h5py.File(results / f"{name}.vtkhdf") as file:
            times = file["VTKHDF/Steps/Values"][()]
            assert list(times) == [0.0, summary["time"]]
            fallen = file["VTKHDF/Points"][-1, 2]
    middle = summary["groups"]["cube"]["centroid"][2]
    assert fallen == pytest.approx(middle, abs=0.51)
    packed = re.search(r"H4sI[\w+/]+=*", (results / "report.html").read_text())  # gzip in base64
    raw = gzip.decompress(base64.b64decode(packed[0]))
    page = json.loads(raw[4 : 4 + int.from_bytes(raw[:4], "little")])
    assert page["times"] == [0.0, summary["time"]]
    assert "stopped" in json.dumps(page["facts"])


def test_an_energy_balance_that_does_not_close_ends_the_run(run_cli, tmp_path, monkeypatch):
    """Bonds break and blocks bounce in this case, so that it closes to some per mille."""
    monkeypatch.chdir(tmp_path)
    Path("case.yaml").write_text(CASE)
    words = run_words(Path("case.yaml"), Path("out"))
    status, out, err = run_cli(*words, "--set", "time.energy_error=1e-4")
    assert (status, out) == (3, "")
    assert "the energy balance is off by" in err and "time.energy_error allows (0.01 %)" in err
    assert json.loads(Path("out/summary.json").read_text())["status"] == "failed"
    assert run_cli(*words, "--overwrite", "--set", "time.energy_error=any")[0] == 0
    error = json.loads(Path("out/summary.json").read_text())["energies"]["error"]
    assert abs(error) > 1e-4
