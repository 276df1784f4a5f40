"""Boundaries of a model: faces, supports that end, forces that stay."""

import numpy as np
import pytest
from scenes import case

import cdem
from cdem.errors import CaseError
from cdem.model.boundaries import impedances, wave_forces
from cdem.model.damping import branches_of
from cdem.model.supports import held_components, supports_of

ROCK = {"density": 2600, "young_modulus": "10 GPa", "poisson_ratio": 0.25}
DOWN, EAST, WEST = ([0, 0, -1], [1, 0, 0], [-1, 0, 0])
STAGES = [
    {"name": "rest", "mode": "static", "tolerance": 1e-7, "relax": "solve"},
    {"name": "shake", "mode": "dynamic", "duration": 0.002},
    {"name": "stand", "mode": "static", "max_steps": 5, "relax": "adaptive"},
    {"name": "again", "mode": "dynamic", "duration": 0.002},
]
BLOCKS = [{"group": "a", "box": {"size": [4, 2, 2], "divisions": [4, 2, 2]}}]


def face(*normal, group="a"):
    return {"surface": {"group": group, "normal": list(normal)}}


def model(*boundaries, supports=None, blocks=BLOCKS, **more):
    """Rock on a base that is held, between two sides."""
    supports = supports or [face(*DOWN) | {"fix": ["x", "y", "z"]}, face(*EAST) | {"fix": ["x"]}]
    given = {"stages": STAGES} | more
    return case(blocks, {"a": {}}, rock=ROCK, boundaries=list(boundaries),
                loads={"gravity": [0, 0, -9.81], "supports": supports}, **given)  # fmt: skip


def quiet(name, *normal, **more):
    return {"name": name, "quiet": True, "stage": "shake"} | face(*normal) | more


def held(sim):
    """Components that are held now, shape (nodes, 3)."""
    support, component = (sim.build.arrays[f"support.{key}"] for key in ("row", "component"))
    return (support >= 0)[:, None] & (component.reshape(-1, 3)[np.maximum(support, 0)] != 0)


def test_supports_end_where_the_boundary_begins_and_their_forces_stay():
    sim = cdem.Simulation(model(quiet("base", *DOWN)), threads=1)
    z, x = sim.build.start_position[:, 2], sim.build.start_position[:, 0]
    sim.run_stage("rest")
    weight = sim.fields["reaction"][z == 0].sum(axis=0)
    assert weight[2] == pytest.approx(4 * 2 * 2 * 2600 * 9.81, rel=1e-6)
    sim.run_until(sim.time + 1e-9)
    assert not held(sim)[(z == 0) & (x < 4)].any()
    assert held(sim)[x == 4].tolist() == [[True, False, False]] * 9  # another support
    kept = sim.build.boundaries.kept
    # the component that the side still holds is left to it
    assert kept.sum(axis=0)[2] == pytest.approx(weight[2])
    assert (kept[x == 4, 0] == 0).all() and (kept[z > 0] == 0).all()


def test_nodes_of_boundaries_are_held_in_a_later_static_stage():
    sim = cdem.Simulation(model(quiet("base", *DOWN)), threads=1)
    base = sim.build.start_position[:, 2] == 0
    sim.run_stage("shake")
    there = sim.fields["position"][base].copy()
    sim.run_stage("stand")
    assert held(sim)[base].all()
    np.testing.assert_array_equal(sim.fields["position"][base], there)
    sim.run_stage("again")
    assert not held(sim)[base].all(axis=1).any()
    assert np.abs(sim.fields["position"][base] - there).max() < 1e-9


def test_the_number_of_supports_stays():
    sim = cdem.Simulation(model(quiet("base", *DOWN), quiet("east", *EAST)), threads=1)
    b = sim.build
    rows = []
    for begun in (0, 1, 2, 3):
        b.boundaries.follow(sim.case, begun)
        found = supports_of(sim.case, b.topology, b.group_names, [], b.boundaries)
        rows.append((len(found["component"]), held_components(found).sum()))
    assert [count for count, _ in rows] == [rows[0][0]] * 4
    # two supports of 15 and 9 nodes that share 3; none; all of them in x, y and z
    assert [many for _, many in rows] == [3 * 15 + 6, 3 * 15 + 6, 0, 3 * 21]


@pytest.mark.parametrize("normal, z", [([0, 0, -1], "xyz"), ([1, 0, 0], "zyx")])
def test_a_wave_pushes_with_twice_its_impedance(normal, z):
    """2 rho c_p v along the normal, 2 rho c_s v across it, times the area of 1 x 1 faces."""
    boundary = quiet(
        "base", *normal, input={"record": "r", "direction": [3, 0, 4], "motion": "upgoing"}
    )
    samples = {"samples": [0, 1, 2, 1, 0, -1, -2, -1, 0, 1, 0], "unit": "m/s", "step": 0.01}
    sim = cdem.Simulation(model(boundary, records={"r": samples | {"scale": 0.1}}), threads=1)
    (place,) = sim.build.boundaries.places
    nodes, force = wave_forces(sim.case, sim.build.topology, place, place.boundary.inputs[0])
    shear = np.sqrt(2600 * 4e9)
    speeds = np.array([shear, shear, np.sqrt(3) * shear])
    impedance = speeds if z == "xyz" else speeds[::-1]
    area = 8.0 if z == "xyz" else 4.0
    assert force.sum(axis=0) == pytest.approx(2 * area * impedance * [0.6, 0, 0.8])
    assert (nodes == place.nodes).all()


