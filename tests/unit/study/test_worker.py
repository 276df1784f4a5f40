"""One run on a worker."""

from __future__ import annotations

import pytest

from cdem.case.case import Case
from cdem.errors import BackendError
from cdem.run.simulation import Simulation
from cdem.study.plan import plan
from cdem.study.worker import execute

RASTER = "ncols 3\nnrows 3\nxllcorner -3\nyllcorner -3\ncellsize 3\n" + "{0} {0} {0}\n" * 3
WET = """
water:
  fields: [{name: table, surface: low.asc, wet: always}]
"""
LATER = "stages: [{name: fall, mode: dynamic, duration: 0.01, set: {water.fields.table.surface: "


def test_a_kept_run_goes_on_from_its_checkpoint(study, tmp_path):
    """To the bit as if it had not been broken off; a second time it is not executed at all."""
    text = "parameters: {stages.fall.duration: [0.1]}\nkeep: true"
    [broken] = plan(study(text), tmp_path / "broken")
    [whole] = plan(study(text), tmp_path / "whole")
    folder = tmp_path / "broken/runs" / broken.name / "results"
    half = Simulation(Case.from_dict(broken.task["case"]), threads=1, output=folder)
    assert half.run(should_stop=lambda: half.time > 0.02) == "stopped"
    before = half.step_count

    found, expected = execute(broken.task), execute(whole.task)
    assert f"resumed at step {before}" in (folder / "run.log").read_text()
    for key in ("groups", "energies", "steps"):
        assert found["summary"][key] == expected["summary"][key]
    stamp = (folder / "summary.json").stat().st_mtime
    assert execute(broken.task) == found
    assert (folder / "summary.json").stat().st_mtime == stamp


def test_water_tables_of_files_go_along(study, tmp_path, monkeypatch):
    """Files of the fields, of stages and of parameters are found from any folder, and by content."""
    case = tmp_path / "cube.yaml"
    text = "\n".join(x for x in case.read_text().splitlines() if not x.startswith("stages"))
    case.write_text(f"{text}\n{WET}{LATER}high.asc}}}}]\n")
    for name, height in {"low": 1, "high": 2, "higher": 3}.items():
        (tmp_path / f"{name}.asc").write_text(RASTER.format(height))

    def runs():
        files = "[low.asc, higher.asc]"
        return plan(study(f"parameters: {{water.fields.0.surface: {files}}}"), tmp_path / "out")

    first, second = runs()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    for run in (first, second):
        assert execute(run.task)["status"] == "finished"
    monkeypatch.chdir(tmp_path)
    assert first.identity == runs()[0].identity
    (tmp_path / "high.asc").write_text(RASTER.format(4))
    assert first.identity != runs()[0].identity
    (tmp_path / "high.asc").unlink()
    with pytest.raises(BackendError, match=r"a worker cannot read .*high\.asc"):
        execute(first.task | {"folder": str(tmp_path / "other")})
