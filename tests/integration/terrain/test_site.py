"""cdem site: from a DEM and an outline in degrees to files that run, in the words of a user."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from shared.maps import RING, UTM32, height, write_raster, write_shape

from cdem import Case
from cdem.errors import CaseError
from cdem.terrain import Landslide, make_mesh, write
from cdem.terrain.site import Question, make_site, surface_of

rasterio = pytest.importorskip("rasterio", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")
pytestmark = pytest.mark.usefixtures("readers_here")  # not so in test_solid.py


@pytest.fixture
def maps(tmp_path, monkeypatch):
    """A DEM and a closed line in degrees, as from the web and from a phone."""
    monkeypatch.chdir(tmp_path)
    write_raster(tmp_path / "dem.tif", "EPSG:4326")
    write_shape(tmp_path / "outline.kml", crs="EPSG:4326", line=True)
    return tmp_path


def question(folder, **changes):
    return Question(folder / "dem.tif", folder / "outline.kml", folder / "site", **changes)


def test_two_files_in_degrees_become_a_case_that_runs(maps, run_cli):
    words = ["site", "dem.tif", "outline.kml", "--depth", "40 m", "--size", "60", "--cell", "20"]
    status, out, err = run_cli(*words)
    assert status == 0, err
    assert "note: outline.kml: transformed from EPSG:4326 to EPSG:32632" in out
    assert (
        "EPSG:32632 (WGS 84 / UTM zone 32N): lengths differ from lengths on the ground by -3.0e-04"
        in out
    )
    assert "40.0 m deep" in out and "F = 0.8" in out
    with rasterio.open("site/dem.tif") as dem, rasterio.open("site/depth.tif") as depth:
        assert dem.crs.to_epsg() == depth.crs.to_epsg() == 32632
        assert dem.units == ("metre",) and dem.transform.a == 20
        thick = depth.read(1, masked=True)
        at = np.array([dem.xy(5, 7)])
        assert dem.read(1)[5, 7] == pytest.approx(height(at)[0], abs=0.05)
    assert thick.sum() * 400 == pytest.approx(3.1e6, rel=0.1)
    assert run_cli("mesh", "site/landslide.yaml", "-o", "site/landslide.msh")[0] == 0
    status, out, err = run_cli("check", "site/case.yaml")
    assert status == 0, err
    assert ": rock: {density: 2600, young_modulus" in out
    assert out.count("  assumed: site/case.yaml:") == 6
    short = ["--set", "stages.slide.duration=0.02", "--set", "stages.settle.max_steps=5"]
    short += ["--set", "output.frames=false"]
    status, out, err = run_cli("run", "site/case.yaml", "-o", "r", "--threads", "1", *short)
    assert status == 0, err
    assert Case.load("r/case.yaml").crs == UTM32
    assert Case.load("site/safety.yaml").stages[-1].mode == "static"
    assert run_cli(*words)[0] == 1  # does not write over it


def test_factor_volume_and_words_agree_with_the_mesh(maps):
    site = make_site(question(maps, surface={"slbl": {"volume": 2e6}}, size=50.0, cell=20.0))
    solid = make_mesh(Landslide.load(maps / "site" / "landslide.yaml"))
    corners = solid.points[solid.tets[solid.tet_group == 1]]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1]).sum() / 6
    assert site.facts["volume"] == pytest.approx(volume, rel=1e-9)
    assert site.facts["volume"] == pytest.approx(2e6, rel=5e-3)
    # a slope of about 30 deg that falls to the east, friction of 25 deg
    assert site.facts["factor"] == pytest.approx(
        np.tan(np.radians(25)) / np.tan(np.radians(30)), rel=0.1
    )
    assert site.facts["direction"] == pytest.approx(90, abs=3)
    import pyogrio

    meta, _, _, fields = pyogrio.raw.read(maps / "site" / "site.gpkg", layer="outline")
    assert meta["crs"] == UTM32
    assert dict(zip(meta["fields"], (f[0] for f in fields), strict=True)) == {
        "group": "slide", "volume_m3": site.facts["volume"]
    }  # fmt: skip


def test_without_a_surface_it_writes_the_ground_and_asks(maps, run_cli):
    status, out, _ = run_cli("site", "dem.tif", "outline.kml")
    assert status == 0
    assert (
        "choose a sliding surface: repeat with --overwrite and --depth, --volume or --surface"
        in out
    )
    assert not (maps / "site" / "case.yaml").exists()
    landslide = Landslide.load(maps / "site" / "landslide.yaml")
    assert landslide.bodies == []
    status, out, _ = run_cli(
        "site", "dem.tif", "outline.kml", "--overwrite", "--volume", "1e6", "--json"
    )
    assert json.loads(out)["volume"] == pytest.approx(1e6, rel=2e-3)


def test_an_outline_must_lie_in_the_terrain(maps, run_cli):
    write_shape(maps / "wide.gpkg", ring=RING + [350.0, 0.0])
    status, _, err = run_cli("site", "dem.tif", "wide.gpkg", "--depth", "30", "--size", "40")
    assert status == 1
    assert "of the outline lies beyond the terrain of dem.tif, or within 3 elements" in err
    assert err.count("\n") == 1
    status, out, err = run_cli(
        "site", "dem.tif", "wide.gpkg", "--depth", "30", "--size", "40", "--cut"
    )
    assert status == 0, err
    assert "of the outline is cut off at the edge of the terrain, along 400 m" in out


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--depth", "40", "--volume", "1e6"], "give one of --depth, --volume and --surface"),
        (["--depth", "40 kg"], "--depth: '40 kg' has the wrong dimension"),
        (["--depth", "-4"], "--depth: must be above 0"),
        (["--crs", "EPSG:3857"], "--crs EPSG:3857: .*Web Mercator"),
        (["--crs", "EPSG:9999999"], "no projection 'EPSG:9999999'"),
        (["--where", "name"], "--where name: write NAME=VALUE"),
        (["--surface", "none.tif"], "--surface none.tif: no such file; or write a mapping"),
        (["--surface", "{slbl: {dept: 3}}"], "surface.slbl.dept: unknown key; did you mean depth"),
        (["--dem-crs", "EPSG:32632"], "dem.tif: .*does not cover the required area"),
    ],
)
def test_mistakes_are_one_line(maps, run_cli, words, message):
    status, _, err = run_cli("site", "dem.tif", "outline.kml", *words)
    assert status == 1
    assert len(err.splitlines()) <= 2, err

    assert re.search(message, err), err


def test_local_metres_need_no_projection(tmp_path):
    write_raster(tmp_path / "dem.tif", label=None)
    ring = [*RING.tolist(), RING[0].tolist()]
    text = json.dumps({"type": "Polygon", "coordinates": [ring]})
    (tmp_path / "outline.geojson").write_text(text)
    given = Question(
        tmp_path / "dem.tif", tmp_path / "outline.geojson", tmp_path / "site",
        surface=surface_of(tmp_path, None, None, "{plane: {dip: 35, dip_direction: 90, through: [591300, 5193500, 1815]}}"),
        size=60.0,
    )  # fmt: skip
    site = make_site(given)
    assert site.facts["crs"] is None
    # plane and ordinary columns: tan 25 / tan 35
    assert site.facts["factor"] == pytest.approx(
        np.tan(np.radians(25)) / np.tan(np.radians(35)), rel=1e-9
    )
    write(
        make_mesh(Landslide.load(tmp_path / "site" / "landslide.yaml")),
        tmp_path / "site" / "landslide.msh",
    )
    assert Case.load(tmp_path / "site" / "case.yaml").crs is None
    with pytest.raises(CaseError, match="names no projection; give it with --dem-crs"):
        make_site(Question(tmp_path / "dem.tif", write_shape(tmp_path / "o.gpkg"), tmp_path / "x"))


def test_rockfall_on_bare_ground_runs(tmp_path, monkeypatch, run_cli):
    example = Path(__file__).parents[3] / "examples/rockfall"
    for file in example.iterdir():
        if file.suffix in (".yaml", ".obj", ".asc"):
            shutil.copy(file, tmp_path)
    monkeypatch.chdir(tmp_path)
    status, out, err = run_cli(
        "mesh", "landslide.yaml", "-o", "ground.msh", "--set", "sizes.body=20"
    )
    assert status == 0, err
    assert "ground_bedrock" in out and "bed:" not in out
    settings = ["--set", "stages.fall.duration=0.4", "--set", "output.frames=false"]
    status, out, err = run_cli("run", "rockfall.yaml", "-o", "r", "--threads", "1", *settings)
    assert status == 0, err
    rocks = json.loads((tmp_path / "r/summary.json").read_text())["groups"]["rocks"]
    assert rocks["centroid"][0] > 21.7 + 0.4 * 3 and rocks["max_displacement"] > 1
