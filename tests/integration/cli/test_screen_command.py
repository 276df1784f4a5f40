"""`cdem screen`: maps, bodies and a picture from a DEM and sets of joints."""

import json

import numpy as np
import pytest
from shared.hills import frustum

rasterio = pytest.importorskip("rasterio", reason="needs the extra 'terrain'")
raw = pytest.importorskip("pyogrio.raw", reason="needs the extra 'terrain'")
shapely = pytest.importorskip("shapely", reason="needs the extra 'terrain'")

SETS = """model:
  joints:
    - {name: J1, dip: 55, dip_direction: 135}
    - {name: J2, dip: 55, dip_direction: 225}
interfaces:
  default: {friction_angle: 30, cohesion: 20 kPa, tensile_strength: 0}
"""
WEST, NORTH = 500_000, 5_100_000


@pytest.fixture
def hill(tmp_path, monkeypatch):
    """A DEM and its joints in a folder of their own."""
    monkeypatch.chdir(tmp_path)
    z = frustum(4.0).values
    place = rasterio.transform.from_origin(WEST, NORTH, 4, 4)
    with rasterio.open(
        "hill.tif", "w", driver="GTiff", width=z.shape[1], height=z.shape[0], count=1,
        dtype="float32", crs="EPSG:32632", transform=place,
    ) as file:  # fmt: skip
        file.write(z[::-1].astype("float32"), 1)
    (tmp_path / "joints.yaml").write_text(SETS)
    return tmp_path


def test_maps_bodies_and_a_picture(run_cli, hill):
    words = ("screen", "hill.tif", "--joints", "joints.yaml", "--volume", "50", "1e5")
    status, out, err = run_cli(*words)
    assert (status, err) == (0, "")
    assert "J1: 55.0/135.0, friction 30.0 deg, cohesion 20 kPa, persistence 1" in out
    assert "J1+J2, slides on both planes" in out and out.endswith("hill.screen/fos.png\n")
    with rasterio.open("hill.screen/fos.tif") as file, rasterio.open("hill.tif") as dem:
        assert (file.crs, file.transform, file.shape) == (dem.crs, dem.transform, dem.shape)
        factor = file.read(1)
    with rasterio.open("hill.screen/fos_mode.tif") as file:
        assert ((file.read(1) > 0) == np.isfinite(factor)).all()
    meta, _, shapes, values = raw.read("hill.screen/bodies.gpkg", layer="bodies")
    table = dict(zip(meta["fields"], values, strict=True))
    assert meta["crs"] == "EPSG:32632" and table["fos"][0] == pytest.approx(np.nanmin(factor))
    assert np.isnan(table["fos_critical"].astype(float)).all() and table["planes"][0] == "J1+J2"
    # the outline holds the area that the planes have in plan
    plan = (table["area_first_m2"] + table["area_second_m2"]) * np.cos(np.radians(55))
    assert shapely.area(shapely.from_wkb(shapes)) == pytest.approx(plan, rel=0.15)
    status, out, _ = run_cli(*words, "-o", "again", "--json", "--density", "2.65 t/m3")
    assert status == 0 and json.loads(out)["bodies"][0]["fos"] == pytest.approx(table["fos"][0])


def test_mistakes_are_one_message(run_cli, hill):
    words = ("screen", "hill.tif", "--joints", "joints.yaml")
    status, _, err = run_cli(*words)
    assert status == 2 and "--volume" in err
    status, _, err = run_cli(*words, "--volume", "50", "0")
    assert status == 2 and "--volume must be above 0, got 0" in err
    status, _, err = run_cli(*words, "--volume", "50", "400", "--cell", "nan")
    assert status == 1 and err == "cells must be larger than 0 m, got nan\n"
    status, _, err = run_cli(*words, "--volume", "50", "40")
    assert status == 1 and err.startswith("volumes from 50 to 40 m3")
    status, _, err = run_cli("screen", "no.tif", "--joints", "joints.yaml", "--volume", "50", "400")
    assert status == 1 and err.startswith("no.tif: cannot read")
    (hill / "joints.yaml").write_text("model: {}\n")
    status, _, err = run_cli(*words, "--volume", "50", "400")
    assert status == 1 and err.startswith("joints.yaml:1:1: model.joints")


def test_nothing_found_is_said(run_cli, hill):
    words = ("screen", "hill.tif", "--joints", "joints.yaml", "--volume", "1e7", "1e8")
    status, out, err = run_cli(*words)
    assert (status, err) == (0, "") and "0 bodies at" in out
    assert len(raw.read("hill.screen/bodies.gpkg")[2]) == 0


@pytest.mark.slow
def test_confirmed_factors_are_those_of_the_closed_form(run_cli, hill):
    words = ("--joints", "joints.yaml", "--volume", "50", "1e5", "--confirm", "1", "--json")
    status, out, _ = run_cli("screen", "hill.tif", *words)
    one = json.loads(out)["confirmed"][0]
    assert status == 0 and one["computed"] == pytest.approx(one["closed"], rel=0.03)
    meta, _, _, values = raw.read("hill.screen/bodies.gpkg")
    assert values[list(meta["fields"]).index("fos_critical")][0] == one["computed"]
