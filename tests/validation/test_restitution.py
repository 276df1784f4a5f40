"""Restitution: v_after = e v_before whatever the masses, Walton & Braun (1986), J. Rheology 30, 949.

Contacts lose (1 - e^2) of the work that loads them. What blocks hold as strain meanwhile they give
back, so a body returns sqrt(e^2 + s (1 - e^2)) of its speed, s the share of the work that is in its
elements: 0.04 to 0.06 for blocks of one element at the default stiffness of contacts, 1 E/h, and
0.1 to 0.2 for 2 x 2 x 2 of them. With 0.03 E/h it is below 0.006.
"""

import numpy as np
import pytest
from scenes import case, digest, mean_velocity, simulate, turn

import cdem

SOFT = {"contact_stiffness": "0.03 E/h"}
TET = [[0.1, 0.1, 0], [1.1, 0.1, 0], [0.1, 1.1, 0], [0.4, 0.4, 1.1]]
BODIES = {
    "cube": {"box": {"size": [1, 1, 1]}},
    "8 hexahedra": {"box": {"size": [1, 1, 1], "divisions": [2, 2, 2]}},
    "tet": {"polyhedron": {"vertices": TET}},
    "48 tets": {"box": {"size": [1, 1, 1], "divisions": [2, 2, 2], "shape": "tet4"}},
}
COEFFICIENTS = [0.2, 0.5, 0.8]
GAP = 1e-4


def plate(size=(4, 4), divisions=(1, 1)):
    """A plate below z = 0, in the middle below a cube."""
    box = {"size": [*size, 1], "divisions": [*divisions, 1]}
    return {
        "group": "plate",
        "box": box,
        "translate": [0.513 - size[0] / 2, 0.521 - size[1] / 2, -1],
    }


def drop(body, e, speed, *, bed=None, law=None, rotation=None, **more):
    """A body that comes down flat onto a fixed plate without gravity, and the way up."""
    up = np.array([0, 0, 1.0])
    if rotation is not None:
        up = turn(*rotation) @ up
        more["model"] = {"rotate": {"axis": list(rotation[0]), "angle": rotation[1]}}
    block = {"group": "body", **BODIES[body], "translate": [0.013, 0.021, GAP]}
    sim = simulate(
        [bed or plate(), block],
        {"plate": {"fix": ["x", "y", "z"]}, "body": {"velocity": (-speed * up).tolist()}},
        defaults=True,
        interfaces={"default": {"friction_angle": 30, "restitution": e, **(law or {})}},
        **more,
    )
    return sim, up


def rebound(sim, up, speed):
    """Velocity after over velocity before, and the largest closing error of the ledger."""
    worst, apart = 0.0, 0
    while apart < 10:
        sim.step(10)
        worst = max(worst, abs(sim.energies["error"]))
        velocity = mean_velocity(sim, "body") @ up
        apart = apart + 1 if velocity > 0 and sim.energies["contact"] == 0 else 0
        assert sim.step_count < 20_000
    return velocity / speed, worst


@pytest.mark.parametrize("e", COEFFICIENTS)
@pytest.mark.parametrize("body", list(BODIES))
def test_bodies_rebound_with_the_coefficient_of_restitution(body, e):
    """Off by at most 0.018 (e = 0.2, 48 tets); the ledger closes to 4e-4."""
    measured, worst = rebound(*drop(body, e, 1.0, law=SOFT), 1.0)
    assert measured == pytest.approx(e, abs=0.02)
    assert worst < 1e-3


@pytest.mark.parametrize("e", COEFFICIENTS)
@pytest.mark.parametrize("body", list(BODIES))
def test_elements_give_back_their_strain_at_the_default_stiffness(body, e):
    most = 0.075 if body in ("cube", "tet") else 0.22
    measured, worst = rebound(*drop(body, e, 1.0), 1.0)
    assert e < measured < np.sqrt(e * e + most * (1 - e * e))
    assert worst < 5e-3


