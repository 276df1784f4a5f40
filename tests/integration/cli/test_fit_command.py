"""`cdem fit`: parameters from the table of a sweep, and one message for a mistake."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest
from shared.cases import FALL

from cdem.study.plan import plan
from cdem.study.samples import SAMPLES, to_keep
from cdem.study.study import Study
from cdem.whole_files import write_json

STUDY = """\
study: 1
case: cube.yaml
parameters:
  loads.gravity.2: {uniform: {low: -12, high: -6}, label: "gravity [m/s2]"}
  loads.gravity.0: {values: [0]}
sampling: {count: 14, seed: 2}
results: [fall]
"""
FIT = "fit: 1\ntitle: a fall\nstudy: study.yaml\nobserved: [{result: fall, value: -4.5, deviation: 0.1}]\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A study whose runs fell by half of gravity in the first second, in a folder with a space."""
    folder = tmp_path / "my fits"
    folder.mkdir()
    monkeypatch.chdir(folder)
    for name, text in (("cube.yaml", FALL), ("study.yaml", STUDY), ("fit.yaml", FIT)):
        Path(name).write_text(text)
    study, sweep = Study.load("study.yaml"), Path("study.sweep")
    sweep.mkdir()
    runs = plan(study, sweep)
    write_json(sweep / SAMPLES, to_keep(study, [run.parameters for run in runs]))
    write_json(sweep / "study.json", study.model_dump(mode="json", exclude_unset=True))
    for run in runs:
        result = {key: run.task[key] for key in ("name", "identity", "version", "parameters")}
        fall = 0.5 * run.parameters["loads.gravity.2"]
        result |= {"status": "finished", "summary": {"fall": fall}, "histories": {}}
        (sweep / "runs" / run.name).mkdir(parents=True)
        write_json(sweep / "runs" / run.name / "result.json", result | {"wall_time": 1.0})
    return folder


def test_the_parameter_is_found_with_its_band(run_cli, folder):
    status, out, err = run_cli("fit", "fit.yaml")
    assert (status, err) == (0, "")
    assert out.endswith("parameters.png\nfit.fit/observed.png\n")
    told = json.loads(Path("fit.fit/fit.json").read_text())
    assert told["title"] == "a fall" and told["runs"] == 14
    found = told["parameters"]["loads.gravity.2"]  # 2 x -4.5, 2 x 1.645 x 0.1
    assert found["median"] == pytest.approx(-9, abs=0.05)
    assert [found["low"], found["high"]] == pytest.approx([-9.33, -8.67], abs=0.06)
    assert told["observed"][0]["left_out_rms"] < 0.01
    with open("fit.fit/posterior.csv") as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["loads.gravity.2"]
    assert np.array(rows[1:], float).mean() == pytest.approx(-9, abs=0.05)
    assert Path("fit.fit/parameters.png").read_bytes().startswith(b"\x89PNG")


def test_json_and_the_folder_of_the_user(run_cli, folder):
    status, out, _ = run_cli("fit", "fit.yaml", "-o", "here", "--json")
    assert status == 0 and json.loads(out)["runs"] == 14
    assert (folder / "here" / "fit.json").is_file()


@pytest.mark.parametrize(
    "old, new, message",
    [
        ("study: study.yaml", "study: none.yaml", "none.yaml: "),
        ("observed", "sweep: other\nobserved", "other: holds no sweep; run cdem sweep"),
        (
            "result: fall",
            "result: fell",
            "fit.yaml:4:.*no column fell in the table of the study; it has:.* fall",
        ),
        (
            "{result: fall, value: -4.5",
            "{runout: reach, value: 4",
            "write keep: true in study.yaml",
        ),
        ("deviation: 0.1", "deviation: 0.1, x: 1", "fit.yaml:4:.*x: unknown key"),
        ("[{result: fall, value: -4.5, deviation: 0.1}]", "[]", "at least 1 entry"),
        ("fit: 1", "fit: 2", "must be 1"),
    ],
)
def test_a_mistake_is_one_message(run_cli, folder, old, new, message):
    Path("fit.yaml").write_text(FIT.replace(old, new))
    status, out, err = run_cli("fit", "fit.yaml")
    assert status == 1 and not out
    assert len(err.strip().splitlines()) == 1
    assert re.search(message, err)


def test_an_empty_file_is_one_message(run_cli, folder):
    Path("fit.yaml").write_text("")
    assert (
        run_cli("fit", "fit.yaml")[2] == "fit.yaml: the file is empty; see docs/observations.md\n"
    )


def test_too_few_runs_are_told_with_their_number(run_cli, folder):
    for path in sorted(Path("study.sweep/runs").iterdir())[4:]:
        (path / "result.json").unlink()
    status, _, err = run_cli("fit", "fit.yaml")
    assert status == 1
    assert "4 runs can be used; 1 parameters need at least 5, better 10" in err
    assert "10 of 14 runs have no result yet" in err
