"""The program: exit statuses, what is printed where, and what is written."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time

import h5py
import meshio
import pytest

from cdem import Case, __version__
from cdem.cli import run_commands
from cdem.run.progress import Progress, describe
from cdem.tools import doctor

CASE = """\
title: A cube falls
model: {blocks: [{group: cube, box: {size: [1, 1, 1]}}]}
materials: {rock: {density: 2700, young_modulus: "1 GPa", poisson_ratio: 0.25}}
groups: {cube: {material: rock}}
interfaces: {default: {friction_angle: 30}}
loads: {gravity: [0, 0, -10]}
stages: [{name: fall, mode: dynamic, duration: "5 ms"}]
output: {every: "1 ms"}
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cube.yaml").write_text(CASE)
    return tmp_path


@pytest.fixture(autouse=True)
def no_pictures(folder, monkeypatch):
    monkeypatch.setattr(
        run_commands, "write_report", lambda folder, silent: None
    )  # they take seconds


def test_version_and_help(cdem):
    assert cdem("--version") == (0, f"cdem {__version__}\n", "")
    status, out, _ = cdem("--help")
    assert status == 0
    verbs = (
        "new",
        "check",
        "run",
        "info",
        "plot",
        "render",
        "runout",
        "export",
        "schema",
        "doctor",
    )
    for verb in verbs:
        assert f"  {verb} " in out


@pytest.mark.parametrize(
    "words",
    [
        ["fly"],
        ["run"],
        ["run", "cube.yaml", "--fast"],
        ["run", "cube.yaml", "--threads", "0"],
        ["run", "cube.yaml", "--device", "abacus"],
        ["run", "cube.yaml", "--resume", "--overwrite"],
        ["run", "cube.yaml", "--quiet", "--json"],
        ["export", "cube.results", "--to", "doc"],
        ["new", "inclin"],
    ],
)
def test_wrong_usage_is_status_2(cdem, words):
    status, out, err = cdem(*words)
    assert (status, out) == (2, "")
    assert "Traceback" not in err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["check", "none.yaml"], "none.yaml: cannot read the case file: No such file"),
        (["check", "cube.yaml", "--set", "loads.gravty=0"], "loads.gravty: unknown key; did you"),
        (["run", "cube.yaml", "--set", "stages=[]"], "stages: needs at least 1 entry, got 0"),
        (["run", "cube.yaml", "--device", "cuda"], "only cpu can run cases"),
        (["run", "cube.yaml", "--resume"], "no checkpoint to resume from"),
        (["run", "cube.yaml", "-o", "cube.yaml"], "cube.yaml: is a file"),
        (["info", "nowhere"], "nowhere: no such folder"),
        (["plot", "."], ".: is not a result folder"),
    ],
)
def test_wrong_input_is_status_1_and_one_message(cdem, folder, words, message):
    status, out, err = cdem(*words)
    assert (status, out) == (1, "")
    assert message in err
    assert err.count("\n") == 1
    assert [path.name for path in folder.iterdir()] == ["cube.yaml"]  # nothing was written


def test_check_reports_and_changes_nothing(cdem, folder):
    status, out, _ = cdem("check", "cube.yaml")
    assert status == 0
    assert "A cube falls" in out
    assert json.loads(cdem("check", "cube.yaml", "--json")[1])["counts"]["nodes"] == 8
    assert [path.name for path in folder.iterdir()] == ["cube.yaml"]


def test_run_writes_its_folder_and_guards_it(cdem, folder):
    status, out, err = cdem("run", "cube.yaml", "--threads", "1")
    assert (status, out) == (0, "finished; results are in cube.results\n")
    assert err.startswith("fall: t ")
    summary = json.loads((folder / "cube.results/summary.json").read_text())
    assert summary["status"] == "finished"
    assert Case.load(folder / "cube.results/case.yaml").stages[0].duration == 0.005

    status, out, err = cdem("run", "cube.yaml")
    assert status == 1
    assert "exists already; use --overwrite to replace it, --resume to go on" in err
    assert cdem("run", "cube.yaml", "--overwrite", "--quiet") == (0, "", "")


