"""Series and histories: what is written reads back to the bit, also after a broken run."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from cdem.errors import CdemError
from cdem.run.writers import FrameWriter, HistoryWriter, SurfaceWriter

# a tetrahedron, a pyramid on it, a wedge and a cube: node ids only need to be in range
CELLS = {
    "tet4": np.array([[0, 1, 2, 3]]),
    "pyramid5": np.array([[0, 1, 2, 3, 4]]),
    "wedge6": np.array([[0, 1, 2, 3, 4, 5]]),
    "hex8": np.array([[0, 1, 2, 3, 4, 5, 6, 7]]),
}


STATIC = {"group": np.array([0, 0, 1, 1], np.int32), "block": np.array([3, 2, 1, 0], np.int32)}


NODES = 8


def frame(step: int) -> tuple:
    random = np.random.default_rng(step)
    points = random.random((NODES, 3))
    return (
        0.1 * step,
        points,
        {"displacement": random.random((NODES, 3))},
        {"stress": random.random((4, 6)), "damage": random.random(4)},
    )


def surface(step: int) -> tuple:
    """Triangles and a quadrilateral; one more triangle in each frame."""
    random = np.random.default_rng(100 + step)
    polygons = np.array([[0, 1, 2, 3], *[[0, 1, 2 + n % 2, -1] for n in range(step + 1)]])
    faces = len(polygons)
    return (
        0.1 * step,
        random.random((4 + step, 3)),
        polygons,
        {"displacement": random.random((4 + step, 3))},
        {"group": np.arange(faces), "broken": np.ones(faces, np.int8)},
    )


def write_volume(path: Path, steps: range, keep: int | None = None) -> None:
    writer = FrameWriter(path, CELLS, STATIC, keep)
    for step in steps:
        writer.append(*frame(step))
    writer.close()


def write_surface(path: Path, steps: range, keep: int | None = None) -> None:
    writer = SurfaceWriter(path, keep)
    for step in steps:
        writer.append(*surface(step))
    writer.close()


def contents(path: Path) -> dict[str, np.ndarray]:
    found = {}
    with h5py.File(path, "r") as file:
        file.visititems(
            lambda name, item: found.update(
                {name: item[()]} if isinstance(item, h5py.Dataset) else {}
            )
        )
        found["NSteps"] = file["VTKHDF/Steps"].attrs["NSteps"]
    return found


def assert_same(one: Path, other: Path) -> None:
    one_content, other_content = contents(one), contents(other)
    assert one_content.keys() == other_content.keys()
    for name, values in one_content.items():
        np.testing.assert_array_equal(values, other_content[name], err_msg=name)


@pytest.mark.parametrize("write", [write_volume, write_surface])
@pytest.mark.parametrize("keep", [0, 1, 3, 5])
def test_a_resumed_series_equals_an_unbroken_one(tmp_path, write, keep):
    write(tmp_path / "unbroken.vtkhdf", range(6))
    write(tmp_path / "broken.vtkhdf", range(5))
    write(tmp_path / "broken.vtkhdf", range(keep, 6), keep)
    assert_same(tmp_path / "unbroken.vtkhdf", tmp_path / "broken.vtkhdf")


@pytest.mark.parametrize("write", [write_volume, write_surface])
def test_a_frame_that_was_cut_short_leaves_no_trace(tmp_path, write):
    """As after a kill in the middle of append: rows are there, but the frame was not counted."""
    write(tmp_path / "unbroken.vtkhdf", range(4))
    write(tmp_path / "broken.vtkhdf", range(3))
    with h5py.File(tmp_path / "broken.vtkhdf", "r+") as file:
        file["VTKHDF/Steps"].attrs["NSteps"] = 2
    write(tmp_path / "broken.vtkhdf", range(2, 4), 2)
    assert_same(tmp_path / "unbroken.vtkhdf", tmp_path / "broken.vtkhdf")


@pytest.mark.parametrize("write", [write_volume, write_surface])
def test_more_frames_than_the_file_holds_cannot_be_kept(tmp_path, write):
    write(tmp_path / "a.vtkhdf", range(2))
    with pytest.raises(CdemError, match=r"holds 2 frames.*after 3.*--overwrite"):
        write(tmp_path / "a.vtkhdf", range(3, 4), 3)


def test_a_missing_or_broken_series_cannot_be_resumed(tmp_path):
    with pytest.raises(CdemError, match=r"none\.vtkhdf"):
        SurfaceWriter(tmp_path / "none.vtkhdf", 1)
    (tmp_path / "junk.vtkhdf").write_bytes(b"junk")
    with pytest.raises(CdemError, match=r"junk\.vtkhdf"):
        SurfaceWriter(tmp_path / "junk.vtkhdf", 1)


def test_fields_may_not_change_within_a_series(tmp_path):
    writer = FrameWriter(tmp_path / "a.vtkhdf", CELLS, STATIC)
    writer.append(*frame(0))
    moment, points, point_data, _ = frame(1)
    with pytest.raises(CdemError, match=r"output\.fields"):
        writer.append(moment, points, point_data, {"damage": np.zeros(4)})


def test_small_models_make_small_files(tmp_path):
    write_volume(tmp_path / "a.vtkhdf", range(10))
    assert (tmp_path / "a.vtkhdf").stat().st_size < 200_000


WRITE_FOR_EVER = """
import sys
from itertools import count
from pathlib import Path
sys.path.insert(0, sys.argv[2])
import test_writers as t
writer = t.SurfaceWriter(Path(sys.argv[1]))
for step in count():
    writer.append(*t.surface(step))
    print(step, flush=True)
