"""Water: buoyancy, pressure in joints, pores, level over time, excavation; against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import case, digest

import cdem
from cdem.rows import rows_of
from cdem.run.fields import surface_of

G = 9.81
UNIT = 1000 * G
ROCK = {"density": 2600, "young_modulus": 1e10, "poisson_ratio": 0.25}
STATIC = [{"name": "rest", "mode": "static", "tolerance": 1e-9, "relax": "adaptive"}]


def wet(blocks, groups=None, *, water, rock=None, **more):
    """A case under gravity with water; the group bed is held."""
    names = {block["group"]: {} for block in blocks}
    if "bed" in names:
        names["bed"] = {"fix": ["x", "y", "z"]}
    groups = {name: of | (groups or {}).get(name, {}) for name, of in names.items()}
    return case(
        blocks, groups, defaults=True, water=water, materials={"rock": ROCK | (rock or {})},
        loads={"gravity": [0, 0, -G], **more.pop("loads", {})},
        **{"stages": STATIC} | more,
    )  # fmt: skip


def start(*args, **kwargs):
    return cdem.Simulation(wet(*args, **kwargs), threads=1)


def water_on(sim, group=None):
    """Sum of the forces of water on a group [N]."""
    force = rows_of(sim.core, "node.water").force
    return force[sim.build.nodes_of(group)].sum(axis=0) if group else force.sum(axis=0)


def box(group, low=(0, 0, 0), size=(1, 1, 1), divisions=(1, 1, 1), shape="hex8", **more):
    return {
        "group": group,
        "box": {"size": list(size), "divisions": list(divisions), "shape": shape},
        "translate": list(low),
        **more,
    }


TURN = {"rotate": {"axis": [1, 2, 3], "angle": 40}}


@pytest.mark.parametrize("shape", ["hex8", "wedge6", "pyramid5", "tet4"])
@pytest.mark.parametrize("biot", [0, 1])
@pytest.mark.parametrize("more", [{}, TURN], ids=["upright", "turned"])
def test_buoyancy_is_exact(shape, biot, more):
    """rho_w g V upward, with blocks impermeable or full of pores."""
    block = box("block", size=[1, 1.5, 2], divisions=[2, 2, 2], shape=shape, **more)
    sim = start([block], water={"reservoir": {"level": 10}}, rock={"biot": biot})
    np.testing.assert_allclose(water_on(sim), [0, 0, UNIT * 3], atol=1e-9 * UNIT)


def test_the_pressure_on_faces_is_shown():
    """rho_w g z in a joint without strength, mean of the face; none on faces that are dry."""
    blocks = [box("bed", [0, 0, -1]), box("block", size=[1, 1, 4])]
    water = {"fields": [{"level": 3, "interface": "seam"}]}
    pairs = [{"name": "seam", "between": ["bed", "block"]}]
    sim = start(blocks, water=water, interfaces={"default": {"friction_angle": 30}, "pairs": pairs})
    places, faces, _, fields = surface_of(sim, {})
    middle = places[faces].mean(axis=1)
    in_seam = np.abs(middle[:, 2]) < 1e-6
    assert in_seam.sum() == 2
    np.testing.assert_allclose(fields["water_pressure"], np.where(in_seam, 3 * UNIT, 0), rtol=1e-12)


def test_pores_turn_with_the_rock():
    """Turned by 50 degrees, every node of a cube full of pores is lifted by its eighth, and not pushed."""
    sim = start([box("rock")], water={"reservoir": {"level": 10}}, rock={"biot": 1})
    c, s = np.cos(np.radians(50)), np.sin(np.radians(50))
    x = sim.motion[:, :3]
    x[:] = x @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    sim.core.find_applied()
    force = rows_of(sim.core, "node.water").force
    np.testing.assert_allclose(force, np.tile([0, 0, UNIT / 8], (8, 1)), atol=1e-9 * UNIT)


@pytest.mark.parametrize("shape", ["hex8", "tet4"])
def test_a_sunken_block_presses_less_on_its_bed(shape):
    """25,506 N dry, 15,696 N under water; the water in the joint below counts."""
    blocks = [box("bed", [0, 0, -1], shape=shape), box("block", shape=shape)]
    for level, force in ((-5, 2600 * G), (10, 1600 * G)):
        sim = start(blocks, water={"reservoir": {"level": level}})
        sim.run()
        bed = sim.build.nodes_of("bed")
        carried = sim.fields["reaction"][bed, 2].sum() - 2600 * G  # its own weight
        carried += water_on(sim, "bed")[2]
        assert carried == pytest.approx(force, rel=2e-5)  # the block is squeezed a little


@pytest.mark.parametrize("parts", [[600], [1, 199, 400]], ids=["at once", "in parts"])
def test_held_rock_carries_its_water_at_any_time(parts):
    """A bed that is held in all directions under water that rises: its supports carry its weight
    and the pressure on its top, 4 m2 times gamma (level - 1 m), in whatever calls the run is made."""
    rise = [[0, 2.0], [0.5, 12.0]]
    sim = start(
        [box("bed", size=[2, 2, 1], divisions=[2, 2, 1])],
        water={"reservoir": {"box": {"min": [-1, -1, 0.9], "max": [5, 5, 50]}, "level": rise}},
        stages=[{"name": "rise", "mode": "dynamic", "duration": 0.4}],
    )
    for steps in parts:
        sim.step(steps)
    last = sim.time / sim.step_count
    level = 2 + 20 * (sim.time - last)  # the forces of a step are those of its begin
    carried = rows_of(sim.core, "node.reaction").force[:, 2].sum()
    right = 4 * 2600 * G + 4 * UNIT * (level - 1)
    assert carried == pytest.approx(right, rel=1e-12)
    assert carried + water_on(sim)[2] == pytest.approx(4 * 2600 * G, rel=1e-12)


def test_a_floating_block_bobs():
    """T = 2 pi sqrt(m / (rho_w g A)); energy stays."""
    block = box("block", [0, 0, -0.4])
    stages = [{"name": "bob", "mode": "dynamic", "duration": 3}]
    sim = start([block], water={"reservoir": {"level": 0}}, stages=stages,
                rock={"density": 500, "young_modulus": 1e8})  # fmt: skip
    period = 2 * np.pi * np.sqrt(500 / UNIT)
    for half in range(1, 5):
        sim.run_until(half * period / 2)
        height = sim.fields["position"][:, 2].mean()
        assert height == pytest.approx(0.1 * (-1) ** half, abs=3e-4)
    assert abs(sim.energies["error"]) < 3e-9
    weight = 500 * G * (height - 0.1)
    assert sim.energies["external"] == pytest.approx(-weight, rel=0.02, abs=1)


def test_a_dam_face_feels_the_triangle_of_pressure():
    """rho_w g h^2 / 2 a metre, whether the water ends at a vertex or inside a face."""
    blocks = [box("dam", size=[1, 2, 3], divisions=[1, 1, 3], shape=s) for s in ("hex8", "tet4")]
    near = {"min": [-0.1, -9, -9], "max": [0.1, 9, 9]}
    for block, tolerance in zip(blocks, (2e-3, 1e-12), strict=True):
        for level in (2.0, 2.4, 2.9):
            sim = start([block], water={"reservoir": {"level": level, "box": near}})
            assert water_on(sim)[0] == pytest.approx(UNIT * level**2, rel=tolerance)


def test_pressure_in_a_joint_lifts_what_lies_on_it():
    """A formula on one interface; the wall below feels the opposite."""
    blocks = [
        box("bed", [0, 0, -1], [4, 1, 1], [4, 1, 1]),
        box("dam", [0, 0, 0], [4, 1, 2], [4, 1, 2]),
    ]
    interfaces = {
        "default": {"friction_angle": 30},
        "pairs": [{"name": "base", "between": ["bed", "dam"], "friction_angle": 30}],
    }
    water = {"fields": [{"interface": "base", "formula": "1000 * max(0, 4 - x)"}]}
    sim = start(blocks, water=water, interfaces=interfaces)
    assert water_on(sim, "dam")[2] == pytest.approx(8000, rel=1e-12)
    assert water_on(sim, "bed")[2] == pytest.approx(-8000, rel=1e-12)
    assert sim.audit.as_dict()["water"]["wet_area"] == pytest.approx(8)


@pytest.mark.parametrize(("wet", "biot", "force"), [
    ("auto", 0, 0), ("auto", 1, 1), ("always", 0, 1), ("broken", 1, 0), ("never", 0, 0),
])  # fmt: skip
def test_when_water_enters_a_bonded_joint(wet, biot, force):
    blocks = [box("bed", [0, 0, -1]), box("top")]
    strong = {"default": {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}}
    water = {"fields": [{"level": 1, "wet": wet}]}
    sim = start(blocks, water=water, interfaces=strong, rock={"biot": biot})
    assert water_on(sim, "top")[2] == pytest.approx(force * UNIT, abs=1e-6)
    if wet == "broken":  # pulled off
        weak = {"interfaces.default.cohesion": 10, "interfaces.default.tensile_strength": 10}
        stages = [{"name": "a", "mode": "dynamic", "duration": 1e-3, "set": weak}]
        sim = start(blocks, water=water, interfaces=strong, rock={"biot": biot}, stages=stages,
                    groups={"top": {"velocity": [0, 0, 0.1]}})  # fmt: skip
        sim.step(20)
        assert water_on(sim, "top")[2] == pytest.approx(UNIT, rel=1e-3)


def test_water_of_a_joint_stays_off_the_face_of_a_slope():
    """A slice slips on a joint that daylights and touches the upper edge of the face below: the water
    of both walls cancels, and none stands on the face."""
    joint = {
        "name": "j",
        "group": "rock",
        "dip": 30,
        "dip_direction": 90,
        "spacing": 9,
        "origin": [2, 0.5, 0.7],
    }
    held = [{"surface": {"group": "rock", "normal": [0, 0, -1]}, "fix": ["x", "y", "z"]}]
    water = {"fields": [{"plane": {"point": [2, 0, 1], "dip": 30, "dip_direction": 90}}]}
    sim = start([box("rock", size=[2, 1, 3])], model={"joints": [joint]}, water=water,
                loads={"supports": held}, interfaces={"default": {"friction_angle": 15}},
                stages=[{"name": "slip", "mode": "dynamic", "duration": 0.3}])  # fmt: skip
    walls = UNIT * 0.3 * 2 / np.cos(np.radians(30))
    for end in (0.1, 0.2, 0.3):
        sim.run_until(end)
        assert np.abs(water_on(sim)).max() < 0.02 * walls


def test_a_joint_that_slips_keeps_its_water():
    """Walls of several faces: vertices that come over the neighbours of their mates stay wet."""
    size, many = [4, 1, 1], [16, 4, 1]
    blocks = [box("bed", [0, 0, -1], size, many, "tet4"), box("top", [0, 0, 0], size, many, "tet4")]
    water = {"fields": [{"formula": "1000", "aperture": "1 cm"}]}
    sim = start(blocks, water=water, loads={"gravity": [0, 0, -1e-3]},
                stages=[{"name": "slip", "mode": "dynamic", "duration": 1}],
                groups={"top": {"velocity": [1, 0, 0.01]}})  # fmt: skip
    sim.run_until(0.2)  # 0.8 of a face; open by 2 mm
    assert water_on(sim, "top")[2] == pytest.approx(3800, rel=0.05)
    assert water_on(sim, "top")[2] == pytest.approx(-water_on(sim, "bed")[2], rel=0.05)


def test_a_joint_that_opens_wide_loses_its_water():
    """Up to the aperture the joint's pressure holds, beyond it what stands in the open: nothing."""
    blocks = [box("bed", [0, 0, -1]), box("top")]
    water = {"fields": [{"formula": "1000", "aperture": "1 mm"}]}
    sim = start(blocks, water=water, loads={"gravity": [0, 0, -1e-3]},
                stages=[{"name": "up", "mode": "dynamic", "duration": 1}],
                groups={"top": {"velocity": [0, 0, 0.1]}})  # fmt: skip
    sim.run_until(0.005)
    assert water_on(sim, "top")[2] == pytest.approx(1000, rel=1e-6)
    sim.run_until(0.02)
    assert water_on(sim, "top")[2] == 0


