"""Columns of ground: strips, levels, shares of faces."""

import numpy as np
import pytest

from cdem.model.columns import shape_integrals


@pytest.mark.parametrize("corners", [3, 4])
def test_shares_of_a_face_sum_to_its_area_in_each_layer(corners):
    rng = np.random.default_rng(1)
    for _ in range(20):
        face = np.array([[0, 0], [3, 0.2], [3.2, 2], [0.1, 1.8]])[:corners]
        face = face + rng.uniform(-0.2, 0.2, face.shape)
        levels = np.array([-1, 0.5, 0.9, 1.4, 5])
        found = shape_integrals(face, levels)
        x, z = face.T
        area = 0.5 * abs(np.dot(x, np.roll(z, -1)) - np.dot(z, np.roll(x, -1)))
        assert sum(w.sum() for w in found.values()) == pytest.approx(area, rel=1e-13)
        assert all((w >= 0).all() for w in found.values())
        whole = shape_integrals(face, levels[[0, -1]])
        assert sum(found.values()) == pytest.approx(whole[0], rel=1e-12)


def test_a_face_across_three_layers_shares_its_middle_by_height():
    """A rectangle of 2 x 3 m between layers of 1 m: N of its feet are (1 - z/3)/2 over the width."""
    face = np.array([[0, 0], [2, 0], [2, 3], [0, 3]], float)
    found = shape_integrals(face, np.array([0.0, 1, 2, 3]))
    for layer, feet in enumerate((5 / 6, 3 / 6, 1 / 6)):
        assert found[layer] == pytest.approx([feet, feet, 1 - feet, 1 - feet], abs=0.06)
    assert sum(found.values()) == pytest.approx([1.5] * 4)


def test_a_face_at_the_border_of_a_layer_belongs_to_it_alone():
    face = np.array([[0, 1], [1, 1], [1, 2], [0, 2]], float)
    found = shape_integrals(face, np.array([0.0, 1, 2, 3]))
    assert list(found) == [1] and found[1] == pytest.approx([0.25] * 4)
