"""Cases of single bodies: their mesh lies on plane beds, and fails at the factor of the closed form."""

import numpy as np
import pytest
from shared.hills import frustum, joint, place_on_face

import cdem
from cdem.screening import cases
from cdem.screening.bodies import Ground, Limits
from cdem.screening.fos_map import screen
from cdem.screening.loads import Loads
from cdem.screening.sliding import on_one, on_two
from cdem.study.criterion import Criterion
from cdem.study.critical import find_critical, strength_reduction
from cdem.terrain.heights import Grid

pytest.importorskip("netgen", reason="needs the extra 'terrain'")

SOUTH = (joint("J1", 55, 135, 30, 20e3), joint("J2", 55, 225, 30, 20e3))
WEST = (joint("J1", 45, 245, 32), joint("J2", 75, 310, 30))


@pytest.fixture(scope="module")
def ground():
    return Ground(frustum(2.0))


def body_of(ground, planes, toward):
    at, _ = place_on_face(ground, toward)
    return ground.body(planes, on_two(*planes), at, Limits(0, 1e9, 26e3))


@pytest.mark.parametrize(("planes", "toward"), [(SOUTH, (0, -1)), (WEST, (-1, 0))])
def test_the_mesh_lies_on_both_planes(ground, planes, toward):
    body = body_of(ground, planes, toward)
    solid, numbers = cases.body_mesh(body, ground)
    assert solid.groups == ["body", "bed1", "bed2"] and numbers == [0, 1]
    corners = solid.points[solid.tets]
    volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
    assert volume.min() > 0
    assert volume[solid.tet_group == 0].sum() == pytest.approx(body.volume, rel=0.04)
    body_points = np.unique(solid.tets[solid.tet_group == 0])
    for group, plane in enumerate(planes, 1):
        shared = np.intersect1d(body_points, solid.tets[solid.tet_group == group])
        away = (solid.points[shared] - body.point) @ plane.normal
        assert len(shared) > 10 and np.abs(away).max() < 1e-9
        assert ((solid.points[body_points] - body.point) @ plane.normal).min() > -1e-9


def test_a_body_on_one_plane():
    x = np.arange(-60, 61.0)
    cone = Ground(Grid(-60, -60, (1, 1), 100 - 0.8 * np.hypot(x[None], x[:, None])))
    plane = joint("a", 20, 90, 15)
    body = cone.body((plane,), on_one(plane), (60, 90), Limits(0, 1e9, 26e3))
    solid, numbers = cases.body_mesh(body, cone)
    assert solid.groups == ["body", "bed1"] and numbers == [0]


def test_a_case_fails_at_the_factor_of_the_closed_form(tmp_path, monkeypatch):
    monkeypatch.setattr(cases, "ACROSS", 3.0)
    ground = Ground(frustum(4.0))
    found = screen(ground, SOUTH, Limits(2000, 1e5, 26e3))
    body = found.bodies[0]
    case = cdem.Case.load(cases.write_case(body, 1, found, tmp_path))
    ends = (0.8 * body.factor, 1.2 * body.factor)
    result = find_critical(
        case,
        strength_reduction(),
        ends,
        tolerance=0.03 * body.factor,
        criterion=Criterion(far=cases.FAR),
        threads=1,
    )
    assert result.value == pytest.approx(body.factor, rel=0.06)


def test_water_and_shaking_of_a_case(tmp_path, ground):
    loads = Loads(kh=0.1, kv=0.05, share=0.4)
    found = screen(ground, SOUTH, Limits(2000, 1e5, 26e3), loads=loads)
    case = cdem.Case.load(cases.write_case(found.bodies[0], 1, found, tmp_path))
    # the wedge slides to the south
    assert case.loads.gravity == pytest.approx([0, -0.981, -0.95 * 9.81], abs=1e-6)
    assert [field.interface for field in case.water.fields] == ["bed1", "bed2"]
    wet = cdem.Simulation(case, threads=1).audit.as_dict()["water"]
    body = found.bodies[0]
    lift = 9810 * 0.4 * np.array(body.heads) * body.areas
    wanted = lift @ [plane.normal for plane in body.planes]
    assert wet["force_on_free_nodes"] == pytest.approx(wanted, abs=0.06 * np.linalg.norm(wanted))