def test_level_plane_table_raster_and_ru(tmp_path):
    """The pressure in pores of one element by each kind of entry."""
    block = box("rock", [0, 0, 0], [2, 2, 2], [1, 1, 1])
    (tmp_path / "t.csv").write_text(
        "x,y,z,pressure\n"
        + "\n".join(
            f"{x},{y},{z},{1000 * (10 - z)}" for x in (-5, 5) for y in (-5, 5) for z in (-5, 5)
        )
    )
    (tmp_path / "t.asc").write_text(
        "ncols 3\nnrows 3\nxllcorner -3\nyllcorner -3\ncellsize 3\n" + "7 7 7\n" * 3
    )
    plane = {"point": [0, 0, 5], "dip": 45, "dip_direction": 90}
    kinds = [
        ({"level": 6}, UNIT * 5),
        ({"level": 6, "lift": 1}, UNIT * 6),
        ({"level": [[0, 6], [1, 9]]}, UNIT * 5),
        ({"level": 6, "history": [[0, 0.5], [1, 1]]}, UNIT * 2.5),
        ({"plane": plane}, UNIT * 3),  # falls by 1 m to the middle
        ({"plane": plane, "seepage": "parallel"}, UNIT * 3 / 2),
        ({"surface": str(tmp_path / "t.asc")}, UNIT * 6),
        ({"surface": str(tmp_path / "t.asc"), "lift": -2}, UNIT * 4),
        ({"table": str(tmp_path / "t.csv")}, 9000),
        ({"formula": "500 * z + x"}, 501),
        ({"ru": 0.5}, 0.5 * 2600 * G),
    ]
    for entry, pressure in kinds:
        sim = start([block], water={"fields": [entry]}, rock={"biot": 1})
        from cdem.run.fields import pore_pressure_of

        assert pore_pressure_of(sim)[0] == pytest.approx(pressure, rel=1e-9), entry


