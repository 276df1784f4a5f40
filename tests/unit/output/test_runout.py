"""Run-out: blocks whose motion is known beforehand, measured from their result folders."""

from __future__ import annotations

import csv
import json

import numpy as np
import pytest
from scenes import case

import cdem
from cdem.errors import CdemError
from cdem.output import runout

TIME = 0.5


SPEED = 4.0  # towards azimuth 30 deg


AZIMUTH = 30.0


WAY = np.array([np.sin(np.radians(AZIMUTH)), np.cos(np.radians(AZIMUTH))])


LOW = {"friction_angle": 0}


def box(group, size, at, divisions=(1, 1, 1), **more):
    return {"group": group, "box": {"size": size, "divisions": divisions, **more}, "translate": at}


def run(folder, blocks, groups, **more):
    made = case(blocks, groups, **more)
    cdem.Simulation(made, threads=1, output=folder).run()
    return folder


@pytest.fixture(scope="module")
def thrown(tmp_path_factory):
    """Two blocks thrown off a cliff: a 2 m cube, 1.5 m before it a 1 m cube of tets; nothing is hit."""
    blocks = [
        box("cliff", [3, 3, 10], [-10, -10, 0]),
        box("rear", [2, 2, 2], [0, 0, 10], [2, 2, 2]),
        box("ahead", [1, 1, 1], [3.5, 0, 10], shape="tet4"),
    ]
    velocity = [*(SPEED * WAY), 0.0]
    groups = {"cliff": {"fix": ["x", "y", "z"]}} | {
        name: {"velocity": velocity} for name in ("rear", "ahead")
    }
    return run(
        tmp_path_factory.mktemp("thrown") / "results", blocks, groups,
        loads={"gravity": [0, 0, -10]},
        stages=[{"name": "fly", "mode": "dynamic", "duration": TIME}], output={"every": 0.05},
    )  # fmt: skip


def test_a_throw_is_measured_as_it_was_thrown(thrown):
    found = runout.measure(thrown, cell=1.0)
    assert found.groups == ["rear", "ahead"]
    assert found.direction == pytest.approx(AZIMUTH, abs=1e-6)
    # the crown is the rearmost of the highest corners, the front the farthest corner's foot
    np.testing.assert_allclose(found.crown, [0, 0, 12], atol=1e-9)
    fall = 0.5 * 10 * TIME**2
    np.testing.assert_allclose(found.front[2], 10 - fall, rtol=1e-3)
    farthest = max(np.array([4.5, 1]) @ WAY, np.array([2, 2]) @ WAY) + SPEED * TIME
    assert found.reach == pytest.approx(farthest, rel=1e-4)
    assert found.drop == pytest.approx(2 + fall, rel=1e-3)
    assert found.centre_travel == pytest.approx(SPEED * TIME, rel=1e-4)
    assert found.centre_drop == pytest.approx(fall, rel=1e-3)
    assert found.history["speed"][-1] == pytest.approx(np.hypot(SPEED, 10 * TIME), rel=1e-3)
    np.testing.assert_allclose(found.history["volume"], 9.0, rtol=1e-4)
    assert not found.rests
    assert found.moving_share == 1
    assert found.speed_end == pytest.approx(np.hypot(SPEED, 10 * TIME), rel=1e-3)
    text = found.text()
    assert f"still moving at {found.speed_end:.3g} m/s (100 % of the mass above 0.1 m/s)" in text
    assert "deposit:" not in text
    assert "  body at t = 0.5" in text
    assert "towards 30.0 deg" in text
    assert f"{found.drop / found.reach:.4f}" in text


def test_reach_is_that_of_the_mass(thrown):
    found = runout.measure(thrown, groups=["rear"], direction=90)
    # towards x the mass of a cube from 0 to 2 m is even
    for share in (0.95, 0.999):
        column = found.history["reach_95" if share == 0.95 else "reach_99_9"]
        np.testing.assert_allclose(
            column, 2 * share + SPEED * WAY[0] * found.history["time"], rtol=1e-4
        )


def test_the_map_holds_the_volume(thrown):
    for cell in (None, 0.3, 1.0):
        found = runout.measure(thrown, cell=cell)
        assert found.deposit.volume == pytest.approx(found.history["volume"][-1], rel=1e-12)
    assert runout.measure(thrown).deposit.cell == 1.0  # eight cubes of 1 m and six tets of 1/6
    source = runout.measure(thrown, cell=1.0).source
    assert source.covered.sum() == 4 + 2  # the small cube lies over two cells
    np.testing.assert_allclose(source.thickness.max(), 2.0)


