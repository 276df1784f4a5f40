"""Runs that end in the middle, and go on: to the same bytes, or with a word on what is lost."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import pytest

import cdem
from cdem.errors import CdemError
from cdem.output.reader import FrameSeries, SurfaceSeries
from cdem.run.checkpoint import read_checkpoint, write_checkpoint

sys.path.insert(0, str(Path(__file__).parents[3] / "tools/torture"))
from runs import CASE, differences, run_words

TOOLS = Path(__file__).parents[3] / "tools/torture"
pytestmark = pytest.mark.usefixtures("no_report")
WORDS = run_words(Path("case.yaml"), Path("out"))
PROGRAM = [sys.executable, "-c", "from cdem.cli import main; main()"]


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """A working folder with case.yaml: two stages in which blocks fall and break."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.yaml").write_text(CASE)
    return tmp_path


@pytest.fixture(scope="module")
def stop(tmp_path_factory) -> Path:
    """A result folder of a run that stopped in the middle of its second stage. None changes it."""
    folder = tmp_path_factory.mktemp("stop")
    (folder / "case.yaml").write_text(CASE)
    simulation = cdem.Simulation(folder / "case.yaml", threads=1, output=folder / "out")
    simulation.run_stage("rest")
    left = iter([False, False, True])
    assert simulation.run(should_stop=lambda: next(left)) == "stopped"
    simulation.close()
    return folder / "out"


@pytest.fixture
def stopped(folder, stop) -> Path:
    """A copy of it that a test may change."""
    return Path(shutil.copytree(stop, folder / "out"))


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """A result folder of a run without a stop. None changes it."""
    folder = tmp_path_factory.mktemp("whole")
    (folder / "case.yaml").write_text(CASE)
    cdem.Simulation(folder / "case.yaml", threads=1, output=folder / "whole").run()
    return folder / "whole"


def summary_of(results: Path) -> dict:
    return json.loads((results / "summary.json").read_text())


@pytest.mark.parametrize("stages", [["rest"], ["rest", "fall"], ["rest", "fall", "last"]])
def test_a_run_that_ended_right_after_a_stage_goes_on_to_the_same_bytes(folder, whole, stages):
    """What a history row needs of the step before is in the checkpoint, too."""
    simulation = cdem.Simulation(folder / "case.yaml", threads=1, output=folder / "out")
    for stage in stages:
        simulation.run_stage(stage)
    simulation.close()
    cdem.Simulation(folder / "case.yaml", threads=1, output=folder / "out", resume=True).run()
    assert differences(whole, folder / "out") == []


def test_a_stopped_run_goes_on_to_the_same_bytes(run_cli, whole, stopped):
    assert run_cli(*WORDS, "--resume") == (0, "", "")
    assert differences(whole, stopped) == []


def as_stored_before(text: str) -> str:
    """The case of a run, as JSON or YAML, as it was stored when `cdem: 1` chose what are keys now."""
    for new, old in {
        "cdem: 2": "cdem: 1", '"cdem":2': '"cdem":1',
        "stiffness_n: 10.0 E/h": "stiffness_n: auto", "stiffness_s: 10.0 E/h": "stiffness_s: auto",
        '"stiffness_n":"10.0 E/h"': '"stiffness_n":"auto"', '"stiffness_s":"10.0 E/h"': '"stiffness_s":"auto"',
        "mass: exact": "mass: auto", '"mass":"exact"': '"mass":"auto"',
        "      cells: alike\n": "", ',"cells":"alike"': "", ',"cells":null': "",
    }.items():  # fmt: skip
        text = text.replace(new, old)
    assert "E/h" not in text and "cells" not in text and "exact" not in text
    return text


@pytest.mark.parametrize("case", ["case.yaml", "out/case.yaml"])
def test_a_run_of_an_old_case_goes_on_to_the_same_bytes(run_cli, folder, case):
    """With the keys in the case, or with the case that it has stored itself."""
    text = CASE.replace("divisions: [2, 1, 2]", "divisions: [2, 1, 2], shape: tet4, cells: alike")
    (folder / "case.yaml").write_text(text)
    simulation = cdem.Simulation(folder / "case.yaml", threads=1, output=folder / "out")
    simulation.run_stage("rest")
    simulation.close()
    arrays, attributes = read_checkpoint(folder / "out/checkpoint.h5")
    write_checkpoint(folder / "out", arrays, as_stored_before(attributes.decode()))
    stored = folder / "out/case.yaml"
    stored.write_text(as_stored_before(stored.read_text()))
    assert run_cli("run", case, *WORDS[2:], "--resume") == (0, "", "")
    cdem.Simulation(folder / "case.yaml", threads=1, output=folder / "whole").run()
    assert differences(folder / "whole", folder / "out") == []


