"""Terrain: readers exact on planes, meshes that conform and hold their volume, errors that say what."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from cdem.errors import BackendError, CaseError
from cdem.mesh.mesh_files import read_mesh

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")

from cdem.terrain import Landslide, make_mesh, measure, text, write
from cdem.terrain.files import read_grid, read_lines, read_outline
from cdem.terrain.heights import Grid, Lines, Plane, Smooth, extra
from cdem.terrain.plan import Plan, _split_pinched
from cdem.terrain.solid import TET_FACES

PLANE = Plane(dip=25.0, dip_direction=200.0, through=(10.0, -5.0, 120.0))
SOMEWHERE = np.random.default_rng(1).uniform([-40, -30], [70, 60], (200, 2))
SQUARE = [[30, 30], [70, 30], [70, 70], [30, 70]]


def contours_of(plane, spacing=10.0):
    """Contour lines of a plane, cut off by a disc."""
    fall = math.tan(math.radians(plane.dip))
    azimuth = math.radians(plane.dip_direction)
    down = np.array([math.sin(azimuth), math.cos(azimuth)])
    across = np.array([-down[1], down[0]])
    lines = []
    for z in np.arange(60, 181, spacing):
        start = np.array(plane.through[:2]) + down * (plane.through[2] - z) / fall
        lines.append([(start + across * s).tolist() for s in (-120, -30, 40, 120)])
    return lines, np.arange(60, 181, spacing)


def slope(**changes):
    """A slab 10 m thick on a slope of 30 deg to the east."""
    data = {
        "terrain": {"plane": {"dip": 30, "dip_direction": 90, "through": [0, 0, 100]}},
        "extent": {"x": [0, 100], "y": [0, 100], "base": 0},
        "surface": {"plane": {"dip": 30, "dip_direction": 90, "through": [0, 0, 90]}},
        "bodies": [{"group": "slab", "outline": SQUARE}],
        "sizes": {"body": 10, "far": 40},
    }
    return data | changes


def check_conforming(solid):
    """Every inner face is used twice, the rest is the outside; the volumes are the shells'."""
    faces = solid.tets[:, TET_FACES].reshape(-1, 3)
    owner = np.repeat(solid.tet_group, 4)
    _, index, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    assert set(count) == {1, 2}
    corners = solid.points[solid.tets]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    assert volume.min() > 0
    middle = solid.points.mean(axis=0)
    for group in range(len(solid.groups)):
        inside = np.bincount(index[owner == group], minlength=len(count))
        shell = faces[(owner == group) & (inside[index] == 1)]
        sides = solid.points[shell] - middle
        enclosed = np.linalg.det(sides).sum() / 6
        assert volume[solid.tet_group == group].sum() == pytest.approx(enclosed, rel=1e-12)
    outside = sum(len(f) for n, f in solid.surfaces.items() if n.startswith(("fix_", "ground_")))
    assert outside == (count == 1).sum()


# ------------------------------------------------------------------ readers


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


def test_beyond_the_outermost_contours_the_plane_goes_on():
    lines, heights = contours_of(PLANE)
    found = Lines(
        [np.column_stack([xy, [z] * 4]) for xy, z in zip(lines, heights, strict=True)], 5.0
    )
    far = np.array([[400.0, 300.0], [-300.0, 10.0]])
    assert np.abs(found(far) - PLANE(far)).max() < 1e-6


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


def test_smoothing_keeps_a_plane_and_rounds_an_edge():
    assert np.abs(Smooth(PLANE, 7.0)(SOMEWHERE) - PLANE(SOMEWHERE)).max() < 1e-10
    x = np.arange(-50.0, 51.0)
    step = Grid(-50.0, -50.0, (1.0, 1.0), np.tile(np.where(x > 0, 10.0, 0.0), (101, 1)))
    z = Smooth(step, 5.0)(np.array([[-30.0, 0.0], [0.5, 0.0], [30.0, 0.0]]))
    assert z == pytest.approx([0.0, 5.0, 10.0], abs=1e-9)


