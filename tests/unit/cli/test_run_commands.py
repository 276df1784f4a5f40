"""The verb that runs a case."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cdem import Case, CdemError
from cdem.cli import run_commands
from cdem.cli.run_commands import write_report as WRITE_REPORT

pytestmark = pytest.mark.usefixtures("cube_folder")


def test_run_writes_its_folder_and_guards_it(run_cli, cube_folder):
    status, out, err = run_cli("run", "cube.yaml", "--threads", "1")
    assert (status, out) == (0, "finished; results are in cube.results\n")
    assert err.startswith("fall: t ")
    summary = json.loads((cube_folder / "cube.results/summary.json").read_text())
    assert summary["status"] == "finished"
    assert Case.load(cube_folder / "cube.results/case.yaml").stages[0].duration == 0.005

    status, out, err = run_cli("run", "cube.yaml")
    assert status == 1
    assert "exists already; use --overwrite to replace it, --resume to continue it" in err
    assert run_cli("run", "cube.yaml", "--overwrite", "--quiet") == (0, "", "")


def test_a_run_killed_as_it_began_is_no_hindrance(run_cli, cube_folder):
    """Its folder has lock and mark, or half of that; a link there is not followed."""
    folder = cube_folder / "cube.results"
    folder.mkdir()
    (folder / ".cdem-lock").touch()
    (folder / ".cdem-results.tmp").write_text("cdem run ma")
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    other = cube_folder / "other.results"
    other.mkdir()
    (cube_folder / "mine").write_text("kept")
    (other / ".cdem-lock").symlink_to(cube_folder / "mine")
    status, _, err = run_cli("run", "cube.yaml", "-o", "other.results", "--quiet")
    assert (status, (cube_folder / "mine").read_text()) == (1, "kept")
    assert "is a link" in err


def test_json_is_all_that_is_on_stdout(run_cli):
    status, out, err = run_cli("run", "cube.yaml", "--json", "-o", "a")
    assert (status, err) == (0, "")
    assert json.loads(out)["groups"]["cube"]["mass"] == pytest.approx(2700)


def test_resuming_with_another_case_is_said(run_cli):
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    status, _, err = run_cli("run", "cube.yaml", "--resume", "--set", "title=Other")
    assert status == 0
    assert "warning: title changes from A cube falls to Other" in err


def test_a_failed_run_is_status_3_and_has_a_report(run_cli, cube_folder, monkeypatch):
    reported = []
    monkeypatch.setattr(run_commands, "write_report", reported.append)
    # An initial speed above that of a P wave is taken for a runaway.
    status, out, err = run_cli("run", "cube.yaml", "--set", "groups.cube.velocity=[1e6, 0, 0]")
    assert (status, out) == (3, "")
    assert "Traceback" not in err
    assert json.loads((cube_folder / "cube.results/summary.json").read_text())["status"] == "failed"
    assert reported == [Path("cube.results")]


def test_warnings_go_to_stderr_and_the_log_and_strict_refuses_before_it_writes(
    run_cli, cube_folder
):
    odd = ("--set", "interfaces.default.friction_angle=0.35")
    status, _, err = run_cli("run", "cube.yaml", *odd)
    assert status == 0
    assert "warning: --set interfaces.default.friction_angle=0.35: interfaces.default" in err
    assert "0.35 deg is unusual" in (cube_folder / "cube.results/run.log").read_text()
    status, out, err = run_cli("run", "cube.yaml", "--strict", "--overwrite", *odd)
    assert (status, out) == (1, "")
    assert "0.35 deg is unusual" in err
    assert "--strict does not allow" in err
    assert (cube_folder / "cube.results/summary.json").exists()  # --overwrite removed nothing


def test_a_report_that_cannot_be_written_is_said_even_by_a_quiet_run(monkeypatch, tmp_path, capsys):
    def fails(folder):
        raise CdemError(f"{folder}/report.html: cannot be written (Input/output error)")

    monkeypatch.setattr("cdem.output.report.report", fails)
    WRITE_REPORT(tmp_path)  # `no_report` has taken its place
    assert capsys.readouterr().err == (
        f"no report.html: {tmp_path}/report.html: cannot be written (Input/output error)\n"
    )
