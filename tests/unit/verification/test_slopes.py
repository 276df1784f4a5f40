"""Closed forms of `cdem verify slopes`, each against a second method."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import fsolve

from cdem.case.case import Case
from cdem.screening.sliding import factors, on_two
from cdem.verification.goodman_bray import problem as goodman_bray
from cdem.verification.slopes import planes, problem, wedges
from cdem.verification.slopes.finer import finer, stiffer
from cdem.verification.slopes.problem import SHOWN, VARIED, slopes
from cdem.verification.slopes.second import root
from cdem.verification.slopes.soil import ACADS, Profile, three_soils

ALL = slopes()


def test_there_are_24_slopes_up_to_300_m():
    heights = [slope.height for slope in ALL.values()]
    assert len(ALL) >= 24
    assert min(heights) == pytest.approx(5) and max(heights) == pytest.approx(300)
    assert set(VARIED) | set(SHOWN) <= set(ALL)


@pytest.mark.parametrize("name", ALL)
def test_each_case_is_short_and_has_no_tuned_value(name, tmp_path):
    case = ALL[name].load(tmp_path)
    assert [stage.name for stage in case.stages] == ["rest"]
    assert not {"time", "contact", "elements"} & set(ALL[name].case)
    assert not set(ALL[name].case["stages"][0]) - {"name", "mode"}


def test_the_shipped_case_is_one_of_the_slopes(tmp_path):
    made = ALL["plane, dry, cohesion"].load(tmp_path)
    file = Case.load(Path(problem.__file__).parent / "case.yaml")
    corners = (case.model.blocks[0].polyhedron.vertices for case in (made, file))
    np.testing.assert_allclose(*map(sorted, corners), atol=1e-5)
    made.loads.supports = file.loads.supports
    file.model = made.model
    file.materials["rock"].density = made.materials["rock"].density
    assert file.model_dump() == made.model_dump()


def test_nearest_value_of_an_interval():
    cut = ALL["vertical cut in clay"]
    assert cut.nearest(1.6) == pytest.approx(1.532) and cut.nearest(1.51) == pytest.approx(1.51)
    assert ALL["buttress"].nearest(9) == ALL["buttress"].factor


@pytest.mark.parametrize("name", [name for name, slope in ALL.items() if slope.second])
def test_the_second_method_finds_the_same_factor(name):
    """Speeds instead of forces, angles instead of vectors, strips instead of a formula."""
    assert ALL[name].second == pytest.approx(ALL[name].factor, rel=1e-6)


def test_slopes_without_a_second_method_are_published():
    assert {name.split(" (")[0] for name, slope in ALL.items() if slope.second is None} == {
        "block toppling, 16 columns",
        "block toppling, support at the toe",
        "soil",
        "soil, 2:1",
        "soil, tension crack",
        "soil, three layers",
        "vertical cut in clay",
    }


def test_plane_with_all_its_forces_by_vectors():
    """Forces as vectors; the plane's unit vectors point down the dip and out of the bed."""
    weight, b, p = 7e6, np.radians(35), np.radians(12)
    down, out = np.array([np.cos(b), -np.sin(b)]), np.array([np.sin(b), np.cos(b)])
    load = np.array([0.15 * weight, -weight]) + [1e6, 0] + 0.8e6 * out
    load = load + 2e6 * np.array([-np.cos(p), -np.sin(p)])
    exact = (30 * 9e3 - load @ out * np.tan(np.radians(32))) / (load @ down)
    found = planes.sliding(weight, 35, 32, 9e3, 30, push=1e6, lift=0.8e6, shaken=0.15, pull=2e6,
                           plunge=12)  # fmt: skip
    assert found == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("second", [wedges.Plane(55, 130, 25, 30e3), wedges.Plane(70, 148, 20)])
def test_wedge_by_the_vectors_of_screening(second):
    wedge = wedges.Wedge(20, 65, wedges.Plane(50, 45, 30, 20e3), second)
    joints = wedge.first, wedge.second
    slides = on_two(
        *(SimpleNamespace(normal=p.normal, tangent=planes.tan(p.friction)) for p in joints)
    )
    assert slides.kind == "both"
    found, _ = factors(
        np.array([p.normal for p in joints]),
        np.array([planes.tan(p.friction) for p in joints]),
        np.array([p.cohesion * area for p, area in zip(joints, wedge.areas, strict=True)]),
        np.array([0.0, 0.0, -wedges.UNIT * wedge.volume]),
    )
    assert wedge.factor() == pytest.approx(float(found), rel=1e-9)


def test_water_in_a_wedge_by_integration():
    wedge = wedges.Wedge(40, 65, wedges.Plane(50, 45, 35, 6e4), wedges.Plane(55, 130, 35, 6e4))
    foot, crest, _, rear = wedge.corners
    u, v = np.array(np.meshgrid(*2 * [(np.arange(800) + 0.5) / 800])).reshape(2, -1)
    points = (
        foot + np.outer(np.sqrt(u) * (1 - v), crest - foot) + np.outer(np.sqrt(u) * v, rear - foot)
    )
    mean = np.maximum(9810 * (30 - points[:, 2]), 0).mean()
    lost = sum(mean * area * planes.tan(35) for area in wedge.areas)
    line = (foot - rear) / np.linalg.norm(foot - rear)
    drive = -wedges.UNIT * wedge.volume * line[2]
    assert wedge.factor() - wedge.factor(30.0) == pytest.approx(lost / drive, rel=1e-3)


