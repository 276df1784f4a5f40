"""Blocks and starts, drawn run by run."""

import numpy as np
import pytest

from cdem.mesh.primitives import polyhedron
from cdem.rockfall.blocks import Wish, draw, value
from cdem.rockfall.ground import Ground
from cdem.rockfall.rigid import RigidBlock
from cdem.rockfall.schema import Blocks, Drawn
from cdem.rockfall.starts import Starts, triangles_of

Z = np.repeat(100.0 - 2.0 * np.arange(41)[None] * 0.7, 41, axis=0)
SLOPE = Ground(0.0, 0.0, np.array([2.0, 2.0]), Z, np.zeros((40, 40), np.int16))
LINE = Starts([np.array([[20.0, 10], [20.0, 70]])], np.zeros((0, 3, 2)), np.zeros((0, 2)))


def wish(**more):
    shapes = Blocks(volume=1.0, shapes={"cube": 1, "slab": 1, "rod": 1, "rounded": 1}).shapes
    volume = Drawn(lognormal={"mean": 1.0, "deviation": 0.5, "low": 0.1, "high": 5})
    given = {
        "seed": 1, "shapes": shapes, "volume": volume, "height": Drawn(values=[0.3]),
        "velocity": Drawn(values=[2.0]), "starts": LINE,
    }  # fmt: skip
    return Wish(**(given | more))


def test_a_run_depends_on_its_number_alone():
    one, two = draw(wish(), 7, SLOPE), draw(wish(), 7, SLOPE)
    np.testing.assert_array_equal(one.boulder.vertices, two.boulder.vertices)
    assert (draw(wish(), 8, SLOPE).boulder.vertices[0] != one.boulder.vertices[0]).any()
    faster = draw(wish(velocity=Drawn(values=[5.0])), 7, SLOPE)
    np.testing.assert_array_equal(faster.boulder.vertices, one.boulder.vertices)
    np.testing.assert_allclose(faster.boulder.velocity, [5.0, 0, 0], atol=1e-12)  # downslope


def test_blocks_have_the_drawn_volumes_and_shapes_and_stand_clear():
    starts = [draw(wish(), number, SLOPE) for number in range(100)]
    for start in starts[:25]:
        mesh = polyhedron("block", start.boulder.vertices)
        body = RigidBlock(mesh.points, mesh.cells["tet4"], 1.0)
        assert body.volume == pytest.approx(start.volume, rel=1e-9)
        corners = start.boulder.vertices
        clear = corners[:, 2] - SLOPE.height(corners[:, :2])
        assert clear.min() == pytest.approx(0.3, abs=1e-9)  # on a plane a corner is the lowest
        assert 8 <= len(corners) <= 14
    shares = [sum(s.shape == name for s in starts) / 100 for name in wish().shapes]
    assert max(abs(share - 0.25) for share in shares) < 0.15
    y = np.array([start.boulder.vertices[:, 1].mean() for start in starts])
    assert abs(np.mean(y) - 40) < 5
    assert (y > 9.5).all()


def test_values_have_units():
    assert value(Drawn(values=["2 km", 5.0]), 0.1, "m") == 2000.0
    assert value(Drawn(uniform={"low": 1, "high": 3}, unit="km/h"), 0.5, "m/s") == pytest.approx(
        2 / 3.6
    )


def test_an_area_is_filled_evenly():
    ring = np.array([[0, 0], [4, 0], [4, 4], [2, 1], [0, 4.0]])  # not convex
    triangles = triangles_of(ring)
    one, two = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    area = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    assert area.sum() == pytest.approx(10.0)
    starts, random = Starts([], triangles, np.zeros((0, 2))), np.random.default_rng(1)
    xy = np.array([starts.place(random) for _ in range(2000)])
    # of 10 m2, those with y below 1 are 4; a band of four deviations
    assert (xy[:, 1] < 1).mean() == pytest.approx(0.4, abs=4 * np.sqrt(0.24 / 2000))
    with pytest.raises(ValueError, match="cross"):
        triangles_of(np.array([[0, 0], [1, 1], [1, 0], [0, 1.0]]))


def test_a_line_is_walked_by_its_length():
    starts = Starts([np.array([[0, 0], [1, 0], [1, 9.0]])], np.zeros((0, 3, 2)), np.zeros((0, 2)))
    random = np.random.default_rng(1)
    xy = np.array([starts.place(random) for _ in range(1000)])
    assert (xy[:, 1] == 0).mean() == pytest.approx(0.1, abs=0.04)
