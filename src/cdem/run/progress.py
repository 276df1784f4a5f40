"""Progress of a run: a live display on a terminal, a line per minute in a log file."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Event, Thread
from typing import Any

LINE_SECONDS = 60.0
"""Wall time between lines in a log file [s]."""
SILENT_SECONDS = {True: 3.0, False: 20.0}
"""Longer work is announced; times by whether there is a terminal [s]."""
BAR_WIDTH = 20
"""Width of the bar on a terminal [characters]."""

Show = Callable[[str, str, float | None], None]
"""Shows (topic, text, fraction done)."""


@dataclass
class Progress:
    """Progress of a run.

    Attributes:
        stage: Name of the running stage.
        time: Simulated time [s].
        end_time: Time at which the stage ends [s], or None for a static stage.
        step: Steps done.
        dt: Time step [s].
        rules: Cause and place of the limit of the step, or nothing if masses are scaled to it.
        unbalance_ratio: Out-of-balance over applied forces.
        energy_error: Closing error of the energy ledger.
        broken: Broken semi-springs.
        steps_per_second: Speed over the last report.
        time_left: Estimate of the stage's remaining wall time [s], or None.
        fraction: Part of the stage that is done, or None.
        note: Advice for the user, or nothing.
    """

    stage: str
    time: float
    end_time: float | None
    step: int
    dt: float
    rules: str
    unbalance_ratio: float
    energy_error: float
    broken: int
    steps_per_second: float
    time_left: float | None
    fraction: float | None
    note: str


@contextmanager
def watch(*, silent: bool, tty: bool) -> Iterator[Callable[[Progress], None] | None]:
    """Give the progress function of a run; see `line`."""
    with line(silent=silent, tty=tty) as show:
        yield None if show is None else lambda p: show(p.stage, describe(p), p.fraction)


@contextmanager
def line(*, silent: bool, tty: bool) -> Iterator[Show | None]:
    """Give the function that shows progress on stderr.

    Args:
        silent: Show nothing.
        tty: Whether stderr is a terminal, which can be redrawn; else a line appears for each new
            topic and every minute.
    """
    if silent:
        yield None
    elif tty:
        with _display() as display:
            task = display.add_task("", total=None)
            yield lambda topic, text, part: display.update(
                task, description=text, completed=part or 0.0, total=None if part is None else 1.0
            )
    else:
        yield _plain_lines()


@contextmanager
def busy(what: str, *, silent: bool = False) -> Iterator[None]:
    """Announce long work on stderr: live on a terminal, else a line per minute.

    Args:
        what: The work within the block, e.g. "building the model".
        silent: Print nothing.
    """
    if silent:
        yield
        return
    done = Event()
    teller = Thread(target=_tell, args=(what, done, sys.stderr.isatty()), daemon=True, name="told")
    teller.start()
    try:
        yield
    finally:
        done.set()
        teller.join()


def _tell(what: str, done: Event, tty: bool) -> None:
    began = time.monotonic()
    if done.wait(SILENT_SECONDS[tty]):
        return
    if tty:
        with _display(timed=True) as display:
            display.add_task(what, total=None)
            done.wait()
        return
    while True:
        print(f"{what}: {clock(time.monotonic() - began)}", file=sys.stderr, flush=True)
        if done.wait(LINE_SECONDS):
            return


@contextmanager
def _display(*, timed: bool = False) -> Iterator[Any]:
    """A bar and a text; for work of unknown length, the elapsed time."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn
    from rich.table import Column

    text = TextColumn("{task.description}", markup=False, table_column=Column(ratio=1))
    last = TimeElapsedColumn() if timed else TaskProgressColumn()
    columns = (BarColumn(BAR_WIDTH), last, text)
    with Progress(*columns, console=Console(stderr=True), transient=timed, expand=True) as display:
        yield display


def _plain_lines() -> Show:
    last_time, last_topic = -LINE_SECONDS, ""

    def show(topic: str, text: str, part: float | None) -> None:
        nonlocal last_time, last_topic
        now = time.monotonic()
        if now - last_time >= LINE_SECONDS or topic != last_topic:
            last_time, last_topic = now, topic
            print(text, file=sys.stderr, flush=True)

    return show


def describe(p: Progress) -> str:
    """One line: stage, time, step, step size, unbalance, energy error, broken, speed, time left."""
    end = "" if p.end_time is None else f" of {p.end_time:.4g}"
    left = "" if p.time_left is None else f", {clock(p.time_left)} left"
    note = f", {p.note}" if p.note else ""
    rules = f" by {p.rules}" if p.rules else ""
    return (
        f"{p.stage}: t {p.time:.4g}{end} s, step {p.step:,}, dt {p.dt:.3g} s{rules}, "
        f"unbalance {p.unbalance_ratio:.2g}, energy error {p.energy_error:.1e}, "
        f"broken {p.broken:,}, {p.steps_per_second:,.0f} steps/s{left}{note}"
    )


def clock(seconds: float) -> str:
    """Write a time as minutes:seconds or hours:minutes:seconds."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
