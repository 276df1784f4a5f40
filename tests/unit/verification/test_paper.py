"""`cdem verify --paper`: the figures of Feng et al. (2014)."""

from __future__ import annotations

import re
from pathlib import Path

from cdem.verification.runner import problems_of_paper
from cdem.verification.stored import STORED

DOCS = Path(__file__).parents[3] / "docs"
PAGE = (DOCS / "paper.md").read_text()
FIGURES = range(1, 29)


def figures(text):
    """Numbers of the figures that a text names."""
    found = set()
    for first, last in re.findall(r"\b(\d+)(?: to (\d+))?", text):
        found |= set(range(int(first), int(last or first) + 1))
    return found


def test_problems_come_in_the_order_of_the_figures():
    found = problems_of_paper()
    names = [problem.name for problem in found]
    assert names[:2] == ["swing", "contact_types"] and names[-1] == "apparent_dip"
    assert {"tension", "cohesion", "friction", "toppling", "tilted_wall", "crossed"} < set(names)
    for problem in found:
        assert f"cdem verify {problem.name}" in PAGE


def test_the_page_has_every_figure():
    named = set()
    for words in re.findall(r"\bFigs?\. ([\d, to]+)", PAGE):
        named |= figures(words)
    for words in re.findall(r"^\| ([\d, to]+) \|", PAGE, re.MULTILINE):
        named |= figures(words)
    assert named >= set(FIGURES)
    for picture in re.findall(r"\]\((pictures/[^)]+)\)", PAGE):
        assert (DOCS / picture).is_file(), picture


def test_stored_results_are_those_of_their_pages():
    pages = "".join((DOCS / name).read_text() for name in ("jiweishan.md", "apparent_dip.md"))
    pages = pages.replace("−", "-")
    for stored in STORED:
        for number in re.findall(r"-?\d[\d,]*\.?\d*", stored.ours):
            assert number in pages, number
        assert stored.figure in PAGE


def test_what_is_stored_is_printed_after_the_problems(monkeypatch, run_cli):
    from cdem.verification import runner

    one = [problem for problem in problems_of_paper() if problem.name == "crossed"]
    monkeypatch.setattr(runner, "problems_of_paper", lambda: one)
    status, out, _ = run_cli("verify", "--paper", "--threads", "1")
    assert status == 0 and "2.927" in out
    assert out.index("sliding acceleration") < out.index("Figs. 22, 23: Jiweishan")
    status, _, err = run_cli("verify", "sliding", "--paper")
    assert status == 1 and "leave out the names" in err
