"""The page of a folder that grows, is damaged, or is made again."""

from __future__ import annotations

import gzip
import json
import os

import h5py
import pytest
from shared.moving import surface

from cdem.output.web_page import RunPage
from cdem.run.frame_files import SurfaceFiles, frame_path


@pytest.fixture
def folder(tmp_path):
    """A result folder with four frames and no histories."""
    files = SurfaceFiles(tmp_path / "surface.vtkhdf", ["bed", "body"])
    for frame in range(4):
        s = surface(frame)
        files.append(frame, s.time, s.points, s.polygons, s.point_data, s.cell_data)
    (tmp_path / "case.yaml").write_text("title: Moving\n")
    return tmp_path


def header(page, frames=0):
    raw = gzip.decompress(page.pack(frames, 0, 10**8))
    return json.loads(raw[4 : 4 + int.from_bytes(raw[:4], "little")])


def test_frames_that_come_later_are_sent_alone(folder):
    last = frame_path(folder / "surface", 3)
    content = last.read_bytes()
    last.unlink()
    page = RunPage(folder)
    assert header(page)["times"] == [0, 0.5, 1]
    assert "times" not in header(page, 3)
    last.write_bytes(content)
    new = header(page, 3)
    assert (new["times"], new["framesKnown"], new["facts"]["warnings"]) == ([1.5], 4, [])


def test_frames_before_a_damaged_one_are_shown_and_it_is_told(folder):
    page = RunPage(folder)
    with h5py.File(frame_path(folder / "surface", 2), "a") as file:
        del file["VTKHDF/Points"]
    found = header(page)
    assert found["times"] == [0, 0.5]
    assert "later frames are not shown" in found["facts"]["warnings"][0]


def test_a_run_that_is_made_again_begins_again(folder):
    page = RunPage(folder)
    assert header(page)["framesKnown"] == 4
    for frame in (2, 3):
        frame_path(folder / "surface", frame).unlink()
    os.utime(folder / "case.yaml", ns=(1, 1))
    found = header(page)
    assert (found["framesKnown"], found["facts"]["run"]) == (2, "1")
