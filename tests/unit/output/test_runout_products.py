"""Maps, GeoPackage, grain sizes, energy line and fit of a run-out, against numbers made by hand."""

from __future__ import annotations

import dataclasses
import json
import sqlite3
import sys
from xml.etree import ElementTree

import numpy as np
import pytest
from scenes import case

import cdem
from cdem.errors import CdemError
from cdem.mesh import primitives
from cdem.mesh.element_volumes import Solids
from cdem.output import runout
from cdem.output.geotiff import epsg_of, write_geotiff
from cdem.output.grain_sizes import GrainSizes
from cdem.output.map_layers import LAYERS, raster_style
from cdem.output.map_picture import hillshade
from cdem.output.runout_measures import EndMotion
from cdem.output.travel import Path, energy_line, lengths
from cdem.terrain.rasters import Raster

SPEED, TIME, FRAMES = 2.0, 1.0, 20


@pytest.fixture(scope="module")
def slid(tmp_path_factory):
    """Two cubes of 1 m that go 2 m to the east without weight, and ground beside them."""
    blocks = [
        {"group": "ground", "box": {"size": [8, 6, 1]}, "translate": [-2, -2, -3]},
        {"group": "rock", "box": {"size": [1, 1, 1]}, "translate": [0, 0, 0]},
        {"group": "rock", "box": {"size": [1, 1, 1]}, "translate": [0, 2, 0]},
    ]
    groups = {"ground": {"fix": ["x", "y", "z"]}, "rock": {"velocity": [SPEED, 0, 0]}}
    made = case(
        blocks, groups, crs="EPSG:32632",
        stages=[{"name": "go", "mode": "dynamic", "duration": TIME}],
        output={"every": TIME / FRAMES},
    )  # fmt: skip
    folder = tmp_path_factory.mktemp("slid") / "results"
    cdem.Simulation(made, threads=1, output=folder).run()
    return folder


def outline(path, rings, crs=None):
    """A GeoJSON file of polygons."""
    shapes = [{"type": "Polygon", "coordinates": [ring]} for ring in rings]
    data = {
        "type": "FeatureCollection",
        "features": [{"type": "Feature", "properties": {}, "geometry": shape} for shape in shapes],
    }
    if crs:
        data["crs"] = {"type": "name", "properties": {"name": f"urn:ogc:def:crs:EPSG::{crs}"}}
    path.write_text(json.dumps(data))
    return path


def square(x0, y0, x1, y1):
    return [[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]]


def test_maps_of_a_slide_hold_what_is_known(slid):
    found = runout.measure(slid, cell=0.5)
    rasters = found.maps.rasters
    assert set(rasters) == set(LAYERS)
    # cubes of 2500 kg at 2 m/s
    for name, value in {
        "thickness_max": 1.0, "velocity_max": 2.0, "velocity_mean_max": 2.0, "momentum_max": 2.0,
        "energy_area_max": 5.0, "energy_piece_max": 5.0, "pressure_max": 10.0,
    }.items():  # fmt: skip
        values = rasters[name].values
        np.testing.assert_allclose(np.nanmax(values), value, rtol=1e-3, err_msg=name)
    # the front enters column k at k / 2 / speed and is 0.05 m into it, at least, a frame later
    first = np.round(np.array([rasters["arrival"].x, rasters["arrival"].y]) / -0.5).astype(int)
    arrival = rasters["arrival"].values[first[1], first[0] :]
    np.testing.assert_allclose(arrival[:2], 0, atol=1e-12)
    enters = (0.5 * np.arange(2, 6) - 1 + 0.05) / SPEED
    assert (arrival[2:6] >= enters - 1e-9).all()
    assert (arrival[2:6] <= enters + 1.1 * TIME / FRAMES).all()
    volume = np.nansum(rasters["thickness_end"].values) * 0.25
    assert volume == pytest.approx(found.history["volume"][-1], rel=1e-9)
    assert np.nansum(rasters["change"].values) == pytest.approx(0, abs=1e-3)
    moved, ends = rasters["permanent_displacement"].values, rasters["thickness_end"].values
    np.testing.assert_allclose(moved[np.isfinite(moved)], SPEED * TIME, rtol=1e-3)
    assert (np.isfinite(moved) >= (np.nan_to_num(ends) > 1e-3)).all()
    assert found.maps.flow.jump == pytest.approx(SPEED * TIME / FRAMES / 0.5, rel=1e-2)
    assert "maxima have gaps" not in found.text()
    assert "maxima have gaps" in runout.measure(slid, cell=0.05).text()
    # two strips of 3 m2; what the last frame lies too far is less than a column
    assert found.maps.as_dict()["area_affected"] == pytest.approx(6.0, abs=1.0)


