"""Ways to rest: local damping, kinetic and adaptive relaxation end in the same state."""

import numpy as np
import pytest
from scenes import case, irregular_tets, simulate

import cdem
from cdem.errors import UnstableError
from cdem.output.reader import SurfaceSeries

BOND = {"friction_angle": 30, "cohesion": "1 GPa", "tensile_strength": "1 GPa"}
SLOPE = [{"group": "slope", "box": {"size": [22, 15, 16], "divisions": [22, 15, 16]}}]
TETS = [{"group": "slope", "box": {"size": [3, 3, 3], "divisions": [3, 3, 3], "shape": "tet4"}}]


def settle(way, blocks, split, tolerance=1e-5, group="slope", **model):
    """Steps to rest under gravity on a fixed base, displacements, closing error."""
    base = {"min": [-99, -99, -1e-6], "max": [99, 99, 1e-6]}
    sim = simulate(
        blocks,
        {group: {}},
        interfaces={"default": BOND},
        loads={"gravity": [3, 0, -9.81], "supports": [{"box": base, "fix": ["x", "y", "z"]}]},
        stages=[{"name": "rest", "mode": "static", "relax": way, "tolerance": tolerance}],
        model={"split": {group: split}, **model},
    )
    assert sim.run() == "converged"
    return sim.step_count, sim.fields["displacement"].copy(), sim.energies["error"]


def test_adaptive_relaxation_of_5184_irregular_tets(tmp_path):
    """A fifth of the steps of local damping 0.8 or fewer (here 481 to 2,901), the same answer."""
    mesh = irregular_tets(tmp_path / "slope.vtk", [22, 15, 16], [12, 8, 9])
    local, expected, _ = settle("local", [], "one", group="default", **mesh)
    steps, found, error = settle("adaptive", [], "one", group="default", **mesh)
    assert steps <= local / 5
    assert np.abs(found - expected).max() < 1e-3 * np.abs(expected).max()
    assert abs(error) < 1e-9


def test_scaled_masses_end_with_their_stage(tmp_path):
    """A column that hung in adaptive relaxation swings with its own masses when gravity ends: period
    4 L / sqrt(E / rho)."""
    sim = simulate(
        [],
        {"default": {}},
        rock={"poisson_ratio": 0.0, "young_modulus": "10 GPa", "density": 2500},
        model=irregular_tets(tmp_path / "column.vtk", [1, 1, 4], [2, 2, 8]),
        loads={
            "gravity": [0, 0, -9.81],
            "supports": [{"box": {"min": [-9, -9, -1e-6], "max": [9, 9, 1e-6]}, "fix": ["x", "y", "z"]}],
        },
        stages=[
            {"name": "hang", "mode": "static", "relax": "adaptive", "tolerance": 1e-7},
            {"name": "swing", "mode": "dynamic", "duration": 4 * 4 / 2000, "set": {"loads.gravity": [0, 0, 0]}},
        ],
    )  # fmt: skip
    times, speeds = [], []

    def watch(_):
        if len(sim.finished_stages) == 1:
            times.append(sim.time)
            speeds.append(sim.fields["mass"] @ sim.fields["velocity"][:, 2])

    assert sim.run(progress=watch) == "finished"
    turn = np.flatnonzero(np.diff(np.sign(speeds)) < 0)[0]
    start = sim.time - 4 * 4 / 2000
    assert times[turn] - start == pytest.approx(2 * 4 / 2000, rel=0.03)
    assert abs(sim.energies["error"]) < 1e-3


def test_adaptive_relaxation_of_5280_hexahedra():
    """A third of the steps of local damping 0.8 or fewer (here 481 to 1,921), the same answer."""
    local, expected, _ = settle("local", SLOPE, "one")
    steps, found, error = settle("adaptive", SLOPE, "one")
    assert steps <= local / 3
    assert np.abs(found - expected).max() < 1e-3 * np.abs(expected).max()
    assert abs(error) < 1e-6


@pytest.mark.parametrize("way", ["kinetic", "adaptive"])
def test_bonded_tets_come_to_the_same_rest(way):
    _, expected, _ = settle("local", TETS, "elements", 1e-6)
    _, found, error = settle(way, TETS, "elements", 1e-6)
    assert np.abs(found - expected).max() < 1e-3 * np.abs(expected).max()
    assert abs(error) < 1e-3


