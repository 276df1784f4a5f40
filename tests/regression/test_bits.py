"""The same case gives the same bits: threads, instruction sets, split runs, restarts, sleeping."""

import os
import subprocess
import sys

import numpy as np
import pytest
from scenes import case, digest

import cdem
from cdem import _instruction_sets, _native
from cdem.rows import rows_of

STAGES = [
    {"name": "rest", "mode": "static", "max_steps": 100},
    {
        "name": "fall",
        "mode": "dynamic",
        "duration": 0.006,
        "damping": {"contact": 0.1, "stiffness": 0.1},
        "set": {"interfaces.default.cohesion": 2e5, "interfaces.default.tensile_strength": 1e5},
    },
]


def breaking_cube(**more):
    """A cube of 384 bonded tets thrown at a bed, so that it breaks: every kernel has work."""
    return case(
        [
            {
                "group": "body",
                "box": {"size": [1, 1, 1], "divisions": [4, 4, 4], "shape": "tet4"},
                "translate": [0, 0, 0.002],
            },
            {"group": "bed", "box": {"size": [4, 4, 1]}, "translate": [-1, -1, -1]},
        ],
        {"body": {"velocity": [0.2, 0.1, -2]}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={"default": {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6}},
        rock={"young_modulus": "0.1 GPa"},
        loads={"gravity": [0, 0, -9.81]},
        stages=STAGES,
        model={"split": {"body": "elements"}},
        output={"every": 0.002},
        **more,
    )


def run_here(threads):
    sim = cdem.Simulation(breaking_cube(), threads=threads)
    sim.run()
    assert sum(sim.broken.values()) > 10
    return digest(sim)


def test_threads_give_identical_results():
    """Contributions are summed in an order that does not depend on the number of threads."""
    assert len({run_here(threads) for threads in (1, 2, 3, 7)}) == 1


CHILD = """
import sys
sys.path.insert(0, {tests!r})
sys.path.insert(0, {here!r})
from test_bits import run_here
print(run_here(2))
"""


@pytest.mark.slow  # quick: test_golden.py
def test_instruction_sets_give_identical_results():
    """Each instruction set that is built and that this machine has, in a process of its own."""
    here = os.path.dirname(__file__)
    code = CHILD.format(tests=os.path.dirname(here), here=here)
    flags = _instruction_sets.cpu_flags()
    found = set()
    for isa in _native.available:
        if not flags >= _instruction_sets.NEEDS[isa]:
            continue
        done = subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | {"CDEM_ISA": isa},
            capture_output=True,
            text=True,
            check=True,
        )
        found.add(done.stdout.strip())
    assert len(found) == 1


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A run without a stop, and its histories. Tests must not change it."""
    folder = tmp_path_factory.mktemp("run") / "whole"
    sim = cdem.Simulation(breaking_cube(), threads=2, output=folder)
    sim.run()
    return sim, (folder / "histories.csv").read_text()


@pytest.mark.parametrize("stops", [[3], [2, 5]])
def test_resumed_run_gives_identical_results(tmp_path, whole, stops):
    """Stopped and resumed, also twice, the run ends with the same bits and the same histories."""
    expected, histories = whole
    asked = 0

    def should_stop():
        nonlocal asked
        asked += 1
        return asked == limit

    broken = tmp_path / "broken"
    for number, limit in enumerate([*stops, None]):
        asked = 0
        sim = cdem.Simulation(breaking_cube(), threads=2, output=broken, resume=number > 0)
        status = sim.run(should_stop=should_stop if limit else None)
    assert status == "finished"
    assert digest(sim) == digest(expected)
    assert (broken / "histories.csv").read_text() == histories


def test_a_resumed_run_knows_which_blocks_have_bonds(tmp_path):
    """By default bonded blocks move lumped masses: not stored, but found again."""

    def cube():
        return breaking_cube(defaults=True)

    expected = cdem.Simulation(cube(), threads=2)
    expected.run()
    lumped = expected.core.rebuilt()["node.lumped"]
    assert lumped.any() and not lumped.all()
    asked = 0

    def should_stop():
        nonlocal asked
        asked += 1
        return asked == 4

    stopped = cdem.Simulation(cube(), threads=2, output=tmp_path / "run")
    assert stopped.run(should_stop=should_stop) == "stopped"
    resumed = cdem.Simulation(cube(), threads=1, output=tmp_path / "run", resume=True)
    resumed.run()
    assert digest(resumed) == digest(expected)


def test_split_runs_give_identical_results():
    """300 steps in one call of the core and in five."""
    one, many = (cdem.Simulation(breaking_cube(), threads=2) for _ in range(2))
    one.step(300)
    for count in (1, 7, 92, 150, 50):
        many.step(count)
    for name in ("node.motion", "triangles.bond", "spring.state"):
        assert np.array_equal(one.core.fields()[name], many.core.fields()[name])


def sleeping_bed(held):
    """A block slides over a meshed, bonded bed that is fixed for `held` seconds, then free."""
    return case(
        [
            {
                "group": "bed",
                "box": {"size": [4, 2, 2], "divisions": [4, 2, 2], "shape": "tet4"},
                "translate": [0, 0, -2],
            },
            {"group": "body", "box": {"size": [1, 1, 1], "divisions": [2, 2, 2]},
             "translate": [2.5, 0.5, 0]},
        ],
        {"body": {"velocity": [6, 0, -1]}, "bed": {"fix": ["x", "y", "z"]}},
        interfaces={
            "default": {"friction_angle": 30, "cohesion": 1e6, "tensile_strength": 1e6},
            "pairs": [{"between": ["bed", "body"], "friction_angle": 10, "cohesion": 0,
                       "tensile_strength": 0}],
        },
        rock={"young_modulus": "0.1 GPa"},
        loads={"gravity": [0, 0, -9.81]},
        stages=[
            {"name": "held", "mode": "dynamic", "duration": held},
            {"name": "free", "mode": "dynamic", "duration": 0.02, "set": {"groups.bed.fix": []}},
        ],
        model={"split": {"bed": "elements"}},
    )  # fmt: skip


def test_sleeping_nodes_give_identical_results():
    """The first step of every call of the core computes all nodes; in the others fixed nodes sleep."""
    at_once, stepwise = (cdem.Simulation(sleeping_bed(9.0), threads=1) for _ in range(2))
    # the body slides during the first steps; later it has left the bed, and pair lists are empty
    for steps, slides in ((150, True), (750, False)):
        at_once.step(steps)
        for _ in range(steps):
            stepwise.step(1)
        assert (len(at_once.contacts["kind"]) > 0) == slides
        assert digest(at_once) == digest(stepwise)
        if slides:
            bed = at_once.build.nodes_of("bed")
            weight = at_once.fields["mass"][bed].sum() * 9.81
            assert at_once.fields["reaction"][bed, 2].sum() > weight


def test_nodes_with_a_common_mass_matrix_wake_together():
    """A plate one element thick is fixed over three quarters of its length.

    A block falls on that part, far from the plate's first nodes. The result has the same bits as
    one in which all nodes are computed in every step.
    """
    plate = case(
        [
            {"group": "plate", "box": {"size": [8, 1, 0.5], "divisions": [8, 1, 1]}},
            {"group": "body", "box": {"size": [0.6, 0.6, 0.6]}, "translate": [3.1, 0.2, 0.501]},
        ],
        {"body": {"velocity": [0, 0, -1]}, "plate": {}},
        rock={"young_modulus": "0.1 GPa"},
        loads={"supports": [{"box": {"min": [-1, -1, -1], "max": [6.1, 2, 0.5]},
                             "fix": ["x", "y", "z"]}]},
    )  # fmt: skip
    at_once, stepwise = (cdem.Simulation(plate, threads=1) for _ in range(2))
    shared = at_once.build.arrays["node.mass_row_first"] >= 0
    assert shared[at_once.build.nodes_of("plate")].all()
    at_once.step(60)
    for _ in range(60):
        stepwise.step(1)
    assert len(at_once.contacts["kind"]) > 0
    assert digest(at_once) == digest(stepwise)


def test_sleeping_nodes_wake_when_released():
    """A bed that is fixed and then released falls freely for 0.02 s: v = g t.

    Tolerance: the block that it carried pushes it, 3 %.
    """
    sim = cdem.Simulation(sleeping_bed(0.01), threads=1)
    sim.run()
    bed = sim.build.nodes_of("bed")
    assert sim.fields["velocity"][bed, 2].mean() == pytest.approx(-9.81 * 0.02, rel=0.05)


@pytest.mark.parametrize(
    ("shape", "hexahedra"), [("tet4", "full"), ("hex8", "full"), ("hex8", "one-point")]
)
def test_fused_blocks_give_identical_results(shape, hexahedra):
    """Bonded elements fly, and a ball is shot at them.

    Blocks of one element without contact have one kernel for force and motion, except in the first
    step of every call of the core.
    """
    scene = case(
        [
            {"group": "bar", "box": {"size": [4, 2, 2], "divisions": [4, 2, 2], "shape": shape}},
            {"group": "ball", "box": {"size": [0.5, 0.5, 0.5]}, "translate": [-0.51, 0.2, 0.4]},
        ],
        {"bar": {"velocity": [0.3, 0.2, 0.1]}, "ball": {"velocity": [20, 0, 1]}},
        interfaces={"default": {"friction_angle": 30, "cohesion": 1e5, "tensile_strength": 1e5}},
        rock={"young_modulus": "0.1 GPa"},
        loads={"gravity": [0, 1, -9.81]},
        stages=[{"name": "fly", "mode": "dynamic", "duration": 1, "damping": {"stiffness": 0.1}}],
        model={"split": {"bar": "elements"}},
        elements={"hexahedra": hexahedra},
    )
    at_once, stepwise = (cdem.Simulation(scene, threads=1) for _ in range(2))
    for steps in (7, 150, 143):
        at_once.step(steps)
        for _ in range(steps):
            stepwise.step(1)
        assert digest(at_once) == digest(stepwise)
    assert sum(at_once.broken.values()) > 0


def test_fixed_block_stops_in_the_same_step():
    """A block flies for 30 steps; a stage that fixes it keeps all positions to the last bit."""
    step = 1e-5
    sim = cdem.Simulation(
        case(
            [{"group": "body", "box": {"size": [2, 1, 1], "divisions": [2, 1, 1], "shape": "tet4"}}],
            {"body": {"velocity": [3, 2, 1]}},
            interfaces={
                "default": {"friction_angle": 30, "cohesion": 1e9, "tensile_strength": 1e9}
            },
            stages=[
                {"name": "fly", "mode": "dynamic", "duration": 29.5 * step},
                {"name": "held", "mode": "dynamic", "duration": 20 * step,
                 "set": {"groups.body.fix": ["x", "y", "z"]}},
            ],
            model={"split": {"body": "elements"}},
            time={"step": step},
        ),
        threads=1,
    )  # fmt: skip
    sim.run_stage("fly")
    assert sim.step_count == 30  # the next step does not sum energies: the fused kernel may run
    before = sim.fields["position"].copy()
    sim.run()
    assert np.array_equal(sim.fields["position"], before)


@pytest.mark.parametrize("way", ["local", "kinetic", "adaptive"])
def test_resumed_relaxation_gives_identical_results(tmp_path, way):
    """Relaxation by each method, stopped after its first report and resumed."""

    def settle(**more):
        return cdem.Simulation(
            case(
                [
                    {
                        "group": "a",
                        "box": {"size": [2, 2, 2], "divisions": [2, 2, 2], "shape": "tet4"},
                    }
                ],
                {"a": {}},
                interfaces={
                    "default": {"friction_angle": 30, "cohesion": 1e9, "tensile_strength": 1e9}
                },
                loads={
                    "gravity": [0, 0, -9.81],
                    "supports": [
                        {"box": {"min": [-1, -1, -1], "max": [3, 3, 0.001]}, "fix": ["x", "y", "z"]}
                    ],
                },
                stages=[{"name": "rest", "mode": "static", "relax": way, "tolerance": 1e-6}],
                model={"split": {"a": "elements"}},
            ),
            threads=2,
            **more,
        )

    whole = settle(output=tmp_path / "whole")
    assert whole.run() == "converged"
    asked = 0

    def should_stop():
        nonlocal asked
        asked += 1
        return asked == 1

    assert settle(output=tmp_path / "broken").run(should_stop=should_stop) == "stopped"
    resumed = settle(output=tmp_path / "broken", resume=True)
    assert resumed.run() == "converged"
    assert digest(resumed) == digest(whole)


def test_adaptive_relaxation_with_contacts_gives_identical_results(tmp_path):
    """Scaled masses that follow contacts: 1 and 3 threads, and a run that is stopped and resumed."""

    def settle(threads, **more):
        stones = [
            {
                "group": "stone",
                "box": {"size": [1, 1, 1]},
                "translate": [0.6 * k, 0, 1.01 * k + 0.001],
            }
            for k in range(3)
        ]
        bed = {"group": "bed", "box": {"size": [4, 3, 1]}, "translate": [-1, -1, -1]}
        return cdem.Simulation(
            case(
                [bed, *stones],
                {"bed": {"fix": ["x", "y", "z"]}, "stone": {}},
                interfaces={"default": {"friction_angle": 30}},
                loads={"gravity": [0.3, 0.1, -9.81]},
                stages=[{"name": "rest", "mode": "static", "relax": "adaptive", "max_steps": 1000}],
            ),
            threads=threads,
            **more,
        )

    whole = settle(1, output=tmp_path / "whole")
    whole.run()
    assert len(whole.contacts["kind"]) > 0
    other = settle(3)
    other.run()
    assert digest(other) == digest(whole)
    asked = iter([False, True, False])
    assert settle(2, output=tmp_path / "broken").run(should_stop=lambda: next(asked)) == "stopped"
    resumed = settle(1, output=tmp_path / "broken", resume=True)
    resumed.run()
    assert digest(resumed) == digest(whole)


def test_restored_state_repeats_the_motion():
    """A cube that has touched the bed is restored to a state before: it flies on with the same bits."""
    sim = cdem.Simulation(
        case(
            [
                {"group": "body", "box": {"size": [1, 1, 1]}, "translate": [0, 0, 0.1]},
                {"group": "bed", "box": {"size": [4, 4, 1]}, "translate": [-1, -1, -1]},
            ],
            {"body": {"velocity": [0, 0, -5]}, "bed": {"fix": ["x", "y", "z"]}},
            interfaces={"default": {"friction_angle": 30}},
            stages=[{"name": "fall", "mode": "dynamic", "duration": 1}],
        ),
        threads=1,
    )
    arrays = {name: values.copy() for name, values in sim.core.fields().items()}
    scalars = sim.core.scalars()

    def fly():
        sim.step(3)
        return digest(sim)

    first = fly()
    while not (rows_of(sim.core, "spring.state").force_n > 0).any():
        sim.step(1)
    sim.core.restore(arrays, scalars)
    sim.core.prepare()
    assert fly() == first


def test_restored_state_continues_the_growth_of_the_time_step():
    """A cube leaves the bed that it has hit, and its step grows by 1 % a step."""

    def cube():
        return cdem.Simulation(
            case(
                [
                    {"group": "body", "box": {"size": [1, 1, 1]}, "translate": [0, 0, 0.01]},
                    {"group": "bed", "box": {"size": [4, 4, 1]}, "translate": [-1, -1, -1]},
                ],
                {"body": {"velocity": [0, 0, -5]}, "bed": {"fix": ["x", "y", "z"]}},
                interfaces={"default": {"friction_angle": 30, "stiffness_n": "100 E/h"}},
            ),
            threads=1,
        )

    sim = cube()
    steps = []
    while len(steps) < 2 or not steps[-1] > steps[-2]:
        sim.step()
        steps.append(sim.core.scalars()["dt"])
    arrays = {name: values.copy() for name, values in sim.core.fields().items()}
    scalars = sim.core.scalars()
    sim.step(20)
    again = cube()
    again.step(int(np.argmin(steps)) + 1)  # where the step may not grow
    again.core.restore(arrays, scalars)
    again.core.prepare()
    again.step(20)
    assert again.core.scalars() == sim.core.scalars()
    assert digest(again) == digest(sim)
