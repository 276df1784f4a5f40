"""Overlaps of faces that do not conform."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import case

from cdem.mesh.overlap import clip, flush_faces, inner_part, point_areas
from cdem.run.simulation import Simulation


@settings(max_examples=60, deadline=None)
@given(
    st.floats(-0.9, 0.9), st.floats(-0.9, 0.9), st.floats(0, 2 * np.pi), st.floats(0.3, 2.0)
)  # fmt: skip
def test_overlap_shares_area_and_centroid_exactly(dx, dy, angle, size):
    """A square moved and turned over another one: the points carry the polygon's area and centre."""
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) - 0.5
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    lower = np.column_stack([square, np.zeros(4)])
    upper = np.column_stack([size * square @ turn.T + [dx, dy], np.zeros(4)])[::-1]
    polygon = clip(lower, upper)
    if polygon is None:
        return
    weights = point_areas(polygon)
    x, y = polygon[:, 0], polygon[:, 1]
    x1, y1 = np.roll(x, -1), np.roll(y, -1)
    cross = x * y1 - x1 * y
    area = abs(cross.sum()) / 2
    center = np.array([((x + x1) * cross).sum(), ((y + y1) * cross).sum()]) / (3 * cross.sum())
    assert weights.sum() == pytest.approx(area, rel=1e-9)
    np.testing.assert_allclose(weights @ polygon[:, :2] / area, center, atol=1e-9)


def test_the_inner_part_of_a_polygon_ends_where_the_function_is_zero():
    square = np.array([[0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1]], float)
    half = inner_part(square, square[:, 0] - 0.5)
    assert sorted(map(tuple, half)) == [(0.5, 0, 1), (0.5, 2, 1), (2, 0, 1), (2, 2, 1)]
    np.testing.assert_array_equal(inner_part(square, square[:, 2]), square)
    assert inner_part(square, -square[:, 2]).shape == (0, 3)


def test_faces_that_lie_flush_are_found_whether_they_conform_or_not():
    """A cube on a plate of two boxes: its lower face lies on both, which lie side by side."""
    sim = Simulation(
        case(
            [
                {"group": "a", "box": {"size": [1, 1, 1]}, "translate": [0.5, 0, 0]},
                {"group": "b", "box": {"size": [1, 1, 1]}, "translate": [0, 0, -1]},
                {"group": "b", "box": {"size": [1, 1, 1]}, "translate": [1, 0, -1]},
            ],
            {"a": {}, "b": {}},
        )
    )
    t = sim.build.topology
    kinds = np.ones((2, 2), bool)
    first, mate = flush_faces(t, kinds)
    met = [sorted(t.face_block[mate[first[f] : first[f + 1]]]) for f in range(len(t.face_nodes))]
    assert sorted(m for m in met if m) == [[0], [0, 1], [1], [2], [2]]  # the cube is the last
    box = t.group_names.index("b")
    kinds[box, box] = False
    first, mate = flush_faces(t, kinds)
    assert len(mate) == 4  # both ways: the cube on either box
