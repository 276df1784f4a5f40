"""Results have the same bits on any number of ranks, however the elements are dealt to them."""

from __future__ import annotations

import json
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))
from golden_scenes import (
    FIXED,
    GOLDEN,
    SCENES,
    SOFT,
    WEIGHT,
    box,
    digest,
    digest_of_results,
    finish,
    thrown,
)
from scenes import case
from shared.ranks import on_ranks

from cdem.errors import CdemError
from cdem.ranks import parts, shared_core
from cdem.ranks.parts import Fences, Parts

PINNED = json.loads(GOLDEN.read_text())["scenes"]
DEAR = (
    "landslide", "leaving", "flowing", "rubble", "defaults", "pressed", "shaken", "soaked",
)  # fmt: skip
COUNTS = (2, 3, 7)
QUICK = [(name, COUNTS[n % 3]) for n, name in enumerate(sorted(SCENES.keys() - set(DEAR)))]
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


def split(groups, boxes, interface, steps, **more):
    """Groups of elements that are blocks of their own."""
    blocks = [box(group, *of) for group, of in zip(groups, boxes, strict=True)]
    stage = {"name": "run", "mode": "dynamic", "duration": 1, "damping": {"contact": 0.1}}
    more["model"] = {"split": dict.fromkeys(groups, "elements")}
    data = case(
        blocks, groups, interfaces={"default": interface}, rock=SOFT, stages=[stage], **more
    )
    return finish(data, steps, 1)


def cohesive(steps=400):
    """A row of tets hits a bed and breaks; what touches then holds by its area."""
    law = {"law": "residual", "friction_angle": 30, "cohesion": 2e4, "tensile_strength": 1e4}
    groups = {"row": {"velocity": [0.2, 0.1, -3]}, "bed": FIXED}
    boxes = ([4, 0.33, 0.33], [0, 0, 0.002], (12, 1, 1), "tet4"), ([5, 2, 1], [-0.4, -0.8, -1])
    return split(groups, boxes, law | {"residual_cohesion": 8e3}, steps, loads=WEIGHT)


def meeting(steps=450):
    """Tets at rest, far from others, fall on them."""
    boxes = (
        ([1, 1, 1], [0, 0, 0], (2, 2, 2), "tet4"),
        ([1, 1, 1], [1.15, 0.3, 0.2], (2, 2, 2), "tet4"),
    )
    groups, pull = {"left": {}, "right": FIXED}, {"gravity": [800, 0, 0]}
    return split(groups, boxes, {"friction_angle": 30}, steps, loads=pull)


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
    "cohesive": lambda: digest_of_results(cohesive()),
    "breaking": lambda: digest("breaking", 1),
    "bolted": lambda: digest("bolted", 1),
    "soaked": lambda: digest("soaked", 1),
}


@cache
def expected(name):
    """Hash on one rank."""
    return DEALT[name]() if name in ("rubble", "cohesive") else PINNED[name]


def dealt_by(deal, seed):
    """Owners as `parts.divide` gives them, anew at each cut."""

    def divide(core, mesh, count, _):
        together = parts._units(core, mesh)
        random = np.random.default_rng([seed, core.scalars()["step"]])
        of_element = deal(int(together.max()) + 1, count, random)[together]
        nodes = len(core.fields()["node.motion"]) // 8
        return Parts(of_element, of_element[mesh.lowest_element(nodes)])

    return divide


@pytest.mark.parametrize(
    ("name", "deal"),
    [
        pytest.param(
            name, deal, marks=[pytest.mark.slow] * (n > 0 and name in ("soaked", "breaking"))
        )
        for name in DEALT
        for n, deal in enumerate(DEALS)
    ],
)
def test_any_deal_of_the_elements_gives_the_same(name, deal, monkeypatch):
    monkeypatch.setattr(shared_core, "divide", dealt_by(deal, seed=len(name)))
    count = 3
    assert on_ranks(count, lambda _: DEALT[name]()) == [expected(name)] * count


# ------------------------------------------------------------------ teeth: too few ghosts are noticed


def fewer(which):
    """`parts.needed` with fewer ghosts."""

    def needed(core, mesh, dealt, fences, rank):
        at_own = (dealt.of_element == rank) | mesh.at_nodes(dealt.of_node == rank)
        if which == "no others":
            return at_own
        boxes = fences.of_elements(mesh)
        return boxes.near(boxes.some(at_own)) | at_own

    return needed


def is_noticed(count, scene):
    """Whether no rank has the results of one rank; the parts may not even fit together."""
    try:
        found = on_ranks(count, lambda _: digest_of_results(scene()))
    except CdemError:
        return True
    return digest_of_results(scene()) not in found


@pytest.mark.parametrize("which", ["no others", "first layer alone"])
def test_too_few_ghosts_are_noticed(which, monkeypatch):
    """An area of contact depends on the elements around those that act on own nodes."""
    monkeypatch.setattr(shared_core, "needed", fewer(which))
    assert is_noticed(3, cohesive)


def test_elements_that_come_near_must_become_ghosts(monkeypatch):
    """With fences that nothing leaves, ghosts are those of the first step."""
    of_nodes = Fences.of_nodes

    def endless(fences, some):
        rows = of_nodes(fences, some)
        rows[:, :3], rows[:, 4:7] = -1e9, 1e9
        return rows

    monkeypatch.setattr(parts, "SKIN", 0)
    assert not is_noticed(2, meeting)
    monkeypatch.setattr(Fences, "of_nodes", endless)
    assert is_noticed(2, meeting)
