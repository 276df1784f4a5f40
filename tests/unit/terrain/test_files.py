"""Readers of contours, grids and outlines: exact on planes, and what they refuse."""

import json
from pathlib import Path

import numpy as np
import pytest
from shared.slopes import PLANE, SOMEWHERE, SQUARE, contours_of

from cdem.errors import CaseError
from cdem.terrain.files import read_grid, read_lines, read_outline
from cdem.terrain.heights import Lines

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")


def test_contours_in_geojson_and_csv_give_a_plane_back(tmp_path: Path):
    lines, heights = contours_of(PLANE)
    features = [
        {
            "type": "Feature",
            "properties": {"id": k, "ELEV": z},
            "geometry": {"type": "LineString", "coordinates": line},
        }
        for k, (line, z) in enumerate(zip(lines, heights, strict=True))
    ]
    geojson = tmp_path / "c.geojson"
    geojson.write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    table = tmp_path / "c.csv"
    rows = [f"{k},{z},{x},{y}" for k, z in enumerate(heights) for x, y in lines[k]]
    table.write_text("\n".join(["# line_id,elev_m,x_east_m,y_north_m  (test)", *rows]))
    for path in (geojson, table):
        found = Lines(read_lines(path), spacing=5.0)
        assert np.abs(found(SOMEWHERE) - PLANE(SOMEWHERE)).max() < 1e-9


@pytest.mark.parametrize("corner", [True, False])
def test_an_ascii_grid_gives_a_plane_back(tmp_path: Path, corner: bool):
    x, y = np.arange(-50, 81, 10.0), np.arange(-40, 71, 10.0)
    z = PLANE(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)).reshape(len(y), len(x))
    place = "xllcorner -55\nyllcorner -45" if corner else "xllcenter -50\nyllcenter -40"
    rows = "\n".join(" ".join(f"{v:.17g}" for v in row) for row in z[::-1])
    path = tmp_path / "g.asc"
    path.write_text(f"ncols 14\nnrows 12\n{place}\ncellsize 10\nNODATA_value -9999\n{rows}\n")
    grid = read_grid(path)
    assert np.abs(grid(SOMEWHERE) - PLANE(SOMEWHERE)).max() < 1e-10
    assert grid.low.tolist() == [-55, -45] and grid.high.tolist() == [85, 75]


def test_a_geotiff_gives_a_plane_back_and_degrees_are_refused(tmp_path: Path):
    rasterio = pytest.importorskip("rasterio")
    x, y = np.arange(-50, 81, 10.0), np.arange(70, -41, -10.0)
    z = PLANE(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)).reshape(len(y), len(x))
    place = rasterio.transform.from_origin(-55, 75, 10, 10)
    head = {"driver": "GTiff", "width": 14, "height": 12, "count": 1, "dtype": "float64"}
    for system, path in (("EPSG:32648", tmp_path / "utm.tif"), ("EPSG:4326", tmp_path / "deg.tif")):
        with rasterio.open(path, "w", crs=system, transform=place, compress="lzw", **head) as file:
            file.write(z, 1)
    found = read_grid(tmp_path / "utm.tif")
    assert np.abs(found(SOMEWHERE) - PLANE(SOMEWHERE)).max() < 1e-10
    with pytest.raises(CaseError, match=r"deg\.tif: is in degrees \(EPSG:4326\); project it"):
        read_grid(tmp_path / "deg.tif")


def test_an_outline_is_read_and_an_open_one_refused(tmp_path: Path):
    path = tmp_path / "o.geojson"
    path.write_text(json.dumps({"type": "Polygon", "coordinates": [[*SQUARE, SQUARE[0]]]}))
    assert read_outline(path).tolist() == SQUARE
    path.write_text(json.dumps({"type": "LineString", "coordinates": SQUARE}))
    with pytest.raises(
        CaseError, match=r"the outline is open: it starts at \[30.0, 30.0\] and ends"
    ):
        read_outline(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ('{"type": "Polygon", "coordinates": []}', "its Polygon is not a list of points"),
        ('{"type": "Polygon", "coordinates": [[]]}', "its Polygon is not a list of points"),
        ('{"type": "Polygon", "coordinates": [[[1], [2], [3], [1]]]}', "its Polygon is not a list"),
        ('{"type": "Polygon", "coordinates": [[[NaN, 1]]]}', "its Polygon is not a list of points"),
        ('{"type": "Polygon", "coordinates": {"a": 1}}', "cannot be read .*an outline is a polyg"),
        ("<kml/>", "is KML or another XML"),
        ("3", "not GeoJSON"),
    ],
)
def test_bad_outlines_are_refused(tmp_path: Path, content: str, message: str):
    path = tmp_path / "o.geojson"
    path.write_text(content)
    with pytest.raises(CaseError, match=message):
        read_outline(path)
    with pytest.raises(CaseError, match=r"o.kml: outlines are read from .geojson \(convert"):
        read_outline(path.with_suffix(".kml"))


