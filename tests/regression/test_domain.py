"""Blocks that leave the domain of the model: physics, bits, and what is told of them."""

import hashlib
import json

import numpy as np
import pytest

import cdem
from cdem.output import runout
from cdem.output.reader import FrameSeries, SurfaceSeries, read_histories

TABLE = """\
title: Blocks slide off a table one after the other
model:
  blocks:
    - {group: table, box: {size: [6, 4, 1]}, translate: [0, 0, -1]}
    - {group: train, box: {size: [1, 1, 1], divisions: [2, 2, 2], shape: tet4}, translate: [4.9, 1.5, 0]}
    - {group: train, box: {size: [1, 1, 1]}, translate: [3.8, 1.4, 0]}
    - {group: train, box: {size: [1, 1, 1]}, translate: [2.7, 1.6, 0]}
    - {group: last, box: {size: [1, 1, 1]}, translate: [0.5, 1.5, 0]}
  domain: {min: [null, null, -1.6], max: [7.2, null, null]}
  split: {train: elements}
materials: {rock: {density: 2700, young_modulus: "20 MPa", poisson_ratio: 0.25}}
groups:
  table: {material: rock, fix: [x, y, z]}
  train: {material: rock, velocity: [4, 0, 0]}
  last: {material: rock}
interfaces: {default: {friction_angle: 5, cohesion: "1 MPa", tensile_strength: "1 MPa"},
             pairs: [{between: [table, train], friction_angle: 5, cohesion: 0, tensile_strength: 0},
                     {between: [table, last], friction_angle: 5, cohesion: 0, tensile_strength: 0}]}
loads: {gravity: [0, 0, -9.81]}
stages:
  - {name: slide, mode: dynamic, duration: 0.8, damping: {contact: 0.2, stiffness: 0.1}}
  - {name: on, mode: dynamic, duration: 0.6, set: {interfaces.default.friction_angle: 10},
     damping: {contact: 0.2, stiffness: 0.1}}
output: {every: 0.1}
"""


def digest(sim):
    """Hash of everything that a checkpoint keeps."""
    whole = hashlib.sha256(json.dumps(sim.core.scalars()).encode())
    for name, values in sorted(sim.core.fields().items()):
        whole.update(name.encode() + np.ascontiguousarray(values).tobytes())
    return whole.hexdigest()


@pytest.fixture(scope="module")
def case_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("domain") / "table.yaml"
    path.write_text(TABLE)
    return path


@pytest.fixture(scope="module")
def whole(case_file):
    """A run without a stop. Tests must not change it."""
    simulation = cdem.Simulation(case_file, threads=1, output=case_file.parent / "whole")
    assert simulation.run() == "finished"
    return simulation


def test_blocks_leave_one_after_the_other_and_the_others_go_on(whole):
    out, names = whole.out, np.array(whole.build.group_names)
    groups = names[whole.build.topology.block_group]
    assert out[groups == "train"].all() and not out[groups != "train"].any()
    lost = whole.taken_out["train"]
    assert lost["blocks"] == 48 + 2
    assert lost["mass"] == pytest.approx(3 * 2700, rel=1e-12)
    nodes = whole.build.nodes_of("train")
    assert not whole.fields["velocity"][nodes].any()
    middle = whole.rigid_motion.middle[out]
    assert ((middle[:, 0] > 7.2) | (middle[:, 2] < -1.6)).all()
    # they hardly went on: a row is 10 ms, 4 to 6 cm
    assert middle[:, 0].max() < 7.2 + 1.1 and middle[:, 2].min() > -1.6 - 1.1
    assert not set(np.flatnonzero(out)) & set(whole.fallen)
    assert np.isfinite(whole.core.stress()["tet4"]).all()


def test_the_energy_of_what_leaves_is_booked(whole, case_file):
    rows = read_histories(case_file.parent / "whole")
    gone, error = rows["taken_out work [J]"], rows["energy error"]
    assert np.abs(error).max() < 1e-5
    assert len(np.unique(gone)) == 4 and (np.diff(gone) >= 0).all()  # three bodies
    # each took its kinetic energy with it, 4 m/s and the fall, and hardly anything else
    assert 3 * 0.5 * 2700 * 3.5**2 < gone[-1] < 3 * 0.5 * 2700 * 5.0**2
    at = np.flatnonzero(np.diff(gone)) + 1
    kinetic = rows["kinetic energy [J]"]
    assert (kinetic[at] < kinetic[at - 1]).all()
    assert (np.abs(np.diff(error))[at - 1] < 2e-6).all()


