"""Yield accelerations against a search by small steps, through changes of mode."""

import numpy as np
import pytest
from shared.hills import joint

from cdem.screening.sliding import KINDS, factors
from cdem.screening.yields import yield_accelerations

STEP = 0.001


def by_steps(normals, tangents, cohesive, still, shaking):
    """The yield acceleration by the factor at many accelerations [g]."""
    k = np.arange(-10, 10, STEP) + STEP / 2
    held = factors(normals, tangents, cohesive, still + k[:, None] * shaking)[0] >= 1
    if factors(normals, tangents, cohesive, still)[0] >= 1:
        slides = np.flatnonzero(~held & (k > 0))
        return k[slides[0]] if len(slides) else np.inf
    rests = np.flatnonzero(held & (k < 0))
    return k[rests[-1]] if len(rests) else -np.inf


def test_random_wedges():
    random = np.random.default_rng(4)
    kinds, infinite = set(), 0
    for _ in range(150):
        dips, directions = random.uniform(20, 80, 2), random.uniform(0, 360, 2)
        normals = np.array(
            [joint("", d, a, 0).normal for d, a in zip(dips, directions, strict=True)]
        )
        tangents = np.tan(np.radians(random.uniform(5, 60, 2)))
        cohesive = random.uniform(0, 0.4, (1, 2)) * random.integers(0, 2)
        turn = random.uniform(0, 2 * np.pi)
        still = np.array([[0, 0, -1.0]]) + random.uniform(0, 0.3, 2) @ normals
        shaking = np.array([[np.cos(turn), np.sin(turn), 0]])
        found = yield_accelerations(normals, tangents, cohesive, still, shaking)[0]
        wanted = by_steps(normals, tangents, cohesive[0], still[0], shaking[0])
        if np.isinf(wanted):
            infinite += 1
            assert found == wanted
            continue
        assert found == pytest.approx(wanted, abs=2 * STEP)
        force = still[0] + found * shaking[0]
        kinds.add(KINDS[int(factors(normals, tangents, cohesive[0], force)[1])])
    assert kinds >= {"both", "first", "second"} and infinite < 100


def test_bodies_together_are_each_alone_and_units_do_not_matter():
    normals = np.array([joint("", 55, 135, 0).normal, joint("", 50, 215, 0).normal])
    tangents, glue = np.array([0.6, 0.8]), np.random.default_rng(1).uniform(0, 1, (6, 2))
    still, shaking = np.tile([0, 0, -1.0], (6, 1)), np.tile([0, -1.0, 0], (6, 1))
    many = yield_accelerations(normals, tangents, glue, still, shaking)
    for one in range(6):
        part = slice(one, one + 1)
        scaled = [5e8 * values[part] for values in (glue, still, shaking)]
        alone = yield_accelerations(normals, tangents, *scaled)
        assert alone[0] == pytest.approx(many[one], rel=1e-9)


def test_a_body_that_nothing_holds_has_none():
    normals = np.array([[0, 0, 1.0]])
    up = yield_accelerations(normals, np.array([1.0]), np.zeros((1, 1)), np.array([[0, 0, 1.0]]),
                             np.array([[1.0, 0, 0]]))  # fmt: skip
    assert up[0] == -np.inf
