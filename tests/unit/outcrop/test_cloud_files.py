"""Clouds in all formats, at map coordinates; and what is refused or noted."""

import laspy
import numpy as np
import pytest

from cdem.errors import CaseError
from cdem.outcrop import cloud_files, las_points
from cdem.outcrop.cloud_files import read_outcrop

MIDDLE = np.array([512_345.0, 5_123_456.0, 1_234.0])
POINTS = np.random.default_rng(6).uniform(-3, 3, (40, 3)).round(3)


def write_las(path, points, wkt=None, version="1.4", format_=6):
    header = laspy.LasHeader(point_format=format_, version=version)
    header.scales, header.offsets = np.full(3, 0.001), np.floor(points.min(axis=0))
    if wkt:
        import pyproj

        header.add_crs(pyproj.CRS.from_user_input(wkt))
    cloud = laspy.LasData(header)
    cloud.x, cloud.y, cloud.z = points.T
    cloud.classification = np.arange(len(points)) % 3
    cloud.write(path)


def check(found, notes=()):
    assert found.points + found.origin - MIDDLE == pytest.approx(POINTS, abs=1e-6)
    assert np.abs(found.points).max() < 7 and (found.origin == np.round(found.origin)).all()
    assert found.notes == list(notes)


@pytest.mark.parametrize("name", ["a.las", "a.laz"])
def test_lidar_of_all_classes(tmp_path, name):
    write_las(tmp_path / name, POINTS + MIDDLE, "EPSG:32632")
    check(read_outcrop(tmp_path / name))


def test_lidar_in_feet_and_in_degrees(tmp_path, readers_here):
    write_las(tmp_path / "feet.las", POINTS + [1000, 2000, 300], "EPSG:2263")
    found = read_outcrop(tmp_path / "feet.las")
    assert np.ptp(found.points, axis=0)[:2] == pytest.approx(
        np.ptp(POINTS, axis=0)[:2] * 0.3048006096
    )
    assert "another unit" in found.notes[0]
    write_las(tmp_path / "deg.las", POINTS / 1e3 + [10, 45, 300], "EPSG:4326")
    with pytest.raises(CaseError, match="is in degrees"):
        read_outcrop(tmp_path / "deg.las")


def test_of_many_points_some_are_read(tmp_path, readers_here, monkeypatch):
    monkeypatch.setattr(cloud_files, "MOST_READ", 15)
    monkeypatch.setattr(las_points, "CHUNK", 7)
    write_las(tmp_path / "a.las", POINTS + MIDDLE)
    found = read_outcrop(tmp_path / "a.las")
    assert found.points + found.origin - MIDDLE == pytest.approx(POINTS[::3], abs=1e-6)
    assert "one of 3 points is read" in found.notes[0]


