"""Fixtures of all tests; tests import what they share from this folder."""

import importlib
import json
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


@pytest.fixture
def no_sheets(monkeypatch):
    """`cdem runout` draws nothing: for tests of what it says."""
    from cdem.output.runout_result import RunOut

    monkeypatch.setattr(RunOut, "draw", lambda self, folder: [])


@pytest.fixture(autouse=True)
def short_estimate(monkeypatch):
    """`cdem check` measures the speed by few steps; test_estimate.py, which looks at it, does not."""
    from cdem.run import estimate

    monkeypatch.setattr(estimate, "SECONDS", 0.02)


@pytest.fixture(autouse=True)
def quick_pictures(monkeypatch):
    """Pictures made in the process of a test have rough edges; those of pages and commands have smooth ones."""
    from cdem.output import scene

    monkeypatch.setattr(scene, "SMOOTH", False)


@pytest.fixture
def readers_here(monkeypatch):
    """GDAL reads in the process of the test, with all its drivers.

    unit/terrain has tests of the processes that read, and of what they drop.
    """
    from cdem.case import reader_process
    from cdem.case.input_file import reading
    from cdem.terrain import gdal

    def read(module, path, mend, kind, asked, size=None, reply=None):
        monkeypatch.setattr(reader_process, "ask", lambda head: reply(json.loads(json.dumps(head))))
        with reading(path, kind, mend, size):
            return importlib.import_module(module).read(path, json.loads(json.dumps(asked)))

    monkeypatch.setattr(reader_process, "read", read)
    monkeypatch.setattr(gdal, "keep_drivers", lambda *_: None)


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