def test_sections_count_what_passed(thrown):
    # both blocks go (1, 1.73) m: the small one over x = 4.2, of which 0.3 m were there before, both
    # over y = 2, none over x = 30; the last line is too short for the small one
    lines = [(4.2, -9, 4.2, 9), (9, 2, -9, 2), (30, -9, 30, 9), (0, 2, 3, 2)]
    found = runout.measure(thrown, sections=lines)
    passed = [s.history["passed"][-1] for s in found.sections]
    north = SPEED * WAY[1] * found.history["time"][-1]
    small, large = north + 1 - 2, 4 * north
    assert passed[0] == pytest.approx(0.7, rel=1e-4)
    assert passed[1] == pytest.approx(small + large, rel=1e-4)
    assert passed[2] == 0.0
    assert passed[3] == pytest.approx(large, rel=1e-4)
    area = found.sections[3].history["area"]
    assert area[0] == 0.0
    np.testing.assert_allclose(area[2:], 4.0, rtol=1e-4)
    assert np.nanmax(found.sections[1].history["velocity"]) == pytest.approx(
        SPEED * WAY[1], rel=1e-6
    )
    still = found.sections[2].history
    assert np.isnan(still["velocity"]).all()
    assert (still["discharge"] == 0).all()
    # a discharge that lasts: area times speed
    middle = found.sections[1].history
    np.testing.assert_allclose(
        middle["discharge"], middle["area"] * SPEED * WAY[1], rtol=1e-4, atol=1e-9
    )


