"""What a run will cost: measured by steps of the model."""

from __future__ import annotations

import json
import re
import time

import numpy as np
import pytest
import yaml
from shared.cases import FALL, WALL
from shared.machine import of_the_cpu

import cdem
from cdem.run import estimate as module
from cdem.run.estimate import StageEstimate, estimate

pytestmark = pytest.mark.usefixtures("cube_folder")


@pytest.fixture(autouse=True)
def short_estimate():
    """Speeds are measured here as for users."""


@of_the_cpu
def test_the_estimate_is_the_time_that_a_run_takes():
    """Within a factor of 2; a busy machine is given three chances."""
    data = yaml.safe_load(WALL)
    data["stages"] = [{"name": "push", "mode": "dynamic", "duration": 0.5}]
    data["output"] = {}
    ratios = []
    for _ in range(3):
        case = cdem.Case(**data)
        said = estimate(cdem.Simulation(case, threads=1)).wall_time
        sim = cdem.Simulation(case, threads=1)
        began = time.perf_counter()
        sim.run()
        ratios.append((time.perf_counter() - began) / said)
        if 0.5 < ratios[-1] < 2:
            return
    raise AssertionError(ratios)


class Clock:
    """A clock that goes with the steps of a core: a second each, two once the bonds are gone."""

    def __init__(self) -> None:
        self.now, self.pace = 0.0, 1.0

    def perf_counter(self) -> float:
        return self.now


class Core:
    """A core whose steps move the clock."""

    def __init__(self, core, clock: Clock) -> None:
        self._core, self._clock = core, clock
        self.ways: set[tuple[str, float]] = set()

    def run(self, steps, **more):
        self.ways.add((more.get("relaxation", "none"), more.get("unbalance_limit", 0.0)))
        before = self._core.scalars()["step"]
        report = self._core.run(steps, **more)
        self._clock.now += self._clock.pace * (self._core.scalars()["step"] - before)
        return report

    def solve_for_rest(self, limit, most_iterations=200):
        self._clock.now += 5 if most_iterations == 200 else 2
        return self._core.solve_for_rest(limit, most_iterations)

    def set_interfaces(self, entries):
        if all(e["parameters"]["cohesion"] == 0 for e in entries):
            self._clock.pace = 2.0
        self._core.set_interfaces(entries)

    def __getattr__(self, name):
        return getattr(self._core, name)


def measured(monkeypatch, text: str) -> tuple[cdem.Simulation, module.Estimate]:
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    sim = cdem.Simulation(cdem.Case(**yaml.safe_load(text)), threads=1)
    sim.core = Core(sim.core, clock)
    return sim, estimate(sim)


def test_time_is_seconds_a_step_times_steps(monkeypatch):
    sim, found = measured(monkeypatch, FALL)
    dt = sim.core.scalars()["dt"]
    (stage,) = found.stages
    assert stage.step_seconds == pytest.approx(1.0)
    assert stage.wall_time == pytest.approx(0.005 / dt, rel=0.05)  # a step may still grow
    assert stage.wall_time_broken is None
    assert found.wall_time == stage.wall_time


def test_bonded_rock_is_measured_broken_too(monkeypatch):
    _, found = measured(monkeypatch, WALL)
    (stage,) = found.stages
    ratio = stage.wall_time_broken / stage.wall_time
    assert 1.8 < ratio < 6  # twice the time a step, and steps that may be shorter
    assert found.wall_time == pytest.approx(stage.wall_time * ratio**0.5)
    assert "depending on broken bonds" in found.text()


def test_static_stages_have_no_time():
    stages = [StageEstimate("settle", "static", 1e-3, None, None)]
    found = module.Estimate(stages, 10**9)
    assert found.wall_time is None
    assert "stage settle: 1 ms a step; the number of steps until rest is unknown" in found.text()
    assert "peak memory 1,000 MB" in found.text()


@pytest.mark.parametrize("way", ["adaptive", "kinetic", "local"])
def test_a_static_stage_is_measured_on_its_way_to_rest(monkeypatch, way):
    """Blocks of one element cost two to three times as much there as where nothing is relaxed."""
    stages = f"[{{name: rest, mode: static, relax: {way}, tolerance: 1e-6}}]"
    text = re.sub(r"stages: .*", f"stages: {stages}", WALL)
    sim, found = measured(monkeypatch, text)
    assert found.stages[0].wall_time is None
    assert sim.core.ways == {("none" if way == "local" else way, 1e-6)}


def test_a_solve_is_measured_by_itself(monkeypatch):
    """It takes the time that the core takes for it; one that is not made is not told."""
    stages = "[{name: rest, mode: static, relax: WAY}, {name: again, mode: static, relax: WAY}]"
    found = {}
    for way in ("solve", "adaptive"):
        text = re.sub(r"  velocities: .*\n", "", WALL)
        text = re.sub(r"stages: .*", f"stages: {stages.replace('WAY', way)}", text)
        found[way] = measured(monkeypatch, text)[1]
    assert [stage.solve_seconds for stage in found["adaptive"].stages] == [0, 0]
    # of the last stage its first iteration is timed
    assert [stage.solve_seconds for stage in found["solve"].stages] == [5, 2 * module.WHOLE]
    assert "stage rest: a solve of 5 s, then " in found["solve"].text()
    assert "a solve" not in found["adaptive"].text()


def test_a_stage_is_measured_up_to_its_end_and_leads_to_the_next(monkeypatch):
    """Rock that moves freely is then where a run would have it."""
    text = FALL.replace(
        'stages: [{name: fall, mode: dynamic, duration: "5 ms"}]',
        'stages: [{name: fall, mode: dynamic, duration: "5 ms"}, {name: then, mode: dynamic, duration: 1}]',
    )
    sim, _ = measured(monkeypatch, text)
    assert list(sim.begins) == ["fall", "then"]
    dt = sim.core.scalars()["dt"]
    assert 0.005 <= sim.begins["then"] < 0.005 + dt


@pytest.mark.parametrize(("spent", "steps"), [((1, 1, 0, 1, 7), 40), ((0.4, 0.5, 0, 1, 8.1), 5)])
def test_steps_without_much_search_need_no_rebuild(monkeypatch, spent, steps):
    """They are all alike, so a few are enough: a million bonded tets take a second for each."""
    monkeypatch.setattr(module, "SECONDS", 0.0)
    clock = Clock()
    monkeypatch.setattr(module, "time", clock)
    sim = cdem.Simulation(cdem.Case(**yaml.safe_load(FALL)), threads=1)
    sim.core = Core(sim.core, clock)
    sim.core.seconds = lambda: clock.now * np.array(spent)
    module._measure(sim, sim.core.run)
    assert sim.step_count == steps


def test_check_says_it(run_cli):
    out = run_cli("check", "cube.yaml", "--threads", "1")[1]
    assert "stage fall: " in out
    facts = json.loads(run_cli("check", "cube.yaml", "--json", "--threads", "1")[1])
    assert facts["stage_estimates"][0]["name"] == "fall"
    assert facts["wall_time_estimate"] > 0
    assert facts["peak_memory_bytes"] > 3e7
