"""Models shared out to ranks: slices make the whole again, byte by byte, at once and after a step
that each rank makes alone with its ghosts.
"""

import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from golden_scenes import FIXED, SCENES, SOFT, WEIGHT, box, case, finish
from shared.shares import core_of, differences, lost, merge, set_rules, slices_of

from cdem.run.restored import wrong_array

PARTS = 3
LONGEST = ("landslide", "leaving", "flowing", "rubble", "defaults")
ROUNDED = ("elastic", "elements", "flowing", "landslide")
"""Scenes of large blocks: tiles of a slice add the forces of elements in another order."""


def scenes(names):
    """Names of scenes; the long ones are slow."""
    return [pytest.param(n, marks=[pytest.mark.slow] * (n in LONGEST)) for n in names]


def simulations(name):
    """Simulations of a scene after their run."""
    done = SCENES[name](1)
    return done if isinstance(done, list) else [done]


@pytest.mark.parametrize("name", scenes(SCENES))
def test_slices_make_the_whole_again_and_run(name):
    for sim in simulations(name):
        slices = slices_of(sim.core, PARTS, seed=1, layers=1)
        whole = merge(sim.core, slices, [kept.state() for kept in slices])
        assert differences(whole, sim.core.fields()) == []
        for kept in slices:
            assert lost(sim.core, kept) == {}
            core = core_of(sim, kept)
            assert wrong_array(core) == ""
            assert differences(core.model(), kept.model()) == []


@pytest.mark.parametrize("name", scenes(n for n in SCENES if n not in ROUNDED))
def test_ranks_make_a_step_and_new_pair_lists_as_one(name):
    (sim,) = simulations(name)
    rules = {"rebuild_interval": 1, "step_given": sim.core.scalars()["dt"]}
    slices = slices_of(sim.core, PARTS, seed=1)
    cores = [core_of(sim, kept, **rules) for kept in slices]
    set_rules(sim, sim.core, **rules)
    for core in [sim.core, *cores]:
        assert core.run(1)[0] == "steps_done"
    states = [core.fields() for core in cores]
    old_firsts = [core.rebuilt()["edge.old_first"] for core in cores]
    assert differences(merge(sim.core, slices, states, old_firsts), sim.core.fields()) == []


def long_bar():
    """A bar of bonded tets breaks on blocks: ranks keep a part of it each."""
    bar = box("bar", [12, 2, 2], [0, 0, 0.002], [12, 2, 2], "tet4")
    bed = [box("bed", [1, 3, 1], [x - 1, -0.5, -1]) for x in range(14)]
    strength = {"friction_angle": 20, "cohesion": 5e4, "tensile_strength": 5e4}
    damping = {"contact": 0.1, "stiffness": 0.1}
    return finish(
        case(
            [bar, *bed],
            {"bar": {"velocity": [0.1, 0.2, -3]}, "bed": FIXED},
            interfaces={"default": strength},
            rock=SOFT,
            loads=WEIGHT,
            model={"split": {"bar": "elements"}},
            stages=[{"name": "fall", "mode": "dynamic", "duration": 1, "damping": damping}],
        ),
        150,
        1,
    )


def test_rows_move_between_other_ranks_after_each_step():
    sim = long_bar()
    core, scalars = sim.core, sim.core.scalars()
    rules = {"rebuild_interval": 1, "step_given": scalars["dt"]}
    start = {name: array.copy() for name, array in core.fields().items()}
    set_rules(sim, core, **rules)
    expected, kept = [], []
    for _ in range(6):
        core.run(1)
        state = {name: array.copy() for name, array in core.fields().items()}
        expected.append((state, core.scalars()))
    assert len(expected[-1][0]["edge.contact"]) > len(start["edge.contact"]) > 0
    core.restore(start, scalars)
    for seed, (state, numbers) in enumerate(expected):
        slices = slices_of(core, 2 + seed % 3, seed)
        cores = [core_of(sim, one, **rules) for one in slices]
        for one in cores:
            one.run(1)
        old_firsts = [one.rebuilt()["edge.old_first"] for one in cores]
        whole = merge(core, slices, [one.fields() for one in cores], old_firsts)
        assert differences(whole, state) == []
        core.restore(whole, numbers)
        kept += [len(one.keep["elements"]) for one in slices]
    assert np.mean(kept) < 0.9 * len(slices[0].local["elements"])