def test_what_left_is_told(whole, case_file, run_cli):
    folder = case_file.parent / "whole"
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["taken_out"] == whole.taken_out
    log = (folder / "run.log").read_text()
    assert log.count("of group train left model.domain") == log.count("left model.domain") == 1
    told = run_cli("info", str(folder))[1]
    assert "left the domain: 50 blocks of group train, 8100 kg (100 % of its mass)" in told
    assert "still moving" not in told


def test_frames_flag_what_left_and_the_surface_is_without_it(whole, case_file):
    folder = case_file.parent / "whole"
    frames, surfaces = FrameSeries(folder), SurfaceSeries(folder)
    flags = [frames.field("CellData", "out", k) for k in range(len(frames))]
    counts = [int(f.sum()) for f in flags]
    assert counts[0] == 0 and counts[-1] == 50 and counts == sorted(counts)
    for k, flag in enumerate(flags):
        block = frames.field("CellData", "block", k)
        assert not set(surfaces[k].cell_data["block"]) & set(block[flag == 1])
        assert set(block[flag == 0]) >= set(surfaces[k].cell_data["block"])


def test_run_out_is_that_of_what_stays(whole, case_file):
    folder = case_file.parent / "whole"
    with pytest.raises(cdem.CdemError, match=r"all of train has left model\.domain"):
        runout.measure(folder, groups=["train"], direction=90)
    found = runout.measure(folder, groups=["train", "last"], direction=90)
    assert found.taken_out == pytest.approx(3, rel=1e-9)
    assert found.deposit.volume == pytest.approx(1, rel=1e-3)  # the block that never moved
    assert found.history["volume"][-1] == pytest.approx(1, rel=1e-3)
    assert found.front[0] == pytest.approx(1.5, abs=1e-2)
    assert found.rests and found.fragments["elements"].sum() == 1
    assert "3 m3 more have left model.domain" in found.text()


def test_any_number_of_threads_gives_the_same_bits(whole, case_file):
    assert whole.out.any()
    for threads in (2, 3):
        other = cdem.Simulation(case_file, threads=threads)
        other.run()
        assert digest(other) == digest(whole)


def stop_behind_the_next(simulation):
    """Run until one more body has left."""
    seen = simulation.out.sum()
    assert simulation.run(should_stop=lambda: simulation.out.sum() > seen) == "stopped"


def test_any_split_gives_the_same_bits(whole, case_file):
    """Also right after a body has left, and over a stage that sets supports and loads again."""
    folder = case_file.parent / "split"
    simulation = cdem.Simulation(case_file, threads=1, output=folder)
    simulation.run_until(0.06)
    simulation.checkpoint()
    for _ in range(3):  # bodies
        simulation.close()
        simulation = cdem.Simulation(case_file, threads=1, output=folder, resume=True)
        stop_behind_the_next(simulation)
    simulation.close()
    simulation = cdem.Simulation(case_file, threads=1, output=folder, resume=True)
    assert simulation.out.sum() == 50 and simulation.run() == "finished"
    assert digest(simulation) == digest(whole)
    histories = [case_file.parent / run / "histories.csv" for run in ("split", "whole")]
    assert histories[0].read_bytes() == histories[1].read_bytes()
    assert (folder / "run.log").read_text().count("left model.domain") == 1


