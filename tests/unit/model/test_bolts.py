"""Bolts in the rock: nodes, crossings, what is refused."""

import numpy as np
import pytest

import cdem
from cdem.errors import CaseError

BAR = {
    "area": 5e-4, "young_modulus": 2e11, "yield_force": 2e5,
    "grout": {"stiffness": 1e8, "strength": 2e5},
}  # fmt: skip


def case(*bolts, kind=BAR, **more):
    """Two cubes of 2 m, one beside the other; bolts of the type bar."""
    blocks = [
        {"group": name, "box": {"size": [2, 2, 2], "divisions": [2, 2, 2]}, "translate": [x, 0, 0]}
        for name, x in (("left", 0), ("right", 2))
    ]
    return cdem.Case.from_dict(
        {
            "model": {"blocks": blocks},
            "materials": {"rock": {"density": 2500, "young_modulus": 2e10, "poisson_ratio": 0.3}},
            "groups": {"left": {"material": "rock", "fix": ["x", "y", "z"]}, "right": {"material": "rock"}},
            "interfaces": {"default": {"friction_angle": 30}},
            "bolt_types": {"bar": kind},
            "bolts": [{"name": "b", "type": "bar"} | bolt for bolt in bolts],
            "stages": [{"name": "go", "mode": "static"}, {"name": "on", "mode": "static"}],
            **more,
        }
    )  # fmt: skip


def model(*bolts, **more):
    return cdem.Simulation(case(*bolts, **more), threads=1).build.bolts


ACROSS = {"points": [[0.5, 0.9, 1.1], [3.7, 0.9, 1.1]]}


def test_parts_are_of_one_length_and_none_crosses_the_joint():
    found = model(ACROSS)
    bolt = found.bolts[0]
    x = np.array(bolt.places)[:, 0]
    left = x < 2
    longest = min(3.2 / 8, np.sqrt(1e8 / 1e8) / 8)
    assert np.ptp(np.diff(x[left])) < 1e-12 and np.diff(x[left])[0] <= longest + 1e-12
    assert np.array(bolt.grouted)[left].sum() == pytest.approx(1.5)
    assert np.array(bolt.grouted)[~left].sum() == pytest.approx(1.7)
    (crossing,) = bolt.crossings
    assert x[crossing.bar] < 2 < x[crossing.bar + 1]
    np.testing.assert_allclose(crossing.place, [2, 0.9, 1.1])
    np.testing.assert_allclose(found.arrays["bolts.weights"].reshape(-1, 8).sum(axis=1), 1)


def test_the_free_length_has_no_grout_and_no_dowel():
    bolt = model(ACROSS | {"free_length": 2.0, "plate": True}, kind=BAR | {"dowel": True})
    assert sum(bolt.bolts[0].grouted) == pytest.approx(1.2)
    assert bolt.arrays["bolts.dowel"].tolist() == [0, 0]
    assert bolt.bolts[0].places[0].tolist() == [0.5, 0.9, 1.1]


def test_defaults_of_a_dowel_and_a_plate():
    """K_d = E I b^3, b = (k / (4 E I))^(1/4); a plate is as stiff as 0.1 m of the bolt."""
    found = model(ACROSS | {"plate": True}, kind=BAR | {"dowel": True})
    bending = 2e11 * 5e-4**2 / (4 * np.pi)
    b = (2e10 / (4 * bending)) ** 0.25
    np.testing.assert_allclose(found.arrays["bolts.dowel"], [bending * b**3, 1e5])
    assert found.arrays["bolts.end"][0] == pytest.approx(1e8 / 0.1)


def test_a_pattern_covers_a_surface_at_its_spacing():
    pattern = {"surface": {"group": "right", "normal": [0, 0, 1]}, "spacing": [0.5, 1],
               "length": 1.5}  # fmt: skip
    found = model({"pattern": pattern})
    heads = np.array([b.places[0] for b in found.bolts])
    assert [b.name for b in found.bolts] == [f"b.{k + 1}" for k in range(8)]
    assert sorted({round(x, 9) for x in heads[:, 0]}) == [2.25, 2.75, 3.25, 3.75]
    assert sorted({round(y, 9) for y in heads[:, 1]}) == [0.5, 1.5]
    toes = np.array([b.places[-1] for b in found.bolts])
    assert toes[:, 2] == pytest.approx(0.5, abs=0.1)


def test_rows_of_a_pattern_are_centred_in_its_box():
    """Four rows up a face of 68 deg, between heights 6 and 22 m: 17.2 m along the dip."""
    pattern = {"surface": {"group": "rock", "normal": [5, 0, 2]},
               "box": {"min": [0, 0, 6], "max": [50, 4, 22]}, "spacing": [3, 4.3],
               "length": 5, "direction": [-1, 0, 0]}  # fmt: skip
    corners = [[x, y, z] for y in (0, 6) for x, z in ((0, 0), (42, 0), (30, 30), (0, 30))]
    cut = {"model": {"blocks": [{"group": "rock", "polyhedron": {"vertices": corners}}]},
           "groups": {"rock": {"material": "rock", "fix": ["x", "y", "z"]}}}  # fmt: skip
    heads = np.array([b.places[0] for b in model({"pattern": pattern, "plate": True}, **cut).bolts])
    edge = 0.5 * (16 * np.sqrt(1.16) - 3 * 4.3)
    heights = 6 + (edge + 4.3 * np.arange(4)) / np.sqrt(1.16)
    np.testing.assert_allclose(heads[:, 2], heights, atol=1e-12)
    np.testing.assert_allclose(heads[:, 1], 2, atol=1e-12)
    np.testing.assert_allclose(heads[:, 0], 42 - 0.4 * heights, atol=1e-12)


