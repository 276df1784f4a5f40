"""The picture of an outcrop: the side from which it is seen, and the colours of sets."""

from types import SimpleNamespace

import numpy as np
import pytest

from cdem.output.facet_picture import view_of


def seen(points):
    """Axes of the picture of a cloud."""
    return view_of(SimpleNamespace(found=SimpleNamespace(points=points)))


@pytest.mark.parametrize("facing", [20.0, 100.0, 200.0, 290.0])
def test_a_face_is_seen_from_the_side_to_which_it_leans(facing):
    random = np.random.default_rng(1)
    out = np.array([np.sin(np.radians(facing)), np.cos(np.radians(facing)), 0])
    along, height = random.uniform(-5, 5, 4_000), random.uniform(0, 6, 4_000)
    x = along[:, None] * np.array([out[1], -out[0], 0]) + height[:, None] * [0, 0, 1]
    x -= 0.4 * height[:, None] * out  # leans back
    right, up, eye = seen(x)
    assert eye[:2] / np.linalg.norm(eye[:2]) @ out[:2] > np.cos(np.radians(5))
    assert eye[2] == pytest.approx(np.sin(np.radians(20)))
    assert np.cross(right, up) == pytest.approx(eye) and right[2] == 0 and up[2] > 0.9


def test_an_upright_face_has_a_view_too():
    x = np.random.default_rng(1).uniform(-1, 1, (500, 3)) * [4, 0.01, 2]
    assert abs(seen(x)[2][1]) > 0.9
