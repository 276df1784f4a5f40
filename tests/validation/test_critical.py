"""`cdem critical`: the critical friction angle and the factor of safety of a block on a slope."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from scenes import case
from typer.testing import CliRunner

import cdem
from cdem.cli import app
from cdem.errors import CaseError
from cdem.run import stages
from cdem.run.behaviour import patience
from cdem.study.criterion import Criterion
from cdem.study.critical import find_critical, find_factor, parameter, strength_reduction
from cdem.study.strengths import keep_strengths

SLOPE = 30.0  # [deg]


def block_on_a_slope(friction_angle=45, **more):
    """A block that comes to rest at a friction angle of 60 degrees, and then gets another."""
    t = np.radians(SLOPE)
    return case(
        [
            {"group": "block", "box": {"size": [1, 1, 0.5]}, "translate": [1, 1, 0]},
            {"group": "bed", "box": {"size": [4, 3, 1]}, "translate": [0, 0, -1]},
        ],
        {"block": {}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={"default": {"friction_angle": 60}},
        loads={"gravity": [9.81 * math.sin(t), 0, -9.81 * math.cos(t)]},
        stages=[
            {"name": "settle", "mode": "static"},
            {
                "name": "decide",
                "mode": "static",
                "set": {"interfaces.default.friction_angle": friction_angle},
            },
        ],
        **more,
    )


def test_critical_friction_angle_is_the_slope():
    """The block slides when tan(phi) < tan(slope): the bracket of 0.01 degrees holds the slope."""
    reported = []
    found = find_critical(
        block_on_a_slope(),
        parameter("interfaces.default.friction_angle"),
        (50, 10),
        tolerance=0.01,
        threads=1,
        report=lambda found: reported.append(found.trials[-1].value),
    )
    assert found.failed <= SLOPE <= found.stable
    assert found.stable - found.failed <= 0.01
    failed = [t for t in found.trials if not t.stable]
    assert all(t.saw == "sliding" and t.steps <= 10_000 for t in failed)
    assert [t.value for t in found.trials] == reported


def test_strength_reduction_gives_the_factor_of_safety():
    """F = tan(phi) / tan(slope) without cohesion; phi is that of the last stage, not 60 degrees.

    Tolerance: the width of the bracket.
    """
    this = block_on_a_slope(friction_angle=45)
    found = find_critical(this, strength_reduction(), (1, 3), tolerance=0.002, threads=1)
    assert found.value == pytest.approx(1 / math.tan(math.radians(SLOPE)), abs=0.002)


def test_search_is_deterministic_on_any_number_of_threads():
    """Two searches on one thread and one on two make the same trials with the same steps."""
    searches = [
        find_critical(
            block_on_a_slope(), strength_reduction(), (1, 3), tolerance=0.5, threads=threads
        )
        for threads in (1, 1, 2)
    ]
    assert searches[0] == searches[1] == searches[2]


def test_search_over_a_parameter_that_changes_the_model():
    """The steepest slope on which friction of 35 degrees holds the block: each trial builds a model."""
    model = {"rotate": {"axis": [0, 1, 0], "angle": 0}}
    this = block_on_a_slope(friction_angle=35, model=model)
    this.set("loads.gravity", [0, 0, -9.81])
    found = find_critical(this, parameter("model.rotate.angle"), (33, 38), tolerance=3, threads=1)
    assert (found.stable, found.failed) == (33, 35.5)


def test_failure_criterion_can_be_set():
    """With at most 50 steps a trial fails because it has not come to rest."""
    found = find_critical(
        block_on_a_slope(),
        parameter("interfaces.default.friction_angle"),
        (50, 10),
        tolerance=10,
        criterion=Criterion(most_steps=50),
        threads=1,
    )
    failed = [trial for trial in found.trials if not trial.stable]
    assert failed and all(trial.steps == 50 for trial in failed)
    assert failed[0].why.startswith("no rest in 50 steps")
    assert Criterion.read(["far=2", "stall_steps=100"]) == Criterion(far=2, stall_steps=100)
    with pytest.raises(
        CaseError, match="--criterion stal_steps=1: stal_steps: unknown key; did you mean"
    ):
        Criterion.read(["stal_steps=1"])


def test_bracket_without_failure_is_an_error():
    """Friction of 40 and of 50 degrees holds a block on a slope of 30 degrees."""
    with pytest.raises(CaseError, match="both 40 and 50 come to rest"):
        find_critical(
            block_on_a_slope(),
            parameter("interfaces.default.friction_angle"),
            (40, 50),
            tolerance=1,
            threads=1,
        )


def test_factor_finds_its_own_bracket():
    """From 1 by 1.5 upwards where the block rests, downwards where it slides: F = 1.73 and 0.34."""
    for angle, low, high in ((45, 1.5, 2.25), (11, 1 / 2.25 / 1.5, 1 / 2.25)):
        found = find_critical(
            block_on_a_slope(friction_angle=angle),
            strength_reduction(),
            None,
            tolerance=1,
            threads=1,
        )
        assert (found.stable, found.failed) == pytest.approx((low, high))
    held = block_on_a_slope()
    held.set("groups.block.fix", ["x", "y", "z"])
    with pytest.raises(CaseError, match="come to rest: check that the model can slide"):
        find_critical(held, strength_reduction(), None, tolerance=1, threads=1)


def test_command_line_prints_the_bracket(tmp_path, monkeypatch):
    """The bracket goes to stdout as JSON and into a file, the trials and the criterion to stderr."""
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "slope.yaml"
    file.write_text(block_on_a_slope().dump())
    words = ["critical", str(file), "--between", "41", "20", "--tolerance", "3", "--threads", "1"]
    done = CliRunner().invoke(
        app, [*words, "--parameter", "interfaces.default.friction_angle", "--json"]
    )
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert found["failed"] < SLOPE < found["stable"]
    name = "slope.interfaces.default.friction_angle"
    assert json.loads((tmp_path / f"{name}.json").read_text()) == found
    assert (tmp_path / f"{name}.failed.png").stat().st_size > 1000
    assert "stable: at rest (" in done.stderr and "steps, block has moved" in done.stderr
    assert "a trial fails when a body gains speed under a steady force" in done.stderr
    wrong = CliRunner().invoke(app, [*words, "--parameter", "materials.rock.densty"])
    assert isinstance(wrong.exception, CaseError)
    assert "did you mean density?" in str(wrong.exception)


def anchored_block():
    """A block held by a rod across its joint, once friction of 20 degrees alone cannot hold it."""
    rod = {"area": 1e-5, "young_modulus": 3e10, "yield_force": 1e9}
    line = {"name": "rod", "type": "rod", "points": [[1.9, 2.5, 0.4], [0.2, 2.5, -0.9]],
            "plate": True, "anchor": True}  # fmt: skip
    this = block_on_a_slope(20, bolt_types={"rod": rod}, bolts=[line])
    this.set("model.blocks.1.box.size", [6, 4, 1])
    this.set("model.blocks.0.translate", [1, 2, 0])
    return this


def slip_of_the_anchored_block():
    """W sin a = W cos a tan(phi) + T (cos b + sin b tan(phi)), T = E A / L cos(b) s [m]."""
    weight, a, t = 2500 * 0.5 * 9.81, math.radians(SLOPE), math.tan(math.radians(20))
    length = math.hypot(1.7, 1.3)
    cos_b, sin_b = 1.7 / length, 1.3 / length
    force = weight * (math.sin(a) - math.cos(a) * t) / (cos_b + sin_b * t)
    return force / (3e10 * 1e-5 / length * cos_b)


def test_a_trial_that_rests_says_after_how_much_slip():
    """An anchored block slips until its rod is tight, and past that by inertia: twice as far at most.

    With a bound on the way (--travel) the same trial has failed.
    """
    slip = slip_of_the_anchored_block()
    assert slip == pytest.approx(0.02, rel=0.01)
    vary, seen = parameter("interfaces.default.friction_angle"), {}
    for bound in (None, 0.01):
        found = find_critical(anchored_block(), vary, (40, 20) if bound else (20, 0.1), tolerance=20,
                              criterion=Criterion(far=0.05, most_moved=bound), threads=1)  # fmt: skip
        seen |= {(bound, trial.value): trial for trial in found.trials}
    free, bound = seen[None, 20], seen[0.01, 20]
    assert free.stable and free.saw == "at rest"
    assert slip <= free.moved <= 2 * slip
    assert f", block has moved {free.moved:.3g} m at (" in free.why
    assert not bound.stable and bound.saw == "sliding"
    assert bound.moved == free.moved and ", more than 0.01 m, and rests" in bound.why
    assert seen[0.01, 40].stable and seen[0.01, 40].moved < 1e-5


def test_command_line_bounds_the_way_to_rest(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "anchored.yaml").write_text(anchored_block().dump())
    words = ["critical", "anchored.yaml", "--parameter", "interfaces.default.friction_angle",
             "--between", "40", "20", "--tolerance", "20", "--threads", "1", "--json"]  # fmt: skip
    refused = CliRunner().invoke(app, words)
    assert "both 40 and 20 come to rest" in str(refused.exception)
    done = CliRunner().invoke(app, [*words, "--travel", "1 cm"])
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert found["criterion"]["most_moved"] == 0.01
    assert [trial["stable"] for trial in found["trials"]] == [True, False]
    assert found["trials"][1]["moved"] > 0.02
    assert "or rests after more than 0.01 m" in done.stderr


def test_a_run_that_rests_says_how_far_it_has_moved(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "anchored.yaml").write_text(anchored_block().dump())
    done = CliRunner().invoke(app, ["run", "anchored.yaml", "--threads", "1"])
    way = json.loads((tmp_path / "anchored.results/summary.json").read_text())
    way = way["groups"]["block"]["max_displacement"]
    assert way > 0.02
    assert done.stdout.startswith(f"converged, moved by up to {way:.3g} m (group block); results")
    told = CliRunner().invoke(app, ["info", "anchored.results"]).stdout
    assert f"converged, moved by up to {way:.3g} m (group block)" in told


WEDGE = """\
model:
  blocks:
    - group: rock
      polyhedron: {vertices: [[0, -17.53, 0], [0, 14.54, 0], [-9.3262, -17.53, 20],
        [-9.3262, 14.54, 20], [-24.48, -17.53, 20], [-24.48, 14.54, 20], [-24.48, -17.53, 0],
        [-24.48, 14.54, 0]]}
  joints:
    - {name: A, dip: 50, dip_direction: 45, origin: [-1.865231, 0, 4]}
    - {name: B, dip: 55, dip_direction: 130, origin: [-1.865231, 0, 4]}
