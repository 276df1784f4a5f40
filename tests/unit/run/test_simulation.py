"""Simulations: what they keep, and those that are resumed."""

from __future__ import annotations

import json

import numpy as np
import pytest
import yaml
from shared.cases import FALL

import cdem
from cdem import _native as native
from cdem.output.report import closing
from cdem.run.checkpoint import read_checkpoint, write_checkpoint

pytestmark = pytest.mark.usefixtures("cube_folder")


def test_a_checkpoint_of_another_version_is_refused_in_one_line(run_cli, cube_folder):
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    arrays, text = read_checkpoint(cube_folder / "cube.results/checkpoint.h5")
    kept = json.loads(text)
    del kept["core"]["dt_stable"], arrays["spring.state"]
    write_checkpoint(cube_folder / "cube.results", arrays, json.dumps(kept))
    status, out, err = run_cli("run", "cube.yaml", "--resume", "--force")
    assert (status, out) == (1, "")
    assert "written by another version of cdem" in err
    assert "dt_stable" in err and "spring.state" in err
    assert "Traceback" not in err


def test_a_checkpoint_of_another_version_with_the_same_fields_can_be_forced(run_cli, cube_folder):
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    arrays, text = read_checkpoint(cube_folder / "cube.results/checkpoint.h5")
    write_checkpoint(
        cube_folder / "cube.results", arrays, json.dumps(json.loads(text) | {"version": "0.0.1"})
    )
    status, _, err = run_cli("run", "cube.yaml", "--resume")
    assert status == 1 and "another version of cdem (0.0.1; this is" in err and "--force" in err
    assert run_cli("run", "cube.yaml", "--resume", "--force", "--quiet")[0] == 0


def test_a_checkpoint_with_a_pair_list_of_before_is_refused_in_one_line(run_cli, cube_folder):
    """Its bounds were in single precision, and faces and edges stood beside their pairs."""
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    arrays, text = read_checkpoint(cube_folder / "cube.results/checkpoint.h5")
    arrays |= {name: np.zeros(0, np.int32) for name in ("outer.slot_faces", "outer.edge_others")}
    arrays |= {name: arrays[name].astype("f4") for name in ("outer.vf_bounds", "outer.ee_bounds")}
    del arrays["outer.ee_edges"]
    write_checkpoint(cube_folder / "cube.results", arrays, text)
    status, out, err = run_cli("run", "cube.yaml", "--resume", "--force")
    assert (status, out, err.count("\n")) == (1, "", 1)
    assert "holds other fields (outer.edge_others, outer.ee_edges, outer.slot_faces, ...)" in err


def test_bounds_of_another_kind_are_refused(run_cli, cube_folder):
    assert run_cli("run", "cube.yaml", "--quiet")[0] == 0
    arrays, text = read_checkpoint(cube_folder / "cube.results/checkpoint.h5")
    arrays["outer.vf_bounds"] = arrays["outer.vf_bounds"].astype("f4")
    for _ in range(2):  # so that the one before is of the same kind
        write_checkpoint(cube_folder / "cube.results", arrays, text)
    status, _, err = run_cli("run", "cube.yaml", "--resume", "--force")
    assert status == 1 and "outer.vf_bounds holds float32, not a row of uint16" in err


@pytest.mark.parametrize("pressed", [False, True])
def test_a_checkpoint_may_lack_the_arrays_of_what_its_case_does_not_have(
    run_cli, cube_folder, pressed
):
    """One of a cdem before surface laws resumes, to the same bytes; where they act it is refused."""
    case = yaml.safe_load(FALL)
    if pressed:
        entry = {"surface": {"group": "cube", "normal": [0, 0, 1]}, "pressure": 10}
        case["loads"]["surfaces"] = [entry]
    (cube_folder / "cube.yaml").write_text(yaml.safe_dump(case))
    simulation = cdem.Simulation(cdem.Case.load("cube.yaml"), output="part", threads=1)
    simulation.run(should_stop=lambda: simulation.step_count >= 5)
    simulation.close()
    arrays, text = read_checkpoint(cube_folder / "part/checkpoint.h5")
    lacks = {n: a for n, a in arrays.items() if "surface" not in n}
    assert len(lacks) < len(arrays)
    write_checkpoint(cube_folder / "part", lacks, text)
    status, _, err = run_cli("run", "cube.yaml", "-o", "part", "--resume", "--quiet")
    if pressed:
        assert status == 1 and "holds other fields" in err and "surface" in err
        return
    assert status == 0, err
    assert run_cli("run", "cube.yaml", "-o", "whole", "--quiet")[0] == 0
    whole, part = (
        read_checkpoint(cube_folder / folder / "checkpoint.h5")[0] for folder in ("whole", "part")
    )
    assert whole.keys() == part.keys()
    assert all((whole[name] == array).all() for name, array in part.items())


def test_a_run_leaves_the_case_of_its_caller_alone():
    case = cdem.Case(
        model={"blocks": [{"group": "rock", "box": {"size": [1, 1, 1]}}]},
        materials={"m": {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.25}},
        groups={"rock": {"material": "m"}},
        interfaces={"default": {"friction_angle": 30}},
        stages=[
            {
                "name": "fall",
                "mode": "dynamic",
                "duration": 1e-3,
                "set": {"interfaces.default.friction_angle": 10},
            }
        ],
    )
    sim = cdem.Simulation(case, threads=1)
    sim.run()
    assert sim.case.interfaces.default.friction_angle == 10
    assert case.interfaces.default.friction_angle == 30


def test_a_case_that_is_changed_after_the_start_stops_the_run():
    """The model is made from it once: a change would do nothing, and would not be said."""
    stages = [{"name": "a", "mode": "dynamic", "duration": 1e-3, "set": {"loads.gravity.2": -5}},
              {"name": "b", "mode": "dynamic", "duration": 1e-3}]  # fmt: skip
    given = cdem.Case(**(yaml.safe_load(FALL) | {"stages": stages}))
    sim = cdem.Simulation(given, threads=1)
    given.loads.gravity[2] = 0.0  # the caller's own is free
    assert sim.run_stage("a") == "finished"
    sim.case.loads.gravity[2] = -3.0
    for go in (sim.run, lambda: sim.step(1)):
        with pytest.raises(
            cdem.CaseError, match=r"simulation\.case\.loads\.gravity\.2: was changed"
        ):
            go()
    sim.case.loads.gravity[2] = -5.0
    assert sim.run() == "finished"


def test_energy_that_is_off_by_more_than_a_percent_is_flagged():
    assert closing({"error": 0.0099}) == "0.99 %"
    assert closing({"error": -0.02}) == "-2 %: above 1 %, check the run before you trust it"


def test_threads_are_those_that_the_core_has(monkeypatch):
    sim = cdem.Simulation("cube.yaml", threads=3)
    assert sim.threads == 3
    monkeypatch.setattr(native.core, "max_threads", lambda: 1)  # as without OpenMP
    sim = cdem.Simulation("cube.yaml", threads=3)
    assert sim.threads == 1


def test_bodies_of_the_caller_go_with_no_result_folder(cube_folder):
    case = cdem.Case.load("cube.yaml")
    mesh = cdem.Simulation(case).build.mesh
    with pytest.raises(ValueError, match="give no output with them"):
        cdem.Simulation(case, output="a.results", more=mesh)
    assert not (cube_folder / "a.results").exists()
