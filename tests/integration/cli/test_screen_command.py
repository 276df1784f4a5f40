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


UNCERTAIN = """uncertain: 1
parameters:
  J1.friction_angle: {normal: {mean: 30, deviation: 3, low: 0}}
  J2.cohesion: {lognormal: {mean: 60, deviation: 40}, unit: kPa}
  water: {triangular: {low: 0, mode: 0.1, high: 0.4}}
sampling: {count: 20, seed: 1, method: monte-carlo}
"""


def test_water_shaking_and_probability(run_cli, hill):
    """All products at once, in a folder with a space in its name."""
    (hill / "un certain.yaml").write_text(UNCERTAIN)
    words = (
        "screen",
        "hill.tif",
        "--joints",
        "joints.yaml",
        "--volume",
        "500",
        "1e5",
        "--stride",
        "8",
    )
    words += ("--water", "0.1", "--kh", "0.05", "--kv", "-0.02", "--crack", "5 m", "--pga", "0.4g")
    words += ("--magnitude", "6.8", "--uncertain", "un certain.yaml", "-o", "a b")
    status, out, err = run_cli(*words)
    assert (status, err) == (0, "")
    for said in (
        "water table at 0.1 of the height", "tension crack of 5 m in profiles", "shaken by 0.05 g",
        "magnitude 6.8, PGA 0.4 g (Jibson 2007)", "20 samples, monte-carlo, seed 1",
        "J2.cohesion [kPa]: mean", "+- ", "rank correlation with F of the worst body",
    ):  # fmt: skip
        assert said in out
    maps = {}
    for name in ("fos", "fos_yield", "fos_newmark", "fos_plane_yield", "fos_plane_newmark",
                 "fos_probability"):  # fmt: skip
        with rasterio.open(f"a b/{name}.tif") as file:
            maps[name] = file.read(1)
    known = np.isfinite(maps["fos"])
    assert (np.isfinite(maps["fos_yield"]) == known).all()
    assert (np.isfinite(maps["fos_newmark"]) == (maps["fos_yield"] > 0)).all()
    assert 0 < maps["fos_probability"][known].max() <= 1
    meta, _, _, values = raw.read("a b/bodies.gpkg", layer="bodies")
    table = dict(zip(meta["fields"], values, strict=True))
    for name in ("yield_g", "newmark_m", "probability", "mean_fos", "reliability"):
        assert len(table[name]) == len(table["fos"])
    rows = (hill / "a b/samples.csv").read_text().splitlines()
    assert len(rows) == 21 and rows[0].endswith("water,lowest_fos,unstable_share,worst_fos")
    for name in ("fos", "newmark", "probability", "tornado"):
        assert (hill / f"a b/{name}.png").stat().st_size > 5000


def test_a_record_and_a_water_table(run_cli, hill):
    t = np.arange(0, 8, 0.01)
    a = 0.5 * np.sin(6 * t) * np.exp(-(((t - 4) / 2) ** 2))
    text = "\n".join(["t [s], a [g]", *(f"{x:.2f}, {y:.6f}" for x, y in zip(t, a, strict=True))])
    (hill / "quake.csv").write_text(text)
    words = (
        "screen",
        "hill.tif",
        "--joints",
        "joints.yaml",
        "--volume",
        "500",
        "1e5",
        "--stride",
        "8",
    )
    more = ("--record", "quake.csv", "--water", "215 m", "--uncertain", "u.yaml", "--json")
    (hill / "u.yaml").write_text(UNCERTAIN.replace("water: {triangular", "kh: {triangular"))
    status, out, err = run_cli(*words, *more)
    assert (status, err) == (0, "")
    facts = json.loads(out)
    assert facts["loads"] == {"kh": 0, "kv": 0, "water": None, "water_table": True, "crack": 0}
    count = len(facts["bodies"])
    assert facts["earthquake"]["record"] == "quake.csv"
    assert len(facts["earthquake"]["yield"]) == len(facts["earthquake"]["newmark"]) == count
    assert len(facts["probability"]["bodies"]["probability"]) == count
    assert len(facts["probability"]["lowest_fos"]) == 20


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (("--water", "1.2"), "--water 1.2: a number must lie in 0 to 1"),
        (("--crack", "-3 m"), "--crack must lie above 0"),
        (("--kv", "1"), "--kv must lie in -5 to 0.99, got 1"),
        (("--pga", "0.3"), "--pga 0.3: write the unit: 0.3g"),
        (("--pga", "0.3g", "--record", "a.csv"), "--pga and --record both give an earthquake"),
        (("--record", "joints.csv"), "joints.csv: "),
        (("--uncertain", "nothing.yaml"), "nothing.yaml: cannot read the distribution file"),
    ],
)
def test_wrong_loads_are_one_line(run_cli, hill, more, said):
    words = ("screen", "hill.tif", "--joints", "joints.yaml", "--volume", "500", "1e5")
    status, _, err = run_cli(*words, *more)
    assert status == 1 and said in err and err.count("\n") == 1


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
    (hill / "hill.screen").mkdir()
    (hill / "hill.screen/tornado.png").touch()
    words = ("screen", "hill.tif", "--joints", "joints.yaml", "--volume", "1e7", "1e8")
    status, out, err = run_cli(*words)
    assert (status, err) == (0, "warning: left from an earlier command: tornado.png\n")
    assert "0 bodies at" in out
    assert len(raw.read("hill.screen/bodies.gpkg")[2]) == 0


@pytest.mark.slow
def test_confirmed_factors_are_those_of_the_closed_form(run_cli, hill):
    words = ("--joints", "joints.yaml", "--volume", "50", "1e5", "--confirm", "1", "--json")
    status, out, _ = run_cli("screen", "hill.tif", *words)
    one = json.loads(out)["confirmed"][0]
    assert status == 0 and one["computed"] == pytest.approx(one["closed"], rel=0.03)
    meta, _, _, values = raw.read("hill.screen/bodies.gpkg")
    assert values[list(meta["fields"]).index("fos_critical")][0] == one["computed"]