@pytest.mark.slow
@pytest.mark.parametrize("e", COEFFICIENTS)
@pytest.mark.parametrize("body", list(BODIES))
def test_restitution_does_not_depend_on_the_speed(body, e):
    """At one stiffness: by default, contacts of bodies faster than 27 m/s are stiffer."""
    law = {"contact_stiffness": "1 E/h"}
    expected, _ = rebound(*drop(body, e, 1.0, law=law), 1.0)
    for speed in (0.1, 10.0, 30.0):
        measured, _ = rebound(*drop(body, e, speed, law=law), speed)
        assert measured == pytest.approx(expected, abs=0.005)


@pytest.mark.parametrize("e", [0.5])
@pytest.mark.parametrize(
    "bed",
    [plate(divisions=(18, 18)), plate((0.6, 0.7)), plate((0.6, 1.7))],
    ids=["16 vertices of the plate too", "vertices of the plate alone", "edges cross"],
)
def test_restitution_does_not_depend_on_the_points_that_touch(bed, e):
    """Off by at most 0.012: other contacts, another share of the work in the elements."""
    measured, _ = rebound(*drop("cube", e, 1.0, bed=bed, law=SOFT), 1.0)
    assert measured == pytest.approx(e, abs=0.02)


def test_restitution_does_not_depend_on_the_frame():
    upright, _ = rebound(*drop("cube", 0.5, 1.0, law=SOFT), 1.0)
    turned, _ = rebound(*drop("cube", 0.5, 1.0, law=SOFT, rotation=([1, 2, 3], 77.0)), 1.0)
    assert turned == pytest.approx(upright, rel=1e-9)


@pytest.mark.parametrize("factor", [1.0, 3.0])
@pytest.mark.parametrize("e", COEFFICIENTS)
def test_central_impact(e, factor):
    """v_2 - v_1 = -e (u_2 - u_1), momentum kept; masses 1 : 1 and 1 : 3."""
    blocks = [
        {"group": "a", "box": {"size": [1, 1, 1]}},
        {"group": "b", "box": {"size": [factor, 1, 1]}, "translate": [1 + GAP, 0, 0]},
    ]
    sim = simulate(
        blocks,
        {"a": {"velocity": [1, 0, 0]}, "b": {}},
        defaults=True,
        interfaces={
            "default": {"friction_angle": 0, "restitution": e, "contact_stiffness": "0.01 E/h"}
        },
    )
    apart = 0
    while apart < 10:
        sim.step(10)
        a, b = (mean_velocity(sim, name)[0] for name in "ab")
        apart = apart + 1 if b > a and sim.energies["contact"] == 0 else 0
    assert a + factor * b == pytest.approx(1, abs=1e-12)
    assert b - a == pytest.approx(e, abs=0.02)


def at_rest(e, height=1.0, gravity=(0, 0, -9.81), then=None, defaults=True):
    """A block that rests on a plate under gravity, and the way there."""
    block = {"box": {"size": [1, 1, height]}, "translate": [0.013, 0.021, 0]}
    stages = [{"name": "rest", "mode": "static", "relax": "local", "tolerance": 1e-8}]
    sim = simulate(
        [plate(), {"group": "body", **block}],
        {"plate": {"fix": ["x", "y", "z"]}, "body": {}},
        defaults=defaults,
        interfaces={
            "default": {"friction_angle": 60, "restitution": e, "contact_stiffness": "0.3 GPa/m"}
        },
        loads={"gravity": list(gravity)},
        stages=[*stages, *([then] if then else [])],
    )
    assert sim.run_stage("rest") == "converged"
    return sim


