"""Where heights come from: grids, cells of another size, and landslide files."""

import json

import numpy as np
import pytest
from shared.slopes import PLANE, slope

from cdem.errors import CaseError
from cdem.screening.ground import read_ground
from cdem.terrain.heights import Grid

pytest.importorskip("rasterio", reason="needs the extra 'terrain'")


def grid_file(path, x, y, cell):
    z = PLANE(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)).reshape(len(y), len(x))
    rows = "\n".join(" ".join(f"{v:.17g}" for v in row) for row in z[::-1])
    path.write_text(
        f"ncols {len(x)}\nnrows {len(y)}\nxllcenter {x[0]}\nyllcenter {y[0]}\ncellsize {cell}\n{rows}\n"
    )
    return path


def is_plane(grid: Grid):
    x = grid.west + grid.step[0] * np.arange(grid.values.shape[1])
    y = grid.south + grid.step[1] * np.arange(grid.values.shape[0])
    xy = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return np.abs(PLANE(xy).reshape(grid.values.shape) - grid.values).max() < 1e-9


def test_a_grid_as_it_is_or_with_other_cells(tmp_path):
    path = grid_file(tmp_path / "g.asc", np.arange(0, 101, 10.0), np.arange(0, 61, 10.0), 10)
    grid, system, notes = read_ground(path)
    assert grid.values.shape == (7, 11) and (system, notes) == (None, [])
    fine, _, _ = read_ground(path, 4.0)
    assert fine.values.shape == (17, 27) and is_plane(fine) and fine.west == -3
    with pytest.raises(CaseError, match=r"cells of 0\.001 m give a map of"):
        read_ground(path, 0.001)


def test_the_map_projection_beside_an_ascii_grid(tmp_path):
    from rasterio.crs import CRS

    path = grid_file(tmp_path / "g.asc", np.arange(0, 31, 10.0), np.arange(0, 31, 10.0), 10)
    (tmp_path / "g.prj").write_text(CRS.from_epsg(32632).to_wkt())
    assert read_ground(path)[1] == "EPSG:32632"


def test_the_extent_of_a_landslide_file(tmp_path):
    grid_file(tmp_path / "g.asc", np.arange(-50, 151, 10.0), np.arange(-50, 151, 10.0), 10)
    data = slope(terrain={"grid": "g.asc"}, extent={"x": [0, 95], "y": [-20, 60], "base": -900})
    path = tmp_path / "landslide.yaml"
    path.write_text(json.dumps(data))
    grid, _, _ = read_ground(path)
    assert grid.values.shape == (9, 10) and is_plane(grid) and (grid.west, grid.south) == (0, -20)
    finer, _, _ = read_ground(path, 5.0)
    assert finer.values.shape == (16, 19) and is_plane(finer)
    path.write_text(
        json.dumps(
            slope(terrain={"grid": "g.asc"}, extent={"x": [0, 900], "y": [0, 60], "base": 0})
        )
    )
    with pytest.raises(
        CaseError, match=r"landslide.yaml:1:\d+: extent: reaches beyond the terrain"
    ):
        read_ground(path)


def test_terrain_without_a_grid_has_cells_of_half_an_element(tmp_path):
    path = tmp_path / "landslide.yaml"
    path.write_text(json.dumps(slope()))
    assert read_ground(path)[0].values.shape == (20, 20)