def test_water_in_pores_takes_from_the_stress():
    """A column at rest: the whole stress is the weight, the law bears it less biot p."""
    from cdem.run.fields import effective_stress_of, pore_pressure_of, stress_of

    column = box("rock", size=[1, 1, 8], divisions=[1, 1, 8])
    held = [{"surface": {"group": "rock", "normal": n}, "fix": [a]}
            for n, a in (([-1, 0, 0], "x"), ([1, 0, 0], "x"), ([0, -1, 0], "y"), ([0, 1, 0], "y"),
                         ([0, 0, -1], "z"))]  # fmt: skip
    sim = start([column], water={"fields": [{"level": 8}]}, loads={"supports": held},
                rock={"biot": 0.8, "saturated_density": 2700})  # fmt: skip
    sim.run()
    depth = 8 - (np.arange(8) + 0.5)
    whole, law, pores = stress_of(sim), effective_stress_of(sim), pore_pressure_of(sim)
    np.testing.assert_allclose(pores, UNIT * depth, rtol=5e-4)  # it settles
    np.testing.assert_allclose(whole[:, 2], -2700 * G * depth, rtol=1e-4)
    np.testing.assert_allclose(law[:, 2], whole[:, 2] + 0.8 * pores, rtol=1e-12)


@pytest.mark.parametrize("biot", [0, 0.7])
@pytest.mark.parametrize("shape", ["hex8", "tet4"])
def test_rock_under_water_begins_at_rest(biot, shape):
    """Overburden under a lake: weight of water and of saturated rock, joints less what presses in them."""
    blocks = [box("rock", [0, 0, k], [2, 2, 1], [2, 2, 2], shape) for k in range(3)]
    held = [{"surface": {"group": "rock", "normal": n}, "fix": [a]}
            for n, a in (([-1, 0, 0], "x"), ([1, 0, 0], "x"), ([0, -1, 0], "y"), ([0, 1, 0], "y"),
                         ([0, 0, -1], "z"))]  # fmt: skip
    sim = start(
        blocks, water={"reservoir": {"level": 5}}, loads={"supports": held},
        rock={"biot": biot, "saturated_density": 2700},
        initial_stress=[{"vertical": "overburden", "k0": 0.6}],
        stages=[{"name": "rest", "mode": "static", "tolerance": 1e-9}],
    )  # fmt: skip
    sim.step(1)
    assert sim.core.unbalance_ratio() < 1e-9


