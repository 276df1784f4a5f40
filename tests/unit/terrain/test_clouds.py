"""Point clouds become grids of their ground points; what has none, or is damaged, is refused."""

import struct

import numpy as np
import pytest
from shared.maps import SOUTH, UTM32, WEST, height, moved

from cdem.case.map_system import look_up
from cdem.errors import CaseError
from cdem.terrain.projection import Projection
from cdem.terrain.resample import Wanted, read_heights

laspy = pytest.importorskip("laspy", reason="needs the extra 'lidar'")
pytest.importorskip("lazrs", reason="needs the extra 'lidar'")

BOX = np.array([WEST, SOUTH]), np.array([WEST + 300, SOUTH + 300])
COUNT = 60_000


def write_cloud(path, crs=UTM32, ground=2, points=COUNT):
    """0.5 points per m2 of ground, and trees 15 m above it on a third of them."""
    import pyproj

    rng = np.random.default_rng(0)
    xy = rng.uniform(BOX[0] - 20, BOX[1] + 20, (points, 2))
    tree = rng.random(points) < 0.3
    there = moved(xy, UTM32, crs) if crs != UTM32 else xy
    head = laspy.LasHeader(point_format=6, version="1.4")
    head.offsets, head.scales = [*np.floor(there.min(axis=0)), 0], [1e-3, 1e-3, 1e-3]
    head.add_crs(pyproj.CRS(crs))
    cloud = laspy.LasData(head)
    cloud.x, cloud.y = there.T
    cloud.z = height(xy) + 15 * tree
    cloud.classification = np.where(tree, 5, ground).astype(np.uint8)
    cloud.write(path)
    return path


def heights(path, **wanted):
    projection = Projection(look_up(UTM32))
    return read_heights(path, projection, Wanted(BOX, cell=10.0, **wanted)), projection.notes


def rms(grid):
    at = np.random.default_rng(1).uniform(BOX[0] + 10, BOX[1] - 10, (500, 2))
    return np.sqrt(np.mean((grid(at) - height(at)) ** 2))


@pytest.mark.parametrize(
    ("name", "crs"), [("a.laz", UTM32), ("a.las", UTM32), ("a.laz", "EPSG:31254")]
)
def test_the_ground_of_a_cloud(tmp_path, name, crs):
    grid, notes = heights(write_cloud(tmp_path / name, crs))
    # a cell holds some 40 points anywhere in 10 m on a slope of 30 deg: 1.7 m / sqrt(40)
    assert rms(grid) < 0.4
    assert (grid.low <= BOX[0]).all() and (grid.high >= BOX[1]).all()
    assert "points to 30 x 30 cells of 10 m, 0 of them empty" in notes[-1]
    with_trees, _ = heights(tmp_path / name, classes="all")
    assert rms(with_trees) > 4


def test_what_is_no_ground_is_refused(tmp_path):
    path = write_cloud(tmp_path / "a.laz", ground=1)
    with pytest.raises(CaseError, match=r"none of its 60,000 points has class 2 \(ground\)"):
        heights(path)
    with pytest.raises(CaseError, match="a point cloud needs a cell size"):
        read_heights(path, Projection(look_up(UTM32)), Wanted(BOX))
    with pytest.raises(CaseError, match=r"a\.las: cannot read the terrain file"):
        heights(tmp_path / "a.las")
    (tmp_path / "b.laz").write_bytes(path.read_bytes()[:3000])
    with pytest.raises(CaseError, match=r"b\.laz: cannot be read .*a point cloud is LAS"):
        heights(tmp_path / "b.laz", classes="all")
    (tmp_path / "c.laz").write_text("nothing")
    with pytest.raises(CaseError, match=r"c\.laz: cannot be read .*a point cloud is LAS"):
        heights(tmp_path / "c.laz")


def chunk_count(raw, start):
    """Number of chunks in the table whose place stands where the points start."""
    (table,) = struct.unpack_from("<q", raw, start)
    return table + 7


def chunk_size(raw, start):
    """Points in a chunk, of what the packing says of itself (VLR of laszip)."""
    return raw.index(b"laszip encoded") + 52 + 15


@pytest.mark.parametrize("place", [chunk_count, chunk_size])
def test_a_cloud_that_ends_its_reader_is_refused(tmp_path, place):
    """Their highest bit asks for so much memory that the decompressor aborts its process."""
    path = write_cloud(tmp_path / "a.laz", points=500)
    raw = bytearray(path.read_bytes())
    with laspy.open(path) as file:
        raw[place(raw, file.header.offset_to_point_data)] ^= 0x80
    path.write_bytes(raw)
    with pytest.raises(CaseError, match=r"a\.laz: its reader crashed .*; .* fetch it again"):
        heights(path)


def test_damaged_clouds_are_read_or_refused_in_one_line(tmp_path):
    """36 bits flipped, three a file: in what comes before the points, the points, their table."""
    path = write_cloud(tmp_path / "a.laz", points=500)
    raw = path.read_bytes()
    with laspy.open(path) as file:
        start = file.header.offset_to_point_data
    rng = np.random.default_rng(1)
    for _ in range(12):
        damaged = bytearray(raw)
        for place in rng.integers([start - 60, start, len(raw) - 20], [start, len(raw), len(raw)]):
            damaged[place] ^= 1 << rng.integers(8)
        path.write_bytes(damaged)
        try:
            grid, _ = heights(path)
        except CaseError as error:
            assert str(error).startswith(str(path)) and "\n" not in str(error)
        else:
            assert isinstance(grid.values, np.ndarray)


def test_plain_points_are_read_without_another_process(tmp_path, monkeypatch):
    path = write_cloud(tmp_path / "a.las")
    monkeypatch.setattr("cdem.case.reader_process.read", None)
    assert rms(heights(path)[0]) < 0.4