def test_a_missed_contact_stops_a_checked_run():
    """`contact.check` compares with an all-pairs search; lists renewed too seldom fail it."""
    blocks = [
        {"group": "bed", "box": {"size": [3, 3, 1]}, "translate": [-1, -1, -1]},
        {"group": "block", "box": {"size": [1, 1, 1]}, "translate": [0, 0, 0.05]},
    ]
    groups = {"bed": {"fix": ["x", "y", "z"]}, "block": {"velocity": [0, 0, -10]}}
    stage = {"name": "drop", "mode": "dynamic", "duration": 0.01}
    simulate(blocks, groups, stages=[stage], contact={"check": True}).run()
    seldom = {"check": True, "refresh": 100000}
    with pytest.raises(UnstableError, match="all-pairs search"):
        simulate(blocks, groups, stages=[stage], contact=seldom).run()


def test_a_static_stage_ends_without_kinetic_energy_gained():
    """From lumped to exact masses: the ledger stays closed over the change of stage."""
    sim = cdem.Simulation(
        cdem.Case.from_dict(
            {
                "cdem": 1,
                "model": {"blocks": [{"group": "a", "box": {"size": [1, 1, 1]}}]},
                "materials": {
                    "rock": {"density": 2500, "young_modulus": 1e9, "poisson_ratio": 0.25}
                },
                "groups": {"a": {"material": "rock", "velocity": [1, 0, 0], "angular_velocity": [0, 3, 5]}},
                "interfaces": {"default": {"friction_angle": 0}},
                "stages": [
                    {"name": "one", "mode": "dynamic", "duration": 0.01, "damping": {"local": 0.5}},
                    {"name": "two", "mode": "dynamic", "duration": 0.01},
                ],
            }
        )
    )  # fmt: skip
    sim.run()
    assert abs(sim.energies["error"]) < 1e-3


@pytest.mark.parametrize("gap", [0, 0.5])
def test_what_cannot_rest_is_said(gap):
    """Two blocks upon a bed come to rest; above it under upward gravity they never do."""
    cube = {"size": [1, 1, 1]}
    sim = simulate(
        [
            {"group": "body", "box": cube, "translate": [0, 0, gap]},
            {"group": "top", "box": cube, "translate": [0, 0, 1 + gap]},
            {"group": "bed", "box": {"size": [4, 4, 1]}, "translate": [-1, -1, -1]},
        ],
        {"body": {}, "top": {}, "bed": {"fix": ["x", "y", "z"]}},
        loads={"gravity": [0, 0, 9.81 if gap else -9.81]},
        stages=[{"name": "rest", "mode": "static", "relax": "local", "max_steps": 12_000}],
    )
    warned = [w for w in sim.audit.warnings if "1 block has no support" in w]
    notes = []
    status = sim.run(progress=lambda p: notes.append(p.note))
    if gap:
        assert len(warned) == 2
        assert status == "max_steps"
        assert "no nearer to rest" in notes[-1]
    else:
        assert not warned
        assert status == "converged"
        assert not any(notes)


@pytest.mark.parametrize(
    ("damping", "divisions"), [({"local": 0.8}, [2, 2, 4]), ({"mass": 2e3}, [1, 1, 1])]
)
def test_damping_leaves_the_force_of_a_driven_end_alone(damping, divisions):
    """A bar that is pressed by v t presses back with E A v t / l at both ends.

    The bar of one element has no nodes that are free along it, which the mass damping would brake.
    """
    end = {"group": "slope", "normal": [0, 0, 1]}
    sim = simulate(
        [{"group": "slope", "box": {"size": [1, 1, 2], "divisions": divisions}}],
        {"slope": {}},
        rock={"poisson_ratio": 0.0, "young_modulus": "10 GPa"},
        loads={
            "supports": [{"surface": end | {"normal": [0, 0, -1]}, "fix": ["x", "y", "z"]}],
            "velocities": [
                {"surface": end, "components": ["z"], "velocity": [0, 0, -0.01],
                 "history": [[0, 0], [0.02, 1]]}
            ],
        },
        stages=[{"name": "press", "mode": "dynamic", "duration": 0.06, "damping": damping}],
    )  # fmt: skip
    sim.run()
    height, force = sim.build.start_position[:, 2], sim.fields["reaction"][:, 2]
    pressed = 1e10 * 0.01 * 0.05 / 2
    assert force[height < 0.01].sum() == pytest.approx(pressed, rel=0.01)
    assert force[height > 1.99].sum() == pytest.approx(-pressed, rel=0.01)