def test_a_run_that_has_ended_is_left_as_it_is(run_cli, folder):
    assert run_cli(*WORDS)[0] == 0
    before = {p: (p.stat().st_mtime_ns, p.read_bytes()) for p in Path("out").rglob("*.*[a-z5]")}
    status, out, _ = run_cli(*WORDS[:-1], "--resume")
    assert (status, out) == (0, "finished; results are in out\n")
    del before[Path("out/.cdem-results")]  # says who looked last
    assert {p: (p.stat().st_mtime_ns, p.read_bytes()) for p in before} == before


def test_a_longer_duration_takes_effect_also_when_the_run_had_ended(run_cli, folder):
    """Rows until then are those of the longer run."""
    assert run_cli(*WORDS)[0] == 0
    longer = ("--set", "stages.last.duration=4 ms")
    status, _, err = run_cli(*WORDS[:-1], "--resume", *longer)
    assert status == 0
    assert "stages.2.duration changes from 0.002 to 0.004" in err
    assert "stages.2.duration changes" in Path("out/run.log").read_text()
    words = run_words(Path("case.yaml"), Path("whole"))
    assert run_cli(*words, *longer)[0] == 0
    assert summary_of(Path("out"))["time"] == summary_of(Path("whole"))["time"]
    rows = [Path(f"{name}/histories.csv").read_text().splitlines() for name in ("out", "whole")]
    assert rows[0][-1] == rows[1][-1] and set(rows[1]) <= set(rows[0])


@pytest.mark.parametrize(
    ("setting", "place"),
    [
        ("materials.rock.young_modulus=10 GPa", "young_modulus: is 10000000000.0, but the run was"),
        ("materials.rock.density=5200", "materials.rock.density: is 5200.0"),
        ("stages.0.max_steps=50", "stages.0.max_steps: is 50"),
        ("output.fields=[stress]", "output.fields"),
    ],
)
def test_another_case_is_refused_with_the_key_unless_forced(run_cli, stopped, setting, place):
    status, out, err = run_cli(*WORDS, "--resume", "--set", setting)
    assert (status, out) == (1, "") and place in err and "--force" in err
    assert run_cli(*WORDS, "--resume")[0] == 0  # and nothing has been spoiled


def test_a_forced_change_is_logged(run_cli, stopped):
    setting = "materials.rock.young_modulus=2 GPa"
    status, _, err = run_cli(*WORDS[:-1], "--resume", "--force", "--set", setting)
    assert status == 0 and "in the middle of the run (--force)" in err
    assert "in the middle of the run (--force)" in (stopped / "run.log").read_text()


def test_the_checkpoint_before_is_used_when_the_last_is_damaged(run_cli, whole, stopped):
    path = stopped / "checkpoint.h5"
    content = bytearray(path.read_bytes())
    content[-100] ^= 1
    path.write_bytes(content)
    status, _, err = run_cli(*WORDS[:-1], "--resume")
    assert status == 0
    assert (
        "checkpoint.h5: is damaged (its checksum is wrong); continuing from the previous one" in err
    )
    assert differences(whole, stopped) == []


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("rows", "stage: Value error, not the values of a StageState"),
        ("name", "its stage 'junk'"),
        ("all", "it is neither in a stage nor after one"),
    ],
)
def test_a_stage_without_a_value_or_of_another_case_is_damage(run_cli, stopped, value, said):
    for name in ("checkpoint.h5", "checkpoint-before.h5"):
        arrays, text = read_checkpoint(stopped / name)
        attributes = json.loads(text)
        attributes["stage"].pop(value, None)
        if value == "all":
            attributes["stage"] = None
        if value == "name":
            attributes["stage"]["name"] = "junk"
        write_checkpoint(stopped, arrays, json.dumps(attributes))
    status, out, err = run_cli(*WORDS, "--resume")
    assert (status, out) == (1, "") and said in err and err.count("\n") == 1


def test_two_damaged_checkpoints_are_one_message(run_cli, stopped):
    for name in ("checkpoint.h5", "checkpoint-before.h5"):
        (stopped / name).write_bytes(b"junk")
    status, out, err = run_cli(*WORDS, "--resume")
    assert (status, out) == (1, "") and err.count("is damaged") == 2 and err.count("\n") == 1


def test_lost_tails_of_histories_and_frames_are_told_and_the_run_goes_on(run_cli, whole, stopped):
    """As after a power cut on a disk that lies about what it has stored."""
    rows = (stopped / "histories.csv").read_text().splitlines(keepends=True)
    (stopped / "histories.csv").write_text("".join(rows[:-2]) + rows[-2][:10])
    (stopped / "frames/frame-0001.vtkhdf").write_bytes(b"")
    (stopped / "surface/frame-0001.vtkhdf").unlink()
    status, _, err = run_cli(*WORDS[:-1], "--resume")
    assert status == 0
    assert "histories.csv: 2 rows are lost" in err
    assert "frames.vtkhdf: frames 1 are lost" in err and "surface.vtkhdf: frames 1" in err
    assert set(differences(whole, stopped)) == {
        "surface/frame-0001.vtkhdf is in one only",
        "checkpoint.h5 differs",  # it counts the rows
        "frames.vtkhdf differs",
        "frames/frame-0001.vtkhdf differs",
        "histories.csv differs",
        "surface.vtkhdf differs",
    }


