"""One run on a worker."""

from __future__ import annotations

from cdem.case.case import Case
from cdem.run.simulation import Simulation
from cdem.study.plan import plan
from cdem.study.worker import execute


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
