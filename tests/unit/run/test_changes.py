"""Which changes of a case a resumed run takes over, and which it refuses."""

from __future__ import annotations

from copy import deepcopy

import pytest

from cdem.run.changes import compare

CASE = {
    "title": "a",
    "model": {"mesh": "a.msh", "blocks": [{"group": "rock", "file": "b.msh"}]},
    "materials": {"rock": {"young_modulus": 1e9}},
    "stages": [
        {"name": "one", "duration": 1.0, "set": {}},
        {"name": "two", "duration": 1.0, "set": {}},
        {"name": "three", "duration": 1.0, "set": {}},
    ],
    "output": {"every": None, "fields": ["stress"]},
}


def changed(path: str, value: object) -> dict:
    case = deepcopy(CASE)
    *way, last = [int(key) if key.isdigit() else key for key in path.split(".")]
    node = case
    for key in way:
        node = node[key]
    node[last] = value
    return case


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("title", "b"),
        ("output.every", 0.1),
        ("stages.1.duration", 2.0),
        ("stages.2.set", {"interfaces.default.friction_angle": 1}),
        ("stages.2.name", "other"),
    ],
)
def test_these_changes_take_effect_in_the_second_stage(path, value):
    found = compare(CASE, changed(path, value), begun=2)
    assert [path.startswith(p) or p.startswith(path) for p, _, _ in found.allowed] == [True]
    assert not found.refused
    assert found.longer == (path == "stages.1.duration")


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("materials.rock.young_modulus", 1e10),
        ("materials.rock.density", 1.0),
        ("stages.0.duration", 2.0),
        ("stages.1.set", {"interfaces.default.friction_angle": 1}),
        ("stages.1.name", "other"),
        ("output.fields", []),
    ],
)
def test_these_are_refused_with_their_path(path, value):
    found = compare(CASE, changed(path, value), begun=2)
    assert not found.allowed
    assert all(p.startswith(path) for p, _, _ in found.refused) and found.refused


def test_a_new_first_stage_is_refused_and_a_new_last_one_is_not():
    new = {"name": "new", "duration": 1.0, "set": {}}
    first, last = deepcopy(CASE), deepcopy(CASE)
    first["stages"].insert(0, new)
    last["stages"].append(new)
    assert compare(CASE, first, begun=2).refused
    assert not compare(CASE, last, begun=2).refused


def test_curves_may_name_the_first_stage_and_no_other_later():
    """Which says the same as to name none: both count from the start of the run."""
    then = CASE | {
        "loads": {"tractions": [{"stage": None}]},
        "water": {"reservoir": {"stage": "one"}},
    }
    for stage, other in (("one", None), ("two", "three")):
        now = CASE | {
            "loads": {"tractions": [{"stage": stage}]},
            "water": {"reservoir": {"stage": other}},
        }
        found = compare(then, now, begun=2)
        assert not found.allowed
        assert len(found.refused) == 2 * (stage == "two")


def test_files_are_compared_by_what_they_hold_and_not_by_their_names():
    other = changed("model.mesh", "elsewhere/a.msh")
    other["model"]["blocks"][0]["file"] = "elsewhere/b.msh"
    found = compare(CASE, other, begun=1)
    assert not found.allowed and not found.refused


@pytest.mark.parametrize(
    ("key", "longer", "shorter"), [("duration", 2.0, 0.5), ("tolerance", 1e-6, 1e-3)]
)
def test_a_stage_goes_on_if_its_end_has_moved_away(key, longer, shorter):
    then = changed(f"stages.2.{key}", 1.0 if key == "duration" else 1e-5)
    for value, is_longer in ((longer, True), (shorter, False)):
        now = changed(f"stages.2.{key}", value)
        assert compare(then, now, begun=3).longer == is_longer


def test_a_key_that_the_run_did_not_know_yet_is_no_change_where_it_is_empty():
    """A run of an earlier cdem goes on; where the key says something, it is another case."""
    now = deepcopy(CASE)
    now["loads"] = {}
    now["model"]["surfaces"] = []
    assert compare(CASE, now, begun=1).refused == []
    now["model"]["surfaces"] = [{"law": "pressure"}]
    (found,) = compare(CASE, now, begun=1).refused
    assert found[0].startswith("model.surfaces")