"""


def test_a_killed_run_leaves_files_that_can_be_read_and_resumed(tmp_path):
    path = tmp_path / "a.vtkhdf"
    command = [sys.executable, "-c", WRITE_FOR_EVER, str(path), str(Path(__file__).parent)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        while "20" not in (line := process.stdout.readline()):
            assert line, "the writer has ended"
        time.sleep(0.003)  # somewhere within a frame
        os.kill(process.pid, signal.SIGKILL)
    with h5py.File(path, "r") as file:
        assert file["VTKHDF/Steps"].attrs["NSteps"] >= 21
    write_surface(path, range(21, 23), 21)
    write_surface(tmp_path / "unbroken.vtkhdf", range(23))
    assert_same(path, tmp_path / "unbroken.vtkhdf")


def test_vtk_reads_the_volume(tmp_path):
    write_volume(tmp_path / "a.vtkhdf", range(3))
    for step in (2, 0):
        moment, points, point_data, cell_data = frame(step)
        grid = read_with_vtk(tmp_path / "a.vtkhdf", moment)
        np.testing.assert_array_equal(grid.points, points)
        np.testing.assert_array_equal(grid.celltypes, [10, 14, 13, 12])
        np.testing.assert_array_equal(grid.point_data["displacement"], point_data["displacement"])
        np.testing.assert_array_equal(grid.cell_data["stress"], cell_data["stress"])
        np.testing.assert_array_equal(grid.cell_data["block"], STATIC["block"])


def test_vtk_reads_the_surface(tmp_path):
    write_surface(tmp_path / "a.vtkhdf", range(3))
    for step in (2, 0, 1):
        moment, points, polygons, point_data, cell_data = surface(step)
        grid = read_with_vtk(tmp_path / "a.vtkhdf", moment)
        np.testing.assert_array_equal(grid.points, points)
        np.testing.assert_array_equal(grid.celltypes, [9, *[5] * (step + 1)])
        np.testing.assert_array_equal(grid.cell_connectivity, polygons[polygons >= 0])
        np.testing.assert_array_equal(grid.point_data["displacement"], point_data["displacement"])
        np.testing.assert_array_equal(grid.cell_data["group"], cell_data["group"])


def read_with_vtk(path: Path, moment: float):
    pyvista = pytest.importorskip("pyvista")
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    reader.SetFileName(str(path))
    reader.UpdateTimeStep(moment)
    return pyvista.wrap(reader.GetOutput())


COLUMNS = ["time [s]", "step", "block.velocity_x [m/s]"]


def test_history_rows_read_back_to_the_same_bits(tmp_path):
    path = tmp_path / "h.csv"
    rows = [[0.1 + 0.2, 7, math.pi], [1e-300, np.int64(8), np.float64(-0.0)]]
    history = HistoryWriter(path, COLUMNS)
    for row in rows:
        history.append(row)
    lines = path.read_text().splitlines()
    assert lines[0] == "time [s],step,block.velocity_x [m/s]"
    assert [float(v) for line in lines[1:] for v in line.split(",")] == [v for r in rows for v in r]
    assert lines[2].split(",")[1] == "8"


def test_a_resumed_history_drops_the_rows_after_the_checkpoint(tmp_path):
    path = tmp_path / "h.csv"
    history = HistoryWriter(path, COLUMNS)
    for step in range(4):
        history.append([0.1 * step, step, 1.0])
    with path.open("a") as file:
        file.write("0.4,")  # killed here
    resumed = HistoryWriter(path, COLUMNS, keep_rows=2)
    resumed.append([0.2, 2, 5.0])
    assert [line.split(",")[1] for line in path.read_text().splitlines()] == ["step", "0", "1", "2"]


def test_a_history_of_another_run_is_refused(tmp_path):
    path = tmp_path / "h.csv"
    HistoryWriter(path, COLUMNS).append([0.0, 0, 1.0])
    with pytest.raises(CdemError, match="columns"):
        HistoryWriter(path, COLUMNS[:2], keep_rows=1)
    with pytest.raises(CdemError, match="holds 1 rows"):
        HistoryWriter(path, COLUMNS, keep_rows=2)
    with pytest.raises(CdemError, match="No such file"):
        HistoryWriter(tmp_path / "none.csv", COLUMNS, keep_rows=2)
