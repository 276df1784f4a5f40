"""Studies written beside their case, and tables of known numbers."""

from pathlib import Path

import pytest
from shared.cases import FALL

from cdem.study.plan import plan
from cdem.study.results_table import Table
from cdem.study.study import Study


@pytest.fixture
def study(tmp_path, monkeypatch):
    """Write a study beside its case and load it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cube.yaml").write_text(FALL)

    def load(text: str) -> Study:
        (tmp_path / "study.yaml").write_text("case: cube.yaml\n" + text)
        return Study.load("study.yaml")

    return load


@pytest.fixture
def table_of():
    """The table of a study whose runs gave the number that a function makes of their parameters."""

    def table_of(study: Study, of) -> Table:
        runs = plan(study, Path("out"))
        for run in runs:
            result = {"f": of(*run.parameters.values()), "text": "x", "list": [1.0, None]}
            run.result = {"status": "finished", "summary": result, "histories": {"toe.x [m]": 2.0}}
        return Table(study, runs)

    return table_of
