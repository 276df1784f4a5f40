"""Whole runs that ranks share leave what one rank leaves, and go on on any number of ranks."""

from __future__ import annotations

import json
from functools import partial
from importlib.resources import files
from pathlib import Path

import pytest
from shared.mpi import needs_mpi, ranks
from shared.stopped import content, strip

from cdem import Case, Simulation
from cdem.ranks.exchange import run_ranks
from cdem.run.checkpoint import read_checkpoint

TEMPLATES = Path(str(files("cdem") / "templates"))
SHORT = {
    "landslide": [
        "interfaces.bed.friction_angle=12", "stages.slide.duration=0.25", "output.every=0.1",
    ],
    "tunnel_bolts": [
        "stages.in situ.max_steps=60", "stages.dig.max_steps=60", "stages.open.duration=0.01",
        "stages.open.release.over=0.005", "output.every=0.004",
    ],
    "dam": ["stages.fill.duration=0.2", "output.every=0.05"],
    "quake": ["stages.rest.max_steps=100", "stages.shake.duration=0.05", "output.every=0.02"],
}  # fmt: skip
"""Templates, and what makes them short."""


def path_of(name: str) -> Path:
    return next(TEMPLATES.rglob(f"{name}.yaml"))


def case_of(name: str) -> Case:
    return Case.load(path_of(name), SHORT[name])


def run(name: str, folder: Path, exchange=None, stop_at: int | None = None, **how) -> int:
    """Run on one rank or as one of several, to the end or to a step; returns the steps done."""
    simulation = Simulation(case_of(name), output=folder, threads=1, exchange=exchange, **how)
    stop = stop_at and (lambda: simulation.step_count >= stop_at)
    status = simulation.run(should_stop=stop or None)
    assert (status == "stopped") == (stop_at is not None)
    return simulation.step_count


def left_by(folder: Path) -> dict[str, object]:
    """All that a run has left: files byte by byte, and what the checkpoint holds."""
    arrays, told = read_checkpoint(folder / "checkpoint.h5")
    found = content(folder) | {f"{name} in checkpoint": a.tobytes() for name, a in arrays.items()}
    return found | {"attributes of checkpoint": strip(json.loads(told))}


def differing(folder: Path, expected: dict[str, object], but: str = "no") -> list[str]:
    """Names of what differs."""
    found = left_by(folder)
    return [n for n in found | expected if n != but and found.get(n) != expected.get(n)]


@pytest.fixture(scope="module", params=SHORT)
def whole(request, tmp_path_factory):
    """A case, its steps, and what an unbroken run on one rank leaves."""
    folder = tmp_path_factory.mktemp("whole") / "results"
    steps = run(request.param, folder)
    return request.param, steps, left_by(folder)


@pytest.mark.parametrize("count", [pytest.param(2, marks=pytest.mark.slow), 3])
def test_a_shared_run_leaves_the_same_files(whole, count, tmp_path):
    """Histories, frames, maps, summary and checkpoint; in a folder with a space in its name."""
    name, _, expected = whole
    folder = tmp_path / "of some ranks"
    run_ranks(count, partial(run, name, folder), timeout=60)
    assert "histories.csv" in expected
    assert ("maxima.h5" in expected) == (name == "landslide")
    assert differing(folder, expected) == []


def test_a_run_goes_on_on_any_number_of_ranks(whole, tmp_path, monkeypatch):
    """It is stopped on one rank, goes on on three, on two, and ends on one."""
    name, steps, expected = whole
    monkeypatch.setattr("cdem.run.simulation.CHUNK_SECONDS", 0.0)  # the loop comes back soon
    folder = tmp_path / "broken"
    run(name, folder, stop_at=steps // 4)
    for count, part in (3, 2), (2, 3):
        going = partial(run, name, folder, stop_at=part * steps // 4, resume=True)
        run_ranks(count, going, timeout=60)
    run(name, folder, resume=True)
    assert differing(folder, expected) == []


@needs_mpi
@pytest.mark.parametrize(("name", "count"), [("landslide", 2), ("dam", 3)])
def test_the_program_leaves_the_same_files_on_ranks(name, count, tmp_path):
    run(name, tmp_path / "one")
    settings = [word for setting in SHORT[name] for word in ("--set", setting)]
    words = ["run", path_of(name), "-o", "of ranks", "--threads", "1", *settings]
    status, said, errors, _ = ranks(count, "-m", "cdem", *words, cwd=tmp_path)
    assert (status, said) == (0, "finished; results are in of ranks\n"), errors
    assert (tmp_path / "of ranks" / "report.html").read_text().rstrip().endswith("</html>")
    (tmp_path / "of ranks" / "report.html").unlink()
    assert differing(tmp_path / "of ranks", left_by(tmp_path / "one")) == []
