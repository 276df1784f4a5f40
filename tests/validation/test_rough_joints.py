"""Rough joints: energies, initial stress, release, threads and what is refused."""

import re

import numpy as np
import pytest
from scenes import case, digest, simulate

import cdem
from cdem import CaseError
from cdem.rows import rows_of
from cdem.run.law_fields import state_of

ROUGH = {"law": "barton-bandis", "jrc": 10, "jcs": "50 MPa", "residual_friction_angle": 28}
YIELDING = {
    "law": "continuously-yielding",
    "friction_angle": 30,
    "initial_friction_angle": 45,
    "roughness": "2 mm",
}
STIFFNESS = {"stiffness_n": "1e11 Pa/m", "stiffness_s": "1e11 Pa/m"}
CUBES = [
    {"group": "bed", "box": {"size": [1, 1, 1]}, "translate": [0, 0, -1]},
    {"group": "block", "box": {"size": [1, 1, 1]}},
]


def stressed(law, sigma, history, threads=1):
    """A cube on another, in touch under an initial stress, then led along x by a history of speed."""
    rock = {"stress": [0, 0, -sigma, 0, 0, 0]}
    return cdem.Simulation(
        case(
            CUBES,
            {"bed": {"fix": ["x", "y", "z"]}, "block": {}},
            interfaces={"default": STIFFNESS | law},
            initial_stress=[rock],
            loads={
                "tractions": [
                    {"surface": {"group": "block", "normal": [0, 0, 1]}, "traction": [0, 0, -sigma]}
                ],
                "velocities": [
                    {
                        "group": "block",
                        "components": ["x", "y"],
                        "velocity": [1, 0, 0],
                        "history": history,
                    }
                ],
            },
        ),
        threads=threads,
    )


def joint_force(sim):
    """Shear and normal force on the joint [N]."""
    bed = sim.build.nodes_of("bed")
    force = rows_of(sim.core, "node.reaction").force[bed].sum(axis=0)
    return abs(force[0]), abs(force[2])


@pytest.mark.parametrize("law", [ROUGH, YIELDING], ids=["rough", "yielding"])
def test_a_joint_in_initial_stress_rests_and_slips_with_its_true_area(law):
    """At rest it bears sigma and does not move; then tau follows the law, before its release and after."""
    sigma = 2e6
    sim = stressed(law, sigma, [[0.002, 0], [0.004, 0.01], [0.3, 0.01]])
    sim.run_until(0.0018)
    assert sim.core.fields()["quads.status"][0] == 1
    assert joint_force(sim)[1] == pytest.approx(sigma, rel=1e-9)
    assert np.abs(sim.fields["displacement"]).max() < 1e-12
    sim.run_until(0.05)  # 0.47 mm
    shear, normal = joint_force(sim)
    slip = state_of(sim, "joint_slip").max()
    tangent = expected(law, slip, normal)
    assert shear / normal == pytest.approx(tangent, rel=1e-3)
    assert abs(sim.energies["error"]) < 1e-5
    while sim.core.fields()["quads.status"][0]:
        sim.step(10)
    sim.step(1)
    assert sim.contacts["force_n"].sum() == pytest.approx(sigma, rel=0.02)
    sim.run_until(0.2)
    assert abs(sim.energies["error"]) < 1e-3


def expected(law, slip, sigma):
    """tan(phi) of a law after a slip under a pressure; above it where strength wears as traction follows."""
    if law is YIELDING:
        angle = np.radians([30, 15 * np.exp(-slip / 2e-3)])
        tangent = np.tan(angle.sum())
        wear = sigma * (1 + tangent**2) * angle[1] / 2e-3  # F k_s = -d tau_m / ds
        return tangent * (1 + wear / 1e11)
    x = slip / (0.1 / 500 * 100**0.33)
    rough = np.interp(x, [0.3, 0.6, 1, 2], [0, 0.75, 1, 0.85])
    return np.tan(np.radians(28 * min(x / 0.3, 1) + rough * 10 * np.log10(50e6 / sigma)))


def test_a_closing_joint_begins_as_deep_as_its_curve_says():
    """d = sigma / (k_i + sigma / V_m) below the end of the curve, k_i 15.35 MPa/mm, V_m 0.227 mm."""
    sim = stressed(ROUGH, 2e6, [[0, 0], [1, 0]])
    stiffness, most = 15.35e9, 1e-3 * (-0.352 + 2.241 * 250**-0.245)
    rest = sim.core.fields()["quads.rest"]
    assert rest.max() == pytest.approx(2e6 / (stiffness + 2e6 / most), rel=1e-12)