@pytest.mark.parametrize("kind", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_ply_of_points(tmp_path, kind):
    head = f"ply\nformat {kind} 1.0\ncomment made up\nelement vertex {len(POINTS)}\n"
    head += "".join(f"property double {axis}\n" for axis in "xyz")
    head += "property uchar red\nend_header\n"
    if kind == "ascii":
        rows = "".join("{:.3f} {:.3f} {:.3f} 7\n".format(*p) for p in POINTS + MIDDLE)
        (tmp_path / "a.ply").write_text(head + rows)
    else:
        order = "<" if "little" in kind else ">"
        rows = np.zeros(len(POINTS), [(axis, order + "f8") for axis in "xyz"] + [("red", "u1")])
        rows["x"], rows["y"], rows["z"] = (POINTS + MIDDLE).T
        (tmp_path / "a.ply").write_bytes(head.encode() + rows.tobytes())
    check(read_outcrop(tmp_path / "a.ply"), ["not used: red"])


def test_single_precision_at_map_size_is_told(tmp_path):
    head = "ply\nformat binary_little_endian 1.0\nelement vertex 40\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    raw = (POINTS + MIDDLE).astype("<f4").tobytes()
    (tmp_path / "a.ply").write_bytes(head.encode() + raw)
    assert "steps of 5e+02 mm" in read_outcrop(tmp_path / "a.ply").notes[0]


@pytest.mark.parametrize(
    ("name", "head", "row", "notes"),
    [
        ("a.xyz", "", "{:.3f} {:.3f} {:.3f}", []),
        ("a.xyz", "# scan of a wall\n", "{:.3f}\t{:.3f}\t{:.3f}", []),
        ("a.pts", "40\n", "{:.3f} {:.3f} {:.3f} 12 255 0 0", ["columns not used: 4 after x, y, z"]),
        ("a.csv", "X,Y,Z,Intensity\n", "{:.3f},{:.3f},{:.3f},9", ["columns not used: Intensity"]),
        ("a.txt", "//X Y Z Nx Ny Nz\n", "{:.3f} {:.3f} {:.3f} 0 0 1",
         ["columns not used: Nx, Ny, Nz"]),
        ("a.csv", "id;easting;northing;elevation\n", "1;{:.3f};{:.3f};{:.3f}",
         ["columns not used: id"]),
    ],
)  # fmt: skip
def test_text(tmp_path, name, head, row, notes):
    rows = [row.format(*p) for p in POINTS + MIDDLE]
    (tmp_path / name).write_text(head + "\n".join(rows) + "\n")
    check(read_outcrop(tmp_path / name), notes)


def test_decimal_commas_and_lost_points(tmp_path):
    rows = ["{:.3f};{:.3f};{:.3f}".format(*p).replace(".", ",") for p in POINTS + MIDDLE]
    (tmp_path / "a.txt").write_text("x;y;z\n" + "\n".join([*rows, "nan;nan;nan"]) + "\n")
    check(read_outcrop(tmp_path / "a.txt"), ["1 points without coordinates are left out"])


ROWS = "".join("{} {} {}\n".format(*p) for p in POINTS)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.obj", "v 0 0 0", "a point cloud is one of .las"),
        ("a.xyz", "", "no line of three numbers"),
        ("a.xyz", "\x00\x01\x02" * 99, "no line of three numbers"),
        ("a.xyz", "1 2\n3 4\n", "no line of three numbers"),
        ("a.xyz", ROWS + "a b c\n", "could not convert string 'a'"),
        ("a.xyz", ROWS + "1 2\n", "cannot be read"),
        ("a.xyz", "nan nan nan\n" * 50, "no line of three numbers"),
        ("a.xyz", ROWS + "9e9 0 0\n", "smaller than 10000"),
        ("a.xyz", "1 2 3\n" * 200, "all points lie at one place"),
        ("a.xyz", "".join(f"10.000{k} 45.000{k} {k}\n" for k in range(90)), "are degrees"),
        ("a.csv", "dip,dip_direction,set\n1,2,3\n", "is a table of measured joints"),
        ("a.csv", "x,y,z,dip,dip_direction,radius\n1,2,3,4,5,6\n", "leave out --extract"),
        ("a.ply", "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
         "property float z\nend_header\n1 2 3\n", "names 9 points and has 1: it is cut off"),
        ("a.ply", "ply\nformat ascii 1.0\n", "has no header"),
        ("a.ply", "no ply", "has no header"),
        ("a.laz", "LASF and nothing more", "cannot be read"),
    ],
)  # fmt: skip
def test_what_is_refused(tmp_path, name, text, words):
    (tmp_path / name).write_text(text)
    with pytest.raises(CaseError) as told:
        read_outcrop(tmp_path / name)
    assert words in str(told.value) and "\n" not in str(told.value) and name in str(told.value)


def test_no_file(tmp_path):
    with pytest.raises(CaseError, match="no such file"):
        read_outcrop(tmp_path / "a.las")
    (tmp_path / "b.las").mkdir()
    with pytest.raises(CaseError, match="is a folder"):
        read_outcrop(tmp_path / "b.las")
