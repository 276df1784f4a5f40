"""Loose blocks at the defaults of a static stage, and stages that local damping has to end."""

import json

import numpy as np
import pytest
from scenes import case

import cdem
from cdem.errors import UnstableError
from cdem.run.stage_state import StageState
from cdem.run.state import Attributes
from cdem.study.critical import find_critical, find_factor, parameter
from cdem.study.verdict import stage_rests
from cdem.verification.dry_wall.problem import wall

BED = {"group": "bed", "box": {"size": [4, 4, 0.5], "divisions": [8, 4, 1]},
       "translate": [-1.5, -1.5, -0.5]}  # fmt: skip
CUBE = {"group": "block", "box": {"size": [1, 1, 1]}, "translate": [0, 0, 1e-4]}
REST = {"name": "rest", "mode": "static"}
ON = {"name": "on", "mode": "dynamic", "duration": 0.002}
GROUPS = {"bed": {"fix": ["x", "y", "z"]}, "block": {}}


def make(blocks, *stages, interface=None, **more):
    """A case at the defaults of the program."""
    more.setdefault("loads", {"gravity": [0, 0, -9.81]})
    faces = {"default": {"friction_angle": 35} | (interface or {})}
    return case(blocks, GROUPS, interfaces=faces, stages=list(stages), defaults=True, **more)


def run(made, **more):
    sim = cdem.Simulation(made, threads=1, **more)
    return sim, sim.run()


def dropped(*stages, **more):
    """A cube falls by 0.1 mm on a bed of stiff joints, where adaptive relaxation misses 6.7 %."""
    stiff = {"stiffness_n": "10 E/h", "stiffness_s": "10 E/h"}
    return make([BED, CUBE], *stages, interface=stiff, **more)


def laid(length, courses, apart=0.0, faces=(1, 1)):
    """The blocks of a dry wall of blocks of 0.4 x 0.3 x 0.2 m on a floor of as many faces."""
    floor = {"size": [0.4 * length + 2, 2.3, 0.5], "divisions": [*faces, 1]}
    rows = [{"group": "bed", "box": floor, "translate": [-1, -1, -0.5]}]
    for x, z, wide, high, _ in wall(length, courses, block_length=0.4, block_height=0.2):
        size = [wide - apart, 0.3, high]
        rows.append({"group": "block", "box": {"size": size}, "translate": [x, 0, z]})
    return rows


@pytest.mark.parametrize("contact", [0.0, 0.09, 0.1, 0.15])
def test_dry_wall_of_52_blocks_comes_to_rest(contact):
    """Dashpots on scaled masses gained 12 % of the energy within 200 steps at 0.1."""
    sim, ended = run(make(laid(6, 8), REST | {"damping": {"contact": contact}, "max_steps": 3000}))
    local, _ = run(make(laid(6, 8), REST | {"relax": "local"}))
    assert len(sim.build.topology.block_group) == 53
    assert ended == "converged"
    assert abs(sim.energies["error"]) < 1e-3
    found, expected = sim.fields["displacement"], local.fields["displacement"]
    assert np.abs(found - expected).max() < 0.02 * np.abs(expected).max()


def test_wall_with_stiff_joints_gains_no_energy():
    """Blocks that stand 1 mm apart on many faces, with joints of 10 E/h, gained 52 %.

    Tolerance: ten times the error, 4e-5.
    """
    rock = {"density": 2500, "poisson_ratio": 0.25}
    stone = {n: rock | {"young_modulus": e} for n, e in (("soft", 63e6), ("stiff", 756e6))}
    joint = {"stiffness_n": "10 E/h", "stiffness_s": "10 E/h", "friction_angle": 20}
    rows = laid(2, 3, apart=1e-3, faces=(8, 4))
    rows[0]["box"]["size"] = [1.6, 1.1, 0.5]
    rows[0]["translate"] = [-0.4, -0.4, -0.5]
    made = make(rows, REST, interface=joint, materials=stone)
    made.set("groups.block.material", "soft")
    made.set("groups.bed.material", "stiff")
    sim, ended = run(made)
    assert ended == "converged" and "handed_over" not in sim.finished_stages[0]
    assert abs(sim.energies["error"]) < 4e-4


@pytest.mark.parametrize("ratio", [1e2, 1e4])
def test_soft_wall_on_a_stiff_bed_holds(ratio):
    """Blocks far softer than their bed do not slide apart, and rest where local damping lets them."""
    rock = {"density": 2500, "poisson_ratio": 0.25}
    stone = {n: rock | {"young_modulus": e} for n, e in (("soft", 5e10 / ratio), ("stiff", 5e10))}
    found = []
    for way in ("adaptive", "local"):
        made = make(laid(6, 8), REST | {"relax": way, "max_steps": 20_000}, materials=stone)
        made.set("groups.block.material", "soft")
        made.set("groups.bed.material", "stiff")
        sim, ended = run(made)
        assert ended == "converged"
        found.append(sim.fields["displacement"].copy())
    assert np.abs(found[0] - found[1]).max() < 0.03 * np.abs(found[1]).max()