@pytest.mark.parametrize("law", [ROUGH, YIELDING], ids=["rough", "yielding"])
def test_blocks_that_tumble_close_their_energy_on_any_number_of_threads(law):
    """Cubes thrown on a bed, with faces, edges and corners: the ledger closes to 1e-3."""
    stones = [
        {"group": "bed", "box": {"size": [6, 6, 1], "divisions": [3, 3, 1]}, "translate": [-3, -3, -1]}
    ] + [
        {"group": "block", "box": {"size": [0.5, 0.5, 0.5]},
         "rotate": {"axis": [1, 2, 3], "angle": 25 * k}, "translate": [k - 1.5, 0.2 * k, 0.6]}
        for k in range(4)
    ]  # fmt: skip
    digests = set()
    for threads in (1, 3):
        sim = cdem.Simulation(
            case(
                stones,
                {"bed": {"fix": ["x", "y", "z"]}, "block": {"velocity": [1, 0.5, 0]}},
                interfaces={"default": law},
                loads={"gravity": [0, 0, -9.81]},
            ),
            threads=threads,
        )
        sim.run_until(0.4)
        digests.add(digest(sim))
        assert abs(sim.energies["error"]) < 1e-3
        assert sim.energies["friction"] > 0
    assert len(digests) == 1


@pytest.mark.parametrize(
    "wrong, told",
    [
        (ROUGH | {"restitution": 0.5}, "restitution must be 1 with law barton-bandis"),
        (ROUGH | {"jrc": 0}, "jrc must be above 0"),
        (ROUGH | {"jrc": 21}, "jrc: must lie in [0, 20]"),
        (ROUGH | {"uniaxial_strength": "40 MPa"}, "uniaxial_strength must not be below jcs, 5e+07 Pa"),
        (ROUGH | {"residual_friction_angle": 70}, "residual_friction_angle: must lie in [0, 70)"),
        (ROUGH | {"cohesion": "1 MPa"}, "cohesion: unknown key; it belongs to law: brittle"),
        (YIELDING | {"initial_friction_angle": 29}, "must not be below friction_angle, 30"),
        (YIELDING | {"roughness": 0}, "roughness must be above 0"),
    ],
)  # fmt: skip
def test_what_does_not_fit_is_told(wrong, told):
    with pytest.raises(CaseError, match=re.escape(told)):
        simulate(CUBES, {"bed": {}, "block": {}}, interfaces={"default": wrong})


def test_the_audit_says_where_the_curve_ends():
    sim = stressed(ROUGH, 2e6, [[0, 0], [1, 0]])
    end = 15.35e9 * 1e-3 * (-0.352 + 2.241 * 250**-0.245) * (np.sqrt(1e11 / 15.35e9) - 1)
    assert f"joints follow a closure curve up to {end:.3g} Pa" in sim.audit.text()


FAST = {"law": "velocity-weakening", "friction_angle": 40, "dynamic_friction_angle": 20}


@pytest.mark.parametrize("velocity, told", [(1e-6, True), (10.0, False)])
def test_friction_that_falls_faster_than_a_step_can_follow_is_told(velocity, told):
    """(mu_s - mu_d) F_n dt sum(1/m) / v_c of a cube that slides under its weight."""
    sim = simulate(
        CUBES,
        {"bed": {"fix": ["x", "y", "z"]}, "block": {"velocity": [0.1, 0, 0]}},
        interfaces={"default": FAST | {"velocity": velocity}},
        loads={"gravity": [0, 0, -9.81]},
    )
    sim.run_until(0.02)
    texts = sim.summary("finished")["fast_weakening"]
    assert len(texts) == told
    if told:
        assert "friction of interface default falls" in texts[0]
        force = rows_of(sim.core, "spring.state").force_n.max()
        fall = (np.tan(np.radians(40)) - np.tan(np.radians(20))) / velocity
        most = fall * force * sim.core.scalars()["dt"] * 2 / sim.fields["mass"].min()
        now = max(one[1] for one in sim.core.fast_weakenings())
        assert 0.5 * most < now < 1.01 * most
