"""Links in a result folder: nothing is written, renamed, removed or read through them."""

import os
import shutil

import h5py
import numpy as np
import pytest
from scenes import case

import cdem
from cdem.errors import CdemError, DiskError
from cdem.output.reader import FrameSeries, SurfaceSeries
from cdem.whole_files import write_text


def scene():
    blocks = [{"group": "box", "box": {"size": [1, 1, 1]}}]
    stages = [{"name": "fall", "mode": "dynamic", "duration": 0.01}]
    return case(blocks, {"box": {}}, stages=stages, output={"every": 0.005})


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    path = tmp_path_factory.mktemp("links") / "fall.results"
    cdem.Simulation(scene(), output=path, threads=1).run()
    return path


@pytest.fixture
def results(made, tmp_path):
    """Results in a folder of a stranger, and a folder of the user beside it."""
    (tmp_path / "user").mkdir()
    return shutil.copytree(made, tmp_path / "fall.results")


@pytest.mark.parametrize(
    "name",
    ["frames", "surface", "run.log", "histories.csv", "checkpoint.h5", ".cdem-lock",
     "frames.vtkhdf.tmp", "frames/frame-0001.vtkhdf", "surface/frame-0001.vtkhdf.tmp"],
)  # fmt: skip
@pytest.mark.parametrize("how", ["resume", "overwrite"])
def test_no_run_goes_on_through_a_link(results, tmp_path, name, how):
    user, there = tmp_path / "user", results / name
    if there.is_dir():
        shutil.move(there, user / "own")
    else:
        (user / "own").write_bytes(there.read_bytes() if there.exists() else b"mine")
        there.unlink(missing_ok=True)
    there.symlink_to(user / "own")

    def state():
        return {p: (p.stat().st_mtime_ns, p.stat().st_size) for p in user.rglob("*")}

    before = state()
    try:
        cdem.Simulation(scene(), output=results, threads=1, **{how: True}).run()
        assert how == "overwrite" and not there.is_symlink()  # removed itself
    except CdemError as error:
        assert "is a link" in str(error) or "which cdem did not write" in str(error)
    assert state() == before


def test_a_file_is_not_written_through_a_link_aside(tmp_path):
    (tmp_path / "user").write_text("mine")
    (tmp_path / "a.txt.tmp").symlink_to(tmp_path / "user")
    with pytest.raises(DiskError, match=r"a\.txt: cannot be written"):
        write_text(tmp_path / "a.txt", "other")
    assert (tmp_path / "user").read_text() == "mine"


@pytest.mark.parametrize("how", ["external", "virtual", "storage", "soft", "elements", "link"])
def test_frames_that_lead_elsewhere_are_refused(results, tmp_path, how):
    secret = tmp_path / "user/secret.h5"
    with h5py.File(secret, "w") as file:
        file["x"] = np.full((8, 3), 42.0)
    frame = results / "frames/frame-0001.vtkhdf"
    if how == "elements":
        frame = results / "frames/elements.h5"
    if how == "link":
        os.replace(frame, tmp_path / "user/frame")
        frame.symlink_to(tmp_path / "user/frame")
    else:
        with h5py.File(frame, "r+") as file:
            root = file if how == "elements" else file["VTKHDF"]
            name = "Connectivity" if how == "elements" else "Points"
            del root[name]
            if how in ("external", "elements"):
                root[name] = h5py.ExternalLink(str(secret), "x")
            elif how == "soft":
                root["Other"] = h5py.ExternalLink(str(secret), "/")
                root[name] = h5py.SoftLink("Other/x")
            elif how == "virtual":
                layout = h5py.VirtualLayout((8, 3), float)
                layout[:] = h5py.VirtualSource(str(secret), "x", (8, 3))
                root.create_virtual_dataset(name, layout)
            else:
                root.create_dataset(name, (8, 3), float, external=[(str(secret), 0, 192)])
    with pytest.raises(CdemError, match=r"leads to another|lie in another|is a link"):
        FrameSeries(results).points(1)


def test_frames_of_ours_are_read(results):
    assert len(FrameSeries(results).points(1)) == 8
    assert len(SurfaceSeries(results)[1].points) == 8
