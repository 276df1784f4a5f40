"""A result folder that `cdem view` serves, in a thread of the test."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cdem.output.view import ViewServer


@contextmanager
def served(folder: Path) -> Iterator[ViewServer]:
    """Serve a folder until the end of the block."""
    with ViewServer(folder) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True)
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()
