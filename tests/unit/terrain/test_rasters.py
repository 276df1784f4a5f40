"""Readers of grids: exact on planes, and what they refuse."""

from pathlib import Path

import numpy as np
import pytest
from shared.slopes import PLANE, SOMEWHERE

from cdem.errors import CaseError
from cdem.terrain.rasters import read_grid

pytest.importorskip("scipy", reason="needs the extra 'terrain'")


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


def test_bad_grids_are_refused(tmp_path: Path):
    path = tmp_path / "g.asc"
    path.write_text("ncols 2\nnrows 2\ncellsize 10\n1 2\n3 4\n")
    with pytest.raises(CaseError, match="its head has no xllcenter, yllcenter"):
        read_grid(path)
    path.write_text("ncols 2\nnrows nan\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3\n")
    with pytest.raises(CaseError, match="its head has a number that is not finite"):
        read_grid(path)
    path.write_text("ncols -2\nnrows -2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3 4\n")
    with pytest.raises(CaseError, match=r"g\.asc: cannot be read .*; a grid is one of .asc"):
        read_grid(path)
    path.write_text("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2\n3\n")
    with pytest.raises(CaseError, match="contains 3 heights, but its head says 2 x 2"):
        read_grid(path)