def test_a_block_settles_as_without_restitution():
    """It rests where the contact has unloaded from its overshoot: between W / K and the peak.

    Local damping of 0.8 lets it overshoot by a third at most; K = A k / 2, the cube's vertices only.
    """
    elastic, sim = (at_rest(e).fields["displacement"][-8:, 2].mean() for e in (1.0, 0.5))
    weight, stiffness = 2500 * 9.81, 0.5 * 0.03 * 10e9
    assert elastic == pytest.approx(-weight / stiffness, rel=0.05)
    assert 1.0 <= sim / elastic < 1.34


@pytest.mark.parametrize("e", COEFFICIENTS)
def test_shear_springs_let_go_with_the_coefficient_of_restitution(e):
    """A block pressed on a plate is pushed aside with little, then let go.

    Its kinetic energy grows to e^2 of what an elastic contact gives it. Tolerance: it rocks, which
    takes 0.7 % of the energy into its normal springs.
    """
    go = {"name": "go", "mode": "dynamic", "duration": 1, "set": {"loads.gravity": [0, 0, -9.81]}}

    def fastest(restitution):
        sim = at_rest(restitution, 0.1, (2, 0, -9.81), go)
        sim.run_until(sim.time * (1 + 1e-9))
        most = 0.0
        for _ in range(200):
            sim.step(5)
            most = max(most, sim.energies["kinetic"])
            assert abs(sim.energies["error"]) < 1e-3
        return most

    expected = fastest({"tangential": 1.0})
    assert fastest({"tangential": e}) / expected == pytest.approx(e * e, abs=0.01)


def tumble(threads, **more):
    """27 cubes and tets fall into a heap, with restitution both ways."""
    stones = [
        {
            "group": "stones",
            **BODIES["tet" if (i + j + k) % 2 else "cube"],
            "translate": [1.15 * i + 0.1 * k, 1.15 * j - 0.07 * k, 1.2 * k + 1e-3],
        }
        for i in range(3)
        for j in range(3)
        for k in range(3)
    ]
    return cdem.Simulation(
        case(
            [plate((9, 9), (9, 9)), *stones],
            {"plate": {"fix": ["x", "y", "z"]}, "stones": {"velocity": [1, 0.5, -4]}},
            interfaces={
                "default": {
                    "friction_angle": 30,
                    "restitution": {"normal": 0.5, "tangential": 0.8},
                }
            },
            loads={"gravity": [0, 0, -9.81]},
            stages=[{"name": "fall", "mode": "dynamic", "duration": 0.08}],
            output={"every": 0.02},
            defaults=True,
        ),
        threads=threads,
        **more,
    )


def test_threads_and_a_stop_give_identical_results(tmp_path):
    whole = tumble(1, output=tmp_path / "whole")
    whole.run()
    assert abs(whole.energies["error"]) < 1e-3
    assert whole.energies["damping"] > 0.1 * whole.energies["kinetic"]
    other = tumble(3)
    other.run()
    assert digest(other) == digest(whole)
    asked = iter([False, False, True])
    assert tumble(2, output=tmp_path / "broken").run(should_stop=lambda: next(asked)) == "stopped"
    resumed = tumble(1, output=tmp_path / "broken", resume=True)
    resumed.run()
    assert digest(resumed) == digest(whole)


def test_restitution_of_1_gives_the_bits_of_none():
    """Also beside an interface that has some."""

    def run(**interfaces):
        sim = simulate(
            [plate(), {"group": "body", **BODIES["48 tets"], "translate": [0.013, 0.021, GAP]}],
            {"plate": {"fix": ["x", "y", "z"]}, "body": {"velocity": [1, 0, -2]}},
            interfaces=interfaces,
            loads={"gravity": [0, 0, -9.81]},
            stages=[{"name": "r", "mode": "dynamic", "duration": 1, "damping": {"contact": 0.1}}],
        )
        sim.step(300)
        assert sim.energies["friction"] > 0
        return sim.fields["position"].tobytes()

    law = {"friction_angle": 30}
    other = {"between": ["body", "body"], "restitution": 0.5}
    assert run(default=law) == run(default=law, pairs=[other])
