"""`relax: solve`: a static stage begins from the equilibrium of elements, bonds and contacts."""

from functools import partial

import numpy as np
import pytest
from scenes import case, simulate

from cdem import Simulation

BOND = {"friction_angle": 30, "cohesion": "1 GPa", "tensile_strength": "1 GPa"}
BASE = {"box": {"min": [-99, -99, -1e-6], "max": [99, 99, 1e-6]}, "fix": ["x", "y", "z"]}
SHAPES = {
    "tet4": {"group": "rock", "box": {"size": [3, 3, 4], "divisions": [3, 3, 4], "shape": "tet4"}},
    "hex8": {"group": "rock", "box": {"size": [3, 3, 4], "divisions": [3, 3, 4]}},
}


def rests(way, blocks, split="elements", tolerance=1e-7, stages=None, **more):
    """A simulation that has come to rest under gravity, with the last stage's way to it."""
    sim = simulate(
        blocks,
        more.pop("groups", {"rock": {}}),
        interfaces=more.pop("interfaces", {"default": BOND}),
        loads={"gravity": [3, 0, -9.81], "supports": [BASE]} | more.pop("loads", {}),
        stages=stages or [{"name": "rest", "mode": "static", "relax": way, "tolerance": tolerance}],
        model={"split": {"rock": split}, **more.pop("model", {})},
        **more,
    )
    assert sim.run() == "converged"
    return sim


def agree(solved, relaxed, within=1e-6, opened=1e-5):
    """Whether two runs have the same displacements and stored energies, and both ledgers close.

    Args:
        within: Relative error of displacements; energies have ten times as much.
        opened: Part of the external work that is missing behind the solve: the work of the forces is
            that of their means at the ends of each round.
    """
    a, b = solved.fields["displacement"], relaxed.fields["displacement"]
    assert np.abs(a - b).max() < within * np.abs(b).max()
    for term in ("strain", "contact", "external"):
        assert solved.energies[term] == pytest.approx(relaxed.energies[term], rel=10 * within)
    assert abs(solved.energies["error"]) < 1e-8
    assert abs(solved.energies["start"]) < opened * solved.energies["external"]


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("split", ["elements", "one"])
def test_bonded_blocks_and_whole_rock_rest_where_relaxation_takes_them(shape, split):
    """The rest of adaptive relaxation, in at most one more step."""
    solve, adaptive = (rests(way, [SHAPES[shape]], split=split) for way in ("solve", "adaptive"))
    assert solve.step_count <= 20 < adaptive.step_count
    agree(solve, adaptive)


def test_a_slender_cantilever_is_solved_for():
    """The first round turns its end without shortening it, so bonds pull; the next ones mend that."""
    beam = {"group": "rock", "box": {"size": [20, 1, 1], "divisions": [20, 1, 1], "shape": "tet4"}}
    wall = {"box": {"min": [-1e-6, -9, -9], "max": [1e-6, 9, 9]}, "fix": ["x", "y", "z"]}
    loads = {"gravity": [0, 0, -9.81], "supports": [wall]}
    solve, adaptive = (
        rests(way, [beam], loads=loads, tolerance=1e-5) for way in ("solve", "adaptive")
    )
    assert solve.step_count <= 20 < adaptive.step_count
    sag = [-sim.fields["displacement"][:, 2].min() for sim in (solve, adaptive)]
    assert sag[0] == pytest.approx(sag[1], rel=5e-5)


def test_soft_rock_turns_far():
    """A column of 40 MPa leans by 0.8 degrees: the first round stretches it, the next ones do not."""
    column = [{"group": "rock", "box": {"size": [2, 2, 6], "divisions": [2, 2, 6]}}]
    rock = {"young_modulus": "40 MPa", "density": 2000, "poisson_ratio": 0.2}
    solve, adaptive = (rests(way, column, rock=rock) for way in ("solve", "adaptive"))
    assert np.abs(solve.fields["displacement"]).max() > 0.08
    agree(solve, adaptive, opened=0.02)


