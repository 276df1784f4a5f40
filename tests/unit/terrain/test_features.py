"""Outlines in every format of GIS come back to a millimetre; layers and features are chosen."""

import numpy as np
import pytest
from shared.maps import RING, UTM32, write_shape

from cdem.case.map_system import look_up
from cdem.errors import CaseError
from cdem.terrain.features import read_features
from cdem.terrain.files import read_outline
from cdem.terrain.projection import Projection

pytest.importorskip("pyogrio", reason="needs the extra 'terrain'")


def outline(path, target=UTM32, **choice):
    """Corners of an outline, and the notes of its projection and of itself."""
    projection = Projection(look_up(target))
    corners, notes = read_outline(
        path, **choice, bring=lambda label, xy: projection.bring(path, label, None, xy)
    )
    return corners, projection.notes + notes


def same_ring(corners):
    """Largest distance of corners from those of RING, wherever it begins and whichever way."""
    away = np.linalg.norm(corners[:, None] - RING[None], axis=2)
    assert len(corners) == len(RING)
    return max(away.min(axis=0).max(), away.min(axis=1).max())


@pytest.mark.parametrize(
    ("name", "crs", "line"),
    [
        ("o.gpkg", UTM32, False),
        ("o.shp", UTM32, False),
        ("o.fgb", UTM32, True),
        ("o.dxf", UTM32, True),
        ("o.geojson", "EPSG:4326", False),
        ("o.kml", "EPSG:4326", True),
        ("o.gpkg", "EPSG:31254", False),
    ],
)
def test_an_outline_comes_back_from_every_format(tmp_path, name, crs, line):
    path = write_shape(tmp_path / name, crs=crs, line=line, label=name != "o.dxf")
    corners, notes = outline(path)
    # DXF keeps 15 digits; KML and GeoJSON have degrees
    assert same_ring(corners) < 1e-3
    brought = any("transformed from" in note or "RFC 7946" in note for note in notes)
    assert brought == (crs != UTM32)


def test_a_file_without_projection_is_taken_as_the_rest_and_told(tmp_path):
    path = write_shape(tmp_path / "o.shp", label=False)
    corners, notes = outline(path)
    assert same_ring(corners) < 1e-6
    assert notes == ["o.shp: names no projection; EPSG:32632 is assumed"]


def test_layers_and_features_are_chosen(tmp_path):
    import pyogrio
    import shapely

    path = write_shape(tmp_path / "o.gpkg", name="slide")
    shapes = np.array([shapely.to_wkb(shapely.Polygon(RING + 2000.0 * k)) for k in (1, 0)])
    names = [np.array(["far", "near"], object)]
    pyogrio.raw.write(
        path, shapes, names, ["name"], layer="two", geometry_type="Polygon", crs=UTM32,
        driver="GPKG", append=True,
    )  # fmt: skip
    with pytest.raises(CaseError, match=r"several layers; choose with 'layer': o, two"):
        read_features(path)
    with pytest.raises(CaseError, match=r"has no layer 'three'; there are: o, two"):
        read_features(path, "three")
    corners, _ = outline(path, layer="two", where={"name": "near"})
    assert same_ring(corners) < 1e-6
    with pytest.raises(CaseError, match=r"no feature has a property 'nme'; there are: \['name'\]"):
        read_features(path, "two", {"nme": "near"})
    with pytest.raises(CaseError, match=r"of name there are: \['far', 'near'\]"):
        read_features(path, "two", {"name": "nowhere"})


def test_files_that_are_no_shapes_are_refused(tmp_path):
    with pytest.raises(CaseError, match=r"o\.gpkg: cannot read the terrain file: No such"):
        read_features(tmp_path / "o.gpkg")
    (tmp_path / "o.gpkg").write_bytes(b"SQLite format 3\0" + b"x" * 500)
    with pytest.raises(CaseError, match=r"o\.gpkg: cannot be read \(.*; lines and polygons"):
        read_features(tmp_path / "o.gpkg")
    (tmp_path / "o.shp").write_text("<OGRVRTDataSource></OGRVRTDataSource>")
    with pytest.raises(CaseError, match=r"its first bytes do not match its ending \.shp"):
        read_features(tmp_path / "o.shp")