def test_buttress_by_a_balance_of_forces():
    """Six numbers: N, shear on the plane; E, shear beside it; normal force of the floor; F."""
    b, w1, w2 = np.radians(40), 26e3 * 9 * 9 / np.tan(np.radians(40)) / 2, 26e3 * 14 * 10

    def balance(x):
        n, s, e, r, floor, f = x[:5].tolist() + [x[5]]
        n, s, e, r, floor = (1e6 * value for value in (n, s, e, r, floor))
        t, j = np.tan(np.radians(24)) / f, np.tan(np.radians(20)) / f
        return np.array([n * np.sin(b) - s * np.cos(b) - e, n * np.cos(b) + s * np.sin(b) + r - w1,
                         floor - w2 - r, e - t * floor, s - t * n, r - j * e]) / 1e6  # fmt: skip

    assert fsolve(balance, [1, 0.2, 0.5, 0.1, 3, 2])[-1] == pytest.approx(ALL["buttress"].factor)


def test_roof_wedge_by_a_balance_of_forces():
    """Faces that lean by 20 degrees: N pushes the wedge down, its friction holds it."""
    a, weight = np.radians(20), 26e3 * 5 * (2 + 5 * np.tan(np.radians(20)))

    def balance(x):
        n, f = 1e6 * x[0], x[1]
        s = n * np.tan(np.radians(38)) / f
        return [(n * np.cos(a) + s * np.sin(a) - 1.2e6) / 1e6,
                (2 * (s * np.cos(a) - n * np.sin(a)) + 250e3 - weight) / 1e6]  # fmt: skip

    assert fsolve(balance, [1.0, 1.2])[1] == pytest.approx(ALL["roof wedge, anchored"].factor)


def test_support_of_toppling_columns_as_in_the_books():
    """A horizontal cable through the toe column needs 2,013 kN/m at tan(phi) = 0.65."""
    along = 25 * goodman_bray.support(0.65) * (1 - 0.65**2)
    cable = along / (np.cos(goodman_bray.DIP) + 0.65 * np.sin(goodman_bray.DIP))
    assert cable == pytest.approx(2013, rel=0.01)


def bishop(centre, radius, weight, soil, ground):
    """Factor of a circle by Bishop's simplified slices."""
    x = np.linspace(centre[0] - radius, centre[0] + radius, 20001)[1:-1]
    foot = centre[1] - np.sqrt(radius**2 - (x - centre[0]) ** 2)
    x, foot = (v[(foot < ground(x)) & (x > -10)] for v in (x, foot))
    width, lean = x[1] - x[0], np.arcsin((x - centre[0]) / radius)
    load, (cohesion, friction), factor = weight * (ground(x) - foot) * width, soil(x, foot), 1.0
    tangent = np.tan(np.radians(friction))
    for _ in range(100):
        part = np.cos(lean) + np.sin(lean) * tangent / factor
        factor = ((cohesion * width + load * tangent) / part).sum() / (load * np.sin(lean)).sum()
    return factor


@pytest.mark.parametrize(("name", "circle", "weight", "soil"), [
    ("soil, 2:1 (Griffiths & Lane 1999, example 1)", (3.116, 23.664, 23.6646), 20e3, (10e3, 20)),
    ("soil (ACADS 1a)", (-0.554, 28.773, 28.7785), 20e3, (3e3, 19.6)),
    ("soil, tension crack (ACADS 1b)", (7.872, 17.383, 19.813), 20e3, (32e3, 10)),
    ("soil, three layers (ACADS 1c)", (4.380, 17.931, 18.5738), 19.5e3, None),
])  # fmt: skip
def test_soil_along_the_critical_circle(name, circle, weight, soil):
    of = {"first": (0, 38), "second": (5.3e3, 23), "third": (7.2e3, 20)}

    def at(x, z):
        return np.array(soil or [of[s] for s in three_soils(np.column_stack([x, z]))]).T

    found = bishop(circle[:2], circle[2], weight, at, lambda x: np.clip(x / 2, 0, 10))
    assert found == pytest.approx(ALL[name].nearest(found), rel=0.01)


@pytest.mark.parametrize("profile", [ACADS, Profile(5, 0, 5, 1.25, 1.25), Profile(10, 20, 12)])
def test_grid_fills_the_profile(profile):
    points, quads = profile.grid(8)
    x, z = np.moveaxis(points[quads], 2, 0)
    areas = 0.5 * (
        (x[:, 2] - x[:, 0]) * (z[:, 3] - z[:, 1]) - (x[:, 3] - x[:, 1]) * (z[:, 2] - z[:, 0])
    )
    back = profile.run + profile.crest
    whole = profile.height * (profile.crest + profile.run / 2) + profile.deep * (
        back + profile.front
    )
    assert areas.min() > 0 and areas.sum() == pytest.approx(whole)


def test_finer_bodies_keep_their_shape(tmp_path):
    made = finer(ALL["plane, tension crack full"], 3)
    assert made.load(tmp_path).model.mesh is not None
    mesh = made.mesh
    assert mesh is not None and len(mesh.cells[0].data) == 3 * 9
    assert np.ptp(mesh.points, axis=0) == pytest.approx([1.15 * 46 / planes.tan(35), 10, 66])
    bridges = finer(ALL["plane, a fifth of it rock bridges"], 2)
    assert bridges.mesh is None
    assert all(b["box"]["divisions"] == [2, 1, 2] for b in bridges.case["model"]["blocks"])


def test_stiffer_rock():
    made = stiffer(ALL["long slope, dry"], 1e-4)
    assert made.case["materials"]["rock"]["young_modulus"] == pytest.approx(20e3 * 5 / 1e-4)
    assert root(lambda factor: 2 - factor) == pytest.approx(2)
