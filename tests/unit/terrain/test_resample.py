"""Grids in any projection, format and unit come to metres: heights are right, lies are refused."""

import numpy as np
import pytest
from shared.maps import RING, SOUTH, UTM32, WEST, height, write_raster

from cdem.case.map_system import look_up
from cdem.errors import CaseError
from cdem.terrain.projection import Projection, stretch, utm_zone
from cdem.terrain.rasters import read_grid
from cdem.terrain.resample import Wanted, filled, read_heights

rasterio = pytest.importorskip("rasterio", reason="needs the extra 'terrain'")

BOX = np.array([WEST, SOUTH]), np.array([WEST + 1000, SOUTH + 1000])
SOMEWHERE = np.random.default_rng(2).uniform(BOX[0] + 30, BOX[1] - 30, (300, 2))


def heights(path, target=UTM32, box=BOX, **wanted):
    projection = Projection(target and look_up(target))
    return read_heights(path, projection, Wanted(box, **wanted)), projection.notes


def worst(grid):
    """Largest error of a grid at random points, some cells from the end of the file [m]."""
    return np.abs(grid(SOMEWHERE) - height(SOMEWHERE)).max()


@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:31254", "EPSG:3857"])
def test_a_dem_is_resampled_once_and_exactly(tmp_path, crs):
    grid, notes = heights(write_raster(tmp_path / "dem.tif", crs), cell=10.0)
    # bilinear between points 10 m apart adds 10 / 150^2 / 8 * 10^2 = 6 mm
    assert worst(grid) < 0.02
    # lines at multiples of the cell
    assert (np.array([grid.west, grid.south]) - 5) % 10 == pytest.approx(0)
    assert notes == [
        f"dem.tif: transformed from {crs} to EPSG:32632",
        "dem.tif: resampled once, cubic, to cells of 10 m",
    ]
    native, _ = heights(tmp_path / "dem.tif")
    assert 6 < native.step[0] < 11


def test_a_grid_in_the_projection_itself_is_not_touched(tmp_path):
    grid, notes = heights(write_raster(tmp_path / "dem.tif"))
    whole = read_grid(tmp_path / "dem.tif")
    assert not notes
    assert np.abs(grid(SOMEWHERE) - whole(SOMEWHERE)).max() < 1e-9
    part = np.array([WEST + 300, SOUTH + 300]), np.array([WEST + 400, SOUTH + 500])
    small, _ = heights(tmp_path / "dem.tif", box=part)
    assert small.values.size < whole.values.size / 10
    assert (small.low <= part[0]).all() and (small.high >= part[1]).all()


@pytest.mark.parametrize("kind", ["asc", "grd", "vrt"])
def test_other_formats_are_read_alike(tmp_path, kind):
    from rasterio.shutil import copy

    write_raster(tmp_path / "dem.tif")
    path = tmp_path / f"dem.{kind}"
    copy(tmp_path / "dem.tif", path, driver={"asc": "AAIGrid", "grd": "GSBG", "vrt": "VRT"}[kind])
    grid, notes = heights(path)
    assert worst(grid) < 0.02
    assert not notes  # ESRI ASCII has a .prj beside it, the Surfer grid an .aux.xml


def test_a_label_that_lies_is_refused_and_replaced(tmp_path):
    path = write_raster(tmp_path / "dem.tif", label="EPSG:4326")
    with pytest.raises(CaseError, match=r"names EPSG:4326 \(degrees\), but its edges are \(590980"):
        heights(path)
    grid, notes = heights(path, told=UTM32)
    assert worst(grid) < 0.02
    assert notes == ["dem.tif: names EPSG:4326, but EPSG:32632 is used as given"]


@pytest.mark.parametrize(("unit", "factor"), [("ft", 0.3048), ("us-ft", 1200 / 3937), ("cm", 0.01)])
def test_heights_of_other_units_become_metres(tmp_path, unit, factor):
    path = write_raster(tmp_path / "dem.tif", change=lambda z: z / factor)
    grid, _ = heights(path, unit=unit)
    assert worst(grid) < 0.02
    with rasterio.open(path, "r+") as file:
        file.units = ({"ft": "foot", "us-ft": "US survey foot", "cm": "cm"}[unit],)
    grid, notes = heights(path)
    assert worst(grid) < 0.02
    assert notes == [f"dem.tif: its heights are multiplied by {factor:.10g}"]
    with rasterio.open(path, "r+") as file:
        file.units = ("cubits",)
    with pytest.raises(CaseError, match=r"in 'cubits'; write 'unit' beside it, one of m, ft"):
        heights(path)


FEET = "EPSG:6529"  # a state plane in US survey feet


