"""Elements that make up for the compliance of the bonds between them."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import case, irregular_tets

import cdem
from cdem.model.build import build

STRONG = {"friction_angle": 30, "cohesion": 1e9, "tensile_strength": 1e9}


def bonded(box, *, defaults=True, nu=0.25, law=STRONG, **more):
    """A box whose every element is a block."""
    return case(
        [{"group": "rock", "box": box}], {"rock": {}}, defaults=defaults,
        interfaces={"default": law}, rock={"young_modulus": 1e10, "poisson_ratio": nu},
        model={"split": {"rock": "elements"}}, **more,
    )  # fmt: skip


CUBES = {"size": [6, 6, 6], "divisions": [6, 6, 6], "shape": "tet4"}


@pytest.fixture(scope="module")
def regular():
    return build(bonded(CUBES))


def test_regular_tets_follow_the_sum_over_faces(regular):
    """q = 6: every tet has A h = 3 V at its four faces, of which each has two sides."""
    made = regular.compensation["rock"]
    assert made.q == pytest.approx(6, rel=1e-6)
    assert made.stiffening == pytest.approx(1.4, rel=3e-7)
    assert made.height * made.area_per_volume == pytest.approx(6, rel=1e-8)
    assert np.abs(made.errors).max() < 5e-7


def test_elements_and_bonds_have_what_was_found(regular):
    made, a = regular.compensation["rock"], regular.arrays
    young, nu = 1.4e10, 0.35
    np.testing.assert_allclose(a["material.mu"], young / (2 + 2 * nu), rtol=3e-7)
    lame = young * nu / ((1 + nu) * (1 - 2 * nu))
    np.testing.assert_allclose(a["material.lambda"], lame, rtol=3e-7)
    stiffness = a["triangles.stiffness"]
    assert set(stiffness[stiffness > 0]) == {made.stiffness}
    assert made.stiffness == pytest.approx(5 * young / made.height, rel=3e-7)
    # contacts keep the modulus of the rock: the elements are up to 1 m high
    assert a["face.stiffness"].min() == pytest.approx(1e10 / 1.0)


def test_irregular_tets_are_found_numerically(tmp_path):
    mesh = irregular_tets(tmp_path / "m.vtk", [6, 6, 6], [6, 6, 6])
    data = case(
        [], {"default": {}}, defaults=True, interfaces={"default": STRONG},
        rock={"young_modulus": 1e10}, model={**mesh, "split": {"default": "elements"}},
    )  # fmt: skip
    made = build(data).compensation["default"]
    sum_over_faces = made.height * made.area_per_volume
    assert made.q / sum_over_faces == pytest.approx(0.97, abs=0.01)
    _, shear, bulk = np.abs(made.errors)
    assert shear < 0.003 and bulk < 0.003


@pytest.mark.parametrize(("nu", "factor"), [(0, 5), (0.3, 5), (0.36, 12)])
def test_bonds_are_stiffer_where_poissons_ratio_leaves_less_room(nu, factor):
    made = build(bonded(CUBES | {"divisions": [3, 3, 3]}, nu=nu)).compensation["rock"]
    assert made.factor == pytest.approx(factor, rel=1e-6)
    assert made.stiffening * nu <= 0.42 + 1e-6


def test_a_poissons_ratio_without_room_is_refused():
    with pytest.raises(cdem.CaseError, match=r"materials.rock.poisson_ratio: 0.42 is too large.*"
                       r"at most 0.4\); give stiffness_n and stiffness_s"):  # fmt: skip
        build(bonded(CUBES, nu=0.42))


@pytest.mark.parametrize(
    "changes",
    [
        {"defaults": False},
        {"law": STRONG | {"stiffness_n": "5 E/h"}},
        {"law": STRONG | {"stiffness_s": 1e10}},
        {"law": {"friction_angle": 30}},
    ],
)
def test_nothing_is_made_up_for(changes):
    assert build(bonded(CUBES, **changes)).compensation == {}


def test_bricks_have_half_the_faces():
    """Cubes: three faces each, q = 3."""
    made = build(bonded(CUBES | {"shape": "hex8"})).compensation["rock"]
    assert made.q == pytest.approx(3, rel=1e-8)


def test_between_two_groups_the_bonds_are_in_series():
    blocks = [
        {"group": g, "box": {"size": [3, 3, 3], "divisions": [3, 3, 3], "shape": "tet4"},
         "translate": [3 * i, 0, 0]}
        for i, g in enumerate("ab")
    ]  # fmt: skip
    soft = {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.2}
    data = case(
        blocks, {"a": {}, "b": {"material": "soft"}}, defaults=True, interfaces={"default": STRONG},
        materials={"rock": soft | {"young_modulus": 1e10}, "soft": soft},
        model={"split": {"a": "elements", "b": "elements"}},
    )  # fmt: skip
    b = build(data)
    hard, weak = (b.compensation[g].stiffness for g in "ab")
    between = 2 * hard * weak / (hard + weak)
    found = np.unique(b.arrays["triangles.stiffness"])
    np.testing.assert_allclose(found[found > 0], sorted([hard, weak, between]), rtol=1e-12)


def test_a_stage_cannot_take_back_what_the_elements_make_up_for():
    stages = [
        {"name": "one", "mode": "dynamic", "duration": 1e-5},
        {"name": "two", "mode": "dynamic", "duration": 1e-5,
         "set": {"interfaces.default.stiffness_n": 1e10}},
    ]  # fmt: skip
    sim = cdem.Simulation(bonded(CUBES | {"divisions": [2, 2, 2]}, stages=stages))
    with pytest.raises(cdem.CaseError, match="of group 'rock' cannot change"):
        sim.run()


def test_the_report_tells_what_is_left_along_each_axis():
    slice_ = {"size": [8, 1, 8], "divisions": [8, 1, 8], "shape": "hex8"}
    text = cdem.Simulation(bonded(slice_)).audit.text()
    assert (
        "remaining error in E up to +20 %" in text and "along x, y, z +0.0, +20.0, +0.0 %" in text
    )


def test_bonds_beside_a_free_end_stand_for_both(regular):
    """Three bricks in a row: both bonds are between one that has one bond and one that has two."""
    row = {"size": [1, 1, 3], "divisions": [1, 1, 3], "shape": "hex8"}
    b = build(bonded(row))
    found = np.unique(b.arrays["quads.stiffness"])
    np.testing.assert_allclose(found, [5 * 1.2e10 / 1.5], rtol=1e-7)


def test_a_joint_counts_as_free():
    """A column cut in two by a joint: the bonds beside the joint stand for both, as at its ends."""
    column = {"size": [1, 1, 8], "divisions": [1, 1, 8], "shape": "hex8"}
    halves = [
        {"group": g, "box": column | {"size": [1, 1, 4], "divisions": [1, 1, 4]},
         "translate": [0, 0, z]}
        for g, z in (("a", 0), ("b", 4))
    ]  # fmt: skip
    joint = {"between": ["a", "b"], **STRONG, "stiffness_n": 1e9, "stiffness_s": 1e9}
    data = case(
        halves, {"a": {}, "b": {}}, defaults=True, interfaces={"default": STRONG, "pairs": [joint]},
        rock={"young_modulus": 1e10}, model={"split": {"a": "elements", "b": "elements"}},
    )  # fmt: skip
    b = build(data)
    found = np.unique(b.arrays["quads.stiffness"].round(-3))
    np.testing.assert_allclose(found, [1e9, 4e10, 6e10], rtol=1e-6)
    assert max(map(abs, b.compensation["a"].along_xyz[2:])) < 1e-7