def test_json_is_all_that_is_on_stdout(cdem):
    status, out, err = cdem("run", "cube.yaml", "--json", "-o", "a")
    assert (status, err) == (0, "")
    assert json.loads(out)["groups"]["cube"]["mass"] == pytest.approx(2700)


def test_a_folder_of_other_things_is_never_overwritten(cdem, folder):
    (folder / "mine").mkdir()
    (folder / "mine/thesis.tex").touch()
    status, _, err = cdem("run", "cube.yaml", "-o", "mine", "--overwrite")
    assert status == 1
    assert "is not a result folder, so it is not overwritten" in err
    assert (folder / "mine/thesis.tex").exists()


def test_resuming_with_another_case_is_said(cdem):
    assert cdem("run", "cube.yaml", "--quiet")[0] == 0
    status, _, err = cdem("run", "cube.yaml", "--resume", "--set", "title=Other")
    assert status == 0
    assert "warning: this is not the case that cube.results was begun with: - title: A cube" in err


def test_a_checkpoint_of_another_mesh_is_refused(cdem):
    """As many nodes, at other places."""
    assert cdem("run", "cube.yaml", "--quiet")[0] == 0
    status, _, err = cdem(
        "run", "cube.yaml", "--resume", "--set", "model.blocks.0.box.size=[1, 1, 1.5]"
    )
    assert status == 1
    assert "belongs to another model, with other elements or groups, or whose nodes" in err


def test_a_checkpoint_of_other_elements_between_the_same_nodes_is_refused(cdem, tmp_path):
    """A block of two wedges, cut along the other diagonal of its top."""
    points = [[x, y, z] for z in (0, 1) for x, y in [(0, 0), (1, 0), (1, 1), (0, 1)]]
    for name, (a, b) in {"one": ([0, 1, 2], [0, 2, 3]), "other": ([0, 1, 3], [1, 2, 3])}.items():
        wedges = [[*a, *(i + 4 for i in a)], [*b, *(i + 4 for i in b)]]
        meshio.write_points_cells(tmp_path / f"{name}.vtk", points, [("wedge", wedges)])
    block = "blocks: [{group: cube, box: {size: [1, 1, 1]}}]"
    text = CASE.replace(block, "mesh: one.vtk").replace("{cube:", "{default:")
    (tmp_path / "cube.yaml").write_text(text)
    assert cdem("run", "cube.yaml", "--quiet")[0] == 0
    status, _, err = cdem("run", "cube.yaml", "--resume", "--set", "model.mesh=other.vtk")
    assert status == 1
    assert "with other elements or groups" in err
    assert cdem("run", "cube.yaml", "--resume", "--quiet")[0] == 0


def test_a_checkpoint_of_another_version_is_refused_in_one_line(cdem, folder):
    assert cdem("run", "cube.yaml", "--quiet")[0] == 0
    with h5py.File(folder / "cube.results/checkpoint.h5", "r+") as file:
        kept = json.loads(file["attributes"][()])
        del kept["core"]["dt_stable"], file["attributes"], file["spring/state"]
        file["attributes"] = json.dumps(kept)
    status, out, err = cdem("run", "cube.yaml", "--resume")
    assert (status, out) == (1, "")
    assert "written by another version of cdem" in err
    assert "dt_stable" in err and "spring.state" in err
    assert "Traceback" not in err


def test_a_failed_run_is_status_3(cdem, folder):
    # An initial speed above that of a P wave is taken for a runaway.
    status, out, err = cdem("run", "cube.yaml", "--set", "groups.cube.velocity=[1e6, 0, 0]")
    assert (status, out) == (3, "")
    assert "Traceback" not in err
    assert json.loads((folder / "cube.results/summary.json").read_text())["status"] == "failed"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_stops_with_a_checkpoint_and_the_run_goes_on(cdem, folder, number):
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
    assert json.loads((folder / "cube.results/summary.json").read_text())["status"] == "stopped"

    steps = json.loads((folder / "cube.results/summary.json").read_text())["steps"]
    words += ["--set", f"stages.fall.max_steps={steps + 100}"]
    assert cdem(*words, "--resume", "--quiet")[0] == 0
    assert json.loads((folder / "cube.results/summary.json").read_text())["steps"] == steps + 100


