"""A run led by a script: values set on the way, actions at intervals, groups, read-only fields."""

import json

import numpy as np
import pytest
from scenes import case

from cdem import CaseError, CdemError, Simulation

SLOPE = 30.0  # [deg]


def sliding_block(friction_angle=10, stages=None):
    """A block on a slope of 30 degrees, which slides at a friction angle of 10 degrees."""
    t = np.radians(SLOPE)
    return case(
        [
            {"group": "block", "box": {"size": [1, 1, 0.5]}, "translate": [1, 1, 0]},
            {"group": "bed", "box": {"size": [8, 3, 1]}, "translate": [0, 0, -1]},
        ],
        {"block": {}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={"default": {"friction_angle": friction_angle}},
        rock={"young_modulus": "1 GPa"},
        loads={"gravity": [9.81 * np.sin(t), 0, -9.81 * np.cos(t)]},
        stages=stages
        or [
            {"name": "slide", "mode": "dynamic", "duration": 0.4, "damping": {"contact": 0.1}},
            {"name": "on", "mode": "dynamic", "duration": 0.1},
        ],
        output={"every": 0.1},
    )


def speed(sim):
    """Of the block down the slope [m/s]."""
    return sim.fields["velocity"][sim.groups["block"].nodes, 0].mean()


def acceleration(friction_angle):
    """Of a block that slides down the slope [m/s2]."""
    t = np.radians(SLOPE)
    return 9.81 * (np.sin(t) - np.cos(t) * np.tan(np.radians(friction_angle)))


def test_friction_set_on_the_way_slows_the_block_down():
    """After 0.2 s at 10 degrees, 25 degrees: a = g (sin 30 - cos 30 tan phi) before and after."""
    sim = Simulation(sliding_block(), threads=1)
    sim.run_until(0.2)
    before, at = speed(sim), sim.time
    sim.set("interfaces.default.friction_angle", "25 deg")
    sim.run_stage("slide")
    assert before == pytest.approx(acceleration(10) * at, rel=0.005)
    assert speed(sim) - before == pytest.approx(acceleration(25) * (sim.time - at), rel=0.02)
    assert sim.given_case.interfaces.default.friction_angle == 10


def test_settings_outlast_a_resume(tmp_path):
    """Set at 0.2 s, stopped at 0.3 s and resumed: the same bits as unbroken; a later stage keeps it."""
    unbroken = Simulation(sliding_block(), threads=1)
    unbroken.run_until(0.2)
    unbroken.set("interfaces.default.friction_angle", 50)
    unbroken.run()

    folder = tmp_path / "run"
    with_stop = Simulation(sliding_block(), threads=1, output=folder)
    with_stop.run_until(0.2)
    with_stop.set("interfaces.default.friction_angle", 50)
    with_stop.run_until(0.3)
    with_stop.checkpoint()
    with_stop.close()
    resumed = Simulation(sliding_block(), threads=1, output=folder, resume=True)
    assert resumed.case.interfaces.default.friction_angle == 50
    resumed.run()
    assert np.array_equal(resumed.motion, unbroken.motion)
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["settings"] == [
        {
            "begun": 1,
            "time": pytest.approx(0.2, abs=1e-3),
            "path": "interfaces.default.friction_angle",
            "value": 50,
        }
    ]
    assert "interfaces.default.friction_angle set to 50" in (folder / "run.log").read_text()


@pytest.mark.parametrize(
    ("path", "value", "why"),
    [
        ("interfaces.default.frction_angle", 1, "unknown key; did you mean friction_angle?"),
        ("interfaces.default.friction_angle", -5, "must lie in"),
        ("model.mesh", "a.msh", "a stage can change interfaces"),
        ("materials.rock.density", 1, "'density' of a material is fixed at the start"),
    ],
)
def test_wrong_settings_are_refused_and_change_nothing(path, value, why):
    """As in a stage's set; the run goes on as before."""
    sim = Simulation(sliding_block(), threads=1)
    with pytest.raises(CaseError, match=why):
        sim.set(path, value)
    assert not sim.settings
    sim.step(10)


def test_actions_come_at_multiples_of_their_interval_and_change_no_bits():
    """At the first step after 0.03, 0.06, ... s, over both stages, also if registered in between."""
    plain = Simulation(sliding_block(), threads=1)
    plain.run()
    sim, seen, late = Simulation(sliding_block(), threads=1), [], []
    sim.every(0.03, lambda s: seen.append(s.time))
    sim.run_until(0.1)
    sim.every(0.2, lambda s: late.append(s.time))
    sim.run()
    assert np.array_equal(sim.motion, plain.motion)
    dt = sim.core.scalars()["dt"]
    assert len(seen) == 16
    assert all(0 <= time - 0.03 * (i + 1) <= 1.01 * dt for i, time in enumerate(seen))
    assert late == pytest.approx([0.2, 0.4], abs=1.01 * dt)
    with pytest.raises(CdemError, match="interval must be above 0"):
        sim.every(0, seen.append)


@pytest.mark.parametrize("interval", [1e-9, 0.01])
def test_actions_leave_a_static_stage_where_it_rests(interval):
    """Also where one comes at every step: a stage that is asked for rest with its time up is at rest."""
    ends = []
    for looks in (False, True):
        sim = Simulation(sliding_block(60, [{"name": "rest", "mode": "static"}]), threads=1)
        if looks:
            sim.every(interval, lambda s: s.step_count > 5000)
        ends.append((sim.run(), sim.step_count))
    assert ends[0] == ends[1] and ends[0][0] == "converged"


def test_an_action_may_end_a_stage(tmp_path):
    """Where it returns True; the stage is `ended`, its last state recorded, and the next begins."""
    sim = Simulation(sliding_block(), threads=1, output=tmp_path / "run")
    sim.every(0.01, lambda s: speed(s) > 0.5)
    assert sim.run() == "ended"
    ends = [(stage["name"], stage["status"]) for stage in sim.finished_stages]
    assert ends == [("slide", "ended"), ("on", "ended")]
    assert sim.finished_stages[0]["time"] == pytest.approx(0.5 / acceleration(10), abs=0.011)
    rows = (tmp_path / "run" / "histories.csv").read_text().splitlines()
    assert float(rows[-1].split(",")[0]) == pytest.approx(sim.time)


def test_groups_pick_rows_and_fields_are_read_only():
    """Every node, element and block is in one group; nothing can be written by accident."""
    sim = Simulation(sliding_block(), threads=1)
    assert list(sim.groups) == sim.build.group_names
    for part, count in (("nodes", "nodes"), ("elements", "elements"), ("blocks", "blocks")):
        ids = np.concatenate([getattr(group, part) for group in sim.groups.values()])
        assert sorted(ids) == list(range(sim.audit.counts[count]))
    assert sim.fields["position"][sim.groups["bed"].nodes, 2].max() == 0
    for values in (*sim.fields.values(), sim.groups["bed"].nodes):
        with pytest.raises(ValueError, match="read-only"):
            values[:] = 0
    sim.motion[:, 4] = 1.0  # on purpose
    assert (sim.fields["velocity"][:, 0] == 1).all()
