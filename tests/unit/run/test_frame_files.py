"""Frames: what is written reads back to the bit, also after a broken run."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from cdem.run.frame_files import FrameFiles, SurfaceFiles, frame_path

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


GROUPS = ["bed", "block"]


def write_volume(path: Path, steps: range, keep: int | None = None) -> FrameFiles:
    series = FrameFiles(path, CELLS, STATIC, GROUPS, keep)
    for step in steps:
        series.append(step, *frame(step))
    series.sync()
    return series


def write_surface(path: Path, steps: range, keep: int | None = None) -> SurfaceFiles:
    series = SurfaceFiles(path, GROUPS, keep)
    for step in steps:
        series.append(step, *surface(step))
    series.sync()
    return series


def assert_same(one: Path, other: Path) -> None:
    """The same list and the same frames, byte for byte."""
    names = sorted(path.name for path in one.with_suffix("").iterdir())
    assert names == sorted(path.name for path in other.with_suffix("").iterdir())
    assert one.read_bytes() == other.read_bytes()
    for name in names:
        assert (one.with_suffix("") / name).read_bytes() == (
            other.with_suffix("") / name
        ).read_bytes(), name


BOTH = pytest.mark.parametrize("write", [write_volume, write_surface])


@pytest.fixture
def paths(tmp_path):
    """Two series of the same name, in two folders: that of an unbroken run and another."""
    for name in ("unbroken", "broken"):
        (tmp_path / name).mkdir()
    return tmp_path / "unbroken/a.vtkhdf", tmp_path / "broken/a.vtkhdf"


@BOTH
@pytest.mark.parametrize("keep", [0, 1, 3, 5])
def test_a_resumed_series_equals_an_unbroken_one(paths, write, keep):
    unbroken, broken = paths
    write(unbroken, range(6))
    write(broken, range(5))
    (broken.with_suffix("") / "frame-0005.vtkhdf.tmp").write_bytes(b"a kill left this")
    write(broken, range(keep, 6), keep)
    assert_same(unbroken, broken)


@BOTH
@pytest.mark.parametrize("damage", ["gone", "short", "junk"])
def test_lost_frames_are_told_and_the_others_stay(paths, write, damage):
    path, _ = paths
    write(path, range(5))
    lost = frame_path(path.with_suffix(""), 2)
    content = lost.read_bytes()
    lost.unlink()
    if damage != "gone":
        lost.write_bytes(content[: len(content) // 2] if damage == "short" else b"junk" * 1000)
    series = write(path, range(4, 6), 4)
    assert series.lost == [2]
    times = [0.0, 0.1, 0.3, 0.4, 0.5]
    with h5py.File(path) as file:
        np.testing.assert_allclose(file["VTKHDF/Steps/Values"], times, rtol=1e-15)
        assert not np.isnan(file["VTKHDF/Points"][()]).any()


def test_a_flipped_bit_in_a_large_frame_is_noticed(tmp_path):
    """HDF5 keeps checksums of chunks; tiny datasets have none."""
    points = np.random.default_rng(1).random((4000, 3))
    series = SurfaceFiles(tmp_path / "a.vtkhdf", GROUPS)
    faces = np.array([[0, 1, 2, -1]])
    series.append(0, 0.0, points, faces, {"displacement": points}, {"group": np.zeros(1)})
    path = frame_path(tmp_path / "a", 0)
    content = bytearray(path.read_bytes())
    content[content.find(points.tobytes()[800:900])] ^= 1
    path.write_bytes(content)
    with h5py.File(path) as file, pytest.raises(OSError, match=r"checksum|filter"):
        file["VTKHDF/Points"][()]
        file["VTKHDF/PointData/displacement"][()]


def test_the_list_is_there_from_the_first_frame_on_and_never_far_behind(tmp_path):
    series = SurfaceFiles(tmp_path / "a.vtkhdf", GROUPS)
    for step in range(60):
        series.append(step, *surface(step))
        with h5py.File(tmp_path / "a.vtkhdf") as file:
            assert file["VTKHDF/Steps"].attrs["NSteps"] >= step + 1 - step // 50


def test_small_models_make_small_files(tmp_path):
    write_volume(tmp_path / "a.vtkhdf", range(10))
    assert sum(p.stat().st_size for p in (tmp_path / "a").iterdir()) < 120_000
    assert (tmp_path / "a.vtkhdf").stat().st_size < 30_000


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