def test_rasters_read_back_with_projection_unit_and_words(slid, tmp_path):
    rasterio = pytest.importorskip("rasterio", reason="needs the extra 'terrain'")
    found = runout.measure(slid, cell=0.5)
    paths = {path.name: path for path in found.write(tmp_path)}
    for name, layer in LAYERS.items():
        with rasterio.open(paths[f"{name}.tif"]) as file:
            assert file.crs.to_epsg() == 32632
            assert file.units == (layer.unit,)
            assert file.descriptions == (name,)
            tags = file.tags()
            rows = file.read(1, masked=True)
            raster = found.maps.rasters[name]
            assert file.bounds == (*np.array(raster.extent)[[0, 2, 1, 3]],)
        assert tags["cdem_at_rest"] == "False"
        assert tags["cdem_what"].startswith("body at t = 1")
        np.testing.assert_array_equal(rows.filled(np.nan), raster.values[::-1].astype("f4"))
        ElementTree.parse(paths[f"{name}.qml"])
    with rasterio.open(paths["deposit.tif"]) as file:
        assert file.crs.to_epsg() == 32632


def test_a_raster_without_projection_names_none(tmp_path):
    rasterio = pytest.importorskip("rasterio", reason="needs the extra 'terrain'")
    write_geotiff(tmp_path / "a.tif", Raster(0.0, 0.0, 1.0, np.eye(3)))
    with rasterio.open(tmp_path / "a.tif") as file:
        assert file.crs is None
        np.testing.assert_array_equal(file.read(1), np.eye(3)[::-1])


def test_codes_of_projections():
    pytest.importorskip("pyproj", reason="needs the extra 'terrain'")
    assert epsg_of(None) is None
    assert epsg_of("EPSG:25832") == 25832
    assert epsg_of("EPSG:5972") == 25832  # with heights: the plan alone


def test_classes_are_round_and_those_of_another_run_are_taken(slid, tmp_path):
    found = runout.measure(slid, cell=0.5)
    assert found.maps.classes["velocity_max"] == [0.25 * k for k in range(9)]
    assert found.maps.classes["change"] == [0.25 * k - 1 for k in range(9)]
    found.write(tmp_path)
    text = (tmp_path / "runout.json").read_text()
    (tmp_path / "runout.json").write_text(text.replace("2.0", "40"))
    other = runout.measure(slid, cell=0.5, classes=tmp_path)
    assert other.maps.classes["velocity_max"] == [*(0.25 * k for k in range(8)), 40]
    style = ElementTree.fromstring(
        raster_style(LAYERS["velocity_max"], other.maps.classes["velocity_max"]).split("\n", 1)[1]
    )
    labels = [item.get("label") for item in style.iter("item")]
    assert labels[-1] == "1.75 - 40 m/s"
    with pytest.raises(CdemError, match="contains no classes of maps"):
        runout.measure(slid, classes=tmp_path / "none")


def test_the_geopackage_reads_back(slid, tmp_path):
    pyogrio = pytest.importorskip("pyogrio", reason="needs the extra 'terrain'")
    shapely = pytest.importorskip("shapely")
    found = runout.measure(slid, cell=0.5, sections=[(1.5, -1, 1.5, 9)])
    path = found.write_geopackage(tmp_path)
    path = found.write_geopackage(tmp_path)  # a second time, over the first
    layers = [str(name) for name, _ in pyogrio.list_layers(path)]
    assert layers == [
        "fragments", "affected", "source", "body_end", "path", "front", "sections", "layer_styles",
    ]  # fmt: skip

    def read(layer):
        meta, _, shapes, values = pyogrio.raw.read(path, layer=layer)
        assert meta["crs"] == "EPSG:32632"
        return shapely.from_wkb(shapes), dict(zip(meta["fields"], values, strict=True))

    places, columns = read("fragments")
    np.testing.assert_allclose(columns["volume_m3"], [1, 1], rtol=1e-3)
    np.testing.assert_allclose(shapely.get_coordinates(places)[:, 0], 2.5, atol=1e-2)
    (area,), columns = read("source")
    assert area.bounds == (0, 0, 1, 3)
    assert area.area == columns["area_m2"][0] == 2
    (area,), columns = read("affected")
    assert area.area == found.maps.as_dict()["area_affected"]
    (line,), columns = read("path")
    assert columns["length_m"][0] == pytest.approx(SPEED * TIME, rel=1e-3)
    assert line.length == pytest.approx(SPEED * TIME, rel=1e-3)
    (_,), columns = read("sections")
    assert columns["passed_m3"][0] == pytest.approx(2.0, rel=1e-3)
    with sqlite3.connect(path) as base:
        styles = dict(base.execute("select f_table_name, styleQML from layer_styles"))
    assert list(styles) == layers[:-1]
    for style in styles.values():
        ElementTree.fromstring(style.split("\n", 1)[1])