def test_a_block_on_an_incline_runs_out_at_the_angle_of_its_bed(tmp_path):
    incline = {"axis": [0, 1, 0], "angle": "30 deg"}
    blocks = [
        box("bed", [12, 4, 1], [0, 0, 0]) | {"rotate": incline, "translate": [0, 0, 0]},
        box("block", [1, 1, 1], [0, 0, 0])
        | {"rotate": incline, "translate": [np.sin(np.pi / 6), 1.5, np.cos(np.pi / 6)]},
    ]
    folder = run(
        tmp_path / "r", blocks, {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
        loads={"gravity": [0, 0, -10]}, rock={"young_modulus": "100 MPa"},
        stages=[{"name": "slide", "mode": "dynamic", "duration": 1.0}], output={"every": 0.2},
    )  # fmt: skip
    found = runout.measure(folder)
    assert found.groups == ["block"]
    assert found.direction == pytest.approx(90, abs=1e-3)
    assert found.centre_drop / found.centre_travel == pytest.approx(np.tan(np.pi / 6), rel=1e-3)
    travel = 0.5 * 10 * np.sin(np.pi / 6) * np.cos(np.pi / 6)
    assert found.centre_travel == pytest.approx(travel, rel=5e-3)
    # crown and front are the upper edges at its rear and front; the foot of the front is a metre down
    assert found.reach == pytest.approx(np.cos(np.pi / 6) + found.centre_travel, rel=1e-3)
    foot = np.sin(np.pi / 6) + np.cos(np.pi / 6) + found.centre_drop
    assert found.drop == pytest.approx(foot, rel=1e-3)


def test_the_energy_line_of_a_block_that_slides_falls_by_its_friction(tmp_path):
    incline = {"axis": [0, 1, 0], "angle": "30 deg"}
    blocks = [
        box("bed", [20, 4, 1], [0, 0, 0]) | {"rotate": incline},
        box("block", [1, 1, 0.5], [0, 0, 0])
        | {"rotate": incline, "translate": [np.sin(np.pi / 6), 1.5, np.cos(np.pi / 6)]},
    ]
    folder = run(
        tmp_path / "r", blocks, {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
        loads={"gravity": [0, 0, -10]}, rock={"young_modulus": "100 MPa"},
        interfaces={"default": {"friction_angle": 20}},
        stages=[{"name": "slide", "mode": "dynamic", "duration": 2.0}], output={"every": 0.2},
    )  # fmt: skip
    found = runout.measure(folder)  # the block still vibrates: 0.8 % off
    assert found.energy_slope == pytest.approx(np.tan(np.radians(20)), rel=2.5e-2)
    assert "energy line: falls by 0.36" in found.text()


@pytest.fixture(scope="module")
def broken(tmp_path_factory):
    """A bonded bar of six cubes, torn at its weak third joint; the left end hangs on a post."""
    blocks = [
        box("post", [1, 1, 1], [-1, 0, 0]),
        box("left", [3, 1, 1], [0, 0, 0], [3, 1, 1]),
        box("right", [3, 1, 1], [3, 0, 0], [3, 1, 1]),
    ]
    strong = {"friction_angle": 0, "cohesion": "1 GPa", "tensile_strength": "1 GPa"}
    weak = {"between": ["left", "right"], "cohesion": "1 kPa", "tensile_strength": "1 kPa"}
    return run(
        tmp_path_factory.mktemp("broken") / "results", blocks,
        {"post": {"fix": ["x", "y", "z"]}, "left": {}, "right": {"velocity": [1, 0, 0]}},
        model={"split": {"left": "elements", "right": "elements"}},
        interfaces={"default": strong, "pairs": [weak]},
        stages=[{"name": "tear", "mode": "dynamic", "duration": 0.02}], output={"every": 0.002},
    )  # fmt: skip


def test_pieces_of_a_bar_broken_in_a_known_place(broken):
    found = runout.measure(broken, groups=["left", "right"])
    h = found.history
    assert (h["pieces"][0], h["attached"][0], h["largest"][0]) == (1, 1, 1)
    assert h["pieces"][-1] == 2
    assert h["attached"][-1] == pytest.approx(0.5, abs=1e-4)
    assert h["broken_tension"][-1] == 4
    assert h["broken_shear"][-1] == 0
    assert h["broken_tension"][0] == 0
    pieces = found.fragments
    np.testing.assert_array_equal(pieces["elements"], [3, 3])
    np.testing.assert_allclose(pieces["volume"], 3.0, rtol=1e-3)
    np.testing.assert_allclose(pieces["mass"], 7500.0, rtol=1e-12)
    np.testing.assert_allclose(pieces["diameter"], np.cbrt(18 / np.pi), rtol=1e-3)
    right = int(pieces["x"].argmax())
    assert pieces["x"][right] == pytest.approx(4.5 + 0.02, abs=1e-3)
    np.testing.assert_array_equal(pieces["attached"], [i != right for i in range(2)])
    np.testing.assert_allclose(pieces["share_of_smaller"], [0.5, 0], atol=1e-3)
    # the default is what moved: the right half alone, one piece from the time of the break
    assert runout.measure(broken).groups == ["right"]


def test_settling_that_was_reset_is_no_run_out(tmp_path):
    stages = [
        {"name": "settle", "mode": "dynamic", "duration": 0.2},
        {"name": "slide", "mode": "dynamic", "duration": 0.1, "reset_displacement": True},
    ]
    folder = run(
        tmp_path / "r", [box("cube", [1, 1, 1], [0, 0, 0])], {"cube": {"velocity": [1, 0, 0]}},
        stages=stages, output={"every": 0.05},
    )  # fmt: skip
    found = runout.measure(folder, sections=[(1.15, -9, 1.15, 9)])
    assert found.crown[0] == pytest.approx(0.2, rel=1e-3)
    assert found.history["time"][0] == pytest.approx(0.2, rel=1e-3)
    assert found.centre_travel == pytest.approx(0.1, rel=2e-2)
    # 0.05 m were beyond the line when the slide began
    assert found.sections[0].history["passed"][-1] == pytest.approx(found.centre_travel, rel=1e-6)


def test_a_strength_set_to_zero_joins_nothing(tmp_path):
    blocks = [box("a", [1, 1, 1], [0, 0, 0]), box("b", [1, 1, 1], [1, 0, 0])]
    bond = {"friction_angle": 0, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
    stages = [
        {"name": "whole", "mode": "dynamic", "duration": 0.001},
        {"name": "apart", "mode": "dynamic", "duration": 0.001,
         "set": {"interfaces.default.cohesion": 0, "interfaces.default.tensile_strength": 0}},
    ]  # fmt: skip
    moving = {"velocity": [1, 0, 0]}
    folder = run(
        tmp_path / "r", blocks, {"a": moving, "b": moving}, interfaces={"default": bond},
        stages=stages, output={"every": 0.001},
    )  # fmt: skip
    np.testing.assert_array_equal(runout.measure(folder).history["pieces"], [1, 1, 2, 2])


def test_files_read_back(thrown, tmp_path):
    line = (4.2, -9, 4.2, 9)
    found = runout.measure(thrown, cell=0.5, sections=[line, line])
    names = {path.name for path in found.write(tmp_path) if path.parent == tmp_path}
    assert names == {
        "runout.json", "runout.csv", "deposit.asc", "deposit.tif", "fragments.csv", "sections.csv",
        "grain_sizes.csv",
    }  # fmt: skip
    lines = (tmp_path / "deposit.asc").read_text().splitlines()
    head = dict(text.split() for text in lines[:6])
    rows = np.loadtxt(lines[6:])
    assert rows.shape == (int(head["nrows"]), int(head["ncols"]))
    assert float(head["xllcorner"]) == found.deposit.x
    assert rows[rows != -9999].sum() * 0.25 == pytest.approx(found.deposit.volume, rel=1e-8)
    north = found.deposit.thickness[-1]
    np.testing.assert_array_equal(rows[0], np.where(north > 1e-9, north, -9999))

    image = pytest.importorskip("PIL.Image").open(tmp_path / "deposit.tif")
    np.testing.assert_array_equal(np.asarray(image), rows.astype(np.float32))
    north_edge = found.deposit.y + len(rows) * 0.5
    assert image.tag_v2[33550] == (0.5, 0.5, 0.0)
    assert image.tag_v2[33922] == (0, 0, 0, found.deposit.x, north_edge, 0)
    assert image.tag_v2[42113] == "-9999"

    data = json.loads((tmp_path / "runout.json").read_text())
    assert data["h_over_l"] == pytest.approx(found.drop / found.reach)
    assert data["deposit"]["volume"] == pytest.approx(9.0, rel=1e-4)
    assert len(data["history"]["front"]) == len(found.history["time"])
    assert data["sections"][0]["history"]["velocity"][-1] is None  # no rock there any more
    with (tmp_path / "sections.csv").open() as file:
        table = list(csv.DictReader(file))
    assert [row["section"] for row in table] == ["1"] * 11 + ["2"] * 11
    assert float(table[10]["passed [m3]"]) == pytest.approx(0.7, rel=1e-4)
    with (tmp_path / "runout.csv").open() as file:
        assert float(list(csv.DictReader(file))[-1]["front [m]"]) == found.reach


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"groups": ["rare"]}, "no group 'rare'; it has: cliff, rear, ahead"),
        ({"groups": ["cliff"]}, "has not moved in plan; give a direction"),
        ({"direction": np.nan}, "the direction must be an azimuth in degrees"),
        ({"cell": -1.0}, "the cell of the map must be above 0 m, got -1"),
        ({"cell": 1e-4}, "choose a larger cell"),
        ({"sections": [(1, 2, 1, 2)]}, "a section needs two different ends"),
        ({"sections": [(1, 2, 3)]}, "a section needs x0, y0, x1, y1"),
    ],
)
def test_what_makes_no_sense_is_said(thrown, words, message):
    with pytest.raises(CdemError, match=message):
        runout.measure(thrown, **words)


