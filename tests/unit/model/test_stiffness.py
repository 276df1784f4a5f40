"""Stiffness of contacts: that of bonds, automatic, or by an allowed overlap."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import case, simulate

import cdem
from cdem.model.stiffness import interface_entries

FRICTION = {"friction_angle": 30}
POSITION = np.array([[0.0, 0, 0], [1, 1, 26]])


def entry(law, defaults=True, velocity=(0, 0, 0), **more):
    """What the core is told of an interface; rock of E = 10 GPa and 2,500 kg/m3."""
    block = {"group": "a", "box": {"size": [1, 1, 1]}}
    data = case([block], {"a": {"velocity": list(velocity)}}, defaults=defaults,
                interfaces={"default": FRICTION | law}, **more)  # fmt: skip
    return interface_entries(data, [data.interfaces.default], ["a"], POSITION)[0]


@pytest.mark.parametrize(
    ("defaults", "law", "normal", "shear", "in_series"),
    [
        (False, {}, (0, 10), (0, 10), False),
        (False, {"stiffness_n": "3 E/h", "stiffness_s": 1e9}, (0, 3), (1e9, 0), False),
        (False, {"contact_stiffness": "0.5 E/h"}, (0, 0.5), (0, 0.5), True),
        (True, {}, (0, 1), (0, 1), True),
        (True, {"stiffness_n": "3 E/h"}, (0, 3), (0, 10), False),  # something is known
        (True, {"contact_stiffness": "2 GPa/m"}, (2e9, 0), (2e9, 0), True),
    ],
)
def test_contacts_have_the_stiffness_that_the_case_leaves_to_them(
    defaults, law, normal, shear, in_series
):
    found = entry(law, defaults)
    assert (found["stiffness_n"], found["stiffness_s"]) == (normal, shear)
    assert found["in_series"] is in_series


WEIGHT = {"loads": {"gravity": [0, 0, -9.81]}}


@pytest.mark.parametrize(
    ("allowed", "more", "factor"),
    [
        # 2 rho g H / (E d) = 2 * 2500 * 9.81 * 26 / (1e10 * 1e-3)
        ({"overlap": 1e-3}, WEIGHT, 0.127530),
        ({"overlap": 1e-4}, WEIGHT, 1.27530),
        # 2 (v / (c d))^2 with c = 2000 m/s
        ({"overlap": 1e-3, "speed": "5 m/s"}, WEIGHT, 0.127530),
        ({"overlap": 1e-3, "speed": "10 m/s"}, WEIGHT, 0.5),
        ({"overlap": 1e-3, "speed": "10 m/s", "impact": 5e-3}, WEIGHT, 2.0),
        ({"overlap": 1e-3}, {"velocity": (0, 0, -10)}, 0.5),
        ({"overlap": 1e-2}, {}, 0.03),
        ({"overlap": 1e-3, "speed": "100 m/s"}, {}, 10),
    ],
)
def test_an_allowed_overlap_gives_a_stiffness(allowed, more, factor):
    found = entry({"contact_stiffness": allowed}, **more)["stiffness_n"]
    assert found == pytest.approx((0, factor), rel=1e-5)


def test_driven_groups_count_with_their_history():
    driven = {"group": "a", "velocity": [0, 0, 2], "history": [[0, 0], [1, -5]]}
    found = entry({"contact_stiffness": {"overlap": 1e-3}}, loads={"velocities": [driven]})
    assert found["stiffness_n"][1] == pytest.approx(0.5)


def test_a_wrong_overlap_is_answered():
    with pytest.raises(cdem.CaseError, match=r"contact_stiffness.*overlap: is missing"):
        entry({"contact_stiffness": {"speed": 5}})


def test_the_audit_tells_how_far_blocks_overlap():
    """A cube on a floor settles by 2 rho g H / k where its vertices alone touch."""
    blocks = [{"group": "cube", "box": {"size": [1, 1, 1]}},
              {"group": "floor", "box": {"size": [3, 3, 1]}, "translate": [-1, -1, -1]}]  # fmt: skip
    sim = simulate(
        blocks, {"cube": {}, "floor": {"fix": ["x", "y", "z"]}}, defaults=True, **WEIGHT,
        interfaces={"default": FRICTION},
        stages=[{"name": "settle", "mode": "static", "tolerance": 1e-6}],
    )  # fmt: skip
    (row,) = sim.audit.contacts
    assert row["stiffness_n"] == pytest.approx([1e10 / 3, 1e10])
    told = "blocks overlap by up to 0.00098 % of an element under 2 m of rock, 0 % at 0 m/s"
    assert told in sim.audit.text()
    assert sim.run() == "converged"
    bottom = sim.build.nodes_of("cube")[
        sim.build.start_position[sim.build.nodes_of("cube"), 2] == 0
    ]
    settled = -sim.fields["displacement"][bottom, 2].mean()
    assert settled == pytest.approx(2 * 2500 * 9.81 / 1e10, rel=0.02)


def test_the_audit_tells_of_restitution_where_it_shortens_the_step():
    def audit(restitution, **more):
        blocks = [{"group": "cube", "box": {"size": [1, 1, 1]}},
                  {"group": "floor", "box": {"size": [3, 3, 1]}, "translate": [-1, -1, -1]}]  # fmt: skip
        law = FRICTION | {"restitution": restitution} | more
        return simulate(blocks, {"cube": {}, "floor": {"fix": ["x", "y", "z"]}}, defaults=True,
                        interfaces={"default": law}).audit  # fmt: skip

    told = "restitution 0.5 makes them 4 times as stiff in unloading, which shortens the step"
    stiff = audit(0.5)
    assert told in stiff.text()
    assert stiff.step["limit"] < 0.6 * audit(1.0).step["limit"]
    assert "restitution" not in audit(1.0).text()
    soft = audit(0.5, contact_stiffness="0.01 E/h")
    assert "restitution" not in soft.text()
