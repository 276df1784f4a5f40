"""The page of a run shows what a case names, and runs none of it."""

from __future__ import annotations

import base64
import gzip
import json
import re
import sys
from html.parser import HTMLParser
from pathlib import Path

import h5py

import cdem
from cdem.output import report

TITLE = """</title><script>alert("1")</script> & "more" $\\frac$"""
HISTORY = "'a' onload=x & $^$"
BLOCK = {"group": "<img src=x>", "box": {"size": [1, 1, 1]}}


class Tags(HTMLParser):
    """Collects the title, and how many scripts there are."""

    def __init__(self) -> None:
        super().__init__()
        self.scripts, self.title, self._tag = 0, "", ""

    def handle_starttag(self, tag, attrs):
        self._tag = tag
        self.scripts += tag == "script"
        assert tag != "img" and not any(name.startswith("on") for name, _ in attrs)

    def handle_data(self, data):
        if self._tag == "title":
            self.title += data


def run(folder: Path) -> Path:
    case = cdem.Case(
        title=TITLE,
        model={"blocks": [BLOCK]},
        materials={"<b>": {"density": 2700, "young_modulus": "1 GPa", "poisson_ratio": 0.25}},
        groups={"<img src=x>": {"material": "<b>"}},
        interfaces={"default": {"friction_angle": 30}},
        stages=[{"name": "<i onload=x>", "mode": "dynamic", "duration": "5 ms"}],
        histories=[{"name": HISTORY, "point": [0, 0, 0], "quantities": ["velocity"]}],
    )
    cdem.Simulation(case, output=folder, threads=1).run()
    return folder


def header(page: str) -> dict:
    """The header of the pack in a page."""
    raw = gzip.decompress(base64.b64decode(re.search('id="data">([^<]+)<', page)[1]))
    return json.loads(raw[4 : 4 + int.from_bytes(raw[:4], "little")])


def test_names_of_a_case_are_text_in_its_report(tmp_path: Path):
    text = report.report(run(tmp_path)).read_text(encoding="utf-8")
    page = Tags()
    page.feed(text)
    assert (page.scripts, page.title.strip()) == (2, TITLE)  # the data, and the page's own
    assert "<img" not in text and "onload" not in text  # all else is in the data
    head = header(text)
    assert head["groups"] == ["<img src=x>"]
    assert f"{HISTORY}.velocity_x [m/s]" in head["columns"]
    assert head["facts"]["tables"][1]["rows"][0][0] == "<i onload=x>"
    assert head["times"][-1] >= 0.005 and head["facts"]["missing"] == ""


def test_it_needs_no_extra(tmp_path: Path, monkeypatch):
    run(tmp_path)
    for extra in ("pyvista", "matplotlib", "vtk"):
        monkeypatch.setitem(sys.modules, extra, None)
    assert report.report(tmp_path).stat().st_size < 150_000


def test_frames_of_an_older_cdem_leave_the_rest_of_the_page(tmp_path: Path):
    run(tmp_path)
    for path in (tmp_path / "surface").iterdir():
        with h5py.File(path, "a") as file:
            del file["VTKHDF/CellData/face"]
    head = header(report.report(tmp_path).read_text(encoding="utf-8"))
    assert "an older cdem wrote these frames" in head["facts"]["missing"]
    assert "times" not in head and head["columns"]
    (tmp_path / "surface" / "frame-0000.vtkhdf").write_bytes(b"damaged")
    head = header(report.report(tmp_path).read_text(encoding="utf-8"))
    assert "is damaged" in head["facts"]["missing"]
