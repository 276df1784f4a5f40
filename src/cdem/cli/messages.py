"""Messages never end a command: stderr may be closed or full, or its reader may be gone."""

from __future__ import annotations

from typing import Any, TextIO


class Messages:
    """A stream that drops text that it cannot write.

    Args:
        stream: Where messages go; None if it was closed before the program began.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write a text, or drop it."""
        if self._stream is not None:
            try:
                self._stream.write(text)
            except (OSError, ValueError):
                self._stream = None  # one failure, no further attempt
        return len(text)

    def flush(self) -> None:
        """Pass on buffered text, or drop it."""
        if self._stream is not None:
            try:
                self._stream.flush()
            except (OSError, ValueError):
                self._stream = None

    def isatty(self) -> bool:
        """Whether it is a terminal."""
        return self._stream is not None and not self._stream.closed and self._stream.isatty()

    def close(self) -> None:
        """Close the stream silently."""
        if self._stream is not None:
            self._stream.close()

    def __getattr__(self, name: str) -> Any:
        if self._stream is None:
            raise OSError(f"stderr is closed: it has no {name}")
        return getattr(self._stream, name)