def test_a_folder_without_frames_is_said(tmp_path):
    blocks = [box("cube", [1, 1, 1], [0, 0, 0])]
    short = [{"name": "rest", "mode": "dynamic", "duration": 1e-3}]
    without = run(tmp_path / "a", blocks, {"cube": {}}, stages=short, output={"frames": False})
    with pytest.raises(CdemError, match=r"was output\.frames switched off"):
        runout.measure(without)
    still = run(tmp_path / "b", blocks, {"cube": {}}, stages=short)
    with pytest.raises(CdemError, match="nothing has moved; name the groups"):
        runout.measure(still)


def test_runs_without_velocity_and_pieces_are_measured_without(tmp_path):
    moving = {"cube": {"velocity": [1, 0, 0]}}
    stages = [{"name": "fly", "mode": "dynamic", "duration": 0.01}]
    folder = run(
        tmp_path / "r", [box("cube", [1, 1, 1], [0, 0, 0])], moving, stages=stages,
        output={"fields": [], "every": 0.002},
    )  # fmt: skip
    found = runout.measure(folder, sections=[(1.0, -9, 1.0, 9)])
    assert found.centre_travel == pytest.approx(found.history["time"][-1], rel=1e-6)
    assert np.isnan(found.history["speed"]).all()
    assert "not recorded; add piece to output.fields" in found.text()
    assert "not recorded; add velocity to output.fields" in found.text()
    assert "fragments.csv" not in {path.name for path in found.write(tmp_path)}


def test_the_program_prints_a_table_and_writes_files(run_cli, thrown):
    status, out, err = run_cli(
        "runout", str(thrown), "--cell", "0.5", "--groups", "rear, ahead", "--section", "4.2,-9,4.2,9",
        "--direction", "30",
    )  # fmt: skip
    assert (status, err) == (0, "")
    assert "run-out of rear, ahead: 9 m3 towards 30.0 deg, t = 0.5" in out
    assert "section 1 (4.2, -9, 4.2, 9): passed 0.7 m3" in out
    assert (thrown / "deposit.png").stat().st_size > 5000
    status, out, _ = run_cli("runout", str(thrown), "--json")
    assert status == 0
    assert json.loads(out) == json.loads((thrown / "runout.json").read_text())


@pytest.mark.parametrize(
    ("words", "status", "message"),
    [
        (["--groups", "rare"], 1, "no group 'rare'"),
        (["--direction", "up"], 2, "--direction needs a number, got 'up'"),
        (["--section", "1,2,3"], 2, "--section needs 4 numbers separated by commas, got '1,2,3'"),
    ],
)
def test_the_program_says_what_is_wrong(run_cli, thrown, words, status, message):
    found, out, err = run_cli("runout", str(thrown), *words)
    assert (found, out) == (status, "")
    assert message in err
    assert "Traceback" not in err