def test_the_wall_time_foreseen_leaves_out_held_rock():
    def foreseen(**bed):
        return simulate(
            [
                {"group": "bed", "box": {"size": [8, 8, 8], "divisions": [8, 8, 8]}},
                {"group": "block", "box": {"size": [1, 1, 1]}, "translate": [3, 3, 8]},
            ],
            {"bed": bed, "block": {}},
            stages=[{"name": "fall", "mode": "dynamic", "duration": 1}],
            time={"step": 1e-4},
        ).audit.wall_time()

    held, moved = foreseen(fix=["x", "y", "z"]), foreseen(fix=["x", "y"])
    assert moved - held == pytest.approx(1e4 * 512 / 2e6, rel=1e-6)


def test_where_nothing_acts_a_static_stage_ends_at_once():
    """Round-off over round-off is no unbalance, and no energy error either."""
    sim = simulate(
        [
            {"group": "bed", "box": {"size": [3, 3, 0.5], "divisions": [2, 2, 1]}, "translate": [0, 0, -0.5]},
            {"group": "rock", "box": {"size": [1, 1, 1], "divisions": [2, 2, 2]}, "translate": [1, 1, 0]},
        ],
        {"bed": {"fix": ["x", "y", "z"]}, "rock": {}},
        stages=[{"name": "rest", "mode": "static", "max_steps": 5000}],
    )  # fmt: skip
    assert sim.run() == "converged"
    assert sim.step_count < 100
    sim.step(100)
    assert abs(sim.energies["error"]) < 1e-6


def test_frames_keep_their_times_when_rows_would_be_closer_than_steps(tmp_path):
    """A tenth of output.every is shorter than a step: frames come by time all the same."""
    sim = cdem.Simulation(
        case(
            [{"group": "block", "box": {"size": [1, 1, 1]}}],
            {"block": {"velocity": [1, 0, 0]}},
            stages=[
                {"name": "fly", "mode": "dynamic", "duration": "6 ms"},
                {"name": "blink", "mode": "dynamic", "duration": 1e-30},
            ],
            time={"step": "0.1 ms"},
            output={"every": "0.3 ms"},
        ),
        output=tmp_path / "r",
        threads=1,
    )
    seen = []
    sim.run(progress=seen.append)
    series = SurfaceSeries(tmp_path / "r")
    times = series.times
    last, again = series[-1], series[len(series) - 1]
    assert last.time == times[-1] and (last.points == again.points).all()
    assert (last.faces == again.faces).all()
    with pytest.raises(IndexError):
        series[len(series)]
    assert len(times) >= 20
    assert np.abs(times[1:20] - 0.3e-3 * np.arange(1, 20)).max() < 0.11e-3
    assert {p.stage for p in seen} == {"fly", "blink"}


@pytest.mark.parametrize("step, warned", [("auto", 0), ("1 us", 0), ("20 ms", 1)])
def test_a_step_above_the_stable_one_is_warned_of(step, warned):
    sim = simulate(
        [{"group": "block", "box": {"size": [1, 1, 1]}}], {"block": {}}, time={"step": step}
    )
    assert len([w for w in sim.audit.warnings if "above the stable" in w]) == warned


def test_damping_that_ends_leaves_nothing_behind():
    """A block falls, first with local damping, then without: the ledger stays closed."""
    sim = simulate(
        [{"group": "a", "box": {"size": [1, 1, 1]}}],
        {"a": {}},
        loads={"gravity": [0, 0, -9.81]},
        stages=[
            {"name": "one", "mode": "dynamic", "duration": 0.01, "damping": {"local": 0.5}},
            {"name": "two", "mode": "dynamic", "duration": 0.01},
        ],
    )
    sim.run()
    assert sim.energies["damping"] > 0
    assert abs(sim.energies["error"]) < 1e-4  # 5e-3 where the last damping force is still counted
