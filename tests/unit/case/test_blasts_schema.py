"""Blasts in a case: their pulses, peaks, entries of surface laws, and errors with their places."""

import math

import pytest
from scenes import case

from cdem.case.blast_pulses import two_exponentials
from cdem.case.blasts_schema import RINGS
from cdem.errors import CaseError

ROCK = [{"group": "a", "box": {"size": [1, 1, 1]}}]
PULSE = {"peak": "20 MPa", "rise": "0.2 ms", "fall": "0.5 ms"}
TOP = {"surface": {"group": "a", "normal": [0, 0, 1]}}
CHARGE = {"density": "850 kg/m3", "speed": 4000, "diameter": "50 mm", "hole": "89 mm"}
STAGES = [
    {"name": "rest", "mode": "static"},
    {"name": "blow", "mode": "dynamic", "duration": 0.1},
]


def blasts(*entries, stages=STAGES[1:], **more):
    """A cube with these blasts."""
    return case(ROCK, {"a": {}}, loads={"blasts": list(entries), **more}, stages=stages)


def test_a_blast_is_one_entry_of_pressure_after_the_laws_on_faces():
    made = blasts(TOP | {"pressure": PULSE, "delay": "25 ms", "stage": "blow"},
                  surfaces=[TOP | {"pressure": 7}])  # fmt: skip
    (first, _), (keys, blast) = made.surface_entries
    assert first == ("loads", "surfaces", 0)
    assert keys == ("loads", "blasts", 0)
    assert (blast.law, blast.pressure, blast.stage, blast.ring) == ("pressure", 20e6, "blow", None)
    assert blast.history == [(t + 0.025, p) for t, p in two_exponentials(0.2e-3, 0.5e-3)]


def test_the_other_shapes_have_their_own_peaks():
    friedlander = {"friedlander": {"peak": "3 MPa", "duration": "2 ms", "decay": 1}}
    table = {"table": [["0 ms", 0], ["1 ms", "4 MPa"], ["2 ms", "-1 MPa"]]}
    made = blasts(TOP | {"pressure": friedlander}, TOP | {"pressure": table})
    entries = [entry for _, entry in made.surface_entries]
    assert [entry.pressure for entry in entries] == [3e6, 4e6]
    assert entries[1].history == [(0, 0), (1e-3, 1), (2e-3, -0.25)]
    assert made.dump() == type(made).from_dict(made.model_dump(mode="json")).dump()


def test_a_table_of_suction_alone_has_its_largest_suction_as_peak():
    made = blasts(TOP | {"pressure": {"table": [[0, 0], ["1 ms", "-2 MPa"], ["2 ms", "-1 MPa"]]}})
    ((_, entry),) = made.surface_entries
    assert entry.pressure == 2e6
    assert entry.history == [(0, 0), (1e-3, -1), (2e-3, -0.5)]


def test_an_explosive_gives_the_peak_and_the_mass():
    """850 4000² / 8 (50 / 89)^2.4; a cylinder of 50 mm and 3 m."""
    pulse = {key: PULSE[key] for key in ("rise", "fall")}
    made = blasts(TOP | {"pressure": pulse, "explosive": CHARGE})
    assert made.loads.blasts[0].peak == pytest.approx(1.7e9 * (50 / 89) ** 2.4)
    assert made.loads.blasts[0].explosive.mass(3) == pytest.approx(850 * math.pi * 0.025**2 * 3)


def test_a_detonation_makes_rings():
    run = {"from": [0, 0, 1], "speed": "4 km/s"}
    made = blasts(TOP | {"pressure": PULSE, "detonation": run})
    rings = [entry.ring for _, entry in made.surface_entries]
    assert [ring.number for ring in rings] == list(range(RINGS))
    assert {(ring.begin, ring.speed) for ring in rings} == {((0, 0, 1), 4000)}
    assert made.dump() == type(made).from_dict(made.model_dump(mode="json")).dump()


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"pressure": PULSE | {"rise": "0.5 ms"}}, "pressure", "rise 0.0005 s must be shorter than fall"),
        ({"pressure": PULSE | {"peak": "20 GPa"}}, "0", "a peak of 20 GPa is more than explosives reach"),
        ({"delay": "-1 ms"}, "delay", "must be at least 0"),
        ({"stage": "rest"}, "stage", "rest is static, and a blast needs time"),
        ({}, "stage", "rest is static, and a blast needs time"),
        ({"stage": "b"}, "stage", "no stage 'b'"),
        ({"surface": {"group": "b", "normal": [0, 0, 1]}}, "surface.group", "no group 'b'"),
        ({"explosive": CHARGE}, "0", "give the peak of the pressure, or the explosive .* not both"),
        ({"pressure": {"rise": 1e-4, "fall": 1e-3}}, "0", "give the peak of the pressure, or the explosive"),
        ({"explosive": CHARGE | {"diameter": "9 cm"}}, "explosive", "does not fit into a hole of 0.089 m"),
        ({"pressure": {"table": [[0, 1], [0, 2]]}}, "pressure", "times must increase"),
        ({"pressure": {"table": [[0, 0], [1, 0]]}}, "pressure", "has no pressure"),
        ({"pressure": {"table": [[0, 0]]}}, "pressure.table", "at least 2"),
        ({"pressure": {"friedlander": {"peak": 1, "duration": 1, "decay": 0.5, "suction": True}}},
         "pressure.friedlander", "give a decay of at least 1"),
        ({"detonation": {"from": [0, 0, 0], "speed": 0}}, "detonation.speed", "must be above 0"),
        ({"detonation": {"speed": 9}}, "detonation.from", "missing"),
    ],
)  # fmt: skip
def test_a_wrong_blast_is_told_with_its_place(change, place, words):
    entry = TOP | {"pressure": PULSE} | ({"stage": "blow"} if change else {}) | change
    where = r"loads\.blasts\.0" + ("" if place == "0" else rf"\.{place}")
    with pytest.raises(CaseError, match=rf"{where}: .*{words}"):
        blasts(entry, stages=STAGES)
