"""A curve whose times count from the begin of a stage, through a run."""

from __future__ import annotations

import csv

import numpy as np
import pytest
import yaml

from cdem import Case, CaseError, Simulation
from cdem.run import stages

COLUMN = """\
model:
  blocks:
    - {group: rock, box: {size: [10, 10, 60], divisions: [1, 1, 12]}}
materials:
  rock: {density: 2500, young_modulus: "5 GPa", poisson_ratio: 0.25}
groups: {rock: {material: rock}}
loads:
  gravity: [0, 0, -9.81]
  supports:
    - {surface: {group: rock, normal: [0, 0, -1]}, fix: [z]}
    - {box: {min: [-1, -1, -1], max: [11, 11, 61]}, fix: [y]}
  velocities:
    - {surface: {group: rock, normal: [0, 0, -1]}, components: [x], velocity: [0.1, 0, 0],
       history: [[0, 0], [0.02, 1], [0.04, 0]], stage: shake}
stages:
  - {name: rest, mode: static}
  - {name: shake, mode: dynamic, duration: 0.3, reset_displacement: true}
histories: [{name: top, point: [0, 0, 60], quantities: [velocity]}]
output: {frames: false}
"""
"""The base of a column at rest is driven by a pulse."""
PASSES = [[0, 0], [0.02, 1], [0.04, 0], [0.05, 2]]


def column(**loads):
    data = yaml.safe_load(COLUMN)
    data["loads"] |= loads
    return data


def top(folder, data):
    """Largest speed of the column's top along x [m/s], and the simulation."""
    sim = Simulation(Case.from_dict(data), threads=1, output=folder, overwrite=True)
    sim.run()
    with (folder / "histories.csv").open() as file:
        rows = list(csv.DictReader(file))
    return max(abs(float(row["top.velocity_x [m/s]"] or 0)) for row in rows), sim


def test_a_pulse_after_a_static_stage_is_that_without_one(tmp_path):
    """0.12 m/s come at the top, and the base has gone the area below the pulse, 2 mm."""
    found, sim = top(tmp_path / "r", column())
    assert found == pytest.approx(0.123, rel=0.01)
    base = sim.build.start_position[:, 2] < 1e-9
    assert sim.fields["displacement"][base, 0] == pytest.approx(2e-3, rel=1e-3)
    alone = column(gravity=[0, 0, 0])
    del alone["stages"][0]
    assert top(tmp_path / "alone", alone)[0] == pytest.approx(found, rel=2e-3)


def test_a_pulse_that_a_static_stage_uses_up_is_refused_while_it_runs(tmp_path, run_cli):
    """By `check` too, whose trial of a small model comes to the end of the static stage."""
    case = tmp_path / "col.yaml"
    case.write_text(COLUMN.replace(", stage: shake", ""))
    says = (
        "col.yaml:14:8: loads.velocities.0.history: is over at 0.04 s, before the stage shake begins: its "
        "times count from the start of the run; write stage: shake beside it, or the stage where it "
        "should start"
    )
    for words in (["check"], ["run", "-o", str(tmp_path / "out")]):
        code, _, error = run_cli(words[0], str(case), *words[1:], "--threads", "1")
        assert code == 1 and says in error and "Traceback" not in error
    sim = Simulation(Case.load(case), threads=1)
    with pytest.raises(CaseError, match=r"is over at 0\.04 s"):
        sim.run()
    assert sim.stage is not None and sim.stage.name == "rest"  # told as soon as it is known


def test_a_static_stage_waits_for_the_curves_that_name_it():
    """A load that grows from nothing: without the wait the stage would be at rest at once."""
    data = column(gravity=[0, 0, 0], velocities=[])
    face = {"group": "rock", "normal": [0, 0, 1]}
    rows = [[0, 0], [0.2, 0], [0.3, 1]]
    data["loads"]["tractions"] = [
        {"surface": face, "traction": [0, 0, -1e6], "history": rows, "stage": "rest"}
    ]
    sim = Simulation(Case.from_dict(data), threads=1)
    assert sim.run_stage("rest") == "converged"
    assert sim.finished_stages[0]["time"] > 0.3
    shorter = sim.fields["displacement"][sim.build.start_position[:, 2] > 59.9, 2].mean()
    stiffness = 5e9 / (1 - 0.25**2)  # held in y, free in x
    assert shorter == pytest.approx(-1e6 * 60 / stiffness, rel=0.01)


def test_a_stage_that_is_tried_again_counts_from_its_first_begin():
    """As a search for a critical value does, which goes on from the last state at rest."""
    sim = Simulation(Case.from_dict(column()), threads=1)
    sim.run_stage("rest")
    begun = stages.begin(sim)
    sim.step(10)
    assert stages.begin(sim).start_time > begun.start_time == sim.begins["shake"]


def test_a_quiet_begin_that_outlasts_the_static_stage_holds_as_before(tmp_path):
    """Times from the start of the run still mean that, where the curve goes on after rest."""
    data = column()
    del data["loads"]["velocities"][0]["stage"]
    data["loads"]["velocities"][0]["history"] = [[0, 0], [9, 0], [9.02, 1], [9.04, 0]]
    data["stages"][1]["duration"] = 0.1
    _, sim = top(tmp_path / "r", data)
    assert sim.finished_stages[1]["status"] == "finished"


STAGES = [
    {"name": "rest", "mode": "static", "max_steps": 30},
    {"name": "wait", "mode": "dynamic", "duration": 0.02},
    {"name": "shake", "mode": "dynamic", "duration": 0.06},
    {"name": "last", "mode": "static", "max_steps": 30},
]
TRACTION = {"surface": {"group": "rock", "normal": [0, 0, 1]}, "traction": [0, 0, -1e3]}
WATER = {
    "fields": [{"level": [[0, 1], [0.04, 5]], "history": PASSES}],
    "reservoir": {"level": [[0, 2], [0.05, 4]]},
}


@pytest.mark.parametrize("stage", [stage["name"] for stage in STAGES])
def test_every_curve_counts_from_the_begin_of_its_stage(stage):
    """Factors of the core are those of the curve at the time since then; before it the first."""
    data = column(tractions=[TRACTION | {"history": PASSES, "stage": stage}])
    data["loads"]["velocities"][0] |= {"history": PASSES, "stage": stage}
    fields = [entry | {"stage": stage} for entry in WATER["fields"]]
    data["water"] = {"fields": fields, "reservoir": WATER["reservoir"] | {"stage": stage}}
    sim = Simulation(Case.from_dict(data | {"stages": STAGES}), threads=1)
    rise, high = [[0, 0], [0.04, 4]], [[0, 0], [0.05, 2]]
    curves = [PASSES, PASSES, PASSES, rise, high]  # velocity, traction, field: factor and lift
    looks = []

    def look(sim):
        now = sim.core.scalars()["loads_time"]  # of the step that has just been done
        since = now - sim.begins.get(stage, np.inf)
        should = sorted(float(np.interp(since, *zip(*rows, strict=True))) for rows in curves)
        factors = sim.core.rebuilt()["curve.load_factor"][1:]
        assert sorted(factors) == pytest.approx(should, abs=1e-12)
        looks.append(since)

    sim.every(0.001, look)
    sim.run()
    begins = [row["begin"] for row in sim.finished_stages]
    assert list(sim.begins.values()) == begins and begins == sorted(begins)
    assert max(looks) > 0.02 and (min(looks) == -np.inf) == (stage != "rest")
