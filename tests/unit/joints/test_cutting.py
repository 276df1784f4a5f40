"""The exact cutter: volumes, areas, closedness and convexity of what it leaves."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from shared.cells import ALL, area_vector, cube, cut, polygons, sides_that_are_single

from cdem.joints import cell_mesh, convex_cells, cutting
from cdem.mesh import primitives


def test_a_cube_cut_by_known_planes():
    # x = 0.5 halves into 2 and 6 m3; x + y + z = 1.5 takes a corner of 1.5^3 / 6 m3 across it
    c = cut(cube(), [((1, 0, 0), 0.5), ((1, 1, 1), 1.5)])
    corner, beyond = 1.5**3 / 6, 1.0**3 / 6  # of the whole, and the part of it with x > 0.5
    assert sorted(c.volumes()) == pytest.approx(
        sorted([2 - corner + beyond, corner - beyond, 6 - beyond, beyond]), rel=1e-13
    )
    for x, source in zip(polygons(c), c.source, strict=True):
        if source == 0:
            assert x[:, 0] == pytest.approx(0.5, abs=1e-14)
        elif source == 1:
            assert x.sum(axis=1) == pytest.approx(1.5, abs=1e-14)
        else:  # on the cube's own sides
            assert (np.isclose(x, 0).all(axis=0) | np.isclose(x, 2).all(axis=0)).any()
    area = [sum(area_vector(x) @ n for x, s in zip(polygons(c), c.source, strict=True)
                if s == k and area_vector(x) @ n > 0) for k, n in ((0, [1, 0, 0]), (1, [1, 1, 1]))]  # fmt: skip
    assert area == pytest.approx([4, 3 * np.sqrt(3) * 1.5**2 / 2 / np.sqrt(3)], rel=1e-13)


def test_planes_through_corners_and_edges_and_along_sides():
    c = cut(cube(), [((1, -1, 0), 0), ((1, 1, 1), 2), ((1, 0, 0), 2), ((0, 0, 1), 0)])
    # the diagonal plane halves; x + y + z = 2 meets three corners of the cube; the sides cut nothing
    assert sorted(c.volumes()) == pytest.approx([2 / 3, 2 / 3, 10 / 3, 10 / 3], rel=1e-13)
    assert not (c.source >= 2).any()


def test_thin_parts_are_not_cut_off():
    whole, left = cutting.cut(cube(), np.array([1.0, 0, 0]), 1.95, 0, among=ALL, thinnest=0.1)
    assert (whole.blocks, left) == (1, 1)
    parts, left = cutting.cut(cube(), np.array([1.0, 0, 0]), 1.85, 0, among=ALL, thinnest=0.1)
    assert (parts.blocks, left) == (2, 0)


@st.composite
def bodies(draw):
    """A convex body: a box or the hull of points on a sphere, anywhere and of any size."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    size = 10.0 ** draw(st.integers(-3, 4))
    if draw(st.booleans()):
        c = cube(size)
    else:
        x = random.normal(size=(draw(st.integers(4, 12)), 3))
        x = size * x / np.linalg.norm(x, axis=1)[:, None] + 10 * size * random.random(3)
        c = convex_cells.from_polyhedron(x, primitives.outward_faces(x, None), 0)
    return c, size, random


@settings(deadline=None, max_examples=40, suppress_health_check=[HealthCheck.too_slow])
@given(bodies(), st.integers(1, 12), st.booleans())
def test_what_is_cut_stays_exact_closed_and_convex(body, count, close):
    c, size, random = body
    before, low, high = c.volumes().sum(), c.points.min(axis=0), c.points.max(axis=0)
    planes = []
    for _ in range(count):
        kind = random.integers(4)
        normal = random.normal(size=3)
        at = random.uniform(low, high)
        if kind == 1 and planes:  # nearly parallel to the last, and near it
            normal = planes[-1][0] + 10.0 ** random.integers(-12, 0) * random.normal(size=3)
            at = at + (planes[-1][1] - at @ normal) * normal / (normal @ normal)
        elif kind == 2:  # through three corners of what is there by now
            at, b, d = c.points[random.choice(len(c.points), 3, replace=len(c.points) < 3)]
            normal = np.cross(b - at, d - at)
        elif kind == 3:
            normal = np.eye(3)[random.integers(3)]
        if np.linalg.norm(normal) < 1e-9 * size**2:
            continue
        planes.append((normal, at @ normal))
        normal = normal / np.linalg.norm(normal)
        c, _ = cutting.cut(c, normal, at @ normal, len(planes) - 1, among=ALL)
    volumes = c.volumes()
    assert volumes.sum() == pytest.approx(before, rel=1e-12)
    assert sides_that_are_single(c) == (0, set())

    faces = polygons(c)
    near = 4 * c.near  # corners within `near` of a plane count as on it
    net = np.zeros((len(planes), 3))
    for x, cell, source in zip(faces, c.cell, c.source, strict=True):
        vector = area_vector(x)
        if source >= 0:
            net[source] += vector
        if np.linalg.norm(vector) < (1e-4 * size) ** 2:
            continue  # too small to have a normal
        own = np.unique(c.corner[np.flatnonzero(c.cell[c.owner()] == cell)])
        height = (c.points[own] - x[0]) @ vector / np.linalg.norm(vector)
        assert height.max() <= near * max(1.0, 1e2 * size / np.sqrt(np.linalg.norm(vector)))
    assert np.abs(net).max(initial=0) <= 1e-12 * size**2 * max(1, len(faces))

    if close:
        closed, _ = cell_mesh.close_short_edges(c, 0.01 * size)
        assert sides_that_are_single(closed) == (0, set())
        made = cell_mesh.to_mesh(closed, ["rock"], [], [str(k) for k in range(len(planes))])
        x = made.points[made.cells["tet4"]]
        tets = np.linalg.det(x[:, 1:] - x[:, :1]) / 6
        assert tets.sum() == pytest.approx(closed.volumes().sum(), rel=1e-12)
