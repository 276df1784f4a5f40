"""One run at a time writes into a result folder."""

from __future__ import annotations

import os
import socket
from pathlib import Path

from filelock import FileLock, Timeout

from cdem.case.stored import MARKER
from cdem.errors import CdemError
from cdem.run.written_files import LOCK, mark


class FolderLock:
    """The right to write into a result folder, until it is released or the process ends.

    The system itself releases the lock of a process that has ended in any way.

    Args:
        folder: The result folder.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._lock = FileLock(folder / LOCK, timeout=0, thread_local=False)

    def take(self) -> None:
        """Take the lock, and write its owner into the mark of the folder.

        Raises:
            CdemError: Another run has it, or the file system has no locks.
        """
        if self._lock.is_locked:
            return
        try:
            self._lock.acquire()
        except Timeout:
            raise CdemError(
                f"{self._folder}: a run is writing into this folder{self._holder()}; wait for it, stop "
                "it, or name another folder with -o"
            ) from None
        except NotImplementedError:
            raise CdemError(
                f"{self._folder}: its file system has no locks, so two runs could damage each "
                "other's results; name a folder on another disk with -o"
            ) from None
        mark(self._folder, f"process {os.getpid()} on {socket.gethostname()}")

    def release(self) -> None:
        """Release the lock."""
        self._lock.release()

    def _holder(self) -> str:
        try:
            last = (self._folder / MARKER).read_text().splitlines()[-1]
        except (OSError, IndexError, ValueError):
            return ""
        return f" ({last.removeprefix('Last run: ')})" if last.startswith("Last run: ") else ""
