"""Plans: edges without thickness are divided."""

import numpy as np
import pytest

from cdem.terrain.plan import Plan, _at, split_pinched

pytest.importorskip("scipy", reason="needs the extra 'terrain'")
pytest.importorskip("netgen", reason="needs the extra 'terrain'")


def test_an_edge_without_thickness_across_a_body_is_divided():
    points = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
    none = np.full(4, np.nan)
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    plan = Plan(points, triangles, np.array([0, 0]), none, none, np.arange(4), [])
    split_pinched(plan, np.array([True, False, True, False]))
    assert plan.points[4].tolist() == [2, 2]
    assert sorted(map(sorted, plan.triangles.tolist())) == [
        [0, 1, 4],
        [0, 3, 4],
        [1, 2, 4],
        [2, 3, 4],
    ]
    sides = plan.points[plan.triangles]
    assert np.linalg.det(sides[:, 1:] - sides[:, :1]) == pytest.approx(8.0)


def test_places_on_a_map_are_exact_to_a_millimetre():
    assert _at(np.array([512345.678, 4123456.789])) == "(512345.678, 4123456.789)"
    assert _at(np.array([0.1 + 0.2, 1e-3])) == "(0.3, 0.001)"