@pytest.mark.parametrize("reference", ["static", 2.0])
def test_waves_have_the_speed_of_the_middle_of_the_band(reference):
    """A branch stores g x^2/(1 + x^2) at x times its frequency; moduli are divided by the sum at 2 Hz."""
    band = {"ratio": 0.05, "band": [0.5, 50], "reference": reference}
    stages = [stage | {"damping": {"maxwell": band}} if stage["mode"] == "dynamic" else stage
              for stage in STAGES]  # fmt: skip
    sim = cdem.Simulation(model(quiet("base", *DOWN), stages=stages), threads=1)
    rest, shaken = (impedances(sim.case, ["a"], name)[0] for name in ("rest", "shake"))
    branches = branches_of(sim.case.stages[1].damping.maxwell)

    def storage(f):
        x2 = (f / np.array(branches.frequency)) ** 2
        return 1 + (branches.weight * x2 / (1 + x2)).sum()

    plain = np.sqrt(2600 * 4e9) * np.array([np.sqrt(3), 1])
    over = storage(5.0) / (1 if reference == "static" else storage(2.0))
    assert shaken == pytest.approx(np.sqrt(over) * plain)
    assert rest == pytest.approx(shaken)  # waves come with the next dynamic stage
    assert sim.build.arrays["surface_quads.impedance"][:2] == pytest.approx(shaken)


WRONG = {
    "twice": (dict(boundaries=[quiet("base", *DOWN), quiet("again", *DOWN)]), "are also in base"),
    "part": (dict(boundaries=[quiet("base", *DOWN)],
                  supports=[{"surface": {"group": ["a", "b"], "normal": DOWN}, "fix": ["z"]}]),
             r"base has 8 of the 9 faces of loads\.supports\.0"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_a_boundary_that_does_not_fit_is_one_clear_line(name):
    given, told = WRONG[name]
    blocks = [*BLOCKS, {"group": "b", "box": {"size": [1, 1, 1]}, "translate": [9, 0, 0]}]
    supports = given.get("supports", [])
    wrong = case(blocks, {"a": {}, "b": {}}, rock=ROCK, stages=STAGES, loads={"supports": supports},
                 boundaries=given["boundaries"])  # fmt: skip
    with pytest.raises(CaseError, match=told) as error:
        cdem.Simulation(wrong, threads=1)
    assert "\n" not in str(error.value) and "boundaries." in str(error.value)


def test_histories_of_a_boundary_split_its_motion(tmp_path):
    """An outcrop moves twice as far as the wave; what comes down is the base less that wave."""
    wave = {"record": "r", "direction": [1, 0, 0]}
    samples = [0, 1, 2, 1, 0, -1, -2, -1, 0, 1, 0]
    base = {"name": "base", "quiet": True, "input": wave} | face(*DOWN)
    history = [{"name": "foot", "boundary": "base", "quantities": ["v_base", "v_up", "v_down"],
                "every": 5e-4}]  # fmt: skip
    shaken = case(BLOCKS, {"a": {}}, rock=ROCK, boundaries=[base], histories=history,
                  waves={"allow_coarse": True},
                  stages=[{"name": "shake", "mode": "dynamic", "duration": 0.01}],
                  records={"r": {"samples": samples, "unit": "m/s", "step": 1e-3, "scale": 0.01}})  # fmt: skip
    simulation = cdem.Simulation(shaken, threads=1, output=tmp_path / "run")
    simulation.run()
    table = np.genfromtxt(tmp_path / "run/histories.csv", delimiter=",", names=True, deletechars="")
    along = {key: table[f"foot.{key}_x_[m/s]"] for key in ("v_base", "v_up", "v_down")}
    np.testing.assert_allclose(along["v_base"], along["v_up"] + along["v_down"], atol=1e-15)
    dt = simulation.core.scalars()["dt_last"]
    expected = np.interp(
        table["time_[s]"] - dt / 2, 1e-3 * np.arange(11), 5e-3 * np.array(samples), 0, 0
    )
    np.testing.assert_allclose(along["v_up"][2:], expected[2:], rtol=1e-6, atol=1e-9)
    assert np.abs(along["v_down"]).max() > 1e-3


@pytest.mark.parametrize(
    "history, told",
    [
        ({"boundary": "x", "quantities": ["v_up"]}, r"histories\.0\.boundary: no boundary 'x'"),
        ({"boundary": "base", "quantities": ["velocity"]}, r"velocity needs a group or a point"),
        ({"group": "a", "quantities": ["v_up"]}, r"v_up needs a boundary"),
    ],
)
def test_a_wrong_history_of_a_boundary_is_one_clear_line(history, told):
    with pytest.raises(CaseError, match=told):
        model(quiet("base", *DOWN), histories=[{"name": "h"} | history])