def test_the_fit_counts_cells_of_both(slid, tmp_path):
    pytest.importorskip("pyogrio", reason="needs the extra 'terrain'")
    # the mapped area: the upper strip, and as much beyond the map to the east
    path = outline(tmp_path / "mapped.geojson", [square(0, 2, 9, 3)], crs=32632)
    found = runout.measure(slid, cell=0.5, against=path)
    met = found.maps.as_dict()["area_affected"]
    fit = found.fit
    assert fit.hit == pytest.approx(met / 2)
    assert fit.beyond == pytest.approx(met / 2)
    assert fit.missed == pytest.approx(9 - met / 2)
    assert fit.csi == pytest.approx((met / 2) / (9 + met / 2))
    assert fit.hit_rate == pytest.approx(met / 2 / 9)
    assert fit.precision == pytest.approx(0.5)
    assert fit.area_factor == pytest.approx(met / 9)
    assert fit.front_gap == pytest.approx(1 + SPEED * TIME - 9, rel=1e-3)
    assert "m short of the outline's" in found.text()


def test_an_outline_in_degrees_is_brought_to_the_case(slid, tmp_path):
    pyproj = pytest.importorskip("pyproj", reason="needs the extra 'terrain'")
    pytest.importorskip("pyogrio", reason="needs the extra 'terrain'")
    back = pyproj.Transformer.from_crs(32632, 4326, always_xy=True)
    ring = [list(back.transform(x, y)) for x, y in square(0, 0, 3, 3)]
    found = runout.measure(slid, cell=0.5, against=outline(tmp_path / "m.geojson", [ring]))
    assert found.fit.precision == 1


@pytest.mark.parametrize(
    ("rings", "message"),
    [
        ([square(50, 50, 60, 60)], "has no cell in common with the run-out"),
        ([], "contains no polygon or closed line"),
    ],
)
def test_an_outline_that_cannot_be_compared_is_said(slid, tmp_path, rings, message):
    pytest.importorskip("pyogrio", reason="needs the extra 'terrain'")
    path = outline(tmp_path / "m.geojson", rings, crs=32632)
    with pytest.raises(CdemError, match=message):
        runout.measure(slid, cell=0.5, against=path)


def test_a_file_that_is_no_map_is_said(slid, tmp_path, run_cli):
    pytest.importorskip("pyogrio", reason="needs the extra 'terrain'")
    (tmp_path / "a.gpkg").write_text("no map")
    for name, message in (
        ("a.gpkg", "lines and polygons are read from"),
        ("b.shp", "No such file"),
    ):
        status, _, err = run_cli("runout", str(slid), "--against", str(tmp_path / name))
        assert status == 1
        assert message in err
        assert "Traceback" not in err


def test_without_the_extra_maps_are_written_and_the_geopackage_is_not(slid, run_cli, monkeypatch):
    for name in ("pyogrio", "shapely", "pyproj"):
        monkeypatch.setitem(sys.modules, name, None)
    status, out, err = run_cli("runout", str(slid))
    assert status == 0
    assert "no runout.gpkg: a GeoPackage needs" in err
    assert "pip install 'cdem[terrain]'" in err
    assert str(slid / "maps") in out.split()
    assert (slid / "maps" / "thickness_max.tif").is_file()


def test_a_deposit_rests_but_for_a_few_stones(slid):
    found = runout.measure(slid)
    for motion, rests in (
        (EndMotion(0.0, 0.0, 0.0), True),
        (EndMotion(3.0, 0.04, 0.009), True),
        (EndMotion(3.0, 0.04, 0.02), False),
        (EndMotion(0.0, 0.06, 0.0), False),
    ):
        at_end = dataclasses.replace(found, end=motion)
        assert at_end.rests is rests
        assert at_end.noun.startswith("deposit" if rests else "body at t = 1")


