"""A run in a notebook shows one line, redrawn in place, and elsewhere none."""

from __future__ import annotations

import pytest
from scenes import case

import cdem
from cdem.run import notebook

BLOCKS = [{"group": "box", "box": {"size": [1, 1, 1]}}]
FALL = {"mode": "dynamic", "duration": 0.01}


def falling():
    stages = [{"name": "<fall>", **FALL}, {"name": "last", **FALL}]
    return cdem.Simulation(case(BLOCKS, {"box": {}}, stages=stages), threads=1)


class Shell:
    """IPython as a run sees it."""

    kernel = None


@pytest.fixture
def drawn(monkeypatch):
    """What a notebook was given to draw: (new or drawn again, data)."""
    display = pytest.importorskip("IPython.display", reason="needs the extra 'docs'")
    found = []

    class Handle:
        def update(self, data, raw):
            found.append(("again", data))

    def show(data, raw, display_id):
        found.append(("new", data))
        return Handle()

    monkeypatch.setattr(display, "display", show)
    monkeypatch.setattr("IPython.get_ipython", Shell)
    return found


def test_a_notebook_shows_one_line_redrawn_in_place(drawn, monkeypatch):
    monkeypatch.setattr(notebook, "DRAW_SECONDS", 0.0)
    sim, told = falling(), []
    assert sim.run() == "finished"
    falling().run(told.append)
    assert [how for how, _ in drawn] == ["new", *["again"] * len(told)]
    texts = [data["text/plain"] for _, data in drawn]
    assert texts[0].startswith("<fall>: t 0.0") and texts[-2] == texts[-1]
    assert texts[-1].startswith("last: t 0.02") and f"step {sim.step_count:,}" in texts[-1]
    pages = [data["text/html"] for _, data in drawn]
    assert "&lt;fall&gt;: t" in pages[0] and "value='1.000'" in pages[-2]
    assert "<progress" not in pages[-1]


def test_a_quick_run_draws_no_more_than_it_must(drawn, monkeypatch):
    monkeypatch.setattr(notebook, "DRAW_SECONDS", 3600.0)
    falling().run()
    assert [how for how, _ in drawn] == ["new", "again"]  # its begin and its end


def test_a_function_of_the_script_takes_its_place(drawn):
    told = []
    falling().run(told.append)
    assert {now.stage for now in told} == {"<fall>", "last"} and drawn == []


def test_the_line_stays_where_a_run_fails(drawn):
    sim = falling()
    sim.every(0.01, lambda s: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        sim.run()
    assert drawn and "<progress" not in drawn[-1][1]["text/html"]


@pytest.mark.parametrize("shell", [lambda: None, object])
def test_a_terminal_or_a_script_shows_nothing(drawn, monkeypatch, shell):
    monkeypatch.setattr("IPython.get_ipython", shell)
    assert falling().run() == "finished" and drawn == []
