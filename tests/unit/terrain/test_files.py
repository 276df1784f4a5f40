"""Readers of contours, grids and outlines: exact on planes, and what they refuse."""

import json
from pathlib import Path

import numpy as np
import pytest
from shared.slopes import PLANE, SOMEWHERE, SQUARE, contours_of

from cdem.errors import CaseError
from cdem.terrain.files import read_lines, read_outline
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


def test_an_outline_is_read_and_an_open_one_refused(tmp_path: Path):
    path = tmp_path / "o.geojson"
    path.write_text(json.dumps({"type": "Polygon", "coordinates": [[*SQUARE, SQUARE[0]]]}))
    assert read_outline(path)[0].tolist() == SQUARE
    path.write_text(json.dumps({"type": "LineString", "coordinates": SQUARE}))
    with pytest.raises(CaseError, match=r"the outline is open: it starts at \(30, 30\) and ends"):
        read_outline(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ('{"type": "Polygon", "coordinates": []}', "its Polygon is not a list of points"),
        ('{"type": "Polygon", "coordinates": [[]]}', "its Polygon is not a list of points"),
        ('{"type": "Polygon", "coordinates": [[[1], [2], [3], [1]]]}', "its Polygon is not a list"),
        ('{"type": "Polygon", "coordinates": [[[NaN, 1]]]}', "its Polygon is not a list of points"),
        ('{"type": "Polygon", "coordinates": {"a": 1}}', "cannot be read .*an outline is a polyg"),
        ("<kml/>", "is XML, not GeoJSON"),
        ("3", "not GeoJSON"),
    ],
)
def test_bad_outlines_are_refused(tmp_path: Path, content: str, message: str):
    path = tmp_path / "o.geojson"
    path.write_text(content)
    with pytest.raises(CaseError, match=message):
        read_outline(path)
    with pytest.raises(CaseError, match=r"o.txt: lines and polygons are read from .geojson,"):
        read_outline(path.with_suffix(".txt"))


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
        ("a.xyz", "", r"contours are read from .geojson, .shp, .gpkg and their like, or .csv"),
        ("a.geojson", "<kml/>", "is XML, not GeoJSON; name a KML file .kml"),
        ("a.geojson", "[" * 100_000, "is nested more deeply than a sound file; lines and"),
        ("a.geojson", '{"features": [{"geometry": 3}]}', "a geometry or its properties are not {"),
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
