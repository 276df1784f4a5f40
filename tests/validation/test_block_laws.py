"""Rock with a weak plane, cones and rock masses: energies, turning, bits, what has yielded."""

import json

import numpy as np
import pytest
from scenes import case, digest, momentum, simulate, turn

import cdem
from cdem.case.softening import reduced_tables
from cdem.run.fields import stress_of
from cdem.run.law_fields import large_strains, state_of, yielded_counts, yielded_of

ELASTIC = {"young_modulus": "1 GPa"}
WEAK = {
    "law": "ubiquitous-joint", "cohesion": "1 MPa", "friction_angle": 30, "joint_dip": 50,
    "joint_dip_direction": 60, "joint_cohesion": "0.2 MPa", "joint_friction_angle": 20,
    "joint_dilation_angle": 5,
}  # fmt: skip
CONE = {"law": "drucker-prager", "cohesion": "1 MPa", "friction_angle": 30, "dilation_angle": 10}
MASS = {"law": "hoek-brown", "uniaxial_strength": "20 MPa", "gsi": 70, "mi": 10}
LAWS = [WEAK, CONE, MASS]
FLOOR = {"surface": {"group": "rock", "normal": [0, 0, -1]}, "fix": ["z"]}


def box(shape="hex8", divisions=(2, 2, 2)):
    """A cube in the group rock."""
    return [{"group": "rock", "box": {"size": [1, 1, 1], "divisions": divisions, "shape": shape}}]


def name_of(law):
    return law["law"]


@pytest.mark.parametrize("law", LAWS, ids=name_of)
@pytest.mark.parametrize("shape", ["hex8", "tet4"])
def test_energy_closes_while_rock_flows(law, shape):
    """A block that hits a held one at 8 m/s yields: the ledger closes, most of it is plastic."""
    sim = simulate(box(shape), {"rock": {"velocity": [0, 0, -8]}}, rock=ELASTIC | law,
                   loads={"supports": [FLOOR]})  # fmt: skip
    sim.step(600)
    e = sim.energies
    assert e["plastic"] > 0.5 * e["start"]
    assert abs(e["error"]) < 2e-4


@pytest.mark.parametrize("law", LAWS, ids=name_of)
def test_flow_keeps_linear_and_angular_momentum(law):
    sim = simulate(box(), {"rock": {}}, rock=ELASTIC | law)
    x = sim.fields["position"] - [0.5, 0.5, 0.5]
    sim.motion[:, 4:7] = (
        np.cross([3.0, 5.0, -4.0], x) + x @ np.diag([-8.0, 3.0, 5.0]) + x[:, [1, 2, 0]] * [4, -6, 2]
    )
    p, spin = momentum(sim)
    sim.step(1000)
    assert sim.energies["plastic"] > 0.05 * sim.energies["start"]
    p_now, spin_now = momentum(sim)
    assert np.abs(p_now - p).max() < 1e-14 * np.abs(spin).max()
    assert np.abs(spin_now - spin).max() < 1e-13 * np.abs(spin).max()


def test_the_weak_plane_turns_with_the_rock():
    """The same cube, plane and pull, turned by 1 rad about y: the same slip.

    The plane dips by 20 deg towards +x; the turn takes x to z, so it steepens to 20 deg + 1 rad.
    """
    slips = []
    degrees = np.degrees(1)
    for angle in (0, degrees):
        r = turn([0, 1, 0], angle)
        blocks = box("hex8", (1, 1, 1))
        sim = simulate(blocks, {"rock": {}}, rock=ELASTIC | WEAK
                       | {"joint_dip": 20, "joint_dip_direction": 90})  # fmt: skip
        x = sim.fields["position"]
        middle = x.mean(axis=0)
        own = x - middle
        sim.motion[:, :3] = own @ r.T + middle
        sim.motion[:, 4:7] = (own @ np.array([[0, 0, 8.0], [0, 0, 3], [2, 0, -6]]).T) @ r.T
        sim.step(300)
        slips.append(state_of(sim, "joint_plastic_shear")[0])
    assert slips[0] > 1e-3
    assert slips[1] == pytest.approx(slips[0], rel=1e-9)


