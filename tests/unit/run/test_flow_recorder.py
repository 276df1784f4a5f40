"""Largest values followed during a run: nothing between frames is missed, and nothing else changes."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scenes import case

import cdem
from cdem.errors import CdemError
from cdem.output import runout
from cdem.run import flow_maps
from cdem.run.flow_recorder import FILE, read_maxima

SPEED = 20.0


def thrown(maps=None, duration=1.0, **more):
    """A cube of 1 m above a plate, thrown at 20 m/s; two frames while it goes twenty cells."""
    blocks = [
        {"group": "plate", "box": {"size": [30, 3, 1]}, "translate": [-2, -1, -1]},
        {"group": "cube", "box": {"size": [1, 1, 1]}, "translate": [0, 0, 3]},
    ]
    groups = {"plate": {"fix": ["x", "y", "z"]}, "cube": {"velocity": [SPEED, 0, 0]}}
    output = {"every": duration / 2} | ({"maps": maps} if maps else {})
    stages = [{"name": "fly", "mode": "dynamic", "duration": duration}]
    return case(blocks, groups, **({"stages": stages, "output": output} | more))


@pytest.fixture(scope="module")
def followed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("followed") / "results"
    cdem.Simulation(thrown({"cell": 1}), threads=1, output=folder).run()
    return folder


def test_what_flies_between_two_frames_is_seen(followed):
    found = runout.measure(followed)
    assert found.maps.from_frames == ""
    assert found.maps.flow.cell == 1.0  # that of the case, without --cell
    assert found.maps.flow.jump <= 0.51
    raster = found.maps.rasters["arrival"]
    row = raster.values[round(0 - raster.y)]
    first = round(0 - raster.x)
    assert np.isfinite(row[first : first + 21]).all()
    # seen within half a cell of its way after it has come 0.1 m far into a cell
    late = row[first + 1 : first + 21] - (np.arange(20) + 0.1) / SPEED
    assert late.min() > -1e-6
    assert late.max() < 0.51 / SPEED
    assert "recorded during the run" in found.text()
    # from frames there are gaps
    gaps = runout.measure(followed, cell=2.0)
    assert gaps.maps.from_frames == "the run recorded cells of 1 m"
    assert gaps.maps.flow.jump > 4
    assert gaps.maps.flow.affected.sum() < 10
    assert "maxima have gaps" in gaps.text()


def test_following_changes_no_bit_of_the_run():
    with_maps, without = (
        cdem.Simulation(thrown(maps, duration=0.2), threads=1) for maps in ({"cell": 0.5}, None)
    )
    for sim in (with_maps, without):
        sim.run()
    np.testing.assert_array_equal(with_maps.motion, without.motion)
    assert with_maps.step_count == without.step_count


def test_a_resumed_run_follows_to_the_same_bits(tmp_path):
    made = thrown({"cell": 0.5, "groups": ["cube"]}, duration=0.3)
    whole = cdem.Simulation(made, threads=1, output=tmp_path / "a")
    whole.run()
    half = cdem.Simulation(made, threads=1, output=tmp_path / "b")
    half.run_until(0.13)
    half.checkpoint()
    half.close()
    resumed = cdem.Simulation(made, threads=1, output=tmp_path / "b", resume=True)
    resumed.run()
    for name, values in whole.flow.arrays.items():
        np.testing.assert_array_equal(resumed.flow.arrays[name], values, err_msg=name)
    for a, b in zip(read_maxima(tmp_path / "a"), read_maxima(tmp_path / "b"), strict=True):
        if hasattr(a, "layers"):
            a, b = a.layers, b.layers
        np.testing.assert_array_equal(a, b)


def test_a_resumed_run_cannot_follow_other_cells(tmp_path):
    half = cdem.Simulation(thrown({"cell": 1}), threads=1, output=tmp_path / "r")
    half.run_until(0.1)
    half.checkpoint()
    half.close()
    for maps in ({"cell": 2}, None):
        with pytest.raises(CdemError, match=r"was written with another output\.maps"):
            cdem.Simulation(thrown(maps), threads=1, output=tmp_path / "r", resume=True, force=True)


def test_a_reset_begins_the_run_out_again(tmp_path):
    stages = [
        {"name": "before", "mode": "dynamic", "duration": 0.2},
        {"name": "slide", "mode": "dynamic", "duration": 0.1, "reset_displacement": True},
    ]
    sim = cdem.Simulation(thrown({"cell": 1}, stages=stages), threads=1, output=tmp_path / "r")
    sim.run()
    maps, groups, time = read_maxima(tmp_path / "r")
    assert groups == ["cube"]
    assert maps.start == pytest.approx(0.2, abs=1e-3)
    assert time == sim.time
    assert maps.low[0] == 4  # 20 m/s for 0.2 s
    arrival = maps["arrival"]
    assert np.nanmin(arrival) == 0
    assert np.nanmax(arrival) <= 0.1


def test_maps_of_other_groups_or_of_an_earlier_time_are_not_taken(followed, tmp_path):
    import shutil

    import h5py

    copy = tmp_path / "copy"
    shutil.copytree(followed, copy)
    with h5py.File(copy / FILE, "r+") as file:
        file.attrs["time"] = 0.5
    assert runout.measure(copy).maps.from_frames == "the run recorded them up to t = 0.5 s"
    found = runout.measure(followed, groups=["cube", "plate"], direction=90)
    assert found.maps.from_frames == "the run recorded cube"
    assert json.loads((followed / "summary.json").read_text())["status"] == "finished"
    (copy / FILE).write_bytes(b"no map")
    with pytest.raises(CdemError, match=r"maxima\.h5: is damaged"):
        runout.measure(copy)


def test_a_map_that_grows_too_large_ends_and_the_run_goes_on(tmp_path, monkeypatch):
    monkeypatch.setattr(flow_maps, "MOST_CELLS", 40)
    sim = cdem.Simulation(thrown({"cell": 0.5}), threads=1, output=tmp_path / "r")
    assert sim.run() == "finished"
    assert "output.maps: recording stopped: cells of 0.5 m give a map" in sim.flow.ended
    assert sim.flow.ended in (tmp_path / "r" / "run.log").read_text()
    _, _, time = read_maxima(tmp_path / "r")
    assert time < 0.5
    sim.flow.restore(sim.flow.arrays)
    assert sim.flow.ended


@pytest.mark.parametrize(
    ("maps", "message"),
    [
        ({"cell": 0}, "output.maps.cell: must be above 0"),
        ({"cell": 1, "groups": ["cub"]}, "output.maps.groups.0"),
        ({"cell": 1, "groups": ["cub"]}, "did you mean cube?"),
        ({"cells": 1}, "output.maps.cells: unknown key"),
        ({"cell": 1e-4}, "choose a larger cell"),
    ],
)
def test_what_makes_no_sense_is_said(maps, message):
    with pytest.raises(CdemError) as caught:
        cdem.Simulation(thrown(maps), threads=1).run()
    assert message in str(caught.value)


def test_a_case_in_which_nothing_moves_has_no_maps():
    blocks = [{"group": "plate", "box": {"size": [1, 1, 1]}}]
    with pytest.raises(CdemError, match=r"output\.maps: no group moves"):
        case(blocks, {"plate": {"fix": ["x", "y", "z"]}}, output={"maps": {"cell": 1}})
