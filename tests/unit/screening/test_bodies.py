"""Bodies in the faces of a frustum: volumes, areas and factors against tetrahedra."""

from dataclasses import replace

import numpy as np
import pytest
from shared.hills import frustum, joint, on_ground, place_on_face, tetrahedron

from cdem.screening.bodies import Ground, Limits, height_of
from cdem.screening.sliding import factors, on_one, on_two
from cdem.terrain.heights import Grid

ALL = Limits(0, 1e9, 26e3)
# planes, face, and the largest error [%] of volume and factor with cells of 2 and 1 m
FACES = {
    "south": ((joint("J1", 55, 135, 30, 20e3), joint("J2", 55, 225, 30, 20e3)), (0, -1)),
    "east": ((joint("J1", 60, 40, 25, 10e3), joint("J2", 50, 130, 35, 40e3)), (1, 0)),
    "west": ((joint("J1", 45, 245, 32, 15e3), joint("J2", 75, 310, 30, 15e3)), (-1, 0)),
}


def center_of_mass(ground, body):
    """In plan [m]."""
    rows, columns = body.window
    x, y = np.meshgrid(ground.x[columns], ground.y[rows])
    t = np.where(body.cells, ground.grid.values[body.window] - body.bed(x, y), 0)
    return (t * x).sum() / t.sum(), (t * y).sum() / t.sum()


def exact_factor(planes, volume, areas):
    normals = np.array([plane.normal for plane in planes])
    cohesive = np.array([plane.cohesion for plane in planes]) * areas
    tangents = np.array([plane.tangent for plane in planes])
    return factors(normals, tangents, cohesive, np.array([0, 0, -26e3 * volume]))[0]


@pytest.mark.parametrize(
    ("face", "cell", "volume", "factor"),
    [
        ("south", 2.0, 0.92, 0.86),
        ("south", 1.0, 0.25, 0.14),
        ("east", 2.0, 0.51, 0.19),
        ("east", 1.0, 0.12, 0.02),
        ("west", 2.0, 0.78, 0.32),
        ("west", 1.0, 0.17, 0.05),
    ],
)
def test_bodies_are_tetrahedra(face, cell, volume, factor):
    planes, toward = FACES[face]
    ground = Ground(frustum(cell))
    at, point = place_on_face(ground, toward)
    exact, areas, corners = tetrahedron(planes, point, toward)
    assert np.abs(on_ground(corners)).max() < 1e-9  # else the tetrahedron is not the body
    sliding = on_two(*planes)
    body = ground.body(planes, sliding, at, ALL)
    assert abs(body.volume / exact - 1) < 3e-2 * volume
    wanted = exact_factor(planes, exact, areas)
    assert abs(body.factor / wanted - 1) < 3e-2 * max(factor, 0.1)
    assert body.areas == pytest.approx(areas, rel=0.1 if cell == 2 else 0.03)  # 0.04, 0.008
    assert np.isclose(body.bed(point[0], point[1]), point[2])


def test_on_one_of_two_planes_the_body_lies_beside_the_point():
    planes, toward = FACES["west"]
    ground = Ground(frustum(2.0))
    at, _ = place_on_face(ground, toward)
    body = ground.body(planes, on_two(*planes), at, ALL)
    rows = np.flatnonzero(body.cells.any(axis=1)) + body.corner[0]
    assert rows[0] >= at[0] - 2 and rows[-1] > at[0] + 20  # all of it to the north of the point
    turned = ground.body(planes[::-1], on_two(*planes[::-1]), at, ALL)
    assert (body.name, turned.name) == ("J1+J2", "J1+J2")
    assert (turned.volume, turned.factor) == (body.volume, body.factor)


@pytest.mark.parametrize("steep", [(80, 120), (85, 110)])
def test_areas_of_steep_planes(steep):
    planes = (joint("a", *steep, 20), joint("b", 45, 215, 20))
    ground = Ground(frustum(1.0))
    at, point = place_on_face(ground, (0, -1))
    body = ground.body(planes, on_two(*planes), at, ALL)
    _, areas, corners = tetrahedron(planes, point, (0, -1))
    assert np.abs(on_ground(corners)).max() < 1e-9
    assert body.areas == pytest.approx(areas, rel=0.005)  # reached: 0.001


