"""Meshes of landslides: they conform and hold their volume."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from shared.maps import height, write_raster, write_shape
from shared.slopes import slope

from cdem.errors import CaseError
from cdem.mesh.mesh_files import read_mesh
from cdem.terrain import Landslide, make_mesh, measure, text, write
from cdem.terrain.solid import TET_FACES

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")


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


def test_a_slab_has_its_volume_its_dip_and_its_surfaces(tmp_path: Path):
    landslide = Landslide(**slope(sizes={"body": 16, "far": 50}))
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
    write(make_mesh(landslide), again)
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


# no shrinking: each example is a mesh; the slab above is the quick one
@pytest.mark.slow
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
    example = Path(__file__).parents[3] / "examples/jiweishan/landslide.yaml"
    solid = make_mesh(Landslide.load(example))
    check_conforming(solid)
    facts = measure(solid)
    assert facts["groups"]["key_body"]["volume"] == pytest.approx(1.11e6, rel=0.01)
    assert facts["groups"]["sliding_body"]["volume"] == pytest.approx(5.88e6, rel=0.01)
    assert facts["bed"]["dip"] == pytest.approx(21, abs=0.1)
    assert facts["bed"]["dip_direction"] == pytest.approx(345, abs=0.1)
    assert facts["tets"] == pytest.approx(46600, rel=0.05)
    assert facts["slivers"] == 0 and facts["smallest_height"] > 1.0


def test_a_dem_in_degrees_and_a_kml_line_become_a_mesh(tmp_path: Path):
    pytest.importorskip("rasterio", reason="needs the extra 'terrain'")
    write_raster(tmp_path / "dem.tif", "EPSG:4326")
    write_shape(tmp_path / "outline.kml", crs="EPSG:4326", line=True)
    file = tmp_path / "landslide.yaml"
    file.write_text(
        "crs: EPSG:32632\n"
        "terrain: {grid: dem.tif, cell: 20}\n"
        "extent: {x: [591100, 591900], y: [5193100, 5193900], base: 1200}\n"
        'surface: {slbl: {volume: "2e6 m3"}}\n'
        "bodies: [{group: slide, outline: {file: outline.kml}}]\n"
        "sizes: {body: 40, far: 150}\n"
    )
    solid = make_mesh(Landslide.load(file))
    check_conforming(solid)
    facts = measure(solid)
    assert facts["crs"] == "EPSG:32632"
    assert "crs: EPSG:32632" in text(facts)
    # surface and mesh have the same triangles; at the rim tets have a least thickness
    assert facts["groups"]["slide"]["volume"] == pytest.approx(2e6, rel=1e-6)
    ground = solid.points[np.unique(solid.surfaces["ground_slide"])]
    assert np.abs(ground[:, 2] - height(ground[:, :2])).max() < 0.1
    for key, words in (("crs", r"crs: no projection"), ("terrain.crs", "terrain.grid: ")):
        with pytest.raises(CaseError, match=words):
            make_mesh(Landslide.load(file, [f"{key}=EPSG:99999"]))
    with pytest.raises(CaseError, match=r"crs at the top; its UTM zone is EPSG:32632"):
        make_mesh(Landslide.load(file, ["crs="]))


def test_bare_ground_is_meshed_without_bodies():
    data = slope(sizes={"body": 10, "far": 20})
    del data["surface"], data["bodies"]
    solid = make_mesh(Landslide(**data))
    check_conforming(solid)
    facts = measure(solid)
    assert solid.groups == ["bedrock"]
    mean_height = 100 - 50 * math.tan(math.radians(30))
    assert facts["groups"]["bedrock"]["volume"] == pytest.approx(1e4 * mean_height, rel=1e-12)
    assert "bed:" not in text(facts)
    with pytest.raises(CaseError, match="bodies need a sliding surface"):
        Landslide(**{k: v for k, v in slope().items() if k != "surface"})
    with pytest.raises(CaseError, match="a surface without bodies has no effect"):
        Landslide(**{k: v for k, v in slope().items() if k != "bodies"})
