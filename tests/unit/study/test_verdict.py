"""What a critical value takes for sliding."""

from types import SimpleNamespace

import numpy as np
import pytest

from cdem.run.behaviour import LEAST_STEPS, LONG, UNKNOWN
from cdem.study import verdict
from cdem.study.criterion import Criterion
from cdem.study.verdict import LOOK, _Watch


def watch_of(looks, wait=LEAST_STEPS, loose=False):
    """Verdicts on a block of faces of 1 m, at each look with a way [m] and an unbalance ratio.

    None before there is one; with a question mark where it is not sure.
    """
    ratio = [1.0]
    topology = SimpleNamespace(block_group=np.zeros(1, int), node_block=np.zeros(1, int))
    sim = SimpleNamespace(
        audit=SimpleNamespace(counts={"faces": 1}),
        build=SimpleNamespace(
            arrays={"face.length": np.ones(1)}, topology=topology, group_names=["rock"]
        ),
        core=SimpleNamespace(unbalance_ratio=lambda: ratio[0]),
        fields={"position": np.zeros((1, 3)), "velocity": np.zeros((1, 3))},
        out=np.zeros(1, bool),
        fallen=np.zeros(0, int),
        step_count=0,
    )
    watch = _Watch(sim, Criterion(), wait, np.array([loose]))
    for number, (way, left) in enumerate(looks, 1):
        ratio[0] = left
        sim.fields["position"] = np.array([[way, 0.0, 0.0]])
        sim.step_count = number * LOOK
        seen = watch.look()
        yield seen and seen.saw + "?" * (not seen.sure)


def steps(count, way, ratio):
    """Looks at a motion: way [m] and ratio as functions of the number of the look."""
    return [(way(k), ratio(k)) for k in range(1, count + 1)]


def test_a_body_that_gains_speed_under_a_steady_force_slides():
    """Not before four looks; it is sure where it has moved by a two-hundredth of a face."""
    accelerated = steps(8, lambda k: 2.5e-4 * k**2, lambda k: 0.02)
    assert list(watch_of(accelerated)) == [*3 * [None], "sliding?", *4 * ["sliding"]]


def test_soft_rock_that_sags_far_is_not_sliding():
    """In the first quarter of a period it gains speed, but its force falls as a cosine."""
    turn = 2 * np.pi / 64  # a look
    sag = steps(64, lambda k: 0.2 * (1 - np.cos(turn * k)), lambda k: abs(np.cos(turn * k)))
    assert not any(watch_of(sag, wait=2 * 64 * LOOK))


def test_a_body_that_slows_down_under_a_steady_force_is_not_sliding():
    """Friction above its drive stops it after a constant deceleration."""
    slowed = steps(30, lambda k: 2e-4 * k * (60 - k), lambda k: 0.02)
    assert not any(watch_of(slowed))


def test_an_anchor_may_tighten_while_a_body_has_hardly_moved():
    slow = steps(UNKNOWN // LOOK, lambda k: 4e-3 * (k * LOOK / UNKNOWN) ** 2, lambda k: 1e-4)
    seen = list(watch_of(slow))
    assert set(seen[3:-1]) == {"sliding?"} and seen[-1] == "sliding"


def test_a_force_that_falls_too_slowly_creeps_in_the_end():
    """Down to 0.62 of its value as the steps double: neither steady nor halved."""
    creep = steps(200, lambda k: 1e-3 * k, lambda k: 0.1 * k**-0.69)
    seen = list(watch_of(creep))
    assert not any(seen[: UNKNOWN // LOOK - 1]) and seen[UNKNOWN // LOOK] == "creeping"


def test_a_body_that_moves_by_a_face_slides_at_any_speed():
    assert list(watch_of([(0.9, 0.1), (1.1, 1e-4)])) == [None, "sliding"]


@pytest.fixture
def lands(monkeypatch):
    """Let the body land at the look of a number: nothing holds it before."""

    def at(number):
        looks = iter(range(1, 10_000))
        monkeypatch.setattr(
            verdict, "loose_nodes", lambda sim: np.array([next(looks) < number], bool)
        )

    return at


def test_a_body_that_nothing_holds_may_fall(lands):
    """Beyond a face, and past the steps after which others creep; but not for ever."""
    lands(10_000)
    fall = steps(LONG // LOOK + 20, lambda k: 1e-3 * k**2, lambda k: 0.1)
    seen = list(watch_of(fall, loose=True))
    assert not any(seen[: LONG // LOOK]) and seen[-1] == "sliding"
    assert "sliding" in list(watch_of(fall))[:10]


@pytest.mark.parametrize("bounces", [0.0, 0.3])
def test_a_body_that_has_landed_settles(lands, bounces):
    """It lies still from there on, though the ratio has not fallen yet, or jumps up once more."""
    lands(50)
    after = UNKNOWN // LOOK

    def way(k):
        return min(k, 50) + bounces * (k > 70)

    assert not any(watch_of(steps(50 + after, way, lambda k: 0.1), loose=True))


def test_a_body_that_lands_and_goes_on_by_a_face_slides(lands):
    """A wall whose blocks begin apart, and which falls down."""
    lands(3)
    fall = steps(100, lambda k: 1e-3 * k**2, lambda k: 0.1)
    seen = list(watch_of(fall, loose=True))
    assert not any(seen[:31]) and seen[31] == "sliding"
