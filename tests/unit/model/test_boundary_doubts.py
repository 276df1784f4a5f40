"""Warnings about boundaries, and rigid bases."""

import re

import numpy as np
import pytest
from scenes import case

import cdem
from cdem.errors import CaseError

ROCK = {"density": 2600, "young_modulus": "5 GPa", "poisson_ratio": 0.25}
STAGES = [
    {"name": "rest", "mode": "static"},
    {"name": "shake", "mode": "dynamic", "duration": 0.01},
]
WAVE = {"samples": [0, 1, 2, 1, 0, -1, -2, -1, 0, 1, 0], "unit": "m/s", "step": 0.01, "scale": 0.1}
INPUT = {"record": "r", "direction": [1, 0, 0]}
DOWN, EAST = [0, 0, -1], [1, 0, 0]


def face(*normal):
    return {"surface": {"group": "a", "normal": list(normal)}}


BASE = face(*DOWN) | {"name": "base", "quiet": True, "stage": "shake"}
SIDE = face(*EAST) | {"name": "east", "stage": "shake"}
HELD = [face(*DOWN) | {"fix": ["x", "y", "z"]}]


def audit(*boundaries, supports=HELD, loads=None, **more):
    """Audit of a block of 8 x 4 x 4 m; its group ends 4 m above its base."""
    blocks = [{"group": "a", "box": {"size": [8, 4, 4], "divisions": [4, 2, 2]}}]
    given = {"stages": STAGES, "records": {"r": WAVE}, "waves": {"allow_coarse": True}}
    model = case(
        blocks,
        {"a": {}},
        rock=ROCK,
        boundaries=list(boundaries),
        loads={"gravity": [0, 0, -9.81], "supports": supports} | (loads or {}),
        **(given | more),
    )
    return cdem.Simulation(model, threads=1).audit


DOUBTS = {
    "weight": (dict(boundaries=[BASE | {"stage": None}], stages=STAGES[1:], supports=[]),
               r"base begins with the run, so no forces of supports carry the weight"),
    "drains": (dict(boundaries=[BASE | {"input": INPUT}, SIDE | {"quiet": True}]),
               r"east is a quiet side of ground that is shaken from below"),
    "held": (dict(boundaries=[BASE], supports=[{"box": {"min": [-1, -1, -1], "max": [9, 9, 0.1]},
                                                "fix": ["z"]}]),
             r"15 of the 15 nodes of base stay held along z"),
    "scaled": (dict(boundaries=[BASE], time={"mass_scaling": {"most": 0.01}}),
               r"mass scaling: waves meet the added mass"),
    "exact": (dict(boundaries=[BASE], elements={"mass": "exact"}),
              r"blocks at quiet faces move lumped masses all the same"),
}  # fmt: skip


@pytest.mark.parametrize("name", DOUBTS)
def test_a_doubt_is_told_and_only_where_it_is_one(name):
    given, told = DOUBTS[name]
    more = {key: value for key, value in given.items() if key != "boundaries"}
    warnings = audit(*given["boundaries"], **more).warnings
    assert any(re.search(told, w) for w in warnings)
    side = SIDE | {"free_field": {"base": "base"}}
    calm = audit(BASE | {"input": INPUT}, side, elements={"mass": "lumped"}).warnings
    assert not any(re.search(told, w) for w in calm)


def test_water_before_a_free_field_is_refused():
    side = SIDE | {"free_field": {"base": "base"}}
    water = {"reservoir": {"level": 3, "box": {"min": [7.9, -1, -1], "max": [20, 9, 9]}}}
    with pytest.raises(CaseError, match="water presses on 4 faces of east") as error:
        audit(BASE, side, water=water)
    assert "boundaries.1" in str(error.value)
    audit(BASE, SIDE | {"quiet": True}, water=water)  # of a quiet side it may


def test_a_wave_along_a_held_axis_is_refused():
    supports = [*HELD, {"box": {"min": [-1, -1, -1], "max": [9, 9, 9]}, "fix": ["x"]}]
    with pytest.raises(CaseError, match="the wave of r comes in along x, along which all"):
        audit(BASE | {"input": INPUT}, supports=supports)


def test_a_rigid_base_tells_the_period_of_the_ground_on_it():
    """4 H / c_s, c_s = sqrt(2 GPa / 2600)."""
    rigid = face(*DOWN) | {"name": "base", "stage": "shake", "input": INPUT | {"kind": "rigid"}}
    found = audit(rigid)
    (row,) = found.rigid_bases
    assert row["period"] == pytest.approx(4 * 4 / np.sqrt(2e9 / 2600))
    assert (row["name"], row["records"], row["faces"]) == ("base", ["r"], 8)
    assert "boundary base: 8 faces move with r; what comes down stays" in found.text()
    assert audit(BASE | {"input": INPUT}).rigid_bases == []