def test_an_outline_is_read_and_an_open_one_refused(tmp_path: Path):
    path = tmp_path / "o.geojson"
    path.write_text(json.dumps({"type": "Polygon", "coordinates": [[*SQUARE, SQUARE[0]]]}))
    assert read_outline(path).tolist() == SQUARE
    path.write_text(json.dumps({"type": "LineString", "coordinates": SQUARE}))
    with pytest.raises(
        CaseError, match=r"the outline is open: it starts at \[30.0, 30.0\] and ends"
    ):
        read_outline(path)


# ------------------------------------------------------------------ meshes


def test_a_slab_has_its_volume_its_dip_and_its_surfaces(tmp_path: Path):
    landslide = Landslide(**slope())
    solid = make_mesh(landslide)
    check_conforming(solid)
    facts = measure(solid)
    assert facts["groups"]["slab"]["volume"] == pytest.approx(40 * 40 * 10, rel=1e-12)
    whole = sum(group["volume"] for group in facts["groups"].values())
    mean_height = 100 - 50 * math.tan(math.radians(30))
    assert whole == pytest.approx(1e4 * mean_height, rel=1e-12)
    assert facts["bed"]["dip"] == pytest.approx(30, abs=1e-9)
    assert facts["bed"]["dip_direction"] == pytest.approx(90, abs=1e-9)
    assert facts["slivers"] == 0
    assert "slab" in text(facts)
    path = tmp_path / "slab.msh.gz"
    write(solid, path)
    mesh = read_mesh(path)
    assert mesh.group_names == ["bedrock", "slab"]
    assert len(mesh.cells["tet4"]) == len(solid.tets)
    assert set(mesh.surfaces) == set(solid.surfaces)
    again = tmp_path / "again.msh.gz"
    write(make_mesh(Landslide(**slope())), again)
    assert again.read_bytes() == path.read_bytes()
    with pytest.raises(CaseError, match=r"written as \.msh"):
        write(solid, tmp_path / "slab.vtu")


def test_coarser_away_from_the_body_and_with_depth():
    solid = make_mesh(Landslide(**slope(sizes={"body": 5, "far": 30})))
    corners = solid.points[solid.tets]
    edge = np.linalg.norm(corners[:, 0] - corners[:, 1], axis=1)
    deep = (solid.tet_group == 0) & (corners[:, :, 2].mean(axis=1) < 20)
    assert np.median(edge[deep]) > 2 * np.median(edge[solid.tet_group == 1])


@pytest.mark.parametrize("corner", [(0.0, 0.0), (500123.4, 3245678.9)])
def test_a_body_ends_at_the_outcrop_and_two_share_a_wall(corner):
    # ground level, bed dips 20 deg to the south and comes out along y = 60: a wedge in two parts
    x, y = corner
    west = np.array([[20, 20], [60, 20], [60, 80], [20, 80]]) + corner
    solid = make_mesh(
        Landslide(
            terrain={"plane": {"dip": 0, "dip_direction": 0, "through": [x, y, 0]}},
            extent={"x": [x, x + 120], "y": [y, y + 100], "base": -60},
            surface={"plane": {"dip": 20, "dip_direction": 180, "through": [x, y + 60, 0]}},
            bodies=[
                {"group": "west", "outline": west},
                {"group": "east", "outline": west + [40, 0]},
            ],
            sizes={"body": 8, "far": 40},
        )
    )
    check_conforming(solid)
    facts = measure(solid)
    wedge = 40 * 40**2 / 2 * math.tan(math.radians(20))
    for name in ("west", "east"):
        assert facts["groups"][name]["volume"] == pytest.approx(wedge, rel=1e-3)
    assert facts["bed"]["dip"] == pytest.approx(20, abs=1e-9)
    assert "west: ends at the outcrop" in facts["notes"][0]
    shared = solid.points[solid.surfaces["wall_west_east"]]
    assert shared[:, :, 0] - x == pytest.approx(60.0, abs=1e-6)


