"""Blasts and their stages: rock that is not there, and runs that end too early."""

import pytest
from scenes import case

from cdem.case.blast_checks import cut_part
from cdem.errors import CaseError

TOP = {"surface": {"group": "a", "normal": [0, 0, 1]}}
PULSE = {"peak": "20 MPa", "rise": "0.2 ms", "fall": "0.5 ms"}
BOXES = [{"group": name, "box": {"size": [1, 1, 1]}, "translate": [0, 0, 2 * i]}
         for i, name in enumerate("ab")]  # fmt: skip


def blasted(stages, **blast):
    """Two cubes with a blast on the first."""
    entry = TOP | {"pressure": PULSE} | blast
    return case(BOXES, {"a": {}, "b": {}}, stages=stages, loads={"blasts": [entry]})


def dynamic(name, duration, **more):
    return {"name": name, "mode": "dynamic", "duration": duration} | more


def cut(model):
    """Warnings about cut pulses."""
    return [w for w in model.warnings if "of its impulse" in w]


def test_a_blast_after_the_end_of_the_run_is_refused():
    """It may go off in a later stage."""
    stages = [dynamic("blow", 0.01), dynamic("fly", 0.02)]
    assert blasted(stages, delay=0.02).loads.blasts[0].delay == 0.02
    with pytest.raises(
        CaseError,
        match=r"blasts\.0\.delay: it goes off 0\.03 s after the begin of blow, and the run ends 0\.03 s "
        "after it; shorten the delay, or let fly last longer",
    ):
        blasted(stages, delay=0.03)
    with pytest.raises(CaseError, match=r"0\.02 s after the begin of fly"):
        blasted(stages, stage="fly", delay=0.02)


def test_a_pulse_that_the_end_of_the_run_cuts_off_is_told():
    assert not cut(blasted([dynamic("blow", 0.01)]))
    (told,) = cut(blasted([dynamic("blow", 0.01)], delay=9.5e-3))
    assert "loads.blasts.0: the run ends 0.01 s after the begin of blow and cuts off" in told
    assert told.endswith("let blow last longer")


def test_the_part_that_is_cut_is_that_of_the_impulse():
    """A triangle up to 2 ms, cut at 1 and 1.5 ms; a pressure that stays counts up to its last change."""
    triangle = {"table": [[0, 0], ["1 ms", 1e6], ["2 ms", 0]]}
    stays = {"table": [[0, 0], ["1 ms", 1e6], ["9 s", 1e6]]}
    stages = [dynamic("blow", 0.01)]
    for pulse, time, exact in (
        (triangle, 1e-3, 1 / 2),
        (triangle, 1.5e-3, 1 / 8),
        (stays, 0.5e-3, 3 / 4),
        (stays, 0.01, 0),
    ):
        blast = blasted(stages, pressure=pulse).loads.blasts[0]
        assert cut_part(blast, time) == pytest.approx(exact, abs=1e-6)


def test_nothing_is_told_where_the_end_of_the_run_is_unknown():
    stages = [dynamic("blow", 1e-4), {"name": "rest", "mode": "static"}]
    assert not cut(blasted(stages))


def test_a_wall_of_rock_that_comes_later_is_refused():
    stages = [dynamic("blow", 0.01), dynamic("later", 0.01, add=["a"])]
    with pytest.raises(
        CaseError, match=r"blasts\.0\.surface\.group: a is not present in the stage blow"
    ):
        blasted(stages)
    assert blasted(stages, stage="later").loads.blasts
