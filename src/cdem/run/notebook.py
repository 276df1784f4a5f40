"""Progress of a run in a notebook: a bar and a line that are redrawn in place."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from typing import Any

from cdem.run.progress import Progress, describe

DRAW_SECONDS = 0.25
"""Least wall time from one drawing to the next [s]."""
BAR = "<progress style='width:12em;vertical-align:middle'{}></progress> "
"""The bar; a browser animates one without a value."""


@contextmanager
def watched(
    progress: Callable[[Progress], None] | None,
) -> Iterator[Callable[[Progress], None] | None]:
    """Give the progress function of a run: the given one, else that of a notebook, else None.

    Args:
        progress: The function that a script gave to the run, or None.
    """
    if progress or not _in_notebook():
        yield progress
        return
    line = _Line()
    try:
        yield line.show
    finally:
        line.end()


def _in_notebook() -> bool:
    """Whether a kernel of Jupyter runs this code; a terminal of IPython has no kernel."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return hasattr(shell, "kernel")


class _Line:
    """A bar and a line, shown at the first call."""

    def __init__(self) -> None:
        self._display: Any = None
        self._text = ""
        self._drawn = -DRAW_SECONDS

    def show(self, now: Progress) -> None:
        self._text = describe(now)
        if time.monotonic() - self._drawn < DRAW_SECONDS:
            return
        self._drawn = time.monotonic()
        part = now.fraction
        self._draw(BAR.format("" if part is None else f" value='{min(part, 1.0):.3f}'"))

    def end(self) -> None:
        """Leave the last line, without a bar."""
        if self._text:
            self._draw("")

    def _draw(self, bar: str) -> None:
        from IPython.display import display

        html = f"<div style='font-variant-numeric:tabular-nums'>{bar}{escape(self._text)}</div>"
        data = {"text/plain": self._text, "text/html": html}
        if self._display is None:
            self._display = display(data, raw=True, display_id=True)
        else:
            self._display.update(data, raw=True)
