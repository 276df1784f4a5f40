"""How far a run is, and the line that shows it: live on a terminal, now and then in a log file."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

LINE_SECONDS = 5.0  # wall time between lines where nothing can be redrawn
BAR_WIDTH = 20  # characters


@dataclass
class Progress:
    """Where a run is.

    Attributes:
        stage: Name of the running stage.
        time: Simulated time [s].
        end_time: Time at which the stage ends [s], or None for a static stage.
        step: Steps done.
        dt: Time step [s].
        rules: What rules it and where, or nothing where masses are made for it.
        unbalance_ratio: Out-of-balance over applied forces.
        energy_error: Closing error of the energy ledger.
        broken: Broken semi-springs.
        steps_per_second: Speed over the last report.
        time_left: Estimate of the stage's remaining wall time [s], or None.
        fraction: Part of the stage that is done, or None.
        note: What a user should know now, or nothing.
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
    """Give the function that a run calls with its progress; see `line`."""
    with line(silent=silent, tty=tty) as show:
        yield None if show is None else lambda p: show(p.stage, describe(p), p.fraction)


@contextmanager
def line(*, silent: bool, tty: bool) -> Iterator[Callable[[str, str, float | None], None] | None]:
    """Give the function that shows (topic, text, part that is done) on stderr.

    Args:
        silent: Show nothing.
        tty: Whether stderr is a terminal, whose line can be redrawn; else there is a line every
            few seconds and at each new topic.
    """
    if silent:
        yield None
    elif tty:
        with _live_line() as show:
            yield show
    else:
        yield _plain_lines()


@contextmanager
def _live_line() -> Iterator[Callable[[str, str, float | None], None]]:
    from rich.console import Console
    from rich.live import Live
    from rich.text import Text

    with Live(console=Console(stderr=True), auto_refresh=False) as live:
        yield lambda topic, text, part: live.update(Text(f"{_bar(part)}{text}"), refresh=True)


def _plain_lines() -> Callable[[str, str, float | None], None]:
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


def _bar(part: float | None) -> str:
    if part is None:
        return ""
    done = round(BAR_WIDTH * min(max(part, 0.0), 1.0))
    return f"[{'=' * done}{' ' * (BAR_WIDTH - done)}] {part:4.0%} "


def clock(seconds: float) -> str:
    """Write a time as minutes:seconds or hours:minutes:seconds."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
