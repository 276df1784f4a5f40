"""Initial stress: what a case may ask for, and what elements and joints get."""

import numpy as np
import pytest

import cdem
from cdem.errors import CaseError
from cdem.run.fields import stress_of


def case(*entries, gravity=(0, 0, -10), **more):
    """Two cubes of 2 m, one on the other, on a held floor."""
    blocks = [
        {"group": name, "box": {"size": [2, 2, 2], "divisions": [2, 2, 2], "shape": "tet4"}}
        for name in ("lower", "upper")
    ]
    blocks[1]["translate"] = [0, 0, 2]
    return cdem.Case.from_dict(
        {
            "model": {"blocks": blocks},
            "materials": {"rock": {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.3}},
            "groups": {"lower": {"material": "rock", "fix": ["z"]}, "upper": {"material": "rock"}},
            "interfaces": {"default": {"friction_angle": 30}},
            "loads": {"gravity": list(gravity)},
            "initial_stress": list(entries),
            "stages": [{"name": "go", "mode": "static"}],
            **more,
        }
    )


def stress(*entries, **more):
    """Stress of the elements, and their middles."""
    sim = cdem.Simulation(case(*entries, **more), threads=1)
    t = sim.build.topology
    return stress_of(sim), t.node_position[t.element_nodes["tet4"]].mean(axis=1), sim


def test_stress_with_a_gradient():
    entry = {
        "stress": ["-1 MPa", "-2 MPa", "-3 MPa", "0.1 MPa", "0.2 MPa", "-0.3 MPa"],
        "origin": [0, 0, 4],
        "gradient": {"z": [1e4, 2e4, 3e4, 0, 0, 0], "x": [0, 0, 0, 0, 5e3, 0]},
    }
    found, x, _ = stress(entry)
    z = (x[:, 2] - 4)[:, None]
    exact = np.array([-1e6, -2e6, -3e6, 1e5, 2e5, -3e5]) + z * [1e4, 2e4, 3e4, 0, 0, 0]
    exact[:, 4] += 5e3 * x[:, 0]
    np.testing.assert_allclose(found, exact, rtol=1e-12, atol=1e-3)


def test_principal_stress():
    """-3 MPa down, -2 MPa towards N 30 E, -1 MPa across."""
    entry = {
        "principal": {
            "values": ["-3 MPa", "-2 MPa", "-1 MPa"],
            "trends": [0, 30, 120],
            "plunges": [90, 0, 0],
        }
    }
    found, _, _ = stress(entry)
    east, north = np.sin(np.radians(30)), np.cos(np.radians(30))
    exact = [
        -2e6 * east**2 - 1e6 * north**2,
        -2e6 * north**2 - 1e6 * east**2,
        -3e6,
        -2e6 * east * north + 1e6 * north * east,
        0,
        0,
    ]
    np.testing.assert_allclose(found, np.tile(exact, (len(found), 1)), rtol=1e-12, atol=1e-3)


def test_overburden():
    """The horizontal stress of k0 = 0.4 points to N 0, that of 0.9 to the east."""
    found, x, _ = stress({"vertical": "overburden", "k0": [0.4, 0.9], "azimuth": 0})
    vertical = -2.5e4 * (4 - x[:, 2])
    np.testing.assert_allclose(found[:, 2], vertical, rtol=1e-12)
    np.testing.assert_allclose(found[:, 1], 0.4 * vertical, rtol=1e-12)
    np.testing.assert_allclose(found[:, 0], 0.9 * vertical, rtol=1e-12)


def test_overburden_of_ground_above_the_model():
    found, x, _ = stress({"vertical": "overburden", "k0": 0.5, "surface": "100 m"})
    np.testing.assert_allclose(found[:, 2], -2.5e4 * (100 - x[:, 2]), rtol=1e-12)


def test_later_entries_replace_earlier_ones():
    found, x, _ = stress(
        {"stress": [-1e5] * 3 + [0] * 3},
        {"stress": [-2e5] * 3 + [0] * 3, "groups": ["upper"]},
        {"stress": [-3e5] * 3 + [0] * 3, "box": {"min": [0, 0, 3], "max": [2, 2, 4]}},
    )
    exact = np.where(x[:, 2] < 2, -1e5, np.where(x[:, 2] < 3, -2e5, -3e5))
    np.testing.assert_allclose(found[:, 0], exact, rtol=1e-9)


def test_what_joints_cannot_bear_is_cut_and_told():
    _, _, sim = stress({"stress": [0, 0, -1e5, 0, 0, 9e4]})
    limit = 1e5 * np.tan(np.radians(30))
    assert sim.build.initial.cut == 3 * 8
    assert sim.build.initial.most_cut == pytest.approx(9e4 - limit)
    assert "24 points of joints and bonds cannot carry it" in sim.audit.text()


def test_pull_in_all_directions_is_doubted():
    _, _, sim = stress({"stress": [1e5, 1e5, 1e5, 0, 0, 0]})
    assert any("write pressure with a minus sign" in text for text in sim.audit.warnings)
    _, _, sim = stress({"stress": [-1e5, -1e5, -1e5, 0, 0, 0]})
    assert not any("minus sign" in text for text in sim.audit.warnings)


@pytest.mark.parametrize(
    ("entry", "text"),
    [
        ({}, "give exactly one of stress, principal, vertical"),
        ({"stress": [0] * 6, "k0": 1}, "k0 does not go with stress or principal"),
        ({"vertical": "overburden", "gradient": {}}, "gradient does not go with vertical"),
        ({"stress": [0] * 5}, "needs at least 6 entries"),
        (
            {"principal": {"values": [1, 2, 3], "trends": [0, 80, 90], "plunges": [0, 0, 90]}},
            "two of them are 10 deg off",
        ),
        ({"stress": [0] * 6, "groups": ["lover"]}, "no group 'lover'"),
        ({"vertical": "overburden", "surface": 3}, "3 m lies below the top of the model, 4 m"),
    ],
)
def test_mistakes(entry, text):
    with pytest.raises(CaseError, match=text):
        stress(entry)


def test_overburden_needs_gravity_downwards():
    with pytest.raises(CaseError, match="overburden needs gravity along -z"):
        stress({"vertical": "overburden"}, gravity=(1, 0, -10))


def test_other_formulations_are_refused():
    with pytest.raises(CaseError, match="must be corotational"):
        stress({"stress": [-1e5] * 3 + [0] * 3}, elements={"formulation": "incremental"})
