"""What the page of a run says, from the files of its folder alone."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cdem.output.page_facts import case_facts, is_over, page_facts

HISTORIES = "time [s],step,energy error,broken tension,broken shear\n0,0,0,0,0\n2.5,40,2e-2,3,1\n"
SUMMARY = {
    "status": "failed", "title": "A slope", "version": "9", "own_laws": {"a": "b"}, "device": "cpu",
    "threads": 3, "counts": {"elements": 1200, "blocks": 7}, "steps": 40, "time": 2.5,
    "wall_time": 7300.0, "energies": {}, "broken": {"tension": 3, "shear": 1}, "stages": [],
    "groups": {"rock": {"mass": 2.0, "displacement": [3, 0, 4], "velocity": [None, 0, 0],
                        "max_displacement": 6.0, "fastest_block": None}},
}  # fmt: skip


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "histories.csv").write_text(HISTORIES)
    (tmp_path / "case.yaml").write_text("cdem: 2\ntitle: A slope\n")
    (tmp_path / "run.log").write_text("  warning: odd\nx warning: twice\ny warning: twice\nend\n")
    return tmp_path


def test_a_run_that_goes_on(folder):
    facts = page_facts(folder)
    assert (facts["title"], facts["tone"], facts["over"]) == ("A slope", "live", False)
    assert ["time simulated", "2.5 s", ""] in facts["tiles"]
    assert ["energy balance: check before use", "2 %", "doubt"] in facts["tiles"]
    assert facts["warnings"] == ["odd", "twice"]


def test_a_run_that_failed(folder):
    (folder / "summary.json").write_text(json.dumps(SUMMARY))
    facts = page_facts(folder)
    assert (facts["status"], facts["tone"], facts["over"]) == ("failed", "bad", True)
    assert facts["tables"][0]["rows"] == [["rock", "2", "5", "6", "–"]]
    assert ["wall time", "2.03 h", ""] in facts["tiles"]
    assert f"cdem run {folder}/case.yaml -o {folder}.again --allow-code" in facts["repeat"]


def test_a_run_that_was_resumed_is_not_over(folder):
    (folder / "summary.json").write_text(json.dumps(SUMMARY | {"steps": 39}))
    assert not is_over(folder) and page_facts(folder)["tone"] == "live"


CASE = """crs: EPSG:32632
groups:
  bedrock: {fix: [x, y, z]}
  plate: {fix: [x, y, z]}
  wall: {fix: [x, y]}
  body: {fix: []}
loads:
  velocities:
  - {group: plate, velocity: [1, 0, 0]}
"""


def test_fixed_rock_is_that_which_nothing_moves_and_a_map_points_north(folder):
    (folder / "case.yaml").write_text(CASE)
    assert case_facts(folder) == {"fixed": ["bedrock"], "north": True}


@pytest.mark.parametrize(
    "text",
    ["", "groups: [bedrock]", "groups: {bedrock: 3}", "- 1", "a: [", "loads: {velocities: 3}"],
)
def test_a_case_that_cdem_did_not_write_has_no_fixed_rock(folder, text):
    (folder / "case.yaml").write_text(text)
    assert case_facts(folder) == {"fixed": [], "north": False}
    (folder / "case.yaml").unlink()
    assert case_facts(folder) == {"fixed": [], "north": False}
