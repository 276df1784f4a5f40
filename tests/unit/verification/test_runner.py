"""`cdem verify`: finding problems, verdicts, and problems that are broken."""

from __future__ import annotations

import json
import math

import pytest

from cdem.errors import CaseError
from cdem.verification import runner
from cdem.verification.runner import Check, Problem


def test_errors_are_relative_or_absolute():
    assert Check("q", theory=-2.0, ours=-2.1, within=0.06).error == pytest.approx(-0.05)
    assert Check("q", theory=0.0, ours=0.1, within=0.2, absolute=True).passed
    assert not Check("q", theory=1.0, ours=math.nan, within=1e9).passed


def test_shipped_problems_are_whole():
    found = runner.problems()
    assert len(found) >= 10
    for problem in found:
        assert problem.page.startswith("# ")
        assert problem.title != problem.name
        assert problem.module.theory.__doc__, problem.name
        assert list(problem.folder.glob("*.yaml")), problem.name


def test_a_problem_of_ones_own(fall, run_cli):
    status, out, _ = run_cli("verify", str(fall), "--report", "manual.html")
    assert status == 0
    assert "A cube falls" in out
    assert "1 of 1 problems pass" in out
    manual = (fall.parent / "manual.html").read_text()
    for part in ("The falling cube", "speed", "m/s", "data:image/png", "cdem verify fall"):
        assert part in manual
    status, out, _ = run_cli("verify", str(fall), "--json", "--report", "table.md")
    assert json.loads(out)[0]["checks"][0]["passed"]
    assert "| fall | speed |" in (fall.parent / "table.md").read_text()


def test_a_miss_is_said_and_told_by_the_exit_status(fall, run_cli):
    text = (fall / "problem.py").read_text().replace("theory(-10, ", "theory(-11, ")
    (fall / "problem.py").write_text(text.replace("within=1e-9", "within=0.01"))
    status, out, _ = run_cli("verify", str(fall))
    assert status == 3
    assert "MISS" in out
    assert "0 of 1 problems pass" in out


@pytest.mark.parametrize(
    "change, said",
    [
        (("simulation.run()", "simulation.runs()"), "problem.py:10: AttributeError"),
        (("study.simulate()", 'study.simulate("stages.0.duration=-1")'), "must be above 0"),
        (("def theory", "def theories"), "has no function theory"),
    ],
)
def test_a_broken_problem_is_one_message(fall, run_cli, change, said):
    text = (fall / "problem.py").read_text().replace("within=1e-9", "within=1")
    (fall / "problem.py").write_text(text.replace(*change))
    status, out, err = run_cli("verify", str(fall))
    assert status in (1, 3)
    assert said in out + err
    assert "Traceback" not in out + err


def test_wrong_names_and_reports(fall, run_cli):
    status, _, err = run_cli("verify", "slidin")
    assert (status, "did you mean sliding?" in err) == (1, True)
    status, _, err = run_cli("verify", str(fall), "--report", "manual.pdf")
    assert (status, ".html" in err) == (1, True)
    status, _, err = run_cli("verify", str(fall), "--report", "none/manual.html")
    assert (status, "no folder" in err) == (1, True)
    with pytest.raises(CaseError, match=r"has no problem\.py"):
        Problem(fall.parent)


def test_the_list_names_all(run_cli):
    status, out, _ = run_cli("verify", "--list")
    assert status == 0
    assert [line.split()[0] for line in out.splitlines()] == [p.name for p in runner.problems()]
