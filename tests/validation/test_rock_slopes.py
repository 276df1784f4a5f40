"""Screening of rock slopes with water and shaking: Hoek & Bray, equilibrium of a wedge, exact chances."""

from dataclasses import replace
from statistics import NormalDist

import numpy as np
import pytest
from shared.hills import FOOT, HALF, HEIGHT, SLOPE, frustum, joint, place_on_face, tetrahedron

from cdem.screening.bodies import Ground, Limits
from cdem.screening.fos_map import screen
from cdem.screening.loads import Loads
from cdem.screening.probability import evaluate
from cdem.screening.profiles import screen_profiles
from cdem.screening.shaking import Earthquake, shake
from cdem.screening.sliding import on_two
from cdem.screening.uncertain import Uncertain
from cdem.terrain.heights import Grid

ROCK, WATER = 26e3, 9810.0
RISE, FACE, DIP, GLUE, FRICTION = 40.0, np.arctan(1.6), np.radians(35), 60e3, 36.0
ALL = Limits(0, 1e9, ROCK)


@pytest.fixture(scope="module")
def bench():
    """A face of 40 m that falls to the east, its toe and crest on points of the grid."""
    x = np.arange(-150, 50.25, 0.5)
    z = np.clip(-x * np.tan(FACE), 0, RISE)
    return Ground(Grid(x[0], 0.0, (0.5, 0.5), np.tile(z, (20, 1))))


def hoek_and_bray(depth, share, kh, kv):
    """Plane failure through the toe with a tension crack behind the crest; also its volume."""
    level = share * depth
    length = (RISE - depth) / np.sin(DIP)
    weight = 0.5 * ROCK * RISE**2 * ((1 - (depth / RISE) ** 2) / np.tan(DIP) - 1 / np.tan(FACE))
    uplift, push = 0.5 * WATER * level * length, 0.5 * WATER * level**2
    sine, cosine = np.sin(DIP), np.cos(DIP)
    normal = weight * ((1 - kv) * cosine - kh * sine) - uplift - push * sine
    drive = weight * ((1 - kv) * sine + kh * cosine) + push * cosine
    factor = (GLUE * length + normal * np.tan(np.radians(FRICTION))) / drive
    return factor, weight / ROCK * length * cosine


@pytest.mark.parametrize(
    ("depth", "share", "kh", "kv"),
    [(8, 0, 0, 0), (8, 1, 0, 0), (12, 0.5, 0, 0), (8, 0.6, 0.12, 0), (8, 0.6, 0.12, -0.06)],
)
def test_plane_failure_with_a_tension_crack(bench, depth, share, kh, kv):
    wanted, volume = hoek_and_bray(depth, share, kh, kv)
    limits = Limits(0.98 * volume, 1.02 * volume, ROCK)  # the profile through the toe alone
    plane = joint("a", np.degrees(DIP), 90, FRICTION, GLUE)
    loads = Loads(kh, kv, share, crack=depth)
    found = screen_profiles(bench, [plane], limits, loads)
    assert found.count == 20
    assert np.nanmin(found.factor) == pytest.approx(wanted, rel=1e-9)  # within 0.5 % was asked


def test_a_crack_deeper_than_the_profile_changes_nothing(bench):
    plane = joint("a", np.degrees(DIP), 90, FRICTION, GLUE)
    with_crack, without = (
        screen_profiles(bench, [plane], ALL, Loads(crack=d)) for d in (30.0, 0.0)
    )
    assert np.array_equal(with_crack.factor, without.factor, equal_nan=True)


@pytest.mark.parametrize("kv", [0.0, 0.2, -0.1])
def test_the_yield_acceleration_of_a_dry_cohesionless_plane(bench, kv):
    # k_y = (1 - kv) tan(phi - psi), also where phi < psi
    for friction in (45.0, 36.0, 30.0):
        plane = joint("a", np.degrees(DIP), 90, friction)
        found = screen_profiles(bench, [plane], ALL, Loads(kv=kv), yields=True)
        wanted = (1 - kv) * np.tan(np.radians(friction) - DIP)
        known = found.yields[np.isfinite(found.factor)]
        assert known == pytest.approx(wanted, rel=1e-10)


WEDGE = (joint("J1", 60, 40, 25, 10e3), joint("J2", 50, 130, 35, 40e3))


def water_above(triangle, toward):
    """Mean height of the ground above a triangle of the bed [m]."""
    n = 120  # parts of each side; the middles of all parts, with their tips up and down
    up = [(i + 1 / 3, j + 1 / 3) for i in range(n) for j in range(n - i)]
    down = [(i + 2 / 3, j + 2 / 3) for i in range(n - 1) for j in range(n - 1 - i)]
    a, b = np.array(up + down).T / n
    at = (1 - a - b)[:, None] * triangle[0] + a[:, None] * triangle[1] + b[:, None] * triangle[2]
    face = (HALF - at[:, :2] @ toward) * np.tan(np.radians(SLOPE))
    return (FOOT + np.clip(face, 0, HEIGHT) - at[:, 2]).mean()


