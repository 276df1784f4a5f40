"""Reading: files that are no case, positions, paths and overrides."""

from __future__ import annotations

from pathlib import Path

import pytest

from cdem.case.reader import load_case_data, plain, replace_at, resolve
from cdem.case.source import Source
from cdem.errors import CaseError


@pytest.fixture
def load(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)

    def load(text: str | bytes, overrides=()):
        path = Path("a.yaml")
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return load_case_data(path, overrides)

    return load


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a.yaml: the file is empty; 'cdem new incline' writes one"),
        ("# only a comment\n", "a.yaml: the file is empty"),
        ("- 1\n", "a.yaml:1:1: a case is a mapping (key: value), got a list of 1"),
        ("just words", "a.yaml:1:1: a case is a mapping (key: value), got 'just words'"),
        ("a: 1\na: 2\n", "a.yaml:2:1: a: this key is given twice; keep one"),
        ("b: {a: 1, a: 2}\n", "a.yaml:1:11: a: this key is given twice; keep one"),
        ("a: [1, 2\nb: 3\n", "a.yaml:2:2: not valid YAML"),
        ("a: b: c\n", "a.yaml:1:5: not valid YAML"),
        ("a:\n\t- 1\n", "a.yaml:2:1: not valid YAML"),
        ("a: *none\n", "a.yaml:1:4: not valid YAML"),
        ("a: 'open\n", "not valid YAML"),
        ("a: 1\n---\nb: 2\n", "not valid YAML"),
        ("a: {b: [1, .nan]}\n", "a.yaml:1:12: a.b.1: must be a finite number, got nan"),
        ("a: \x07\n", "not valid YAML"),
        ("? {a: [1]}\n: 2\n", "a list or mapping is used as a key"),
        (b"\x89HDF\xff\xfe", "a.yaml: not a text file"),
    ],
)
def test_files_that_are_no_case(load, text, message):
    with pytest.raises(CaseError) as caught:
        load(text)
    assert message in str(caught.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(CaseError, match=r"none.yaml: cannot read the case file: No such file"):
        load_case_data(tmp_path / "none.yaml")
    with pytest.raises(CaseError, match="Is a directory"):
        load_case_data(tmp_path)


def test_what_is_no_small_file_is_refused(tmp_path):
    with pytest.raises(CaseError, match="cannot read the case file: File name too long"):
        load_case_data(tmp_path / ("x" * 300))
    with pytest.raises(CaseError, match="/dev/zero: a device, not a case file"):
        load_case_data(Path("/dev/zero"))
    with (tmp_path / "a.yaml").open("wb") as file:
        file.truncate(30_000_000)
    with pytest.raises(CaseError, match=r"too large for a study \(30,000,000 bytes\); meshes"):
        load_case_data(tmp_path / "a.yaml", what="study")


def test_positions_count_from_one(load):
    data, source = load("a:\n  - b: 1\n    7: [x, y]\n")
    assert data == {"a": [{"b": 1, "7": ["x", "y"]}]}
    assert source.where("a") == "a.yaml:1:1"
    assert source.where("a.0") == "a.yaml:2:5"
    assert source.where("a.0.7.1") == "a.yaml:3:12"
    assert source.where("a.0.missing.deeper") == "a.yaml:2:5"
    assert source.where("elsewhere") == "a.yaml"


def test_x_and_y_are_not_booleans_and_exponents_are_numbers(load):
    data, _ = load("fix: [x, y]\na: 1e-5\nb: 1_000\n")
    assert data == {"fix": ["x", "y"], "a": 1e-5, "b": 1000}
    assert {type(value) for value in data.values()} == {list, float, int}


def test_anchors_and_merges_are_plain_data(load):
    data, source = load("a: &rock {d: 1}\nb: {<<: *rock, e: 2}\n")
    assert data["b"] == {"d": 1, "e": 2}
    assert source.where("b.d").startswith("a.yaml:")


def test_overrides(load):
    data, source = load(
        "a: {b: [1, 2]}\nc: [{name: n, d: 1}]\n", ["a.b.1=5", "e.f=[7]", "c.n.d='x y'"]
    )
    assert data == {"a": {"b": [1, 5]}, "c": [{"name": "n", "d": "x y"}], "e": {"f": [7]}}
    assert source.where("a.b.1") == "--set a.b.1=5"


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("a.b", "--set a.b: write key.path=value"),
        ("=3", "write key.path=value"),
        ("a..b=3", "write key.path=value"),
        ("a.b.7=3", "--set a.b.7=3: no entry '7' in a.b; it has: 0 to 1"),
        ("a.b.x.y=3", "no entry 'x' in a.b"),
        ("a.b=[1", "--set a.b=[1:1:3: not valid YAML"),
        ("a.b=.inf", "must be a finite number"),
        ("s.t=1", "--set s.t=1: s has no entries"),
    ],
)
def test_bad_overrides(load, override, message):
    with pytest.raises(CaseError) as caught:
        load("a: {b: [1, 2]}\ns: text\n", [override])
    assert message in str(caught.value)


def test_paths_may_hold_keys_with_dots():
    assert resolve({"groups": {"a.b": {"fix": []}}}, "groups.a.b.fix") == ("groups", "a.b", "fix")


def test_replace_at_leaves_the_original():
    tree = {"a": [1, {"b": 2}]}
    assert replace_at(tree, ("a", 1, "b"), 3) == {"a": [1, {"b": 3}]}
    assert tree == {"a": [1, {"b": 2}]}


def test_plain_refuses_infinite_numbers_in_python_data():
    with pytest.raises(CaseError, match=r"case: a.0: must be a finite number"):
        plain({"a": [float("inf")]}, Source())