def test_water_that_falls_and_rises_gives_back_its_work():
    """An elastic block on rollers, slowly drowned and drained."""
    block = box("rock", size=[1, 1, 2], divisions=[1, 1, 2])
    held = [{"surface": {"group": "rock", "normal": [0, 0, -1]}, "fix": ["x", "y", "z"]}]
    level = [[0, 0], [0.2, 2], [0.4, 0]]
    sim = start([block], water={"reservoir": {"level": level}}, loads={"supports": held},
                rock={"young_modulus": 1e7},
                stages=[{"name": "tide", "mode": "dynamic", "duration": 0.4, "damping": {"mass": 30}}])  # fmt: skip
    sim.run()
    assert abs(sim.energies["error"]) < 1e-6


def test_what_is_dug_out_under_water_leaves_the_rest_as_it_was():
    """The force of water on the wall goes with the block, and is let go with what it bore."""
    blocks = [box("bed", [0, 0, -1]), box("low"), box("high", [0, 0, 1])]
    stages = [
        *STATIC,
        {
            "name": "dig",
            "mode": "static",
            "remove": ["high"],
            "release": {"to": 0},
            "tolerance": 1e-9,
        },
        {"name": "let go", "mode": "static", "release": {}, "tolerance": 1e-9},
    ]
    sim = start(blocks, water={"fields": [{"level": 2}]}, stages=stages)
    sim.run_stage("rest")
    before = sim.fields["position"].copy()
    nodes = sim.build.nodes_of("low")
    sim.run_stage("dig")
    settled = np.abs(before - sim.build.start_position)[nodes].max()
    assert np.abs(sim.fields["position"] - before)[nodes].max() < 1e-4 * settled
    sim.run_stage("let go")
    assert sim.core.unbalance_ratio() < 1e-9


