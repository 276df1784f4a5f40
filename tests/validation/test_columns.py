"""Free fields: columns of ground beside the sides of a model."""

import numpy as np
import pytest
from scenes import case, digest

import cdem
from cdem.rows import rows_of

ROCK = {"density": 2000, "young_modulus": "1 GPa", "poisson_ratio": 0.3}
WAVE = {"samples": [0, 1, 3, 6, 3, 0, -4, -6, -2, 0, 1, 0], "unit": "m/s", "step": "10 ms"}
SIDES = {"west": [-1, 0, 0], "east": [1, 0, 0], "south": [0, -1, 0], "north": [0, 1, 0]}


def ground(
    *, sides=SIDES, turn=0.0, at=(0, 0, 0), shape="hex8", scale=1e-4, base=None, stage=None, **more
):
    """A box of ground, shaken from below along x and z; turned about z."""
    cosine, sine = np.cos(np.radians(turn)), np.sin(np.radians(turn))

    def turned(v):
        return [cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1], v[2]]

    box = {"size": [12, 8, 12], "divisions": [6, 4, 6], "shape": shape}
    base = base or {"quiet": True}
    given = {"record": "wave", "direction": turned([2, 0, 1])} | (
        {} if base.get("quiet") else {"kind": "rigid"}
    )
    faces = [
        {"name": name, "surface": {"group": "a", "normal": turned(normal)},
         "free_field": {"base": "base"}, "stage": stage}
        for name, normal in sides.items()
    ]  # fmt: skip
    model = case(
        [{"group": "a", "box": box, "rotate": {"axis": [0, 0, 1], "angle": turn},
          "translate": list(at)}],
        {"a": {}}, rock=ROCK, elements={"mass": "lumped"},
        records={"wave": WAVE | {"scale": scale}}, waves={"allow_coarse": True},
        boundaries=[{"name": "base", "surface": {"group": "a", "normal": [0, 0, -1]},
                     "input": given, "stage": stage} | base, *faces],
        **({"stages": [{"name": "shake", "mode": "dynamic", "duration": 0.15}]} | more),
    )  # fmt: skip
    return cdem.Simulation(model, threads=1)


def uneven(sim, at=0.0):
    """Largest difference of velocities at one height, over the largest velocity."""
    v, z = sim.fields["velocity"], sim.build.start_position[:, 2] - at
    level = np.round(z / 2).astype(int)
    return max(np.ptp(v[level == k], axis=0).max() for k in range(7)) / np.abs(v).max()


@pytest.mark.parametrize("base", [{"quiet": True}, {"quiet": False}], ids=["compliant", "rigid"])
def test_flat_ground_moves_as_one_column(base):
    sim = ground(base=base)
    sim.step(150)
    assert uneven(sim) < 8e-6  # reached 1.8e-6; strains of 1e-5 turn elements
    assert abs(sim.energies["error"]) < 1e-8
    bare = ground(base=base, sides={})
    bare.step(150)
    assert uneven(bare) > 0.1


DAMPINGS = {
    "rayleigh": {"rayleigh": {"ratio": 0.1, "frequency": 20}},
    "maxwell": {"maxwell": {"ratio": 0.1, "band": [2, 200]}},
    "reference": {"maxwell": {"ratio": 0.1, "band": [2, 200], "reference": 20}},
    "stiffness": {"stiffness": 0.3},
    "mass": {"mass": 20},
}


@pytest.mark.parametrize("damping", DAMPINGS.values(), ids=DAMPINGS)
def test_columns_are_damped_as_the_ground(damping):
    stages = [{"name": "shake", "mode": "dynamic", "duration": 0.15, "damping": damping}]
    sim = ground(stages=stages)
    sim.run()
    assert uneven(sim) < 8e-6  # reached 1.8e-6
    bare = ground()
    bare.run()
    there, without = sim.fields["velocity"], bare.fields["velocity"]
    assert np.abs(there - without).max() > 0.01 * np.abs(without).max()


