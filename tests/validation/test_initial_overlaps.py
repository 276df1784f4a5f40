"""Every overlap at the start is held by contacts or refused with blocks, depth and place."""

import re

import numpy as np
import pytest
from scenes import simulate

from cdem.errors import ModelError

GROUPS = {"floor": {"fix": ["x", "y", "z"]}, "body": {}}


def box(group, low, size, divisions=(1, 1, 1), shape="hex8", **more):
    """A box by its lowest corner."""
    body = {"size": list(size), "divisions": list(divisions), "shape": shape}
    return {"group": group, "box": body, "translate": list(low), **more}


def scene(*blocks, **more):
    """The blocks under gravity, the floor held."""
    return simulate(list(blocks), GROUPS, loads={"gravity": [0, 0, -9.81]}, **more)


def refusal(*blocks):
    """Depth [m] and place [m] of which the error tells."""
    with pytest.raises(ModelError, match=r"\(group floor\)") as caught:
        scene(*blocks)
    message = str(caught.value)
    assert "(group body)" in message
    depth = re.search(r"by ([-+.e\d]+) m near \((.*?)\)", message)
    return float(depth[1]), np.array([float(x) for x in depth[2].split(",")])


def on_floor(depth, shape, at=(0.0, 0.0)):
    """A cube of 1 m, so deep in a floor, both of elements of half a metre."""
    return (
        box("floor", [-1, -1, -1], [3, 3, 1], [6, 6, 2], shape),
        box("body", [*at, -depth], [1, 1, 1], [2, 2, 2], shape),
    )


@pytest.mark.parametrize("shape", ["tet4", "hex8"])
@pytest.mark.parametrize(
    "depth", [0.0, pytest.param(1e-4, marks=pytest.mark.slow), 0.01, pytest.param(0.05, marks=pytest.mark.slow), 0.07]
)  # fmt: skip
def test_shallow_overlaps_are_held_under_gravity(depth, shape):
    """The cube settles by less than 1 mm in 0.1 s, in which it would fall by 49 mm."""
    sim = scene(*on_floor(depth, shape))
    while sim.time < 0.1:
        sim.step(100)
    assert np.abs(sim.fields["displacement"][:, 2]).max() < 1e-3


@pytest.mark.parametrize("at", [(0.0, 0.0), (0.13, 0.21)])
@pytest.mark.parametrize("shape", ["tet4", "hex8"])
@pytest.mark.parametrize("depth", [0.15, 0.2])
def test_deep_overlaps_with_a_floor_are_refused(depth, shape, at):
    """A cube of tets 0.1 m deep fell through the floor as if there was none."""
    found, place = refusal(*on_floor(depth, shape, at))
    assert found == pytest.approx(depth, rel=1e-3)
    assert -depth <= place[2] <= 0


@pytest.mark.parametrize("divisions", [(1, 1, 1), (2, 2, 2)])
@pytest.mark.parametrize("shape", ["tet4", "hex8"])
@pytest.mark.parametrize("shift", [0.0, 0.5])
def test_a_body_given_twice_is_refused(shape, divisions, shift):
    """All faces coincide, or vertices lie on vertices inside: no vertex is inside an element."""
    refusal(
        box("body", [0, 0, 0], [1, 1, 1], divisions, shape),
        box("floor", [shift, 0, 0], [1, 1, 1], divisions, shape),
    )


@pytest.mark.parametrize("shape", ["tet4", "hex8"])
def test_a_body_inside_another_is_refused(shape):
    _, place = refusal(
        box("floor", [-1.1, -1.2, -1.3], [3, 3, 3], [2, 2, 2], shape),
        box("body", [0, 0, 0], [0.5, 0.5, 0.5], [1, 1, 1], shape),
    )
    assert np.all(place >= 0) and np.all(place <= 0.5)


def test_bodies_that_pierce_each_other_are_refused():
    """Crossed beams: edges go through faces, and no vertex is inside the other."""
    beams = [
        box("floor", [0, 0, 0], [4, 1, 1]),
        box("body", [1.5, -1.5, 0.6], [1, 4, 1]),
    ]
    depth, place = refusal(*beams)
    assert depth == pytest.approx(0.4, rel=1e-3)
    np.testing.assert_allclose(place, [2, 0.5, 0.8], rtol=1e-3)


def test_shallow_crossed_beams_are_held_under_gravity():
    """Edges begin down to 0.05 L = 0.103 m."""
    sim = scene(box("floor", [0, 0, 0], [4, 1, 1]), box("body", [1.5, -1.5, 0.91], [1, 4, 1]))
    while sim.time < 0.05:
        sim.step(100)
    assert np.abs(sim.fields["displacement"][:, 2]).max() < 1e-3


def test_bodies_that_touch_or_cannot_move_are_not_refused():
    """Non-conforming and bonded neighbours, and two bodies that are held."""
    floor, cube = on_floor(0.0, "tet4", (0.13, 0.21))
    scene(floor, cube)
    bond = {"friction_angle": 30, "cohesion": "1 MPa", "tensile_strength": "1 MPa"}
    scene(*on_floor(0.0, "tet4"), interfaces={"default": bond})
    simulate(list(on_floor(0.5, "hex8")), {"floor": GROUPS["floor"], "body": GROUPS["floor"]})