materials: {rock: {density: 2600, young_modulus: "10 GPa", poisson_ratio: 0.25}}
groups: {rock: {material: rock}}
interfaces:
  default: {friction_angle: 30, stiffness_n: "1 GPa/m", stiffness_s: "1 GPa/m"}
  pairs:
    - {name: A, joint: A, friction_angle: 30, cohesion: "20 kPa"}
    - {name: B, joint: B, friction_angle: 25, cohesion: "30 kPa"}
loads:
  gravity: [0, 0, -9.81]
  supports:
    - {box: {min: [-99, -99, -1], max: [99, 99, 0.01]}, group: rock, fix: [x, y, z]}
    - {box: {min: [-99, -99, -1], max: [-24.47, 99, 99]}, group: rock, fix: [x, y, z]}
    - {box: {min: [-99, -99, -1], max: [99, -17.52, 99]}, group: rock, fix: [x, y, z]}
    - {box: {min: [-99, 14.53, -1], max: [99, 99, 99]}, group: rock, fix: [x, y, z]}
stages: [{name: rest, mode: static}]
"""


def test_a_wedge_with_cohesion_at_defaults(tmp_path):
    """Strengths kept: limit equilibrium of the wedge, with its reactions normal to both planes.

    F = (N_a tan 30 + N_b tan 25 + c_a A_a + c_b A_b) / (W sin(plunge)). As written, bonds break one
    after the other, and the factor lies between those with and without cohesion.
    """
    volume, areas = 489.785, np.array([135.139, 138.944])  # of the tetrahedral wedge [m3], [m2]
    weight = 2600 * 9.81 * volume

    def normal(dip, direction):
        d, a = np.radians([dip, direction])
        return np.array([np.sin(d) * np.sin(a), np.sin(d) * np.cos(a), np.cos(d)])

    a, b = normal(50, 45), normal(55, 130)
    line = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    line *= -np.sign(line[2])
    pull = -weight * line[2]
    pressed = np.linalg.lstsq(
        np.column_stack([a, b]), np.array([0, 0, weight]) + pull * line, rcond=None
    )[0]
    dry = pressed @ np.tan(np.radians([30, 25])) / pull
    exact = dry + areas @ [2e4, 3e4] / pull
    assert exact == pytest.approx(1.454, abs=1e-3)

    file = tmp_path / "wedge.yaml"
    file.write_text(WEDGE)
    found = find_factor(cdem.Case.load(file), tolerance=0.005, threads=1)
    assert found.may_lose == ["A", "B"]
    assert found.kept.value == pytest.approx(exact, rel=0.01)
    assert dry < found.written.stable < found.written.failed < 0.9 * exact
    assert 0 < sum(found.written.broken.values()) < 0.5
    (body,) = next(t for t in found.kept.trials if t.value == found.kept.failed).bodies
    assert body.volume == pytest.approx(volume, rel=1e-4)
    assert body.whole and body.blocks == 1 and body.groups == ["rock"]
    assert {slip.interface: round(slip.area) for slip in body.through} == {"A": 135, "B": 139}
    assert all(slip.slip == pytest.approx(body.moved, rel=0.05) for slip in body.through)


@pytest.mark.parametrize(("modulus", "within"), [(1e10, 0.02), (5e7, 0.2)])
def test_a_column_that_sags_far_does_not_slide(modulus, within):
    """Its sag is no failure, with one stage as with two; it tears off its bed at last.

    The bonds are at its corners: those uphill bear the bending moment on half of the area,
    T / F = 2 M / b^3 - N / b^2 with M = rho g_x h^2 b^2 / 2, N = rho g_z h b^2, b = 1 m.
    A soft column leans by 13 cm, which adds to the moment.
    """
    height, along, down = 4.5, 4.1, 8.9
    column = case(
        [
            {"group": "soil", "box": {"size": [1, 1, height], "divisions": [1, 1, 10]}},
            {"group": "bed", "box": {"size": [1, 1, 0.5]}, "translate": [0, 0, -0.5]},
        ],
        {"soil": {}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={"default": {"friction_angle": 60, "cohesion": 1e7, "tensile_strength": 1e7}},
        loads={"gravity": [along, 0, -down]},
        stages=[{"name": "settle", "mode": "static"}],
    )
    column.set("materials.rock.young_modulus", modulus)
    tension = 2500 * (along * height**2 - down * height)
    found = find_factor(column, tolerance=0.5, threads=1)
    assert found.kept.trials[0].stable and found.kept.trials[0].steps < 100
    assert found.kept.value == pytest.approx(1e7 / tension, rel=within)


def test_a_trial_waits_for_two_periods_of_a_column():
    """Rayleigh's quotient of a bar that hangs in its own weight, u = x (2 L - x): w^2 = 5 E / (2 rho L^2).

    Its error over the true first mode, w = pi c / (2 L), is 0.7 %.
    """
    length, rock = 60.0, {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.0}
    column = case(
        [{"group": "bar", "box": {"size": [1, 1, length], "divisions": [1, 1, 120]}}],
        {"bar": {}},
        rock=rock,
        loads={
            "gravity": [0, 0, -9.81],
            "supports": [
                {"box": {"min": [-1, -1, -1], "max": [2, 2, 0.01]}, "fix": ["x", "y", "z"]}
            ],
        },
        stages=[{"name": "rest", "mode": "static", "relax": "local"}],
    )
    sim = cdem.Simulation(column, threads=1)
    stages.begin(sim)
    period = 2 * math.pi * length * math.sqrt(2 * 2500 / (5 * 1e9))
    assert patience(sim) == pytest.approx(2 * period / float(sim.core.scalars()["dt"]), rel=0.01)


def test_nothing_holds_a_block_that_falls():
    """It is told once it has fallen past the edge of the model."""
    lone = block_on_a_slope()
    lone.set("model.blocks.0.translate", [9, 1, 0])
    lone.set("stages", [{"name": "fall", "mode": "static"}])
    said = "does not rest even with strengths 100 times as high .* past the edge of the model"
    with pytest.raises(CaseError, match=said):
        find_factor(lone, threads=1)


def slope_with_a_chip():
    """A block that slides at F = 1.73, and a small one on a smoother spot that does at 0.21."""
    this = block_on_a_slope()
    data = this.model_dump(exclude_unset=True)
    data["model"]["blocks"].append(
        {"group": "chip", "box": {"size": [0.2, 0.2, 0.2]}, "translate": [2.5, 1.3, 0]}
    )
    data["groups"]["chip"] = data["groups"]["block"]
    data["interfaces"]["pairs"] = [{"between": ["chip", "bed"], "friction_angle": 7}]
    data["stages"] = data["stages"][:1]
    data["interfaces"]["default"]["friction_angle"] = 45
    return cdem.Case(**data)


@pytest.mark.parametrize("limit", [{"ignore_below": 0.1}, {"group": "block"}])
def test_a_chip_that_slides_is_taken_out_and_told(limit):
    found = find_factor(
        slope_with_a_chip(), tolerance=0.02, criterion=Criterion(**limit), threads=1
    )
    assert found.kept.value == pytest.approx(1 / math.tan(math.radians(SLOPE)), abs=0.02)
    (chip,) = found.kept.trials[0].chips
    assert chip.groups == ["chip"] and chip.volume == pytest.approx(0.008)
    failed = next(t for t in found.kept.trials if t.value == found.kept.failed)
    assert [body.groups for body in failed.bodies] == [["block"]]


def test_a_chip_counts_where_none_is_ignored():
    found = find_factor(slope_with_a_chip(), tolerance=0.02, threads=1)
    exact = math.tan(math.radians(7)) / math.tan(math.radians(SLOPE))
    assert found.kept.value == pytest.approx(exact, abs=0.02)
    with pytest.raises(
        CaseError, match="--group chp: no such group in the model; it has: block, bed, chip"
    ):
        find_factor(slope_with_a_chip(), criterion=Criterion(group="chp"), threads=1)


def test_a_page_for_a_client(tmp_path, monkeypatch):
    """It has both factors, the body, strengths, actions, warnings and a picture, and loads nothing."""
    monkeypatch.chdir(tmp_path)
    text = WEDGE + 'title: "Wedge <A & B>"\nwater: {fields: [{name: table, level: 2}]}\n'
    Path("wedge.yaml").write_text(text)
    words = [
        "critical",
        "wedge.yaml",
        "--factor",
        "--tolerance",
        "0.2",
        "--threads",
        "1",
        "--report",
    ]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    page = Path("wedge.factor.html").read_text()
    assert "Wedge &lt;A &amp; B&gt;" in page and "<A & B>" not in page
    for part in (
        "kept as joints slip",
        "progressive failure: A, B may lose strength",
        "1 block of rock, 489.8 m3",
        "friction_angle 25 deg, cohesion 3e+04 Pa",
        "water.fields: {name: table, level: 2.0}",
        "loads.supports: {box:",
        "bonded or not (wet: auto)",
        "fails, sliding",
        "data:image/png;base64,",
        f"cdem {cdem.__version__}",
        "bonded pairs",
    ):
        assert part in page, part
    assert "http" not in page.replace("http-equiv", "") and "<script" not in page
    found = json.loads(Path("wedge.factor.json").read_text())
    assert found["as_written"]["value"] < found["value"]
    assert "factor, strengths kept: rests at" in done.stdout
    refused = CliRunner().invoke(
        app, [*words[:2], "--parameter", "loads.gravity.2", "--between", "-9", "-20", "--report"]
    )
    assert refused.exit_code == 2 and "--report goes with --factor" in refused.output


def test_a_stone_that_falls_before_the_search_is_no_travel():
    """It drops by 2 cm onto the bed; the block beside it slides at its friction angle.

    Blocks that rest after they have slid are told, with how far.
    """
    t = np.radians(10)
    blocks = [
        {"group": "block", "box": {"size": [1, 1, 0.5]}, "translate": [1, 1, 0]},
        {"group": "stone", "box": {"size": [1, 1, 0.5]}, "translate": [5, 1, 0.02]},
        {"group": "bed", "box": {"size": [9, 3, 1]}, "translate": [0, 0, -1]},
    ]
    data = case(
        blocks,
        {"block": {}, "stone": {}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={"default": {"friction_angle": 20}},
        loads={"gravity": [9.81 * math.sin(t), 0, -9.81 * math.cos(t)]},
        stages=[{"name": "rest", "mode": "static"}],
    )
    found = find_factor(data, criterion=Criterion(most_moved=0.01), threads=1).kept
    theory = math.tan(math.radians(20)) / math.tan(t)
    assert found.value == pytest.approx(theory, rel=0.01)
    assert found.slip == 0


def quarry_bench(*stones):
    """A bench with a fault and cracks, on which a wedge of three blocks slides; stones above a floor."""
    foot = [[0, 0, 0], [26, 0, 0], [20, 0, 22], [0, 0, 22]]
    rock = [*foot, *([x, 8, z] for x, _, z in foot)]
    blocks = [
        {"group": "rock", "polyhedron": {"vertices": rock}},
        {"group": "floor", "box": {"size": [8, 8, 2]}, "translate": [26, 0, -2]},
    ]
    blocks += [
        {"group": "stone", "box": {"size": 3 * [1.2]}, "translate": [28, 3 + 2 * k, gap]}
        for k, gap in enumerate(stones)
    ]
    soft = {"stiffness_n": "8 GPa/m", "stiffness_s": "3 GPa/m"}
    fault = {"friction_angle": 28, "cohesion": "55 kPa"} | soft
    joints = [
        {"name": "fault", "dip": 42, "dip_direction": 90, "origin": [25.2, 4, 3]},
        {"name": "cracks", "dip": 85, "dip_direction": 270, "origin": [11, 4, 22], "spacing": 6},
    ]
    return case(
        blocks,
        {"rock": {}, "floor": {"fix": ["x", "y", "z"]}} | ({"stone": {}} if stones else {}),
        model={"joints": joints},
        defaults=True,
        rock={"density": 2700, "young_modulus": 3e10, "poisson_ratio": 0.22},
        interfaces={
            "default": {"friction_angle": 35},
            "pairs": [
                {"name": "fault", "joint": "fault"} | fault,
                {"name": "cracks", "joint": "cracks", "friction_angle": 38} | soft,
            ],
        },
        loads={
            "gravity": [0, 0, -9.81],
            "supports": [
                {"surface": {"group": "rock", "normal": normal}, "fix": axes}
                for normal, axes in (
                    ([0, 0, -1], ["x", "y", "z"]),
                    ([-1, 0, 0], ["x"]),
                    ([0, -1, 0], ["y"]),
                    ([0, 1, 0], ["y"]),
                )
            ],
        },
        stages=[{"name": "rest", "mode": "static"}],
    )


def bench_by_hand():
    """Factor of the wedge between the face, the crack at (11, 22) and the fault, by limit equilibrium."""
    down, up = math.tan(math.radians(42)), math.tan(math.radians(85))
    ways = {"crack": (1, -1 / up, 11 - 22 / up), "face": (1, 6 / 22, 26)}
    rear, toe = (
        np.linalg.solve([[a, b], [down, 1]], [c, 3 + 25.2 * down]) for a, b, c in ways.values()
    )
    x, z = np.array([rear, toe, [20, 22], [11, 22]]).T
    weight = 2700 * 9.81 * 0.5 * abs(x @ np.roll(z, -1) - z @ np.roll(x, -1))
    holds = 55e3 * np.linalg.norm(toe - rear)
    holds += weight * math.cos(math.radians(42)) * math.tan(math.radians(28))
    return holds / (weight * math.sin(math.radians(42)))


def test_a_loose_stone_does_not_change_the_factor_of_the_rock():
    """A trial waits for the rock, not for the fall of the stone: the rock slid and caught on edges."""
    told = []
    alone, beside = (
        find_critical(
            keep_strengths(quarry_bench(*stones))[0],
            strength_reduction(keep=True),
            None,
            tolerance=0.01,
            threads=1,
            tell=told.extend,
        )
        for stones in ((), (0.4, 0.1))
    )
    assert alone.value == pytest.approx(bench_by_hand(), rel=0.01)
    assert (beside.stable, beside.failed) == (alone.stable, alone.failed)
    assert sum(t.steps for t in beside.trials) < 1.5 * sum(t.steps for t in alone.trials)
    (line,) = [text for text in told if "before the search" in text]
    assert "at rest after" in line and "stone has moved 0.4 m" in line
    shown = beside.body  # the fall is not in the picture
    ways, height = np.linalg.norm(shown.point_data["displacement"], axis=1), shown.points[:, 2]
    assert height[ways > 0.5 * ways.max()].min() > 2 and 0 < ways.max() < 0.05


@pytest.mark.slow
def test_a_loose_stone_does_not_change_a_critical_value():
    """It may fall in the first trial, also beside rock that slides there."""
    strong, weak = 900e3, 5e3
    alone, beside = (
        find_critical(
            quarry_bench(*stones),
            parameter("interfaces.pairs.0.cohesion"),
            (weak, strong),
            tolerance=5e3,
            threads=1,
        )
        for stones in ((), (0.4, 0.1))
    )
    assert (beside.stable, beside.failed) == (alone.stable, alone.failed)
    assert beside.trials[0].bodies[0].groups == ["rock"] and not beside.trials[0].stable