def test_new_lists_and_writes_templates(cdem, folder):
    status, out, _ = cdem("new")
    assert status == 0
    names = [line.split()[0] for line in out.splitlines()]
    assert names == ["incline", "landslide", "safety", "slope", "wall"]
    for name in names:
        assert cdem("new", name, "cases")[0] == 0
        case = Case.load(folder / "cases" / f"{name}.yaml")
        assert case.title
    assert (folder / "cases/slope.msh").exists()
    status, _, err = cdem("new", "incline", "cases")
    assert status == 1
    assert "cases/incline.yaml: exists already; use --force" in err
    assert cdem("new", "incline", "cases", "--force")[0] == 0
    assert "did you mean incline?" in cdem("new", "inclin")[2]


@pytest.mark.parametrize("name", ["incline", "wall", "slope", "safety", "landslide"])
def test_templates_check(cdem, name):
    cdem("new", name)
    status, out, err = cdem("check", f"{name}.yaml")
    assert (status, err) == (0, "")
    assert "warning" not in out


def test_schema_is_json(cdem):
    status, out, _ = cdem("schema")
    assert status == 0
    assert "materials" in json.loads(out)["properties"]
    assert "parameters" in json.loads(cdem("schema", "study")[1])["properties"]


def test_doctor_says_what_works(cdem, monkeypatch):
    monkeypatch.setattr(doctor, "_opengl", lambda: "not tried")  # takes seconds
    status, out, _ = cdem("doctor")
    assert status == 0
    assert f"cdem      {__version__}" in out
    assert " is used; built for " in out


def test_the_progress_line_says_it_all():
    progress = Progress(
        "slide", 0.5, 2.0, 12345, 1e-5, 3e-3, 1e-4, 42, 1500.0, 3725.0, 0.25, "a word"
    )
    assert describe(progress) == (
        "slide: t 0.5 of 2 s, step 12,345, dt 1e-05 s, unbalance 0.003, energy error 1.0e-04, "
        "broken 42, 1,500 steps/s, 1:02:05 left, a word"
    )


def test_import_and_help_are_fast():
    code = "import sys, cdem, cdem.cli; print(*sorted(sys.modules))"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    heavy = {"numpy", "h5py", "pydantic", "ruamel.yaml", "meshio", "matplotlib", "pyvista"}
    assert heavy & set(out.stdout.split()) == set()


def test_benchmark_rows_say_what_was_measured(monkeypatch):
    from cdem.tools import benchmark

    monkeypatch.setattr(benchmark, "SECONDS", 1e-4)
    monkeypatch.setattr(benchmark, "TRIAD_BYTES", 3_000_000)
    rubble, search = benchmark.rubble(1, 1)
    broken = benchmark.tets_broken(2, 1)
    assert broken.more["broken [%]"] > 0
    shared, bonded = benchmark.tets_shared(2, 1), benchmark.tets_bonded(2, 1)
    for row in (shared, bonded, broken, benchmark.mixed(1, 1), rubble):
        assert 0 < row.least <= row.rate <= row.most
        assert sum(v for k, v in row.more.items() if k.split()[0] in benchmark.PHASES) == (
            pytest.approx(100)
        )
        assert row.name in row.text()
    assert search.rate > rubble.rate
    assert search.more["lists [us per spring and refresh]"] > 0
    limits = benchmark.machine(2)
    assert limits["bandwidth, 2 threads"] > 1e8
    assert limits["multiply-adds, 1 threads"] > 1e8


def test_only_what_can_touch_needs_an_interface(cdem, folder):
    alone = CASE.replace("interfaces: {default: {friction_angle: 30}}\n", "")
    (folder / "alone.yaml").write_text(alone)
    assert cdem("check", "alone.yaml")[0] == 0
    second = ", {group: cube, box: {size: [1, 1, 1]}, translate: [3, 0, 0]}]}"
    (folder / "two.yaml").write_text(alone.replace("]}}]}", "]}}" + second))
    status, _, err = cdem("check", "two.yaml")
    assert status == 1
    assert "may come to touch" in err