def test_heights_of_a_projection_in_feet_are_asked_for(tmp_path):
    """Nobody says whether they are feet too: it makes a slope of 30 deg one of 62 deg."""
    foot = 1200 / 3937
    place = rasterio.transform.from_origin(1.7e6, 1.7e6 + 161 * 20, 20, 20)
    ground = 6000 + np.tan(np.radians(30)) * 20 * np.arange(161) * np.ones((161, 1))
    shape = {"width": 161, "height": 161, "count": 1, "dtype": "float64", "transform": place}
    for name, crs, values in (
        ("plan", FEET, ground),
        ("feet", f"{FEET}+6360", ground),
        ("metres", f"{FEET}+5703", ground * foot),
    ):
        with rasterio.open(tmp_path / f"{name}.tif", "w", driver="GTiff", crs=crs, **shape) as file:
            file.write(values, 1)
    low = np.array([1.7e6 + 500, 1.7e6 + 500])
    ring = Projection(look_up("EPSG:32613")).bring(
        tmp_path, FEET, None, np.array([low, low + 1500, low + [1500, 0], low + [0, 1500]])
    )
    box = ring.min(axis=0), ring.max(axis=0)
    with pytest.raises(CaseError, match=r"plan\.tif: its projection is in US survey foot, but it"):
        heights(tmp_path / "plan.tif", "EPSG:32613", box)
    with pytest.raises(CaseError, match="does not name the unit of its heights; write 'unit'"):
        heights(tmp_path / "plan.tif", "EPSG:32613", box, told=FEET)
    for name, unit in (("plan", "us-ft"), ("feet", None), ("metres", None)):
        grid, _ = heights(tmp_path / f"{name}.tif", "EPSG:32613", box, unit=unit)
        slope = np.hypot(*np.gradient(grid.values, *grid.step[::-1]))
        assert np.degrees(np.arctan(np.median(slope))) == pytest.approx(30, abs=0.05)


def test_heights_above_sea_and_ellipsoid_are_not_mixed(tmp_path):
    low = write_raster(tmp_path / "dem.tif", label="EPSG:25832+5783")
    high = write_raster(tmp_path / "bed.tif", label="EPSG:4979", crs="EPSG:4326")
    projection = Projection(look_up(UTM32))
    read_heights(low, projection, Wanted(BOX))
    with pytest.raises(CaseError, match=r"bed\.tif: its heights refer to 'ellipsoid of WGS 84'"):
        read_heights(high, projection, Wanted(BOX))


def test_gaps_are_filled_counted_and_refused_in_an_outline(tmp_path):
    def holes(z):
        z = z.copy()
        z[10:13, 10:14] = -9999.0
        z[60:63, 60:63] = -32768.0
        return z

    path = write_raster(tmp_path / "dem.tif", change=holes, nodata=-9999.0)
    grid, _ = heights(path, nodata=[-32768.0])
    assert np.isnan(grid.values).sum() == 12 + 9
    whole, notes = filled(path, grid, 50.0, [RING + 350.0])
    assert worst(whole) < 2.0
    assert notes == ["dem.tif: 21 cells without data filled"]
    with pytest.raises(CaseError, match=r"has a gap in an outline, at \(591585, 5193395"):
        filled(path, grid, 50.0, [RING - 50.0])
    _, notes = filled(path, grid, "all", [RING - 50.0])
    assert notes == ["dem.tif: 21 cells without data filled, 9 of them in outlines"]
    some, notes = filled(path, grid, 10.0, [])
    assert notes == ["dem.tif: 18 cells without data filled"]
    assert np.isnan(some.values).sum() == 3


def test_files_of_nowhere_and_of_another_place(tmp_path):
    path = write_raster(tmp_path / "dem.tif")
    away = BOX[0] + 5000, BOX[1] + 5000
    with pytest.raises(CaseError, match=r"and does not cover the required area, \(596000"):
        heights(path, box=away)
    with pytest.raises(
        CaseError, match=r"'WGS 84' is not a map projection.*write the projection of"
    ):
        heights(write_raster(tmp_path / "deg.tif", "EPSG:4326"), target=None)


def test_projections_are_what_geodesy_says():
    assert utm_zone(10.2, 46.9).to_epsg() == 32632
    assert utm_zone(-70.0, -33.0).to_epsg() == 32719
    # UTM at 91 km from the central meridian: 0.9996 (1 + 91^2 / 2 / 6380^2)
    assert stretch(RING, look_up(UTM32)) == pytest.approx(
        0.9996 * (1 + (91 / 6380) ** 2 / 2) - 1, abs=2e-6
    )
    # Web Mercator: 1 / cos 46.9 deg
    from shared.maps import moved

    ring = moved(RING, UTM32, "EPSG:3857")
    assert 1 + stretch(ring, look_up("EPSG:3857")) == pytest.approx(
        1 / np.cos(np.radians(46.88)), rel=3e-3
    )


def test_gaps_count_where_heights_are_needed_only(tmp_path):
    """A clipped DEM in every format: none in the part that is read, though the file has some."""
    from rasterio.shutil import copy

    def clip(z):
        z = z.copy()
        z[:, :20] = z[:15, :] = -9999.0
        return z

    write_raster(tmp_path / "dem.tif", change=clip, nodata=-9999.0)
    part = np.array([WEST + 500, SOUTH + 300]), np.array([WEST + 800, SOUTH + 600])
    found = []
    for kind, driver in (("tif", None), ("asc", "AAIGrid"), ("grd", "GSBG"), ("vrt", "VRT")):
        path = tmp_path / f"dem.{kind}"
        if driver:
            copy(tmp_path / "dem.tif", path, driver=driver)
        grid, _ = heights(path, box=part)
        assert np.isfinite(grid.values).all(), kind
        found.append(grid)
    for grid in found[1:]:
        assert grid.values.shape == found[0].values.shape
        assert np.abs(grid.values - found[0].values).max() < 1e-3
        assert (grid.west, grid.south) == pytest.approx((found[0].west, found[0].south))