@pytest.mark.parametrize("damping", [{}, *DAMPINGS.values()], ids=["none", *DAMPINGS])
def test_bonded_layers_move_as_one_column(damping):
    """The bond between two groups is a layer of the column."""
    boxes = [{"group": g, "box": {"size": [12, 8, 6], "divisions": [6, 4, 3]}, "translate": [0, 0, z]}
             for g, z in (("a", 0), ("b", 6))]  # fmt: skip
    sides = [
        {"name": name, "surface": {"group": ["a", "b"], "normal": normal},
         "free_field": {"base": "base"}}
        for name, normal in SIDES.items()
    ]  # fmt: skip
    base = {"name": "base", "surface": {"group": "a", "normal": [0, 0, -1]}, "quiet": True,
            "input": {"record": "wave", "direction": [2, 0, 1]}}  # fmt: skip
    strong = {"friction_angle": 30, "cohesion": "1 GPa", "tensile_strength": "1 GPa",
              "stiffness_n": "0.2 GPa/m", "stiffness_s": "0.1 GPa/m"}  # fmt: skip
    model = case(boxes, {"a": {}, "b": {}}, rock=ROCK, elements={"mass": "lumped"},
                 interfaces={"default": strong}, boundaries=[base, *sides],
                 waves={"allow_coarse": True}, records={"wave": WAVE | {"scale": 1e-4}},
                 stages=[{"name": "shake", "mode": "dynamic", "duration": 0.15,
                          "damping": damping}])  # fmt: skip
    sim = cdem.Simulation(model, threads=1)
    assert [one["levels"] for one in sim.audit.modules["columns"]] == [8] * 4
    sim.run()
    z, v = sim.build.start_position[:, 2], sim.fields["velocity"]
    for group, heights in (("a", (0, 4, 6)), ("b", (6, 8, 12))):
        inside = np.isin(np.arange(len(z)), sim.build.nodes_of(group))
        for height in heights:
            level = inside & (abs(z - height) < 1e-6)
            # reached 1.3e-6
            assert np.ptp(v[level], axis=0).max() < 8e-6 * np.abs(v).max()


def test_a_model_that_is_turned_moves_as_before():
    sims = [ground(turn=angle, scale=0.1) for angle in (0.0, 30.0)]
    turned = []
    for sim, angle in zip(sims, (0.0, np.radians(30.0)), strict=True):
        sim.step(100)
        x, v = sim.build.start_position, sim.fields["velocity"]
        top = np.argsort(x[:, 2], kind="stable")[-1]
        turned.append(v[top] @ [[np.cos(angle), -np.sin(angle), 0],
                                [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])  # fmt: skip
    assert np.abs(turned[0] - turned[1]).max() < 1e-9 * np.abs(turned[0]).max()


def test_a_model_far_away_moves_as_before():
    near, far = ground(scale=0.1), ground(scale=0.1, at=(1e5, -2e5, 3e4))
    for sim in (near, far):
        sim.step(100)
    size = np.abs(near.fields["velocity"]).max()
    assert np.abs(near.fields["velocity"] - far.fields["velocity"]).max() < 1e-5 * size


def test_a_run_in_parts_and_with_threads_has_the_bits_of_one():
    whole = ground(shape="tet4")
    whole.step(80)
    parts = cdem.Simulation(whole.case, threads=2)
    for steps in (1, 30, 49):
        parts.step(steps)
    assert digest(parts) == digest(whole)


def test_ground_that_rests_stays_where_it_is_and_its_columns_too():
    """Stress at the begin is not the column's: only its change acts."""
    fix = [
        {"surface": {"group": "a", "normal": normal}, "fix": list(axes)}
        for normal, axes in (([0, 0, -1], "xyz"), ([-1, 0, 0], "x"), ([1, 0, 0], "x"),
                             ([0, -1, 0], "y"), ([0, 1, 0], "y"))
    ]  # fmt: skip
    stages = [{"name": "rest", "mode": "static", "tolerance": 1e-8, "relax": "solve"},
              {"name": "shake", "mode": "dynamic", "duration": 0.3}]  # fmt: skip
    loads = {"gravity": [0, 0, -9.81], "supports": fix}
    sim = ground(stages=stages, stage="shake", scale=1e-12, loads=loads)
    sim.run_stage("rest")
    start = sim.fields["position"].copy()
    sim.run()
    assert np.abs(sim.fields["position"] - start).max() < 1e-9
    assert np.abs(rows_of(sim.core, "columns.after").velocity).max() < 1e-9


def test_a_side_that_leans_is_refused():
    with pytest.raises(cdem.errors.CaseError, match=r"boundaries\.1: west is no vertical plane"):
        ground(sides={"west": [0, 0, 1]})


def test_layers_that_are_not_bonded_are_refused():
    boxes = [
        {"group": g, "box": {"size": [4, 4, 2]}, "translate": [0, 0, z]} for g, z in ("a0", "b2")
    ]
    boxes = [b | {"translate": [0, 0, float(b["translate"][2])]} for b in boxes]
    with pytest.raises(cdem.errors.CaseError, match=r"b is not bonded to a below it"):
        cdem.Simulation(
            case(boxes, {"a": {}, "b": {}}, boundaries=[
                {"name": "base", "surface": {"group": "a", "normal": [0, 0, -1]}, "quiet": True},
                {"name": "side", "surface": {"group": ["a", "b"], "normal": [1, 0, 0]},
                 "free_field": {"base": "base"}}])
        )  # fmt: skip