def test_a_bowl_under_a_slope_comes_out_all_round():
    # an elliptic paraboloid 25 m deep, cut off by the ground in an ellipse of 60 m by 50 m
    x, y = np.meshgrid(np.linspace(20, 180, 17), np.linspace(20, 180, 17))
    depth = 25 * np.maximum(-1, 1 - ((x - 100) / 60) ** 2 - ((y - 100) / 50) ** 2)
    bed = 150 - math.tan(math.radians(25)) * x - depth
    solid = make_mesh(
        Landslide(
            terrain={"plane": {"dip": 25, "dip_direction": 90, "through": [0, 0, 150]}},
            extent={"x": [0, 200], "y": [0, 200], "base": 0},
            surface={"lines": np.stack([x, y, bed], axis=-1)},
            bodies=[{"group": "bowl", "outline": [[25, 25], [175, 25], [175, 175], [25, 175]]}],
            sizes={"body": 8, "far": 40},
        )
    )
    check_conforming(solid)
    facts = measure(solid)
    # chords of 8 and 10 m cut off some of it
    assert facts["groups"]["bowl"]["volume"] == pytest.approx(25 * math.pi * 60 * 50 / 2, rel=0.05)
    assert facts["slivers"] == 0 and facts["smallest_height"] > 0.1 * 8
    assert not any(name.startswith("wall_") for name in solid.surfaces)


def test_an_edge_without_thickness_across_a_body_is_divided():
    points = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
    none = np.full(4, np.nan)
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    plan = Plan(points, triangles, np.array([0, 0]), none, none, np.arange(4), [])
    _split_pinched(plan, np.array([True, False, True, False]))
    assert plan.points[4].tolist() == [2, 2]
    assert sorted(map(sorted, plan.triangles.tolist())) == [
        [0, 1, 4],
        [0, 3, 4],
        [1, 2, 4],
        [2, 3, 4],
    ]
    sides = plan.points[plan.triangles]
    assert np.linalg.det(sides[:, 1:] - sides[:, :1]) == pytest.approx(8.0)


# no shrinking: each example is a mesh
@settings(max_examples=4, deadline=None, derandomize=True, phases=[Phase.generate])
@given(
    dip=st.floats(0, 45), azimuth=st.floats(0, 360), deep=st.floats(6, 18), turn=st.floats(0, 90)
)
def test_any_slab_on_a_plane_slope_has_its_volume(dip, azimuth, deep, turn):
    angle = np.radians(turn + np.array([0, 90, 180, 270]))
    outline = np.column_stack([50 + 28 * np.cos(angle), 50 + 28 * np.sin(angle)])
    plane = {"dip": dip, "dip_direction": azimuth}
    solid = make_mesh(
        Landslide(
            terrain={"plane": plane | {"through": [50, 50, 150]}},
            extent={"x": [0, 100], "y": [0, 100], "base": 0},
            surface={"plane": plane | {"through": [50, 50, 150 - deep]}},
            bodies=[{"group": "slab", "outline": outline}],
            sizes={"body": 14, "far": 50},
        )
    )
    facts = measure(solid)
    assert facts["groups"]["slab"]["volume"] == pytest.approx(2 * 28**2 * deep, rel=1e-9)
    whole = sum(group["volume"] for group in facts["groups"].values())
    assert whole == pytest.approx(1e4 * 150, rel=1e-9)
    assert facts["bed"]["dip"] == pytest.approx(dip, abs=1e-6)
    check_conforming(solid)


@pytest.mark.slow
def test_jiweishan_from_its_contours():
    """Published: 1.11 + 5.88 Mm3 (reconstruction), 345/21 deg, 46,584 tets (Feng et al. 2014)."""
    example = Path(__file__).parents[2] / "examples/jiweishan/landslide.yaml"
    solid = make_mesh(Landslide.load(example))
    check_conforming(solid)
    facts = measure(solid)
    assert facts["groups"]["key_body"]["volume"] == pytest.approx(1.11e6, rel=0.01)
    assert facts["groups"]["sliding_body"]["volume"] == pytest.approx(5.88e6, rel=0.01)
    assert facts["bed"]["dip"] == pytest.approx(21, abs=0.1)
    assert facts["bed"]["dip_direction"] == pytest.approx(345, abs=0.1)
    assert facts["tets"] == pytest.approx(46600, rel=0.05)
    assert facts["slivers"] == 0 and facts["smallest_height"] > 1.0