@pytest.mark.parametrize("way", ["incremental", "one-point", "static"])
def test_other_formulations_and_static_stages_let_blocks_go(way):
    """Two boxes drop out of the domain; the third stands on its foot."""
    size = {"size": [1, 1, 1], "divisions": [2, 2, 2]}
    stage = {"name": "fall", "mode": "dynamic", "duration": 0.6}
    if way == "static":
        stage = {"name": "fall", "mode": "static", "relax": "adaptive", "max_steps": 3000}
    simulation = cdem.Simulation(
        cdem.Case.from_dict(
            {
                "model": {
                    "blocks": [
                        {"group": "foot", "box": {"size": [1, 1, 1]}, "translate": [0, 0, -1]},
                        {"group": "stands", "box": size},
                        {"group": "falls", "box": size, "translate": [3, 0, 0]},
                        {"group": "falls", "box": size, "translate": [6, 0, 0]},
                    ],
                    "domain": {"min": [None, None, -1]},
                },
                "materials": {
                    "rock": {"density": 2700, "young_modulus": 2e7, "poisson_ratio": 0.25}
                },
                "groups": {
                    "foot": {"material": "rock", "fix": ["x", "y", "z"]},
                    "stands": {"material": "rock"},
                    "falls": {"material": "rock"},
                },
                "interfaces": {"default": {"friction_angle": 30}},
                "loads": {"gravity": [0, 0, -9.81]},
                "elements": {"hexahedra": "one-point"}
                if way == "one-point"
                else {"formulation": "incremental" if way == "incremental" else "corotational"},
                "stages": [stage],
            }
        ),
        threads=1,
    )
    status = simulation.run()
    assert status == ("converged" if way == "static" else "finished")
    assert simulation.taken_out["falls"]["blocks"] == 2
    assert abs(simulation.energies["error"]) < 2e-7
    stands = simulation.build.nodes_of("stands")
    assert np.abs(simulation.fields["displacement"][stands]).max() < 0.02
    for values in simulation.core.stress().values():
        assert np.isfinite(values).all()


SLIDE = """\
title: A weak body breaks up on a slope that ends
model:
  blocks:
    - {group: slope, box: {size: [4, 4, 1], divisions: [2, 2, 1]}, translate: [0, 0, -1]}
    - {group: body, box: {size: [1.5, 1.5, 1], divisions: [3, 3, 2], shape: tet4, cells: alike},
       translate: [2.2, 1.2, 0]}
    - {group: stone, box: {size: [0.5, 0.5, 0.5]}, translate: [0.2, 0.2, 0]}
  split: {body: elements}
  domain: {min: [null, -3, -4], max: [7, 7, null]}
materials: {rock: {density: 2600, young_modulus: "1 MPa", poisson_ratio: 0.25}}
groups:
  slope: {material: rock, fix: [x, y, z]}
  body: {material: rock, velocity: [2, 0, 0]}
  stone: {material: rock}
interfaces:
  default: {friction_angle: 50, stiffness_n: 10 E/h, stiffness_s: 10 E/h}
  pairs:
    - {between: [slope, body], friction_angle: 10}
    - {between: [body, body], friction_angle: 20, cohesion: "3 kPa", tensile_strength: "1 kPa"}
loads: {gravity: [5.6, 0, -8.0]}     # 35 degrees
stages:
  - {name: slide, mode: dynamic, duration: 8, until: rest,
     damping: {contact: 0.3, stiffness: 0.1}}
elements: {mass: exact}
output: {every: 0.25}
"""


@pytest.fixture
def slide(tmp_path, monkeypatch, no_report, no_sheets):
    """Words that run the landslide in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "slide.yaml").write_text(SLIDE)
    return ("run", "slide.yaml", "--threads", "1")


@pytest.mark.slow  # quick: test_a_fall_as_fast_as_a_wave_is_said_to_be_a_fall
def test_without_the_domain_its_fall_ends_the_run_at_the_speed_of_the_wave(run_cli, slide):
    on = ("--set", "model.domain=null", "--set", "stages.0.until=null", "-o", "open")
    status, _, err = run_cli(*slide, *on)
    assert status == 3 and "or let model.domain remove such blocks" in err


def test_a_landslide_off_the_edge_comes_to_its_end(tmp_path, run_cli, slide):
    status, out, err = run_cli(*slide)
    lost = json.loads((tmp_path / "slide.results/summary.json").read_text())["taken_out"]
    but = f"but for {lost['body']['blocks']} blocks of group body that left the domain"
    assert (status, out) == (0, f"at rest, {but}; results are in slide.results\n")
    assert err.count("of group body left model.domain") == 1
    rows = read_histories(tmp_path / "slide.results")
    assert np.abs(rows["energy error"]).max() < 5e-3
    assert rows["broken tension"][-1] + rows["broken shear"][-1] > 50
    assert len(np.unique(rows["taken_out work [J]"])) > 4
    assert lost["body"]["blocks"] > 100 and "stone" not in lost
    assert run_cli("runout", "slide.results", "--groups", "stone,body", "--direction", "90")[0] == 0