def test_limits_of_volume_and_the_edge_of_the_map():
    planes, toward = FACES["south"]
    ground, sliding = Ground(frustum(2.0)), on_two(*planes)
    at, _ = place_on_face(ground, toward)
    whole = ground.body(planes, sliding, at, ALL)
    for factor, there in ((0.99, False), (1.01, True)):
        assert (ground.body(planes, sliding, at, replace(ALL, largest=factor * whole.volume))
                is not None) is there  # fmt: skip
        found = ground.body(planes, sliding, at, replace(ALL, smallest=factor * whole.volume))
        assert (found is None) is there
    # cut off behind the point, the body reaches the edge
    behind = Grid(ground.x[0], ground.y[0], (2, 2), ground.grid.values[: at[0] + 6])
    assert Ground(behind).body(planes, sliding, at, ALL) is None
    # a hole in the ground
    holed = ground.grid.values.copy()
    holed[at[0] + 6, at[1]] = np.nan
    assert Ground(replace(ground.grid, values=holed)).body(planes, sliding, at, ALL) is None


def test_windows_grow_to_the_body():
    # from a point near the foot the body is larger than the first window of 33 cells
    planes, _ = FACES["south"]
    ground = Ground(frustum(1.0))
    at = (int(np.argmin(np.abs(ground.y + 85))), int(np.argmin(np.abs(ground.x))))
    body = ground.body(planes, on_two(*planes), at, ALL)
    exact, _, corners = tetrahedron(planes, ground.point(*at), (0, -1))
    assert max(body.cells.shape) > 33 and np.abs(on_ground(corners)).max() < 1e-9
    assert body.volume == pytest.approx(exact, rel=0.02)


def test_a_plane_that_daylights_all_round():
    # a plane through a cone's flank cuts off an elliptic cap; volume by a fine sum in polar cuts
    x = np.arange(-60, 61.0)
    z = 100 - 0.8 * np.hypot(x[None], x[:, None])
    ground = Ground(Grid(-60, -60, (1, 1), z))
    plane = joint("a", 20, 90, 15, 5e3)
    at = (60, 90)  # 30 m to the east
    body = ground.body((plane,), on_one(plane), at, ALL)
    # z > plane: with m = 0.8, k = tan 20, the height of the apex above the plane is H = 24 - 30 k;
    # volume = pi H^3 / (3 (m^2 - k^2)^1.5) m
    m, k = 0.8, np.tan(np.radians(20))
    apex = 100 - (76 + 30 * k)
    volume = np.pi * apex**3 * m / (3 * (m**2 - k**2) ** 1.5)
    assert body.volume == pytest.approx(volume, rel=0.01)
    plan = np.pi * apex**2 * m / (m**2 - k**2) ** 1.5
    assert body.areas[0] == pytest.approx(plan / np.cos(np.radians(20)), rel=0.02)
    assert (body.sliding.kind, body.name) == ("plane", "a")


def test_a_body_that_would_turn_about_the_edge_of_its_plane_is_left_out():
    # at corners of a steep hill bodies lean on the steep plane, beside the one they slide on
    ground = Ground(frustum(1.0, slope=82))
    planes = (joint("a", 45, 100, 30), joint("b", 70, 60, 30))
    sliding = on_two(*planes)
    assert sliding.kind == "first"
    found = [
        ground.body(planes, sliding, (i, j), ALL)
        for i in range(143, 159, 3)
        for j in range(143, 159, 3)
    ]
    bodies = [body for body in found if body is not None]
    assert len(bodies) > 5
    for body in bodies:
        x, y = center_of_mass(ground, body)
        first, second = (height_of(plane, body.point, x, y) for plane in planes)
        assert first >= second