def test_a_box_around_the_surface_changes_nothing():
    pattern = {"surface": {"group": "right", "normal": [0, 0, 1]}, "spacing": [0.5, 1], "length": 1}
    boxed = pattern | {"box": {"min": [0, 0, 0], "max": [9, 9, 9]}}
    for all_, some in zip(*(model({"pattern": p}).bolts for p in (pattern, boxed)), strict=True):
        np.testing.assert_array_equal(all_.places, some.places)


def test_rings_begin_where_the_opening_ends():
    rings = {"axis": [[3, 0.5, 1], [3, 1.5, 1]], "spacing": 1, "count": 2, "angles": [90, 270],
             "inside": "right", "length": 0.5}  # fmt: skip
    with pytest.raises(CaseError, match="hits no rock"):  # to the right there is none
        model({"rings": rings})
    found = model({"rings": rings | {"count": 1, "angles": [270, 270]}})
    assert found.bolts[0].places[0] == pytest.approx([2 - found.bolts[0].grouted[0] / 2, 0.5, 1])


@pytest.mark.parametrize(
    ("bolt", "what"),
    [
        ({"points": [[0.5, 1, 1], [5, 1, 1]]}, r"b is outside the rock 3.5 m from its head"),
        ({"points": [[-1, 1, 1], [1, 1, 1]]}, "b is outside the rock 0 m from its head"),
        ({"points": [[0.5, 1, 1], [0.5, 1, 1]]}, "two successive points are equal"),
        (ACROSS | {"pretension": 1e4}, "pretension needs a plate"),
        (ACROSS | {"type": "baar"}, "did you mean bar"),
        (ACROSS | {"install": "onn"}, "no stage 'onn'; did you mean on"),
        (ACROSS | {"install": "on", "remove": "go"}, "must be a later stage than 'on'"),
        ({"pattern": {"surface": {"group": "right", "normal": [0, 0, 1]}, "spacing": [9, 9],
                      "length": 1}}, "the pattern has no bolts"),
        ({"pattern": {"surface": {"group": "right", "normal": [0, 0, 1]}, "spacing": [1, 1],
                      "length": 1, "direction": [0, 0, 1]}}, "points out of the surface"),
        ({"pattern": {"surface": {"group": "right", "normal": [0, 0, 1]}, "spacing": [1, 1],
                      "length": 1, "box": {"min": [0, 0, 0], "max": [1, 2, 3]}}},
         r"the surface has no part in this box; it reaches from \[2, 0, 2\] to \[4, 2, 2\]"),
        ({"pattern": {"surface": {"group": "right", "normal": [0, 0, 1]}, "spacing": [1, 1],
                      "length": 1, "box": {"min": [2, 0, 0], "max": [2.5, 2, 3]}}},
         "its spacing is wider than the surface in its box"),
        ({"pattern": {"surface": {"group": "right", "normal": [0, 0, 1]}, "spacing": [1, 1],
                      "length": 1, "box": {"min": [2, 0, 4], "max": [4, 2, 3]}}},
         "min must not be above max"),
        (ACROSS | {"rings": {"axis": [[0, 0, 0], [0, 1, 0]], "spacing": 1, "count": 3, "length": 1}},
         "points"),
    ],
)  # fmt: skip
def test_what_is_refused(bolt, what):
    with pytest.raises(CaseError, match=what):
        model(bolt)


def test_nothing_holds_a_bolt_without_grout_plate_and_anchor():
    bare = {key: value for key, value in BAR.items() if key != "grout"}
    with pytest.raises(CaseError, match="no grout, plate or anchor holds both ends"):
        model(ACROSS | {"plate": True}, kind=bare)
    assert len(model(ACROSS | {"plate": True, "anchor": True}, kind=bare).bolts) == 1


def test_steel_that_would_tear_before_it_yields():
    with pytest.raises(CaseError, match=r"below the strain 0\.002 at which the steel yields"):
        model(ACROSS, kind=BAR | {"rupture_strain": 0.001})


def test_the_audit_counts_bolts_and_a_bolt_holds_a_block():
    sim = cdem.Simulation(case(ACROSS), threads=1)
    assert "bar: 1 bolt, 3.2 m, 26 nodes" in sim.audit.text()
    assert sim.audit.as_dict()["bolts"]["bar"]["crossings"] == 1
    assert not any("no support" in w for w in sim.audit.warnings)
