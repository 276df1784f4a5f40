"""Landslides that make no sense are answered with what is wrong."""

from pathlib import Path

import numpy as np
import pytest
from shared.slopes import SQUARE, slope

from cdem.case.map_system import look_up
from cdem.errors import CaseError
from cdem.terrain import Landslide, make_mesh
from cdem.terrain.projection import Projection

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"bodies": [{"group": "slab", "outline": [[30, 30], [70, 70], [70, 30], [30, 70]]}]},
            r"bodies\.0\.outline: crosses itself: Self-intersection\[50 50\]",
        ),
        (
            {"bodies": [{"group": "slab", "outline": [[30, 30], [170, 30], [70, 70]]}]},
            r"bodies\.0\.outline: leaves the extent: it spans \(30, 30\) to \(170, 70\)",
        ),
        (
            {"surface": {"plane": {"dip": 30, "dip_direction": 90, "through": [0, 0, 110]}}},
            r"bodies\.0\.outline: contains no rock: the sliding surface lies above the ground",
        ),
        (
            {"surface": {"plane": {"dip": 345, "dip_direction": 21, "through": [0, 0, 90]}}},
            r"surface\.plane\.dip: must lie in \[0, 90\) \[deg\], got 345",
        ),
        (
            {"surface": {"plane": {"dip": "30 m", "dip_direction": 9, "through": [0, 0, 0]}}},
            r"surface\.plane\.dip: '30 m' has the wrong dimension",
        ),
        (
            {"extent": {"x": [0, 100], "y": [0, 100], "base": 45}},
            r"extent\.base: must lie at least an element below the ground",
        ),
        ({"extent": {"x": [100, 0], "y": [0, 100], "base": 0}}, r"extent: x must rise"),
        ({"sizes": {"body": 10, "far": 300}}, r"sizes\.far: is larger than the extent"),
        ({"sizes": {"body": 10, "far": 3}}, r"sizes: far must be at least body"),
        (
            {"surface": {"lines": [[[20, 20, 50], [80, 20, 50]], [[20, 60, 50], [80, 60, 51]]]}},
            r"surface: has no data at \(.*\); it reaches from \(20, 20\) to \(80, 60\)",
        ),
        (
            {"surface": {"lines": [[[20, 20, 50], [80, 20, 50]]]}},
            r"surface\.lines: the points lie on one straight line",
        ),
        (
            {"surface": {}},
            r"surface: needs exactly one of contours, grid, triangles, lines, plane, planes, ellipsoid, points, slbl",
        ),
        (
            {"bodies": [{"group": "bedrock", "outline": SQUARE}]},
            r"bodies\.0\.group: the name 'bedrock' is used twice",
        ),
        ({"body": []}, r"body: unknown key; did you mean bodies"),
    ],
)
def test_mistakes_are_answered(changes, message):
    with pytest.raises(CaseError, match=message):
        make_mesh(Landslide(**slope(**changes)))


def test_mistakes_in_a_file_say_where(tmp_path: Path):
    file = tmp_path / "slope.yaml"
    file.write_text(
        "terrain: {contours: none.geojson}\n"
        "extent: {x: [0, 100], y: [0, 100], base: 0}\n"
        "surface: {plane: {dip: 30, dip_direction: 90, through: [0, 0, 90]}}\n"
        "bodies: [{group: slab, outline: [[3, 3], [7, 3], [7, 7]]}]\n"
        "sizes: {body: 10, far: 30}\n"
    )
    with pytest.raises(
        CaseError, match=r"slope\.yaml:1:11: terrain\.contours: .*none\.geojson: cannot"
    ):
        make_mesh(Landslide.load(file))


def test_contours_in_feet_are_asked_for_their_unit_and_brought_to_metres(tmp_path: Path):
    """A slope of 30 deg, contours every 50 ft; 1 ft (US survey) is 1200/3937 m."""
    raw, shapely = pytest.importorskip("pyogrio").raw, pytest.importorskip("shapely")
    foot, low = 1200 / 3937, np.array([3_000_000.0, 1_700_000.0])
    levels = 50.0 * np.arange(12)
    lines = [
        shapely.LineString(low + [[z / np.tan(np.radians(30)), y] for y in (0.0, 400.0, 1000.0)])
        for z in levels
    ]
    raw.write(
        tmp_path / "feet.gpkg", np.array([shapely.to_wkb(line) for line in lines], object),
        [6000 + levels], ["elev"], geometry_type="LineString", driver="GPKG", crs="EPSG:6529",
    )  # fmt: skip
    projection = Projection(look_up("EPSG:32613"))
    ends = projection.bring(tmp_path, "EPSG:6529", None, low + [[100.0, 100.0], [800.0, 900.0]])
    x, y = np.sort(ends, axis=0).T.tolist()
    text = (
        f"crs: EPSG:32613\nextent: {{x: {x}, y: {y}, base: 0}}\nsizes: {{body: 20, far: 60}}\n"
        "terrain: {contours: feet.gpkg%s}\n"
        "surface: {plane: {dip: 20, dip_direction: 90, through: [0, 0, 0]}}\n"
        f"bodies: [{{group: slab, outline: [[{x[0]}, {y[0]}], [{x[1]}, {y[0]}], [{x[1]}, {y[1]}]]}}]\n"
    )
    path = tmp_path / "slope.yaml"
    path.write_text(text % "")
    with pytest.raises(CaseError, match=r"projection is in US survey foot, .* write 'unit'"):
        Landslide.load(path).ground()
    path.write_text(text % ", unit: us-ft")
    ground = Landslide.load(path).ground()
    middle = ends.mean(axis=0)
    rise = np.diff(ground(middle + np.array([[-30.0, 0], [30.0, 0]])))[0]
    assert rise / 60 == pytest.approx(np.tan(np.radians(30)), rel=0.01)
    assert ground(middle[None])[0] == pytest.approx(
        (6000 + 450 * np.tan(np.radians(30))) * foot, abs=1
    )
