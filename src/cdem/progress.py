"""The line that shows how far a run is: live on a terminal, now and then in a log file."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cdem.simulation import Progress

LINE_SECONDS = 5.0  # wall time between lines where nothing can be redrawn
BAR_WIDTH = 20  # characters


@contextmanager
def watch(*, silent: bool, tty: bool) -> Iterator[Callable[[Progress], None] | None]:
    """Give the function that a run calls with its progress.

    Args:
        silent: Show nothing.
        tty: Whether stderr is a terminal, whose line can be redrawn.
    """
    if silent:
        yield None
    elif tty:
        with _live_line() as show:
            yield show
    else:
        yield _plain_lines()


@contextmanager
def _live_line() -> Iterator[Callable[[Progress], None]]:
    from rich.console import Console
    from rich.live import Live
    from rich.text import Text

    with Live(console=Console(stderr=True), auto_refresh=False) as live:
        yield lambda p: live.update(Text(f"{_bar(p)}{describe(p)}"), refresh=True)


def _plain_lines() -> Callable[[Progress], None]:
    last_time, last_stage = -LINE_SECONDS, ""

    def show(progress: Progress) -> None:
        nonlocal last_time, last_stage
        now = time.monotonic()
        if now - last_time >= LINE_SECONDS or progress.stage != last_stage:
            last_time, last_stage = now, progress.stage
            print(describe(progress), file=sys.stderr, flush=True)

    return show


def describe(p: Progress) -> str:
    """One line: stage, time, step, step size, unbalance, energy error, broken, speed, time left."""
    end = "" if p.end_time is None else f" of {p.end_time:.4g}"
    left = "" if p.time_left is None else f", {_clock(p.time_left)} left"
    note = f", {p.note}" if p.note else ""
    return (
        f"{p.stage}: t {p.time:.4g}{end} s, step {p.step:,}, dt {p.dt:.3g} s, "
        f"unbalance {p.unbalance_ratio:.2g}, energy error {p.energy_error:.1e}, "
        f"broken {p.broken:,}, {p.steps_per_second:,.0f} steps/s{left}{note}"
    )


def _bar(p: Progress) -> str:
    if p.fraction is None:
        return ""
    done = round(BAR_WIDTH * min(max(p.fraction, 0.0), 1.0))
    return f"[{'=' * done}{' ' * (BAR_WIDTH - done)}] {p.fraction:4.0%} "


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
