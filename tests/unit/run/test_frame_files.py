"""Frames: what is written reads back to the bit, also after a broken run."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest

from cdem.run import frame_files as module
from cdem.run.frame_files import FrameFiles, SurfaceFiles, frame_path, names_of_groups

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


def test_writing_the_list_takes_a_20th_of_the_time(paths, monkeypatch):
    """A second each here, and half a second a frame; `sync` lists all that is there."""
    now, listed = [0.0], []
    put_steps = module.FrameFiles._put_steps

    def slow(series, *what):
        put_steps(series, *what)
        now[0] += 1.0
        listed.append(len(series._frames))

    monkeypatch.setattr(module, "time_now", lambda: now[0])
    monkeypatch.setattr(module.FrameFiles, "_put_steps", slow)
    series = FrameFiles(paths[0], CELLS, STATIC, GROUPS)
    for step in range(50):
        series.append(step, *frame(step))
        now[0] += 0.5
    assert listed == [1, 41]
    series.sync()
    assert listed == [1, 41, 50]


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


def flipped(content: bytes, place: int) -> bytes:
    return content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]


@pytest.mark.parametrize("count", [3, 4000])
def test_a_flipped_bit_in_a_frame_is_noticed(tmp_path, count):
    """HDF5 keeps checksums of chunks; tiny datasets are one chunk, too."""
    points = np.random.default_rng(1).random((count, 3))
    series = SurfaceFiles(tmp_path / "a.vtkhdf", GROUPS)
    faces = np.array([[0, 1, 2, -1]])
    series.append(0, 0.0, points, faces, {"displacement": points}, {"group": np.zeros(1)})
    path = frame_path(tmp_path / "a", 0)
    content = path.read_bytes()
    path.write_bytes(flipped(content, content.find(points.tobytes()[: 24 * count][-50:])))
    with h5py.File(path) as file, pytest.raises(OSError, match=r"checksum|filter"):
        file["VTKHDF/Points"][()]
        file["VTKHDF/PointData/displacement"][()]
    assert SurfaceFiles(tmp_path / "a.vtkhdf", GROUPS, keep=1).lost == [0]


@BOTH
@pytest.mark.parametrize("each", [29, pytest.param(7, marks=pytest.mark.slow)])
def test_a_flipped_bit_is_lost_or_of_no_use(paths, write, each):
    """Wherever it is in a small frame: in numbers, names, shapes or times."""
    path, _ = paths
    write(path, range(1))
    lost = frame_path(path.with_suffix(""), 0)
    whole = lost.read_bytes()
    values = contents(lost)
    told = 0
    for place in range(0, len(whole), each):
        lost.write_bytes(flipped(whole, place))
        if write(path, range(0), 1).lost:
            told += 1
        else:
            assert contents(lost) == values
    assert told > 0


def contents(path: Path) -> dict[str, bytes]:
    """Bytes of all datasets that are in a frame itself, and of the names of its groups."""
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        found = {"names": str(names_of_groups(root)).encode()}

        def keep(name: str, item: h5py.Group | h5py.Dataset) -> None:
            if isinstance(item, h5py.Dataset):
                found[name] = item[()].tobytes()

        root.visititems(keep)
    return found
