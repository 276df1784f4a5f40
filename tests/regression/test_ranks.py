"""Results have the same bits on any number of ranks, however the elements are dealt to them."""

from __future__ import annotations

import json
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from golden_scenes import GOLDEN, SCENES, digest, digest_of_results, thrown
from shared.ranks import on_ranks
from staged_scenes import run_stages

from cdem.ranks import parts, shared_core
from cdem.ranks.parts import Parts

PINNED = json.loads(GOLDEN.read_text())["scenes"]
DEAR = ("landslide", "leaving", "flowing", "rubble", "defaults")
COUNTS = (2, 3, 7)
QUICK = [(name, COUNTS[n % 3]) for n, name in enumerate(n for n in SCENES if n not in DEAR)]
SLOW = [(name, count) for name in SCENES for count in COUNTS if (name, count) not in QUICK]


@pytest.mark.parametrize(
    ("name", "count"), QUICK + [pytest.param(*one, marks=pytest.mark.slow) for one in SLOW]
)
def test_results_are_those_pinned(name, count):
    """A scene has its hash on every rank; quickly with one count of ranks, slowly with all."""
    assert on_ranks(count, lambda _: digest(name, 1)) == [PINNED[name]] * count


def rubble(steps=250):
    """Tets without bonds fall apart on a bed."""
    return thrown(1, 0, steps, divisions=(2, 2, 3))


# ------------------------------------------------------------------ elements dealt in other ways


def at_random(units, count, random):
    """Every element anywhere."""
    return random.integers(0, count, units)


def one_alone(units, count, random):
    """One element for each rank but the first."""
    rank = np.zeros(units, np.int64)
    rank[random.choice(units, count - 1, replace=False)] = np.arange(1, count)
    return rank


def most_at_the_last(units, count, random):
    """Nine of ten elements at the last rank, which are not those around each other."""
    rank = np.full(units, count - 1)
    few = random.permutation(units)[: units // 10]
    rank[few] = random.integers(0, count - 1, len(few))
    return rank


def none_at_some(units, count, random):
    """No element at the first rank."""
    return random.integers(1, count, units)


DEALS = (at_random, one_alone, most_at_the_last, none_at_some)
DEALT = {
    "rubble": lambda: digest_of_results(rubble()),
    "breaking": lambda: digest("breaking", 1),
    "bolted": lambda: digest("bolted", 1),
    "soaked": lambda: digest("soaked", 1),
}


@cache
def expected(name):
    """Hash on one rank."""
    return PINNED.get(name) if name != "rubble" else DEALT[name]()


def dealt_by(deal, seed):
    """Owners as `parts.divide` gives them, anew at each cut."""

    def divide(core, mesh, count):
        together = parts._units(core, mesh)
        random = np.random.default_rng([seed, core.scalars()["step"]])
        of_element = deal(int(together.max()) + 1, count, random)[together]
        nodes = len(core.fields()["node.motion"]) // 8
        return Parts(of_element, of_element[mesh.lowest_element(nodes)])

    return divide


@pytest.mark.parametrize("deal", DEALS)
@pytest.mark.parametrize("name", DEALT)
def test_any_deal_of_the_elements_gives_the_same(name, deal, monkeypatch):
    monkeypatch.setattr(shared_core, "divide", dealt_by(deal, seed=len(name)))
    count = 3
    assert on_ranks(count, lambda _: DEALT[name]()) == [expected(name)] * count