def test_a_stage_raises_the_water():
    stages = [*STATIC, STATIC[0] | {"name": "rain", "set": {"water.fields.0.lift": 1}}]
    sim = start(
        [box("bed", [0, 0, -1]), box("top")], water={"fields": [{"level": 1}]}, stages=stages
    )
    sim.run_stage("rest")
    before = water_on(sim, "top")[2]
    sim.run_stage("rain")
    assert before == pytest.approx(UNIT, rel=1e-5)
    assert water_on(sim, "top")[2] == pytest.approx(2 * UNIT, rel=1e-5)


def test_a_stage_weakens_rock():
    """Strengths of a material may change: a pillar crushes once its cohesion falls."""
    rock = {"law": "mohr-coulomb", "cohesion": 1e7, "friction_angle": 30}
    weaker = {"materials.rock.cohesion": 1e4}
    stages = [*STATIC, {"name": "rot", "mode": "dynamic", "duration": 0.01, "set": weaker}]
    sim = start([box("rock", size=[1, 1, 4], divisions=[1, 1, 4])], rock=rock, stages=stages,
                water={"fields": [{"level": -9}]},
                loads={"supports": [{"surface": {"group": "rock", "normal": [0, 0, -1]}, "fix": ["z"]}]})  # fmt: skip
    sim.run_stage("rest")
    assert sim.energies["plastic"] == 0
    sim.run_stage("rot")
    assert sim.energies["plastic"] > 0


def test_a_stage_that_would_wet_other_faces_is_refused():
    stages = [*STATIC, STATIC[0] | {"name": "rain", "set": {"water.fields.0.wet": "always"}}]
    sim = start([box("bed", [0, 0, -1]), box("top")], stages=stages,
                water={"fields": [{"level": 1, "wet": "never"}]})  # fmt: skip
    sim.run_stage("rest")
    with pytest.raises(cdem.errors.CaseError, match="a stage cannot change the set of joints"):
        sim.run_stage("rain")


def test_a_resumed_run_knows_its_water_table(tmp_path):
    """A raster that is another one is refused; a case that moved finds its file."""
    raster = tmp_path / "t.asc"
    head = "ncols 3\nnrows 3\nxllcorner -3\nyllcorner -3\ncellsize 3\n"
    raster.write_text(head + "7 7 7\n" * 3)
    made = wet([box("rock")], water={"fields": [{"surface": str(raster)}]}, rock={"biot": 1},
               stages=[{"name": "a", "mode": "dynamic", "duration": 1}])  # fmt: skip
    first = cdem.Simulation(made, threads=1, output=tmp_path / "r")
    first.run_until(0.01)
    first.checkpoint()
    first.close()
    cdem.Simulation(made, threads=1, output=tmp_path / "r", resume=True).close()
    raster.write_text(head + "9 9 9\n" * 3)
    with pytest.raises(cdem.errors.CdemError):
        cdem.Simulation(made, threads=1, output=tmp_path / "r", resume=True)


def test_threads_and_resume_change_no_bit(tmp_path):
    joints = [{"name": "j", "dip": 30, "dip_direction": 70, "spacing": 0.6}]
    blocks = [box("bed", [-1, -1, -1], [5, 5, 1]), box("rock", [0, 0, 0], [3, 3, 3])]
    made = wet(
        blocks, water={"reservoir": {"level": [[0, 1], [0.05, 3]]}}, rock={"young_modulus": 1e8},
        model={"joints": [j | {"group": "rock"} for j in joints]},
        stages=[{"name": "a", "mode": "dynamic", "duration": 0.05}], output={"every": 0.02},
    )  # fmt: skip
    whole = cdem.Simulation(made, threads=1)
    whole.run()
    two = cdem.Simulation(made, threads=2)
    two.run()
    assert digest(whole) == digest(two)
    first = cdem.Simulation(made, threads=1, output=tmp_path / "r")
    first.run_until(0.02)
    first.checkpoint()
    first.close()
    again = cdem.Simulation(made, threads=2, output=tmp_path / "r", resume=True)
    again.run()
    assert digest(again) == digest(whole)


