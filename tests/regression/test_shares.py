"""Models shared out to ranks: slices make the whole again, byte by byte, at once and after a step
that each rank makes alone with its ghosts.
"""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))
from golden_scenes import SCENES
from shared.shares import core_of, differences, set_rules, slices_of

from cdem.ranks.merge import merge
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
            assert kept.lost() == {}
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
