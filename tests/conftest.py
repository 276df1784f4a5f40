"""Fixtures of all tests; tests import what they share from this folder."""

import sys
from pathlib import Path

import pytest
from hypothesis import settings
from shared.cases import CUBE, WALL

# the same examples in every run: what fails, fails again
settings.register_profile("fixed", derandomize=True)
settings.load_profile("fixed")


@pytest.fixture
def run_cli(monkeypatch, capsys):
    """Call the program; returns exit status, stdout and stderr."""
    from cdem import cli

    def call(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["cdem", *words])
        try:
            cli.main()
            status = 0
        except SystemExit as end:
            status = end.code or 0
        printed = capsys.readouterr()
        return status, printed.out, printed.err

    return call


@pytest.fixture
def no_report(monkeypatch):
    """Runs write no report.html."""
    from cdem.cli import run_commands

    monkeypatch.setattr(run_commands, "write_report", lambda folder: None)


@pytest.fixture(autouse=True)
def short_estimate(monkeypatch):
    """`cdem check` measures the speed by few steps; test_estimate.py, which looks at it, does not."""
    from cdem.run import estimate

    monkeypatch.setattr(estimate, "SECONDS", 0.02)


@pytest.fixture
def cube_folder(tmp_path: Path, monkeypatch, no_report) -> Path:
    """A working folder with cube.yaml, a cube that falls."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "cube.yaml").write_text(CUBE)
    return tmp_path


@pytest.fixture
def wall_folder(tmp_path: Path, monkeypatch) -> Path:
    """A working folder with model.yaml, a wall of bonded tets that is pushed."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "model.yaml").write_text(WALL)
    return tmp_path
