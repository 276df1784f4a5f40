"""The page of a run shows what a case names, and runs none of it."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path

import pytest

import cdem
from cdem.errors import CdemError
from cdem.output import report

ALLOWED = {
    "html",
    "meta",
    "title",
    "style",
    "h1",
    "h2",
    "p",
    "b",
    "pre",
    "img",
    "table",
    "tr",
    "td",
}
TITLE = """<script>alert("1")</script> & "more" $\\frac$"""
HISTORY = "'a' onload=x & $^$"


class Tags(HTMLParser):
    """Collects the tags, their attributes, and the text of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.found: set[str] = set()
        self.alt: list[str | None] = []
        self.text = ""

    def handle_starttag(self, tag, attrs):
        self.found.add(tag)
        assert {name for name, _ in attrs} <= {"lang", "charset", "alt", "src"}
        self.alt += [value for name, value in attrs if name == "alt"]

    def handle_data(self, data):
        self.text += data


def test_names_of_a_case_are_text_in_its_report(tmp_path: Path, monkeypatch):
    pytest.importorskip("matplotlib", reason="needs the extra 'viz'")
    case = cdem.Case(
        title=TITLE,
        model={"blocks": [{"group": "<img src=x>", "box": {"size": [1, 1, 1]}}]},
        materials={"<b>": {"density": 2700, "young_modulus": "1 GPa", "poisson_ratio": 0.25}},
        groups={"<img src=x>": {"material": "<b>"}},
        interfaces={"default": {"friction_angle": 30}},
        stages=[{"name": "<i onload=x>", "mode": "dynamic", "duration": "5 ms"}],
        histories=[{"name": HISTORY, "point": [0, 0, 0], "quantities": ["velocity"]}],
    )
    cdem.Simulation(case, output=tmp_path, threads=1).run()

    def fail(folder):
        raise CdemError("<u>none</u>")

    monkeypatch.setattr(report, "render", fail)
    page = Tags()
    page.feed(report.report(tmp_path).read_text(encoding="utf-8"))
    assert page.found <= ALLOWED
    for shown in (TITLE, "<img src=x>", "<i onload=x>", "No pictures: <u>none</u>"):
        assert shown in page.text
    assert f"history-{HISTORY}" in page.alt