def test_faces_that_do_not_conform():
    """A fine block bonded onto a coarse one: bonds of overlaps, hexahedra on tets."""
    blocks = [
        {"group": "rock", "box": {"size": [3, 3, 2], "divisions": [2, 2, 2], "shape": "tet4"}},
        {"group": "rock", "box": {"size": [3, 3, 2], "divisions": [3, 3, 2]}, "translate": [0, 0, 2]},
    ]  # fmt: skip
    solve, adaptive = (rests(way, blocks) for way in ("solve", "adaptive"))
    agree(solve, adaptive)


def test_a_block_that_lies_on_a_bed():
    """Contacts in touch bear as springs: without bonds, once they touch."""
    blocks = [
        {"group": "bed", "box": {"size": [6, 6, 1]}, "translate": [-3, -3, 0]},
        {"group": "rock", "box": {"size": [1, 1, 2], "divisions": [2, 2, 4]}, "translate": [0, 0, 1]},
    ]  # fmt: skip
    joint = {"friction_angle": 40}
    interfaces = {"default": BOND, "pairs": [{"between": ["rock", "bed"], **joint}]}
    loads = {"gravity": [1, 0, -9.81]}
    make = partial(rests, blocks=blocks, groups={"rock": {}, "bed": {}}, interfaces=interfaces)
    agree(make("solve", loads=loads), make("adaptive", loads=loads), within=5e-5)


def test_bolts_across_a_soft_joint():
    """Bars and dowels bear most of the weight of what they hold: without them the solve would fail."""
    blocks = [
        {"group": "rock", "box": {"size": [3, 3, 2], "divisions": [3, 3, 2]}},
        {"group": "top", "box": {"size": [3, 3, 2], "divisions": [3, 3, 2]}, "translate": [0, 0, 2]},
    ]  # fmt: skip
    soft = {"between": ["rock", "top"], "stiffness_n": "1 MPa/m", "stiffness_s": "1 MPa/m"}
    bolts = [
        {"name": f"b{k}", "type": "bar", "points": [[x, y, 4.0], [x, y, 0.1]]}
        for k, (x, y) in enumerate([(0.4, 0.6), (0.7, 2.4), (2.3, 0.5), (2.6, 2.2)])
    ]
    bar = {"area": "5 cm2", "young_modulus": "200 GPa", "yield_force": "5 MN", "dowel": True,
           "grout": {"stiffness": 1e9, "strength": 1e7}}  # fmt: skip
    make = partial(
        rests,
        blocks=blocks,
        groups={"rock": {}, "top": {}},
        interfaces={"default": BOND, "pairs": [BOND | soft]},
        loads={"gravity": [1, 0, -9.81]},
        model={"split": {"top": "elements"}},
        bolt_types={"bar": bar},
        bolts=bolts,
    )
    solve, adaptive = make("solve"), make("adaptive")
    assert solve.ended_stage.solved.startswith("solved in")
    agree(solve, adaptive, opened=1e-3)


def test_a_block_that_only_bolts_hold_is_left_to_steps():
    """It has a rest, which no spring of its bolts across their axes would find."""
    blocks = [
        {"group": "rock", "box": {"size": [3, 3, 2], "divisions": [3, 3, 2]}},
        {"group": "top", "box": {"size": [1, 1, 1]}, "translate": [1, 1, 2]},
    ]
    bar = {"area": "5 cm2", "young_modulus": "200 GPa", "yield_force": "5 MN",
           "grout": {"stiffness": 1e9, "strength": 1e7}}  # fmt: skip
    make = partial(
        rests,
        blocks=blocks,
        groups={"rock": {}, "top": {}},
        interfaces={
            "default": {"friction_angle": 40},
            "pairs": [BOND | {"between": ["rock", "rock"]}],
        },
        loads={"gravity": [0, 0, 9.81]},
        bolt_types={"bar": bar},
        bolts=[{"name": "b", "type": "bar", "points": [[1.5, 1.5, 3.0], [1.5, 1.5, 0.1]]}],
    )
    agree(make("solve"), make("adaptive"), within=1e-5, opened=0.05)