@pytest.mark.parametrize(
    "loads",
    [Loads(), Loads(share=0.3), Loads(kh=0.1), Loads(kh=0.08, kv=-0.05, share=0.25)],
)
def test_a_wedge_with_water_and_shaking(loads):
    # unknown normal forces and shear along the line balance all other forces
    toward = (1, 0)
    ground = Ground(frustum(1.0))
    at, point = place_on_face(ground, toward)
    volume, areas, corners = tetrahedron(WEDGE, point, toward)
    sliding = on_two(*WEDGE)
    normals = np.array([plane.normal for plane in WEDGE])
    heads = [water_above(corners[k], toward) for k in ([0, 1, 2], [0, 1, 3])]
    lift = WATER * loads.share * np.array(heads) * areas
    # all of the body is above one plane or the other
    assert np.dot(heads, areas * normals[:, 2]) == pytest.approx(volume, rel=1e-4)
    weight = ROCK * volume
    way = sliding.direction[:2] / np.linalg.norm(sliding.direction[:2])
    force = weight * np.array([*(loads.kh * way), loads.kv - 1]) + lift @ normals
    line = np.cross(*normals) / np.linalg.norm(np.cross(*normals))
    line *= -np.sign(line[2])
    first, second, shear = np.linalg.solve(np.column_stack([*normals, -line]), -force)
    assert min(first, second) > 0
    held = first * WEDGE[0].tangent + second * WEDGE[1].tangent
    held += sum(plane.cohesion * area for plane, area in zip(WEDGE, areas, strict=True))
    body = ground.body(WEDGE, sliding, at, ALL, loads)
    assert body.kind == "both"
    assert body.factor == pytest.approx(held / shear, rel=0.001)  # reached: 0.0002


def test_yield_accelerations_are_where_the_factor_is_one():
    ground = Ground(frustum(4.0))
    loads = Loads(kv=0.05, share=0.1)
    found = screen(ground, WEDGE, Limits(200, 1e5, ROCK), loads=loads, yields=True)
    shaken = shake(found, Earthquake(0.3))
    assert len(found.bodies) > 3
    for body, least in zip(found.bodies[:5], shaken.listed_yields, strict=False):
        for k, stays in ((least - 1e-6, True), (least + 1e-6, False)):
            one = replace(loads, kh=k)
            i, j = (
                int(np.abs(a - v).argmin())
                for a, v in zip((ground.y, ground.x), body.point[1::-1], strict=True)
            )
            again = ground.body(body.planes, body.sliding, (i, j), found.limits, one)
            assert (again.factor >= 1) is stays
            assert again.factor == pytest.approx(1, abs=1e-4)


DRAWN = {"a.friction_angle": {"normal": {"mean": 32, "deviation": 3}}}


@pytest.mark.parametrize("method", ["latin-hypercube", "monte-carlo"])
def test_the_probability_of_a_cohesionless_plane(method):
    # F = tan(phi) / tan(psi) on each plane, so P = Phi((psi - mean) / deviation)
    x = np.arange(-60, 61.0, 3)
    cone = Ground(Grid(-60, -60, (3, 3), 100 - 0.8 * np.hypot(x[None], x[:, None])))
    plane = joint("a", 30, 90, 32)
    found = screen(cone, [plane], Limits(0, 1e9, ROCK), stride=8)
    count = 200
    uncertain = Uncertain(
        uncertain=1, parameters=DRAWN, sampling={"count": count, "seed": 3, "method": method}
    )
    columns = uncertain.draw()
    chance = evaluate(found, [plane], uncertain, columns)
    p = NormalDist(32, 3).cdf(30)
    error = np.sqrt(p * (1 - p) / count)
    assert (chance.lowest < 1).mean() == pytest.approx(p, abs=3 * error)
    assert chance.listed[0, 0] == (chance.lowest < 1).mean()
    assert np.nanmax(chance.map) == chance.listed[0, 0]
    if method == "latin-hypercube":  # one value in each of equally likely parts
        assert columns["a.friction_angle"].mean() == pytest.approx(32, abs=0.01)
        assert chance.listed[0, 0] == pytest.approx(p, abs=1 / count)
    factors = np.tan(np.radians(columns["a.friction_angle"])) / np.tan(np.radians(30))
    assert chance.worst == pytest.approx(factors, rel=1e-10)
    assert chance.listed[0, 1] == pytest.approx(factors.mean())
    index = (factors.mean() - 1) / factors.std(ddof=1)
    assert chance.listed[0, 2] == pytest.approx(index)
    assert chance.influence()["a.friction_angle"] == pytest.approx(1)
