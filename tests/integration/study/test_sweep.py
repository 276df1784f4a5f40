"""Sweeps: each run once, whatever is killed; the same results as `cdem run`; table and plots."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from shared.cases import STUDY, SWEPT

from cdem.errors import BackendError, CaseError
from cdem.study.plots import effects
from cdem.study.study import Study
from cdem.study.sweep import run_study

psutil = pytest.importorskip("psutil")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cube.yaml").write_text(SWEPT)
    (tmp_path / "study.yaml").write_text(STUDY)
    return tmp_path


@pytest.fixture(scope="module")
def cluster():
    """A scheduler with two workers, each a process of its own."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50
    ) as cluster:
        yield cluster


def results_of(folder: Path) -> dict[str, float]:
    """When each result was written."""
    return {p.parent.name: p.stat().st_mtime for p in folder.glob("runs/*/result.json")}


def slow(folder: Path, seconds: float) -> None:
    """Make each of six runs take about as long."""
    case = SWEPT.replace("duration: 0.05", f"duration: {10 * seconds}")
    (folder / "cube.yaml").write_text(case.replace("frames: false", "frames: false, every: 100"))
    (folder / "study.yaml").write_text(
        "case: cube.yaml\nparameters: {groups.cube.velocity.0: [1, 2, 3, 4, 5, 6]}"
    )


def test_a_sweep_goes_on_with_the_values_that_it_has_drawn(folder, monkeypatch):
    """Another SciPy draws others."""
    (folder / "study.yaml").write_text(
        "case: cube.yaml\nparameters: {groups.cube.velocity.0: {uniform: {low: 1, high: 2}}}\n"
        "sampling: {count: 2}"
    )
    first = run_study("study.yaml", "out", workers=2)
    written = results_of(Path("out"))
    monkeypatch.setattr("cdem.study.samples.draw", lambda *_: pytest.fail("drawn again"))
    again = run_study("study.yaml", "out", workers=2)
    assert [run.parameters for run in again.runs] == [run.parameters for run in first.runs]
    assert results_of(Path("out")) == written and len(written) == 2


def test_a_sweep_from_the_command_line(run_cli, folder, no_report):
    """Two of six runs fail, the others are those of `cdem run`; asked again, nothing is repeated."""
    status, out, err = run_cli("sweep", "study.yaml", "--workers", "2", "-o", "out")
    assert status == 3
    assert err.count("failed: ") == 2 and "moves at 1e+06 m/s" in err
    assert "6 of 6 runs, 2 failed" in err and "dashboard" not in err
    rows = list(csv.DictReader((folder / "out/table.csv").open()))
    assert [row["status"] for row in rows] == ["finished"] * 4 + ["failed"] * 2
    assert [row["interfaces.default.cohesion [kPa]"] for row in rows] == ["1", "2"] * 3
    for name in ("lines-way", "map-way", "tornado-way"):
        assert f"-{name}" in out

    # the run with 1 m/s and 2 kPa, to the bit
    words = ["--set", "groups.cube.velocity.0=1", "--set", "interfaces.default.cohesion=2 kPa"]
    assert run_cli("run", "cube.yaml", *words, "--quiet", "--threads", "2")[0] == 0
    there = json.loads((folder / "cube.results/summary.json").read_text())
    here = json.loads((folder / "out/runs" / rows[3]["run"] / "results/summary.json").read_text())
    for key in ("groups", "energies", "steps", "unbalance_ratio"):
        assert here[key] == there[key]
    assert float(rows[3]["way"]) == there["groups"]["cube"]["displacement"][0]
    assert float(rows[3]["both"]) == float(rows[3]["way"]) + float(rows[3]["drop"])
    last = (folder / "cube.results/histories.csv").read_text().splitlines()[-1].split(",")
    assert rows[3]["drop"] == last[-1]

    written = results_of(folder / "out")
    status, out, err = run_cli("sweep", "study.yaml", "-o", "out", "--json")
    assert status == 3
    assert results_of(folder / "out") == written and len(written) == 6
    told = json.loads(out)
    assert told["failed"] == 2 and told["runs"][3]["way"] == float(rows[3]["way"])


def test_critical_values_with_a_scheduler(folder, cluster):
    """F = tan(phi) / tan(30 deg); a study of it also asks for what the case cannot give."""
    (folder / "block.yaml").write_text(
        (Path(sys.modules["cdem"].__file__).parent / "templates/safety.yaml").read_text()
    )
    study = Study(
        case="block.yaml",
        parameters={"interfaces.default.friction_angle": [35, 45]},
        set={"stages": [{"name": "decide", "mode": "static", "relax": "adaptive"}]},
        critical={"factor": True, "between": ["= 1", 2], "tolerance": 0.1},
        results={"F": "value", "theory": "= tan(interfaces.default.friction_angle) / tan(30)"},
    )
    table = run_study(study, "out", scheduler=cluster.scheduler_address)
    assert not table.failed
    assert table.column("F") == pytest.approx(table.column("theory"), abs=0.05)
    low, high = effects(table, "F")["interfaces.default.friction_angle"]
    assert (low, high) == (table.column("F")[0], table.column("F")[1])


