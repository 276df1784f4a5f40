"""Files that people bring: what once was misread, passed over or refused, with its right value."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
from shared.faults import FAULTS
from shared.maps import write_shape

from cdem.joints.directions import dips
from cdem.joints.discs import read_discs

MM = FAULTS / "field2/mm.yaml"


@pytest.mark.parametrize(
    "name",
    [
        "azimuth_strike",
        "joints_comment_lines",
        "joints_degree_signs",
        "joints_quadrant",
        "joints_strike_quadrant_column",
    ],
)
def test_both_sets_of_every_table(run_cli, tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    status, out, _ = run_cli("joints", str(FAULTS / f"field/{name}.csv"), "--sets", "2", "--json")
    assert status == 0
    sets = sorted((s["dip"], s["dip_direction"]) for s in json.loads(out)["sets"])
    assert np.allclose(sets, [(40, 120), (75, 300)], atol=1.5)


@pytest.mark.parametrize("name", ["adfne.csv", "normal.csv", "semi.csv", "polygons.dat"])
def test_the_same_discs_in_four_files(name):
    rows = read_discs(FAULTS / "field2" / name)
    assert len(rows) == 12
    assert rows[2].center == pytest.approx([2.503, 1.441, 3.2], abs=1e-3)
    dip, direction = dips(rows[2].normal)
    assert (dip, direction) == (pytest.approx(71.7, abs=0.1), pytest.approx(252.7, abs=0.1))
    area = 2 * np.sqrt(2) / np.pi if name == "polygons.dat" else 1.0  # of an octagon in the circle
    assert rows[2].radius == pytest.approx(2.21 * np.sqrt(area), rel=3e-3)  # of two decimals


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "area"), [("d_adfne_csv", 133.0), ("d_semi_csv", 133.0), ("d_polygons_dat", 120.7)]
)
def test_discs_of_every_file_cut_the_box_alike(run_cli, case, area):
    """Areas within the box: of 200,000 points drawn on each disc [m2]. Tolerance: tets of 1 m."""
    status, out, _ = run_cli("check", str(FAULTS / f"field2/{case}.yaml"))
    assert status == 0 and "joint set m: 12 discs, 12 of them meet blocks" in out
    assert float(re.search(r"meet blocks; joint (\S+) m2", out)[1]) == pytest.approx(area, rel=0.03)


@pytest.mark.parametrize("file", ["two.obj", "two.stl"])
def test_two_solids_are_two_blocks(run_cli, tmp_path, monkeypatch, file):
    text = (FAULTS / "field/two.yaml").read_text().replace("two.obj", str(FAULTS / "field" / file))
    (tmp_path / "two.yaml").write_text(text)
    status, out, _ = run_cli("check", str(tmp_path / "two.yaml"), "--json")
    assert status == 0
    rock = json.loads(out)["groups"]["rock"]
    assert rock["blocks"] == 2 and rock["volume"] == pytest.approx(2)


def test_millimetres_are_asked_for_and_scaled(run_cli, tmp_path):
    status, _, err = run_cli("check", str(MM))
    assert status == 1 and "spans 1,489 x 1,089 x 709.1 m" in err and "scale: 0.001" in err
    text = (MM).read_text()
    text = text.replace("mm.stl}", f"{MM.with_suffix('.stl')}, scale: 0.001}}")
    (tmp_path / "mm.yaml").write_text(text)
    status, out, _ = run_cli("check", str(tmp_path / "mm.yaml"), "--json")
    assert status == 0
    assert json.loads(out)["groups"]["rock"]["volume"] == pytest.approx(0.4016, rel=1e-3)


FOOT = 1200 / 3937
"""A US survey foot [m]."""
TERRAIN = {"ft_horizontal": "EPSG:6529", "ft_compound": "EPSG:6529+6360", "ft_hor_mvert": "EPSG:6529+5703"}  # fmt: skip


@pytest.fixture
def feet(tmp_path, monkeypatch):
    """A slope of 30 deg in a US projection in feet, as `field/make_feet_dem.py` writes it, and outlines."""
    rasterio = pytest.importorskip("rasterio", reason="needs the extra 'terrain'")
    pytest.importorskip("pyogrio", reason="needs the extra 'terrain'")
    monkeypatch.chdir(tmp_path)
    count, cell, corner = 161, 20.0, 1.7e6  # [ft]
    z = 6000 + np.tan(np.radians(30)) * cell * np.arange(count) * np.ones((count, 1))
    place = rasterio.transform.from_origin(corner, corner + count * cell, cell, cell)
    shape = {"width": count, "height": count, "count": 1, "dtype": "float64", "transform": place}
    for name, crs in TERRAIN.items():
        with rasterio.open(f"{name}.tif", "w", driver="GTiff", crs=crs, **shape) as file:
            file.write(z * (FOOT if name == "ft_hor_mvert" else 1), 1)
    turn = np.radians(np.arange(0, 360, 10))
    ring = corner + count * cell / 2 + 400 * np.column_stack([np.cos(turn), np.sin(turn)])
    write_shape(tmp_path / "out_ft.gpkg", ring, crs="EPSG:6529", source="EPSG:6529")
    write_shape(tmp_path / "out.kml", ring, crs="EPSG:4326", source="EPSG:6529")
    return tmp_path


WORDS = ["--depth", "20 m", "--crs", "EPSG:32613", "--overwrite", "--json"]


@pytest.mark.usefixtures("feet")
def test_heights_of_a_map_in_feet_are_asked_for(run_cli):
    """Taken as metres they made a slope of 62 deg of one of 30 deg, F = 0.25."""
    status, out, err = run_cli("site", "ft_horizontal.tif", "out.kml", *WORDS)
    assert (status, out) == (1, "") and err.count("\n") == 1
    assert "ft_horizontal.tif: its projection is in US survey foot" in err
    assert "write 'unit' beside it (--unit), us-ft, ft or m" in err


@pytest.mark.slow
@pytest.mark.usefixtures("feet")
@pytest.mark.parametrize("outline", ["out.kml", "out_ft.gpkg"])
@pytest.mark.parametrize("name", TERRAIN)
def test_a_slope_in_feet_has_the_factor_of_one_in_metres(run_cli, name, outline):
    """Friction of 25 deg on 30 deg: tan 25 / tan 30 = 0.81."""
    unit = ["--unit", "us-ft"] if name == "ft_horizontal" else []
    status, out, err = run_cli("site", f"{name}.tif", outline, *WORDS, *unit)
    assert status == 0, err
    assert json.loads(out)["factor"] == pytest.approx(
        np.tan(np.radians(25)) / np.tan(np.radians(30)), abs=0.01
    )