def test_the_energy_line_of_a_rigid_slide_falls_by_the_tangent_of_friction():
    slope, friction, g = np.radians(30), np.radians(20), 9.81
    time = np.linspace(0, 6, 61)
    a = g * (np.sin(slope) - np.cos(slope) * np.tan(friction))
    way, speed = 0.5 * a * time**2, a * time
    line = energy_line(-way * np.sin(slope), 0.5 * 3.0 * speed**2, 3.0 * g * np.ones(61))
    path = lengths(np.column_stack([way * np.cos(slope), 0 * way]))
    np.testing.assert_allclose(np.diff(line) / np.diff(path), -np.tan(friction), rtol=1e-10)
    assert np.isnan(energy_line(np.ones(2), np.ones(2), np.zeros(2))).all()


def test_lengths_along_a_bent_path():
    # 10 m to the east, then 10 m to the north; a metre back and forth does not matter
    places = np.array([[0, 0], [5, 0], [10, 0], [10, 5], [10, 10]], float)
    path = Path(places)
    assert path.length_at(np.array([-3, 1])) == pytest.approx(-3)
    assert path.length_at(np.array([4, -2])) == pytest.approx(4)
    assert path.length_at(np.array([11, 6, 99])) == pytest.approx(16)
    assert path.length_at(np.array([9, 14])) == pytest.approx(24)
    assert np.isnan(Path(np.zeros((3, 3))).length_at(np.ones(2)))


def test_grain_sizes_by_volume():
    volume = np.pi / 6 * np.array([1.0, 8.0, 27.0, 64.0])
    curve = GrainSizes.of(volume, volume / 8)
    np.testing.assert_allclose(curve.diameter, [1, 2, 3, 4])
    np.testing.assert_allclose(curve.passing, [1, 9, 36, 100])
    assert curve.sizes == pytest.approx({"d10": 3, "d50": 4, "d90": 4})
    assert curve.size(9) == pytest.approx(2)
    assert curve.element == pytest.approx(1.25)


def test_the_light_on_planes():
    flat = hillshade(np.zeros((3, 3)), 1.0)
    np.testing.assert_allclose(flat, np.sin(np.pi / 4))
    y, x = np.mgrid[:4, :5].astype(float)
    towards = hillshade((x - y) / np.sqrt(2), 1.0)  # falls to the north-west, by 45 deg
    np.testing.assert_allclose(towards, 1.0)
    np.testing.assert_allclose(hillshade((y - x) / np.sqrt(2), 1.0), 0.0, atol=1e-12)


def test_tops_are_the_highest_surface():
    made = [primitives.box("rock", [4, 4, h]) for h in (1, 3)]
    points = np.vstack([made[0].points, made[1].points + [2, 0, 5]])
    solids = Solids.of(
        points, {"hex8": np.vstack([made[0].cells["hex8"], 8 + made[1].cells["hex8"]])}
    )
    top = solids.tops(np.arange(-0.5, 8), np.array([-1.0, 1.0, 3.0]))
    assert np.isnan(top[0]).all()
    np.testing.assert_allclose(top[1], [np.nan, 1, 1, 8, 8, 8, 8, np.nan, np.nan])


def test_pictures_are_drawn(slid, tmp_path):
    pytest.importorskip("matplotlib")
    names = [path.name for path in runout.measure(slid, cell=0.5).draw(tmp_path)]
    assert names == ["deposit.png", "maps.png", "grain_sizes.png"]  # no weight, no energy line
    assert min((tmp_path / name).stat().st_size for name in names) > 5000


def test_cells_too_large_to_be_met_make_empty_maps(slid, tmp_path):
    pyogrio = pytest.importorskip("pyogrio", reason="needs the extra 'terrain'")
    found = runout.measure(slid, cell=50.0)
    assert not found.maps.flow.affected.any()
    assert np.nansum(found.maps.rasters["thickness_end"].values) * 2500 == pytest.approx(
        2, rel=1e-3
    )
    found.write(tmp_path)
    path = found.write_geopackage(tmp_path)
    assert pyogrio.raw.read(path, layer="affected")[3][0] == 0