def test_wrong_result_names_stop_a_sweep_and_lose_nothing(folder, cluster):
    text = STUDY.replace("way: groups", "way: grops").replace("keep: true\n", "")
    (folder / "study.yaml").write_text(text)
    with pytest.raises(CaseError, match=r"study.yaml:5:11: .*did you mean groups.cube.displacem"):
        run_study("study.yaml", "out", scheduler=cluster.scheduler_address)
    assert results_of(folder / "out")


def test_a_worker_that_is_killed_is_replaced(folder, cluster):
    slow(folder, 0.25)
    killed: list[int] = []

    def kill_one() -> bool:
        if not killed and results_of(folder / "out"):
            killed.append(next(iter(cluster.workers.values())).pid)
            os.kill(killed[0], signal.SIGKILL)
        return False

    address = cluster.scheduler_address
    table = run_study("study.yaml", "out", scheduler=address, should_stop=kill_one)
    assert killed and not table.failed and not table.waiting
    assert len(results_of(folder / "out")) == 6


def test_a_scheduler_that_is_killed_is_said_and_the_sweep_goes_on(folder, cluster):
    from distributed import LocalCluster

    slow(folder, 0.25)

    def end() -> bool:
        if results_of(folder / "out"):
            lost.close()
        return False

    with LocalCluster(n_workers=1, dashboard_address=":0", silence_logs=50) as lost:
        address = lost.scheduler_address
        with pytest.raises(
            BackendError, match="scheduler no longer answers; finished runs are kept"
        ):
            run_study("study.yaml", "out", scheduler=address, should_stop=end)
    before = results_of(folder / "out")
    assert 1 <= len(before) < 6
    assert not run_study("study.yaml", "out", scheduler=cluster.scheduler_address).waiting
    after = results_of(folder / "out")
    assert len(after) == 6 and before.items() <= after.items()


def test_a_local_worker_that_is_killed_is_replaced(folder):
    slow(folder, 0.25)
    killed: list[int] = []

    def kill_one() -> bool:
        if not killed and results_of(folder / "out"):
            killed.append(psutil.Process().children()[0].pid)
            os.kill(killed[0], signal.SIGKILL)
        return False

    table = run_study("study.yaml", "out", workers=2, should_stop=kill_one)
    assert killed and not table.failed and not table.waiting
    assert len(results_of(folder / "out")) == 6


def test_workers_import_nothing_from_the_current_folder(folder):
    """A stranger's folder has modules of names that workers import."""
    (folder / "study.yaml").write_text("case: cube.yaml\nparameters: {groups.cube.velocity.0: [1]}")
    for name in ("json", "pickle", "numpy", "multiprocessing", "sitecustomize", "cdem"):
        (folder / f"{name}.py").write_text(f"open({str(folder / 'ran')!r}, 'w')")
    program = [sys.executable, "-I", "-c", "from cdem.cli import main; main()"]
    command = [*program, "sweep", "study.yaml", "--workers", "1", "-o", "out"]
    subprocess.run(command, check=True, capture_output=True)
    assert len(results_of(folder / "out")) == 1 and not (folder / "ran").exists()


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_a_sweep_that_is_killed_goes_on(folder, cluster, number):
    """What was finished is not repeated; no worker stays behind."""
    slow(folder, 0.25)
    program = [sys.executable, "-c", "from cdem.cli import main; main()"]
    child = subprocess.Popen(
        [*program, "sweep", "study.yaml", "--workers", "2", "-o", "out"],
        start_new_session=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    while not results_of(folder / "out"):
        assert child.poll() is None
        time.sleep(0.05)
    workers = psutil.Process(child.pid).children(recursive=True)
    assert len(workers) == 2
    for process in (psutil.Process(child.pid), *workers):  # nobody can enter
        assert process.net_connections(kind="inet") == []
    if number == signal.SIGKILL:
        child.kill()
    else:
        os.killpg(child.pid, number)  # as a terminal does
    _, err = child.communicate(timeout=30)
    if number == signal.SIGINT:
        assert child.returncode == 4 and "the same command continues" in err
        assert "Traceback" not in err
    assert not psutil.wait_procs(workers, timeout=10)[1]
    before = results_of(folder / "out")
    assert 1 <= len(before) < 6
    assert not run_study("study.yaml", "out", scheduler=cluster.scheduler_address).waiting
    after = results_of(folder / "out")
    assert len(after) == 6 and before.items() <= after.items()
