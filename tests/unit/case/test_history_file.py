"""Histories from files."""

import pytest

from cdem import Case
from cdem.case.history_file import with_histories
from cdem.case.source import Source
from cdem.errors import CaseError


def rows(folder, text, name="a b.csv"):
    """The rows that a case gets of a file."""
    (folder / name).write_text(text)
    source = Source(file=str(folder / "case.yaml"))
    return with_histories({"history": {"file": name}}, source)["history"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0, 0\n0.5, 2\n", [[0, 0], [0.5, 2]]),
        ("0 0\r\n0.5\t2", [[0, 0], [0.5, 2]]),
        ("# blast\n\ntime [ms]; factor [%]\n0; 0\n # middle\n1.5; 50\n", [[0, 0], [0.0015, 0.5]]),
        ("time, factor\n1e-3, -1\n", [[0.001, -1]]),
        ("\ufefftime [min], factor\n2, 1\n", [[120, 1]]),
    ],
)
def test_two_columns_in_any_unit_become_rows(tmp_path, text, expected):
    assert rows(tmp_path, text) == [pytest.approx(row) for row in expected]


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("0, 0\n1, 2, 3\n", ":2", "not two numbers"),
        ("0, 0\n1, x\n", ":2", "not two numbers"),
        ("time [m], factor\n0, 0\n", ":1", "time"),
        ("time, factor [Pa]\n0, 0\n", ":1", "factor"),
        ("time, factor, more\n0, 0\n", ":1", "3 columns"),
        ("", "", "0 rows"),
        ("time, factor\n", "", "0 rows"),
        ("\x00\x01", ":1", "columns"),
    ],
)
def test_what_is_no_history_is_one_error_with_its_line(tmp_path, text, line, words):
    with pytest.raises(CaseError) as caught:
        rows(tmp_path, text)
    assert f"a b.csv{line}" in str(caught.value) and words in str(caught.value)
    assert "\n" not in str(caught.value) and "history" in str(caught.value)


def test_a_file_that_is_not_there_is_named_with_the_place_in_the_case(tmp_path):
    with pytest.raises(CaseError, match=r"history: .*none\.csv: cannot read the history"):
        with_histories({"history": {"file": "none.csv"}}, Source(file=str(tmp_path / "c.yaml")))


def test_a_case_has_the_rows_of_files_also_of_those_that_a_stage_sets(tmp_path):
    (tmp_path / "h.csv").write_text("time [ms], factor\n0, 0\n5, 1\n")
    (tmp_path / "case.yaml").write_text(
        """\
model: {blocks: [{group: a, box: {size: [1, 1, 1]}}]}
materials: {m: {density: 2600, young_modulus: 1 GPa, poisson_ratio: 0.2}}
groups: {a: {material: m}}
interfaces: {default: {friction_angle: 30}}
loads:
  tractions: [{surface: {group: a, normal: [0, 0, 1]}, traction: [0, 0, 1e5], history: {file: h.csv}}]
stages:
  - {name: one, mode: dynamic, duration: 1 ms}
  - {name: two, mode: dynamic, duration: 1 ms, set: {loads.tractions.0.history: {file: h.csv}}}
"""
    )
    case = Case.load(tmp_path / "case.yaml")
    assert case.loads.tractions[0].history == [(0, 0), (0.005, 1)]
    assert case.stages[1].set["loads.tractions.0.history"] == [[0, 0], [0.005, 1]]
    (tmp_path / "h.csv").write_text("0 2\n")
    case.set("loads.tractions.0.history", {"file": "h.csv"})
    assert case.loads.tractions[0].history == [(0, 2)]


def test_times_of_a_file_must_increase_as_those_of_a_case(tmp_path):
    (tmp_path / "h.csv").write_text("1 0\n0 1\n")
    (tmp_path / "case.yaml").write_text(
        """\
model: {blocks: [{group: a, box: {size: [1, 1, 1]}}]}
materials: {m: {density: 2600, young_modulus: 1 GPa, poisson_ratio: 0.2}}
groups: {a: {material: m}}
interfaces: {default: {friction_angle: 30}}
loads: {surfaces: [{surface: {group: a, normal: [0, 0, 1]}, pressure: 1e5, history: {file: h.csv}}]}
stages: [{name: one, mode: dynamic, duration: 1 ms}]
"""
    )
    with pytest.raises(CaseError, match=r"case\.yaml:5:.*loads\.surfaces\.0.*times must increase"):
        Case.load(tmp_path / "case.yaml")