# ------------------------------------------------------------------ mistakes


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
            r"bodies\.0\.outline: holds no rock: the sliding surface lies above the ground",
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
            r"extent\.base: must lie an element below the ground",
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
        ({"surface": {}}, r"surface: needs exactly one of contours, grid, lines, plane; got none"),
        (
            {"bodies": [{"group": "bedrock", "outline": SQUARE}]},
            r"bodies\.0\.group: the name 'bedrock' is taken",
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


def test_the_verb_writes_a_mesh_and_says_what_it_holds(cdem, tmp_path: Path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    data = slope(sizes={"body": 20, "far": 50})
    (tmp_path / "slope.yaml").write_text(json.dumps(data))
    status, out, err = cdem("mesh", "slope.yaml")
    assert (status, err) == (0, "")
    assert out.startswith("slope.msh: ") and "bed: dip 30.000 deg towards 90.000 deg" in out
    mesh = read_mesh("slope.msh")
    assert mesh.group_names == ["bedrock", "slab"]
    status, out, err = cdem("mesh", "slope.yaml", "-o", "fine.msh", "--set", "sizes.body=12")
    assert (status, err) == (0, "")
    assert len(read_mesh("fine.msh").cells["tet4"]) > 1.5 * len(mesh.cells["tet4"])
    status, out, err = cdem("mesh", "slope.yaml", "--set", "sizes.bodies=40")
    assert status == 1 and "sizes.bodies" in err and "Traceback" not in err
    data["surface"]["plane"]["through"] = [0, 0, 900]
    (tmp_path / "slope.yaml").write_text(json.dumps(data))
    status, out, err = cdem("mesh", "slope.yaml")
    assert status == 1 and out == ""
    assert "slope.yaml:1:" in err and "bodies.0.outline: holds no rock" in err


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.csv", "a,b,c\n1,2,3\n", "must name the columns x, y and z"),
        ("a.csv", "x,y,z\n1,2,three\n", "row 2 has no numbers x, y, z: 1,2,three"),
        ("a.csv", "x,y,z\n1,2,3\n4,5,3\n", "all points have the same height 3"),
        ("a.geojson", "{", r"a\.geojson:1:2: not JSON"),
        (
            "a.geojson",
            '{"features": [{"properties": {"name": 1}, "geometry": {"type": "LineString", '
            '"coordinates": [[0, 0], [1, 1]]}}]}',
            r"feature 0 has no height; name its property with 'elevation' \(it has: name\)",
        ),
        ("a.csv", "x,y,z\n107.1,29.2,800\n107.2,29.3,1400\n", "longitude and latitude in degrees"),
        ("a.shp", "", "contours are read from .geojson or .csv"),
    ],
)
def test_bad_contours_are_refused(tmp_path: Path, name: str, content: str, message: str):
    path = tmp_path / name
    path.write_text(content)
    with pytest.raises(CaseError, match=message):
        read_lines(path)


def test_a_missing_library_is_named_with_its_cure():
    with pytest.raises(BackendError, match=r"needs no_such_library: pip install 'cdem\[terrain\]'"):
        extra("no_such_library.part")


def test_bad_grids_are_refused(tmp_path: Path):
    path = tmp_path / "g.asc"
    path.write_text("ncols 2\nnrows 2\ncellsize 10\n1 2\n3 4\n")
    with pytest.raises(CaseError, match="its head has no xllcenter, yllcenter"):
        read_grid(path)
    path.write_text("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3\n")
    with pytest.raises(CaseError, match="holds 3 heights, but its head says 2 x 2"):
        read_grid(path)
