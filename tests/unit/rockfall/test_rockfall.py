"""The rockfall file: its ground."""

import numpy as np
import pytest

from cdem.rockfall.rockfall import Rockfall

pytest.importorskip("rasterio", reason="needs the extra 'terrain'")
EVEN = {"friction_angle": 30, "restitution": 0.5}


def test_zones_hold_the_cells_whose_middles_they_hold(tmp_path, monkeypatch):
    """A square, a triangle beside it, and a third polygon that both of them hide in part."""
    monkeypatch.chdir(tmp_path)
    head = "ncols 9\nnrows 7\nxllcorner -1\nyllcorner -1\ncellsize 2\n"
    (tmp_path / "a.asc").write_text(head + ("5 " * 9 + "\n") * 7)  # points at 0, 2 ... 16 and 12
    rings = (
        [[2, 2], [8.5, 2], [8.5, 8], [2, 8]],
        [[8.5, 0], [16, 0], [16, 12]],
        [[0, 0], [12, 0], [12, 4], [0, 4]],
    )
    zones = [{"name": f"z{n}", "area": ring, **EVEN} for n, ring in enumerate(rings)]
    ground = Rockfall(
        rockfall=1,
        terrain={"grid": "a.asc"},
        starts={"line": [[4, 4], [5, 5]]},
        count=1,
        blocks={"volume": 1},
        ground={"default": EVEN, "zones": zones},
    ).make_ground()
    x, y = np.meshgrid(np.arange(1, 16, 2), np.arange(1, 12, 2))  # middles
    square = (x > 2) & (x < 8.5) & (y > 2) & (y < 8)
    triangle = (x > 8.5) & (y < 12 / 7.5 * (x - 8.5))
    third = (x < 12) & (y < 4)
    assert (ground.zone == np.select([square, triangle, third], [1, 2, 3])).all()
    assert set(np.unique(ground.zone)) == {0, 1, 2, 3}
