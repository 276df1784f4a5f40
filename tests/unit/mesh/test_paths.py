"""Straight paths through elements."""

import numpy as np
import pytest

import cdem
from cdem.mesh.paths import Pass, passes, walk, weights_in


def topology(shape, divisions=(3, 2, 2)):
    """A box of 3 x 2 x 2 m."""
    case = cdem.Case.from_dict(
        {
            "model": {
                "blocks": [
                    {"group": "rock", "box": {"size": [3, 2, 2], "divisions": list(divisions),
                                              "shape": shape}}
                ]
            },
            "materials": {"rock": {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.3}},
            "groups": {"rock": {"material": "rock"}},
            "stages": [{"name": "go", "mode": "static"}],
        }
    )  # fmt: skip
    return cdem.Simulation(case, threads=1).build.topology


SHAPES = ["tet4", "pyramid5", "wedge6", "hex8"]


@pytest.mark.parametrize("shape", SHAPES)
def test_a_path_is_covered_without_gaps(shape):
    t = topology(shape)
    start, end = np.array([0.1, 0.2, 0.3]), np.array([2.9, 1.7, 1.9])
    length = np.linalg.norm(end - start)
    path = list(walk(passes(t, start, end), length, 1e-9))
    ends = np.array([[p.first, p.last] for p in path])
    assert ends[0, 0] == 0 and ends[-1, 1] == pytest.approx(length, rel=1e-12)
    np.testing.assert_allclose(ends[1:, 0], ends[:-1, 1], atol=1e-9)
    assert len(path) >= 3


@pytest.mark.parametrize("shape", SHAPES)
def test_weights_make_up_the_place(shape):
    t = topology(shape)
    start, end = np.array([0.1, 0.2, 0.3]), np.array([2.9, 1.7, 1.9])
    length = np.linalg.norm(end - start)
    for p in walk(passes(t, start, end), length, 1e-9):
        place = start + (end - start) * 0.5 * (p.first + p.last) / length
        nodes, weights = weights_in(t, p.shape, p.element, place)
        assert weights.sum() == pytest.approx(1, abs=1e-12)
        np.testing.assert_allclose(weights @ t.node_position[nodes], place, atol=1e-12)
        assert weights.min() > -1e-9


def test_a_path_along_faces_stays_in_one_row_of_elements():
    t = topology("hex8")
    path = list(walk(passes(t, np.array([0.0, 1, 1]), np.array([3.0, 1, 1])), 3.0, 1e-9))
    assert [p.last for p in path] == pytest.approx([1, 2, 3])


def test_a_path_that_leaves_ends_there_and_one_that_misses_has_no_parts():
    t = topology("tet4")
    path = list(walk(passes(t, np.array([1.0, 1.1, 1.2]), np.array([5.0, 1.1, 1.2])), 4.0, 1e-9))
    assert path[-1].last == pytest.approx(2)
    assert not passes(t, np.array([0.0, 5, 5]), np.array([3.0, 5, 5]))


def test_a_path_along_a_joint_stays_in_its_block():
    alone, other = Pass(0, 1, "hex8", 5, 1, 0), Pass(1, 2, "hex8", 1, 0, 0)
    same = Pass(1, 2, "hex8", 6, 1, 0)
    assert [p.block for p in walk([alone, other, same], 2.0, 1e-9)] == [1, 1]