def mixed():
    """All laws side by side, in one run of elements."""
    blocks = [
        {"group": g, "box": {"size": [1, 1, 1], "divisions": [2, 3, 2], "shape": "tet4"},
         "translate": [1.5 * i, 0, 0]} for i, g in enumerate(("weak", "cone", "mass", "hard"))
    ]  # fmt: skip
    laws = {"weak": WEAK, "cone": CONE, "mass": MASS, "hard": {}}
    data = case(
        blocks,
        {g: {"velocity": [5, 0, -30], "material": g} for g in laws},
        loads={"supports": [FLOOR | {"surface": {"group": g, "normal": [0, 0, -1]}} for g in laws]},
        stages=[{"name": "hit", "mode": "dynamic", "duration": 0.02}],
        output={"every": 0.005},
        materials={g: {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.25} | law
                   for g, law in laws.items()},
    )  # fmt: skip
    return data


def test_results_are_the_same_bits_on_any_number_of_threads_and_after_resuming(tmp_path):
    whole = cdem.Simulation(mixed(), threads=1, output=tmp_path / "one")
    whole.run()
    assert all(share["ever"] for share in yielded_counts(whole).values())
    two = cdem.Simulation(mixed(), threads=2, output=tmp_path / "two")
    two.run_until(0.007)
    two.checkpoint()
    two.close()
    again = cdem.Simulation(mixed(), threads=1, output=tmp_path / "two", resume=True)
    again.run()
    assert digest(again) == digest(whole)


def test_yielded_tells_now_from_ever():
    """A cube pressed beyond its strength flows in shear now; let go, only what was is left."""
    top = {"surface": {"group": "rock", "normal": [0, 0, 1]}, "components": ["z"],
           "velocity": [0, 0, -0.5], "history": [[0, 1], [0.02, 1], [0.021, -1], [1, -1]]}  # fmt: skip
    rock = ELASTIC | {"law": "mohr-coulomb", "cohesion": "1 MPa", "friction_angle": 30}
    sim = simulate(box("hex8", (1, 1, 1)), {"rock": {}}, rock=rock,
                   loads={"supports": [FLOOR], "velocities": [top]},
                   stages=[{"name": "press", "mode": "dynamic", "duration": 1,
                            "damping": {"stiffness": 0.5}}])  # fmt: skip
    sim.step(1)
    assert yielded_of(sim)[0] == 0
    sim.run_until(0.02)
    assert yielded_of(sim)[0] == 1 + 4
    assert yielded_counts(sim) == {"rock": {"now": 1, "ever": 1}}
    sim.run_until(0.0225)
    assert yielded_of(sim)[0] == 4
    assert yielded_counts(sim) == {"rock": {"now": 0, "ever": 1}}
    assert json.loads(json.dumps(sim.summary("stopped")))["yielded"]["rock"]["ever"] == 1


def test_a_strength_factor_goes_with_a_factor_of_safety():
    from cdem.case.laws import BLOCK_LAWS

    rock = case(box(), {"rock": {}}, rock=MASS | {"strength_factor": 1.5}).materials["rock"]
    assert BLOCK_LAWS["hoek-brown"].reduced(rock, 2) == {"strength_factor": 3}


def test_large_strain_is_told_and_ends_a_run(tmp_path):
    """A cube pressed to 0.7 of its height is told of, with its place; pulled to 2.3 times it, the run ends."""
    rock = ELASTIC | {"law": "mohr-coulomb", "cohesion": "1 MPa", "friction_angle": 0}
    top = {"surface": {"group": "rock", "normal": [0, 0, 1]}, "components": ["z"],
           "velocity": [0, 0, -2]}  # fmt: skip
    parts = {"rock": rock, "loads": {"supports": [FLOOR], "velocities": [top]},
             "time": {"energy_error": "any"}, "output": {"every": 0.05}}  # fmt: skip

    def press(time, folder):
        stage = {
            "name": "press",
            "mode": "dynamic",
            "duration": time,
            "damping": {"stiffness": 0.5},
        }
        this = case(box("hex8", (1, 1, 1)), {"rock": {}}, stages=[stage], **parts)
        return cdem.Simulation(this, threads=1, output=tmp_path / folder)

    sim = press(0.15, "told")
    sim.run()
    (strain,) = large_strains(sim)
    assert strain.state == "plastic_shear" and 0.25 < strain.value < 0.45
    assert strain.place[2] == pytest.approx(0.35, abs=1e-3)
    assert "above elements.strain_limit 0.2" in (tmp_path / "told/run.log").read_text()
    assert "above elements.strain_limit 0.2" in sim.summary("finished")["large_strains"][0]
    with pytest.raises(cdem.errors.UnstableError, match="a run ends above 1"):
        top["velocity"] = [0, 0, 2]
        press(0.65, "ended").run()