def test_excavation_in_parts(monkeypatch):
    """Each part that is let go is solved for; the rest is that of relaxation."""
    blocks = [
        {"group": "rock", "box": {"size": [6, 1, 4], "divisions": [6, 1, 4]}},
        {"group": "dug", "box": {"size": [2, 1, 4], "divisions": [2, 1, 4]}, "translate": [6, 0, 0]},
    ]  # fmt: skip

    def dig(way):
        rest = {"mode": "static", "relax": way, "tolerance": 1e-7}
        stages = [
            {"name": "rest", **rest},
            {"name": "dig", **rest, "remove": ["dug"], "release": {"parts": 3}},
        ]
        groups = {"rock": {}, "dug": {}}
        return rests(
            way, blocks, stages=stages, groups=groups, model={"split": {"dug": "elements"}}
        )

    told = []
    monkeypatch.setattr(Simulation, "tell", lambda _, text: told.append(text))
    solve, adaptive = dig("solve"), dig("adaptive")
    assert [text.split(" in ")[0] for text in told] == ["rest: solved", *3 * ["dig: solved"]]
    assert solve.step_count < 100 < adaptive.step_count
    agree(solve, adaptive)


def test_rock_that_breaks_goes_on_as_adaptive():
    """Where rest lies beyond a failure the solve is taken back, and no bit is lost."""
    weak = {"friction_angle": 30, "cohesion": "1 kPa", "tensile_strength": "1 kPa"}
    stage = {"name": "rest", "mode": "static", "max_steps": 300}
    make = partial(
        simulate,
        [SHAPES["hex8"]],
        {"rock": {}},
        interfaces={"default": weak},
        loads={"gravity": [9, 0, -9.81], "supports": [BASE]},
        model={"split": {"rock": "elements"}},
    )
    found = []
    for way in ("solve", "adaptive"):
        sim = make(stages=[stage | {"relax": way}])
        sim.run()
        found.append(sim)
    solve, adaptive = found
    assert "no rest nearby" in solve.ended_stage.solved
    assert sum(solve.broken.values()) > 0
    for name, field in solve.core.fields().items():
        assert np.array_equal(field, adaptive.core.fields()[name]), name
    assert {**solve.core.scalars()} == {**adaptive.core.scalars()}


def test_moving_supports_are_left_to_steps():
    """A plate that presses for 10 ms: at its start there is a rest, which is not what is asked for."""
    press = {
        "surface": {"group": "rock", "normal": [0, 0, 1]},
        "velocity": [0, 0, -0.01],
        "history": [[0, 1], [0.01, 1], [0.011, 0]],
    }
    make = partial(rests, blocks=[SHAPES["hex8"]], loads={"velocities": [press]})
    solve, adaptive = make("solve"), make("adaptive")
    assert solve.ended_stage.solved == ""
    assert solve.step_count == adaptive.step_count
    assert np.array_equal(solve.fields["displacement"], adaptive.fields["displacement"])


def test_threads_and_a_stop_behind_the_solve_change_no_bit(tmp_path):
    """One thread or two; stopped behind the first stage and resumed."""
    stages = [
        {"name": "rest", "mode": "static", "relax": "solve", "tolerance": 1e-6},
        {"name": "swing", "mode": "dynamic", "duration": 0.002, "set": {"loads.gravity": [0, 0, 0]}},
    ]  # fmt: skip

    def make(**how):
        model = case(
            [SHAPES["tet4"]],
            {"rock": {}},
            interfaces={"default": BOND},
            loads={"gravity": [3, 0, -9.81], "supports": [BASE]},
            stages=stages,
            model={"split": {"rock": "elements"}},
        )
        return Simulation(model, **{"threads": 1, **how})

    one, two, stopped = make(threads=1), make(threads=2), make(output=tmp_path / "run")
    for sim in (one, two):
        assert sim.run() == "finished"
    assert stopped.run(should_stop=lambda: stopped.step_count > 0) == "stopped"
    resumed = make(output=tmp_path / "run", resume=True)
    assert resumed.run() == "finished"
    assert resumed.finished_stages[0]["steps"] == one.finished_stages[0]["steps"]
    for sim in (two, resumed):
        for name, field in one.core.fields().items():
            assert np.array_equal(field, sim.core.fields()[name]), name