@pytest.mark.parametrize("series", ["frames", "surface"])
def test_a_flipped_bit_of_a_frame_is_told_at_resume_and_when_it_is_read(run_cli, stopped, series):
    path = stopped / series / "frame-0001.vtkhdf"
    with h5py.File(path) as file:
        place = file["VTKHDF/Points"].id.get_chunk_info(0).byte_offset
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)
    status, _, err = run_cli(*WORDS[:-1], "--resume")
    assert status == 0 and "Traceback" not in err
    assert f"{series}.vtkhdf: frames 1 are lost" in err
    assert "move those files out of" in err
    frames = FrameSeries(stopped) if series == "frames" else SurfaceSeries(stopped)
    with pytest.raises(CdemError, match=r"frame-0001.vtkhdf: is damaged .* move it away"):
        frames.points(1) if isinstance(frames, FrameSeries) else frames[1]
    path.unlink()
    assert len((FrameSeries if series == "frames" else SurfaceSeries)(stopped)) == len(frames) - 1


def test_a_flipped_bit_of_a_history_is_told_and_its_row_is_lost(run_cli, whole, stopped):
    path = stopped / "histories.csv"
    lines = path.read_bytes().splitlines(keepends=True)
    lines[1] = bytes([lines[1][0] ^ 1]) + lines[1][1:]  # a digit becomes another
    path.write_bytes(b"".join(lines))
    status, _, err = run_cli(*WORDS[:-1], "--resume")
    assert status == 0 and "histories.csv: 1 rows are lost" in err
    rows = (whole / "histories.csv").read_bytes().splitlines()
    assert path.read_bytes().splitlines() == [rows[0], *rows[2:]]


def test_two_runs_cannot_write_into_one_folder(run_cli, folder):
    words = [*WORDS, "--set", "stages.fall.duration=1000", "--set", "output.every=1000"]
    words += ["--set", "output.checkpoint_every=0.01"]
    with subprocess.Popen([*PROGRAM, *words]) as run:
        try:
            deadline = time.monotonic() + 60
            while not Path("out/checkpoint.h5").is_file():
                assert time.monotonic() < deadline and run.poll() is None
                time.sleep(0.02)
            for way in ("--resume", "--overwrite"):
                status, out, err = run_cli(*WORDS, way)
                assert (status, out) == (1, "")
                assert f"out: a run is writing into this folder (process {run.pid} on " in err
        finally:
            os.kill(run.pid, signal.SIGKILL)
    assert run_cli(*WORDS, "--resume", "--set", "stages.fall.duration=6 ms")[0] == 0


def test_a_failed_start_lets_go_of_the_folder(stopped, folder):
    settings = ["materials.rock.density=5200", "time.energy_error=any"]
    case = cdem.Case.load(folder / "case.yaml", settings)
    with pytest.raises(cdem.CdemError, match="density") as refused:
        cdem.Simulation(case, output=stopped, resume=True)
    assert refused  # its traceback still holds the simulation
    assert cdem.Simulation(case, output=stopped, resume=True, force=True).run() == "finished"


def test_a_full_disk_is_one_message_and_the_run_can_go_on(run_cli, folder, whole):
    """A limit on the size of files has the same effect on each of them."""
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (90_000, -1))"
    program = [sys.executable, "-c", f"{limit}; from cdem.cli import main; main()"]
    done = subprocess.run([*program, *WORDS], capture_output=True, text=True, check=False)
    assert done.returncode == 1 and done.stdout == ""
    assert "checkpoint.h5: cannot be written (File too large). Free disk space" in done.stderr
    assert done.stderr.count("\n") == 1
    assert run_cli(*WORDS, "--overwrite")[0] == 0
    assert differences(whole, Path("out")) == []


@pytest.mark.skipif(sys.platform != "linux", reason="the shim is for Linux")
@pytest.mark.parametrize("how", ["kill", pytest.param("ENOSPC", marks=pytest.mark.slow)])
def test_a_fault_in_any_call_leaves_a_folder_that_opens_and_resumes(how):
    """A few of the calls; `make torture` tries all of them. A full disk is tried above, too."""
    pytest.importorskip("vtk")
    command = [sys.executable, str(TOOLS / "faults.py"), "--every", "997"]
    command += ["--how", how]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow  # quick: test_checkpoint.py, test_strange_checkpoints.py
def test_damaged_checkpoints_neither_crash_nor_pass():
    """A few damages; `make torture` tries thousands."""
    command = [sys.executable, str(TOOLS / "damage.py"), "--bits", "49", "--bends", "12"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
