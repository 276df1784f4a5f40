"""How a static stage of a run ends that finds no rest."""

import json

import numpy as np
import pytest
from scenes import case

import cdem
from cdem.run.behaviour import LONG, UNKNOWN, Look, _status, behaviour
from cdem.run.stage_state import StageState
from cdem.run.stages import STATIC_RECORD_STEPS


def status(steps, way, ratio):
    """Status after some steps, with ways [faces] and unbalance ratios by the number of steps."""
    stage = StageState("rest", "static", 0.0, 0, None, 1.0)
    for step in range(0, steps + 1, STATIC_RECORD_STEPS):
        stage.ways.append(way(step))
        stage.ratios.append(min([*stage.ratios[-1:], ratio(step)]))
    return _status(stage, steps)


def steady(_):
    return 0.1


def test_a_force_that_halves_as_steps_double_has_no_verdict():
    assert behaviour([Look(k**0.5, 1 / (k + 1)) for k in range(80)]) is None


def test_what_gains_speed_moves_once_it_has_gone_a_face_or_for_long():
    def far(step):
        return 2 * (step / UNKNOWN) ** 2

    assert status(UNKNOWN - STATIC_RECORD_STEPS, far, steady) is None
    assert status(UNKNOWN, far, steady) == "moving"
    assert status(UNKNOWN, lambda k: 0.1 * far(k), steady) is None
    assert status(LONG, lambda k: 0.01 * far(k), steady) == "moving"
    assert status(LONG, lambda k: 5e-4 * far(k), steady) is None  # stones that settle


def test_a_force_that_falls_too_slowly_creeps():
    def slow(step):
        return (1 + step) ** -0.3

    assert status(LONG, lambda k: k / LONG, slow) == "creeping"
    assert status(UNKNOWN, lambda k: 2 * k / UNKNOWN, slow) == "moving"  # by more than a face
    assert status(4 * LONG, lambda k: k / LONG, lambda k: (1 + k) ** -1.1) is None


def test_blocks_that_stay_where_they_are_chatter():
    assert status(LONG, lambda k: 0.2 + 1e-3 * np.sin(k), steady) is None
    assert status(4 * LONG, lambda k: 0.2 + 1e-3 * np.sin(k), steady) == "chattering"


def test_what_neither_rests_nor_goes_on_is_undecided_in_the_end():
    """It slows down, but far too slowly."""

    def slower(step):
        return np.sqrt(step / LONG)

    assert status(LONG, slower, steady) is None
    assert status(4 * LONG, slower, steady) == "undecided"


def on_a_slope(tmp_path, friction_angle):
    """A run of a block on a plane of 30 degrees, then a short dynamic stage."""
    blocks = [
        {"group": "block", "box": {"size": [1, 1, 0.5]}, "translate": [1, 1, 0]},
        {"group": "bed", "box": {"size": [40, 3, 1]}, "translate": [0, 0, -1]},
    ]
    stages = [
        {"name": "rest", "mode": "static"},
        {"name": "on", "mode": "dynamic", "duration": 0.01},
    ]
    return case(
        blocks,
        {"block": {}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={"default": {"friction_angle": friction_angle}},
        loads={"gravity": [4.905, 0, -8.4957]},
        stages=stages,
    )


def rows_of_summary(folder):
    """Stages of a summary without their wall times."""
    stages = json.loads((folder / "summary.json").read_text())["stages"]
    return [{k: v for k, v in row.items() if k != "wall_time"} for row in stages]


def test_a_stage_that_slides_names_the_body_and_the_run_goes_on(tmp_path):
    """Stopped and resumed on the way it ends at the same step."""
    data = on_a_slope(tmp_path, 20)
    sim = cdem.Simulation(data, threads=1, output=tmp_path / "a")
    assert sim.run() == "finished"
    first, second = rows_of_summary(tmp_path / "a")
    assert first["status"] == "moving" and first["steps"] == LONG + STATIC_RECORD_STEPS
    assert first["no_rest"].startswith("found no rest, moving")
    [body] = first["moving"]
    assert body["groups"] == ["block"] and body["volume"] == pytest.approx(0.5)
    assert second["status"] == "finished" and "no_rest" not in second
    assert "warning: stage rest found no rest, moving" in (tmp_path / "a" / "run.log").read_text()

    stops = iter([False, False, True])
    part = cdem.Simulation(data, threads=1, output=tmp_path / "b")
    assert part.run(should_stop=lambda: next(stops)) == "stopped"
    assert 0 < part.step_count < LONG
    cdem.Simulation(data, threads=1, output=tmp_path / "b", resume=True).run()
    assert rows_of_summary(tmp_path / "b") == [first, second]


def test_a_stage_that_rests_tells_nothing(tmp_path):
    sim = cdem.Simulation(on_a_slope(tmp_path, 45), threads=1, output=tmp_path / "a")
    sim.run()
    assert [row["status"] for row in rows_of_summary(tmp_path / "a")] == ["converged", "finished"]
    assert "found no rest" not in (tmp_path / "a" / "run.log").read_text()