@pytest.mark.parametrize(("water", "says"), [
    ({}, "give fields, a reservoir, or both"),
    ({"fields": [{"level": 1, "ru": 0.1}]}, "level"),
    ({"fields": [{"formula": "w * 2"}]}, "x, y and z only; remove w"),
    ({"fields": [{"interface": "crack", "level": 1}]}, "no interface 'crack'"),
    ({"fields": [{"groups": ["rok"], "level": 1}]}, "did you mean rock"),
    ({"fields": [{"level": 1, "seepage": "parallel"}]}, "seepage: parallel goes with plane"),
    ({"fields": [{"ru": 0.1, "lift": 1}]}, "lift goes with"),
    ({"reservoir": {"level": [[1, 0], [0, 1]]}}, "times must increase"),
    ({"fields": [{"table": "none.csv"}]}, "none.csv"),
    ({"fields": [{"formula": "1 / (x - x)"}]}, "formula has no value"),
])  # fmt: skip
def test_mistakes_are_told(water, says):
    with pytest.raises(cdem.errors.CdemError, match=says):
        start([box("rock")], water=water, rock={"biot": 1})


def test_water_that_acts_nowhere_is_told():
    sim = start([box("rock")], water={"fields": [{"level": 1, "wet": "never"}]})
    assert any("water presses nowhere" in warning for warning in sim.audit.warnings)


@pytest.mark.parametrize(("change", "middle"), [("add", 1.5), ("remove", 2)])
def test_water_that_waits_for_a_stage_is_not_told(change, middle):
    """A lake beside which there is nothing yet, or whose bed is buried yet."""
    blocks = [box("rock", [0, 0, 2], [1, 1, 1]), box("dam", [0, 0, 1], [1, 1, 1])]
    around = {"min": [-1, -1, middle - 0.1], "max": [2, 2, middle + 0.1]}
    lake = {"reservoir": {"level": middle + 0.1, "box": around}}
    stages = [
        {"name": "dry", "mode": "dynamic", "duration": 0.01},
        {"name": "wet", "mode": "dynamic", "duration": 0.01, change: ["dam"]},
    ]
    bonded = {"default": {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}}
    sim = start(blocks, water=lake, stages=stages, interfaces=bonded)
    assert not any("water presses nowhere" in warning for warning in sim.audit.warnings)


@pytest.mark.parametrize(
    ("wet", "named", "presses"),
    [(None, True, True), ("auto", True, True), ("broken", True, False), (None, False, False)],
)
def test_a_bonded_joint_of_a_set_is_wet_by_default(wet, named, presses):
    """Water below a level h on both faces of an upright joint of width b: p g h / 2 on h b each.

    A bonded joint between groups that has no name is dry until it breaks.
    """
    width, level = 2.0, 3.0
    halves = [
        {
            "group": name,
            "box": {"size": [2, width, 4], "divisions": [1, 1, 4]},
            "translate": [x, 0, 0],
        }
        for name, x in (("left", 0), ("right", 2))
    ]
    whole = [{"group": "rock", "box": {"size": [4, width, 4], "divisions": [2, 1, 4]}}]
    joints = [{"name": "crack", "dip": 90, "dip_direction": 90, "origin": [2, 1, 2]}]
    strong = {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}
    field = {"name": "table", "level": level} | ({"wet": wet} if wet else {})
    groups = ["rock"] if named else ["left", "right"]
    this = cdem.Case(
        model={"blocks": whole, "joints": joints} if named else {"blocks": halves},
        materials={"rock": {"density": 2700, "young_modulus": 1e10, "poisson_ratio": 0.25}},
        groups={name: {"material": "rock", "fix": ["x", "y", "z"]} for name in groups},
        interfaces={"default": strong, "pairs": [strong | {"joint": "crack"}] if named else []},
        loads={"gravity": [0, 0, -9.81]},
        water={"fields": [field]},
        stages=[{"name": "rest", "mode": "static"}],
    )
    sim = cdem.Simulation(this, threads=1)
    water = rows_of(sim.core, "node.water").force
    pushed = 1000 * 9.81 * level**2 / 2 * width
    found = water[water[:, 0] > 0, 0].sum()
    assert found == pytest.approx(pushed if presses else 0.0, rel=1e-6)
