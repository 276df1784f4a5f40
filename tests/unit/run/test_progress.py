"""How far a run is: on a terminal, in a log, and while there is nothing to count."""

from __future__ import annotations

import io
import threading
import time
from functools import partial

import pytest
from rich.console import Console

from cdem.run import progress
from cdem.run.progress import Progress, describe


def test_the_progress_line_says_it_all():
    now = Progress(
        "slide",
        0.5,
        2.0,
        12345,
        1e-5,
        "bonds of rock at 1, 2, 3 (63 %)",
        3e-3,
        1e-4,
        42,
        1500.0,
        3725.0,
        0.25,
        "a word",
    )
    assert describe(now) == (
        "slide: t 0.5 of 2 s, step 12,345, dt 1e-05 s by bonds of rock "
        "at 1, 2, 3 (63 %), unbalance 0.003, energy error 1.0e-04, "
        "broken 42, 1,500 steps/s, 1:02:05 left, a word"
    )


@pytest.fixture
def now(monkeypatch):
    """A clock that stands still: now[0] [s]."""
    at = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: at[0])
    return at


def test_a_log_has_a_line_a_minute_and_one_at_each_topic(now, capsys):
    with progress.line(silent=False, tty=False) as show:
        for seconds, topic in ((0, "a"), (59, "a"), (61, "a"), (62, "b"), (63, "b"), (122, "b")):
            now[0] = 100.0 + seconds
            show(topic, f"{topic} {seconds}", None)
    assert capsys.readouterr().err.splitlines() == ["a 0", "a 61", "b 62", "b 122"]


def test_a_terminal_has_one_display(monkeypatch):
    screen = io.StringIO()
    terminal = partial(Console, file=screen, force_terminal=True, width=80)
    monkeypatch.setattr("rich.console.Console", lambda stderr: terminal())
    with progress.line(silent=False, tty=True) as show:
        show("a", "step 1 of [all]", None)
        show("a", "step 2 of [all]", 0.25)
    assert "step 2 of [all]" in screen.getvalue()
    assert " 25%" in screen.getvalue()


def test_only_work_that_takes_long_is_told(monkeypatch, capsys):
    with progress.busy("nothing"):
        pass
    assert capsys.readouterr().err == ""
    monkeypatch.setitem(progress.SILENT_SECONDS, False, 0.01)
    monkeypatch.setattr(progress, "LINE_SECONDS", 0.05)
    with progress.busy("meshing"):
        time.sleep(0.2)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "meshing: 0:00"
    assert 2 <= len(lines) <= 5
    with progress.busy("meshing", silent=True):
        time.sleep(0.1)
    assert capsys.readouterr().err == ""


def test_work_that_fails_ends_the_telling(monkeypatch, capsys):
    monkeypatch.setitem(progress.SILENT_SECONDS, False, 0.01)
    with pytest.raises(ZeroDivisionError), progress.busy("meshing"):
        1 / 0  # noqa: B018
    assert not [t for t in threading.enumerate() if t.name == "told"]