SOFT = {
    "law": "mohr-coulomb", "young_modulus": "1 GPa", "cohesion": "1 MPa", "friction_angle": 30,
    "dilation_angle": 10, "tensile_strength": "0.5 MPa",
    "softening": {"cohesion": [[0, "1 MPa"], ["5 mm", "0.5 MPa"], ["1 cm", "0.1 MPa"]],
                  "fracture_energy": "1 kJ/m2"},
}  # fmt: skip


def test_energy_closes_while_rock_softens():
    sim = simulate(
        box(), {"rock": {"velocity": [0, 0, -5]}}, rock=SOFT, loads={"supports": [FLOOR]}
    )
    sim.step(600)
    assert sim.energies["plastic"] > 0.5 * sim.energies["start"]
    assert abs(sim.energies["error"]) < 1e-3


def test_a_cube_that_softens_bears_its_residual_strength():
    """Uniaxial: 2 c_r (tan phi + sqrt(1 + tan^2 phi)) = 0.2 * 1.7320508 MPa, without dilation."""
    rock = SOFT | {"dilation_angle": 0, "softening": {"cohesion": [[0, 1e6], [0.01, 1e5]]}}
    top = {"surface": {"group": "rock", "normal": [0, 0, 1]}, "components": ["z"],
           "velocity": [0, 0, -0.2], "history": [[0, 0], [0.02, 1], [0.2, 1], [0.21, 0.001]]}  # fmt: skip
    sim = simulate(box("hex8", (1, 1, 1)), {"rock": {}}, rock=rock,
                   loads={"supports": [FLOOR], "velocities": [top]},
                   stages=[{"name": "press", "mode": "dynamic", "duration": 0.3,
                            "damping": {"stiffness": 0.5}}])  # fmt: skip
    sim.run()
    assert -stress_of(sim)[0, 2] == pytest.approx(2e5 * np.sqrt(3), rel=1e-3)


@pytest.mark.parametrize(
    "wrong, told",
    [
        ({"softening": {"cohesion": [[0, 2e6], [1, 1e6]]}}, r"must begin with \[0, 1e\+06\]"),
        ({"softening": {"cohesion": [[0, 1e6], [1, 2e6]]}}, "must fall or stay"),
        ({"softening": {"cohesion": [[0, 1e6], [0, 1e5]]}}, "slips must increase"),
        ({"softening": {"cohesion": [[0, 1e6]]}}, "takes 2 to 8 rows, got 1"),
        ({"softening": {"joint_cohesion": [[0, 1e6], [1, 1]]}}, "has no such strength; it has coh"),
        ({"softening": {}}, "has no table; leave it out"),
        ({"softening": {"friction_angle": [[0, 30], [1, 5]]}}, "let dilation_angle fall as well"),
        ({"tensile_strength": None, "softening": {"fracture_energy": 1}}, "needs a tensile_strength"),
        ({"softening": {"tensile_strength": [[0, 5e5], [1, 0]], "fracture_energy": 1}}, "not both"),
        (MASS | {"softening": {"cohesion": [[0, 1]]}}, "law hoek-brown does not soften; give law: moh"),
    ],
)  # fmt: skip
def test_softening_that_cannot_be_is_refused(wrong, told):
    rock = wrong if "law" in wrong else SOFT | wrong
    with pytest.raises(cdem.CaseError, match=told):
        case(box(), {"rock": {}}, rock={k: v for k, v in rock.items() if v is not None})


@pytest.mark.parametrize(
    "softening, told",
    [
        ({"fracture_energy": 50}, r"by a factor of 1.25; it takes elements of 0.396 m at most \(here 0.5"),
        ({"cohesion": [[0, 1e6], [1e-3, 0]]}, "cohesion would fall faster than the element at"),
    ],
)  # fmt: skip
def test_rock_that_would_snap_back_is_refused(softening, told):
    """h A < E in tension: 0.5 m * T^2 / (2 G) = 1.25 GPa; h A < mu in shear."""
    with pytest.raises(cdem.CdemError, match=told):
        simulate(box(), {"rock": {}}, rock=SOFT | {"softening": softening})


def test_a_factor_of_safety_divides_tables_too():
    rock = case(box(), {"rock": {}}, rock=SOFT).materials["rock"]
    assert reduced_tables(rock, 2) == {"softening.cohesion": [(0, 5e5), (5e-3, 2.5e5), (0.01, 5e4)]}
