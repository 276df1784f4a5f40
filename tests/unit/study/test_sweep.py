"""Sweeps into folders and on schedulers that are wrong."""

from __future__ import annotations

from functools import partial

import pytest
from shared.cases import STUDY, SWEPT

from cdem.study.dask_workers import DaskWorkers
from cdem.study.results_table import check_results
from cdem.study.run import Run
from cdem.study.study import Study
from cdem.study.sweep import _Execution

pytest.importorskip("distributed")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cube.yaml").write_text(SWEPT)
    (tmp_path / "study.yaml").write_text(STUDY)
    return tmp_path


class Lost:
    """A future whose worker dies after it has computed the result, so that another one does it."""

    def __init__(self) -> None:
        self.seen = ["pending", "lost", "pending", "finished"]

    @property
    def status(self) -> str:
        return self.seen.pop(0) if len(self.seen) > 1 else self.seen[0]

    def result(self) -> dict:
        return {"status": "finished", "summary": {}, "histories": {}}


class Scheduler:
    """Takes tasks and gives futures that are lost once."""

    def submit(self, *_, **__) -> Lost:
        return Lost()


def test_a_result_that_was_lost_with_its_worker_is_waited_for(folder):
    run = Run("a", "a", {}, {})
    study = Study(case="cube.yaml", parameters={"groups.cube.velocity.0": [0]})
    execution = _Execution(partial(check_results, study), {"a": [run]}, DaskWorkers(Scheduler()))
    execution.submit(threads=1)
    for _ in range(4):
        assert execution.going
        execution.collect()
    assert not execution.going and run.status == "finished"


def test_folders_and_addresses_that_are_wrong(run_cli, folder):
    (folder / "mine").mkdir()
    (folder / "mine/thesis.tex").touch()
    status, _, err = run_cli("sweep", "study.yaml", "-o", "mine")
    assert (status, err.count("\n")) == (1, 1) and "contains other files than a sweep" in err
    status, _, err = run_cli("sweep", "study.yaml", "--scheduler", "nowhere")
    assert (status, err.count("\n")) == (1, 1) and "no Dask scheduler answers at nowhere" in err