def test_stage_that_loses_the_balance_goes_on_by_local_damping(tmp_path):
    """It rests, the missing energy is booked, and log and summary say so; a later stage closes."""
    sim, ended = run(dropped(REST, ON), output=tmp_path / "r")
    assert ended == "finished"
    rest, on = sim.finished_stages
    assert rest["status"] == "converged" and rest["handed_over"] is True
    assert "handed_over" not in on
    log = (tmp_path / "r" / "run.log").read_text()
    assert log.count("so the stage goes on from there by relax: local") == 1
    assert "of adaptive relaxation the energy balance is off by -6.6" in log
    assert json.loads((tmp_path / "r" / "summary.json").read_text())["stages"][0] == rest
    assert abs(sim.energies["error"]) < 1e-9
    weight = 1e-4 * 2500 * 9.81
    assert sim.energies["damping"] == pytest.approx(weight, rel=0.02)
    local, _ = run(dropped(REST | {"relax": "local"}))
    moved = [s.fields["displacement"].copy() for s in (sim, local)]
    # friction locks the spread of the base by 0.2 or 0.3 um of the 101, as the cube came down
    assert np.abs(moved[0] - moved[1]).max() < 4e-3 * np.abs(moved[1]).max()


def test_stage_handed_over_keeps_its_bits_through_a_stop(tmp_path):
    """Stopped once local damping goes on, and resumed: the bits of the unbroken run."""
    made = dropped(REST | {"tolerance": 1e-9}, ON)
    whole, _ = run(made, output=tmp_path / "whole")
    first = cdem.Simulation(made, threads=1, output=tmp_path / "r")
    assert first.run(should_stop=lambda: first.stage.handed_over) == "stopped"
    first.close()
    again, ended = run(made, output=tmp_path / "r", resume=True)
    assert ended == "finished"
    assert 100 < first.step_count < whole.finished_stages[0]["steps"]
    assert again.finished_stages[0]["handed_over"] is True
    fields = whole.core.fields()
    for name, field in again.core.fields().items():
        assert np.array_equal(field, fields[name]), name
    assert {**again.core.scalars()} == {**whole.core.scalars()}


def test_checkpoint_of_before_has_not_handed_over():
    """A stage in a checkpoint without the key goes on as it was."""
    made = make([BED, CUBE], REST | {"max_steps": 40})
    sim = cdem.Simulation(made, threads=1)
    sim.run_until(1e-9)
    kept = json.loads(sim.attributes("", 0, 0).model_dump_json())
    assert kept["stage"].pop("handed_over") is False
    stage = Attributes.model_validate_json(json.dumps(kept)).stage
    assert isinstance(stage, StageState) and not stage.handed_over


@pytest.mark.parametrize(("way", "limit"), [("kinetic", 1e-9), ("local", 1e-9)])
def test_other_ways_to_rest_end_where_the_balance_is_off(way, limit):
    with pytest.raises(UnstableError, match="energy balance is off"):
        run(dropped(REST | {"relax": way}, time={"energy_error": limit}))


def test_handed_over_stage_is_judged_like_any_other():
    """What local damping and the stage after it miss still ends the run."""
    falls = CUBE | {"translate": [0, 0, 1.05]}
    sim = cdem.Simulation(make([BED, CUBE, falls], REST, time={"energy_error": 1e-5}), threads=1)
    with pytest.raises(UnstableError, match="energy balance is off"):
        sim.run()
    assert sim.stage.handed_over
    sim = cdem.Simulation(dropped(REST, ON, time={"energy_error": "any"}), threads=1)
    assert sim.run() == "finished"
    assert "handed_over" not in sim.finished_stages[0]
    assert sim.energies["error"] < -0.05


def test_a_trial_that_loses_the_balance_goes_on_by_local_damping():
    """In the words of a run; the next trial begins by adaptive relaxation again.

    The cube slides where gravity along its bed is tan 35 of that across it.
    """
    tilt = parameter("loads.gravity.0")
    found = find_critical(dropped(REST), tilt, (0.5, 9), tolerance=0.5, threads=1)
    assert found.stable <= 9.81 * np.tan(np.radians(35)) <= found.failed + 0.01
    first, *others = found.trials
    assert "of adaptive relaxation the energy balance is off by -5." in first.why
    assert "so the stage goes on from there by relax: local" in first.why
    assert not any("relax: local" in trial.why for trial in others)


def test_a_search_tells_that_it_began_by_local_damping():
    told = []
    made = dropped(REST, time={"energy_error": 0.01})
    made.set("loads.gravity", [1.0, 0, -9.81])
    found = find_factor(made, tolerance=0.2, threads=1, tell=told.extend).kept
    assert found.value == pytest.approx(9.81 * np.tan(np.radians(35)), rel=0.02)
    (line,) = told
    assert line.startswith("before the search") and "relax: local" in line
    assert not any("relax: local" in trial.why for trial in found.trials)
    assert max(trial.steps for trial in found.trials if trial.stable) <= 200  # local: 860


@pytest.mark.parametrize("way", ["kinetic", "local"])
def test_a_trial_by_another_way_fails_where_the_balance_is_off(way):
    made = dropped(REST | {"relax": way}, time={"energy_error": 1e-9})
    found = stage_rests(cdem.Simulation(made, threads=1))
    assert found.saw == "unstable" and "energy balance is off" in found.why


def test_stage_out_of_steps_is_not_handed_over():
    """At its last step a stage that has lost the balance still fails."""
    with pytest.raises(UnstableError, match="energy balance is off"):
        run(dropped(REST | {"max_steps": 155}))