def test_a_geotiff_is_no_link_to_another_file(tmp_path: Path):
    pytest.importorskip("rasterio")
    (tmp_path / "other.asc").write_text(
        "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3 4\n"
    )
    (tmp_path / "g.tif").write_text(
        '<VRTDataset rasterXSize="2" rasterYSize="2"><VRTRasterBand dataType="Float32" band="1">'
        f"<SimpleSource><SourceFilename>{tmp_path}/other.asc</SourceFilename></SimpleSource>"
        "</VRTRasterBand><GeoTransform>0, 10, 0, 20, 0, -10</GeoTransform></VRTDataset>"
    )
    with pytest.raises(CaseError, match=r"g\.tif: not a GeoTIFF"):
        read_grid(tmp_path / "g.tif")


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.csv", "a,b,c\n1,2,3\n", "must name the columns x, y and z"),
        ("a.csv", "x,y,z\n1,2,three\n", "row 2 has no numbers x, y, z: 1,2,three"),
        ("a.csv", "x,y,z,line\n1,2,3\n", "row 2 has no line: 1,2,3"),
        ("a.csv", "x,y,z\n1,2,3\n4,5,3\n", "all points have the same height 3"),
        ("a.geojson", "{", r"a\.geojson:1:2: not JSON"),
        (
            "a.geojson",
            '{"features": [{"properties": {"name": 1}, "geometry": {"type": "LineString", '
            '"coordinates": [[0, 0], [1, 1]]}}]}',
            r"feature 0 has no height; name its property with 'elevation' \(it has: name\)",
        ),
        ("a.csv", "x,y,z\n107.1,29.2,800\n107.2,29.3,1400\n", "longitude and latitude in degrees"),
        ("a.shp", "", r"contours are read from .geojson or .csv \(convert others with ogr2ogr"),
        ("a.geojson", "<kml/>", "is KML or another XML, not GeoJSON; convert others with ogr2ogr"),
        ("a.geojson", "[" * 100_000, "is nested deeper than a sound file does; contours are"),
        ("a.geojson", '{"features": [{"geometry": 3}]}', "a geometry or properties are no {"),
        ("a.geojson", '{"type": "LineString", "coordinates": 3}', "a.geojson: "),
        ("a.geojson", '{"type": "LineString", "coordinates": []}', "a.geojson: "),
        ("a.csv", "x,y,z\n1,nan,3\n", "row 2 has no numbers x, y, z: 1,nan,3"),
        ("a.csv", "x,y,z\n" + "1" * 200_000, "cannot be read .field larger than field limit"),
    ],
)
def test_bad_contours_are_refused(tmp_path: Path, name: str, content: str, message: str):
    path = tmp_path / name
    path.write_text(content)
    with pytest.raises(CaseError, match=message):
        read_lines(path)


def test_bad_grids_are_refused(tmp_path: Path):
    path = tmp_path / "g.asc"
    path.write_text("ncols 2\nnrows 2\ncellsize 10\n1 2\n3 4\n")
    with pytest.raises(CaseError, match="its head has no xllcenter, yllcenter"):
        read_grid(path)
    path.write_text("ncols 2\nnrows nan\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3\n")
    with pytest.raises(CaseError, match="its head has a number that is not finite"):
        read_grid(path)
    path.write_text("ncols -2\nnrows -2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3 4\n")
    with pytest.raises(CaseError, match=r"g\.asc: cannot be read .*; a grid is ESRI ASCII"):
        read_grid(path)
    path.write_text("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3\n")
    with pytest.raises(CaseError, match="holds 3 heights, but its head says 2 x 2"):
        read_grid(path)
