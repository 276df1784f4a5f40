"""`cdem rockfall`: runs continue, more runs join them, and mistakes are one line."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from cdem.rockfall.rockfall import Rockfall
from cdem.rockfall.run import plan, run_rockfall
from cdem.rockfall.worker import TRACK, execute, place

FILE = """rockfall: 1
title: A short slope
terrain: {grid: slope.asc}
starts: {line: [[4, 10], [4, 20]], height: 0.3, velocity: 4}
count: 2
blocks: {volume: 0.5, shapes: {cube: 1}, contact_modulus: "5 MPa"}
ground: {default: {friction_angle: 35, restitution: 0.3}}
barriers: [{name: Road 1, line: [[10, 1], [10, 29]], height: 2, energy: "100 kJ"}]
duration: 2
"""


@pytest.fixture
def slope(tmp_path, monkeypatch):
    """A rockfall in a folder with a space."""
    folder = tmp_path / "my site"
    folder.mkdir()
    monkeypatch.chdir(folder)
    x = np.arange(20) * 2.0
    rows = "\n".join(" ".join(f"{30 - 0.7 * v:.2f}" for v in x) for _ in range(16))
    head = "ncols 20\nnrows 16\nxllcorner -1\nyllcorner -1\ncellsize 2\nNODATA_value -9999\n"
    (folder / "slope.asc").write_text(head + rows + "\n")
    (folder / "fall.yaml").write_text(FILE)
    return folder


def rows_of(path):
    with path.open() as file:
        return list(csv.DictReader(file))


def test_more_runs_join_those_that_are_done(run_cli, slope, monkeypatch):
    status, out, _err = run_cli("rockfall", "fall.yaml", "--workers", "1")
    assert status == 0
    assert "barrier Road 1: 2 of 2 runs pass, 100 %" in out
    folder = slope / "fall.rockfall"
    first = (folder / "runs.csv").read_text()
    passed = (folder / "barriers.csv").read_text()
    assert (folder / "barrier_road_1.png").stat().st_size > 10_000
    assert {p.name for p in (folder / "maps").glob("*.tif")} == {
        "passages.tif", "reach_probability.tif", "height_95.tif", "velocity_95.tif",
        "energy_95.tif", "energy_max.tif",
    }  # fmt: skip
    monkeypatch.setattr("cdem.rockfall.pictures.draw_all", lambda *_: [])
    times = {p: p.stat().st_mtime_ns for p in folder.glob("runs/*/result.json")}
    status, out, _ = run_cli(
        "rockfall", "fall.yaml", "--workers", "1", "--set", "count=3", "--json"
    )
    assert status == 0
    found = json.loads(out)
    assert found["runs"] == 3
    assert found["barriers"][0]["quantiles"]["energy"][1]["level"] == 0.95
    assert {p: p.stat().st_mtime_ns for p in times} == times  # a done run is not repeated
    assert (folder / "runs.csv").read_text().startswith(first)
    assert set(passed.splitlines()) < set((folder / "barriers.csv").read_text().splitlines())

    # another line asks for no new run
    line = "barriers=[{name: lower, line: [[14, 1], [14, 29]]}]"
    before = {p: p.read_bytes() for p in folder.glob("runs/*/track.npy")}
    assert len(before) == 3
    assert run_cli("rockfall", "fall.yaml", "--set", "count=3", "--set", line)[0] == 0
    assert {p: p.read_bytes() for p in folder.glob("runs/*/track.npy")} == before
    assert {row["barrier"] for row in rows_of(folder / "barriers.csv")} == {"lower"}

    # a run is the same on any worker
    (slope / "again").mkdir()
    task = plan(Rockfall.load("fall.yaml", ["count=3"]), slope / "again").runs[2].task
    plan(Rockfall.load("fall.yaml"), slope).ground.write(Path(task["ground"]))
    execute(task)
    assert (place(task) / TRACK).read_bytes() == (
        folder / "runs" / task["name"] / TRACK
    ).read_bytes()


@pytest.mark.parametrize(
    "setting, said",
    [
        ("blocks.volume={normal: {mean: 1, deviation: 1}}", "blocks.volume: must be above 0; give low"),
        ("blocks.volume={uniform: {low: 1, high: 2}, unit: kg}", "blocks.volume: "),
        ("blocks.volume={grid: {first: 1, last: 2, count: 3}}", "a grid is not drawn"),
        ("blocks.shapes={ball: 1}", "blocks.shapes.ball"),
        ("blocks.shapes={plate: {share: 1, sides: [1, 1, 0.01]}}", "at least 0.1 of the longest"),
        ("blocks.contact_modulus=soft", "blocks.contact_modulus"),
        ("starts.line=[[4, 10], [400, 10]]", "is not on the terrain, which reaches from (0, 0)"),
        ("starts.area=[[2, 2], [8, 8], [8, 2], [2, 8]]", "needs exactly one of line, area, file"),
        ("starts.line=[[4, 10], [4, 10]]", "starts.line: has no length"),
        ("starts.velocity=4 m", "starts.velocity: "),
        ("ground.default.restitution=1.4", "ground.default.restitution"),
        ("ground.default.friction=30", "did you mean friction_angle"),
        ("barriers=[{name: a, line: [[1, 1], [1, 1]]}]", "barriers.0.line: has no length"),
        ("barriers=[{name: a, line: [[1, 1], [2, 1]]}, {name: A, line: [[1, 1], [2, 1]]}]", "used twice"),
        ("ground.zones=[{name: z, friction_angle: 30, restitution: 1, area: [[90, 90], [99, 90], [99, 99]]}]",
         "ground.zones.0.area: holds the middle of no cell"),
        ("extent={x: [100, 200], y: [0, 10]}", "does not cover the required area"),
        ("terrain={grid: fall.yaml}", "terrain.grid"),
        ("terrain={grid: .}", "terrain.grid"),
        ("terrain={grid: nothing.tif}", "terrain.grid"),
        ("terrain={plane: {dip: 30, dip_direction: 90, through: [0, 0, 0]}}", "needs a grid of heights"),
        ("count=0", "count"),
        ("count=1e9", "count"),
        ("duration=-1 s", "duration"),
        ("duraton=3", "did you mean duration"),
    ],
)  # fmt: skip
def test_mistakes_are_one_line(run_cli, slope, setting, said):
    status, out, err = run_cli("rockfall", "fall.yaml", "--set", setting)
    assert (status, out) == (1, "")
    assert said in err
    assert len(err.splitlines()) == 1
    assert not (slope / "fall.rockfall").exists()


def test_folders_of_others_are_left_alone(run_cli, slope):
    (slope / "full").mkdir()
    (slope / "full" / "mine.txt").write_text("x")
    status, _, err = run_cli("rockfall", "fall.yaml", "-o", "full")
    assert status == 1
    assert "contains other files than a rockfall" in err
    assert run_cli("rockfall", "fall.yaml", "-o", "full", "--overwrite")[0] == 1
    assert (slope / "full" / "mine.txt").read_text() == "x"
    status, _, err = run_cli("rockfall", "fall.yaml", "-o", "fall.yaml")
    assert status == 1
    assert "is a file" in err
    assert run_cli("rockfall", "fall.yaml", "--workers", "1", "--scheduler", "tcp://x")[0] == 2
    assert "No such file" in run_cli("rockfall", "none.yaml")[2]


@pytest.mark.slow  # a cluster takes seconds to begin
def test_runs_on_dask_are_those_of_local_workers(slope):
    distributed = pytest.importorskip("distributed")
    run_rockfall("fall.yaml", "local", workers=2)
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, dashboard_address=":0", silence_logs=50
    ) as cluster:
        found = run_rockfall("fall.yaml", "dask", scheduler=cluster.scheduler_address)
    for run in found.runs:
        assert run.result["status"] != "failed"
        tracks = [slope / folder / "runs" / run.name / TRACK for folder in ("local", "dask")]
        assert tracks[0].read_bytes() == tracks[1].read_bytes()
