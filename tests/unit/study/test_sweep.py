"""Sweeps into folders and on schedulers that are wrong."""

from __future__ import annotations

import pytest
from shared.cases import STUDY, SWEPT

pytest.importorskip("distributed")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cube.yaml").write_text(SWEPT)
    (tmp_path / "study.yaml").write_text(STUDY)
    return tmp_path


def test_folders_and_addresses_that_are_wrong(run_cli, folder):
    (folder / "mine").mkdir()
    (folder / "mine/thesis.tex").touch()
    status, _, err = run_cli("sweep", "study.yaml", "-o", "mine")
    assert (status, err.count("\n")) == (1, 1) and "holds other things than a sweep" in err
    status, _, err = run_cli("sweep", "study.yaml", "--scheduler", "nowhere")
    assert (status, err.count("\n")) == (1, 1) and "no Dask scheduler answers at nowhere" in err
