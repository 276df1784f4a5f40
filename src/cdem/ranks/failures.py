"""How ranks fail: an error that all have is told once; any other ends all ranks."""

from __future__ import annotations

import os
import sys
import threading
import time
import traceback
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import TracebackType
from typing import Any, NoReturn

import numpy as np

from cdem.errors import CdemError

PATIENCE = 5.0
"""A rank that fails waits so long for the others to fail too [s]."""
TELLING = 0.5
"""What started the ranks passes on the last words within this time; some drop them at an abort [s]."""
ABORT_TIME = 3.0
"""An abort that lasts longer hangs [s]."""
FAILED = 70
"""Exit status of all ranks after an error of some of them."""


def words_of(error: BaseException) -> str:
    """What to tell of an error; a traceback, unless it is meant for users."""
    if isinstance(error, CdemError):
        return str(error)
    if isinstance(error, SystemExit):
        return f"ended with status {error.code}"
    return "".join(traceback.format_exception(error)).rstrip()


def tell(words: str) -> None:
    """Print words, on any rank; ranks other than the first print nothing otherwise."""
    with suppress(OSError, ValueError):
        print(words, file=sys.__stderr__, flush=True)


def end(mpi: Any, words: str) -> NoReturn:
    """Print words and end all ranks.

    An MPI for one thread may be in a call of another one. Its abort is tried all the same: where a
    rank ends without, the status may be that of the ranks that are killed then.
    """
    tell(words)
    with suppress(OSError, ValueError):
        sys.stdout.flush()
    time.sleep(TELLING)
    threading.Timer(ABORT_TIME, os._exit, [FAILED]).start()
    mpi.COMM_WORLD.Abort(FAILED)
    os._exit(FAILED)  # some return from Abort


class Failures:
    """The end of all ranks after an error.

    Args:
        mpi: The module mpi4py.MPI.
        communicator: Of the ranks; a copy of it is used.
    """

    def __init__(self, mpi: Any, communicator: Any) -> None:
        self._mpi, self._comm = mpi, communicator.Dup()
        self._settled = False

    def settle(self, error: BaseException) -> None:
        """Return if all ranks have failed, else end them all with the words of this error."""
        if self._settled:
            return
        self._settled = True
        words = words_of(error)
        me, kinds = self._comm.rank, self._kinds(words)
        if kinds is None:
            end(self._mpi, f"rank {me} of {self._comm.size}: {words}")
        elif kinds.index(kinds[me]) == me > 0:  # not the error of rank 0, nor of one before
            tell(f"rank {me} of {self._comm.size}: {words}")

    def _kinds(self, words: str) -> list[int] | None:
        """A number for the error of each rank, or None if some have none."""
        own, kinds = np.array([zlib.crc32(words.encode())]), np.empty(self._comm.size, np.int64)
        until = time.monotonic() + PATIENCE
        try:
            request = self._comm.Iallgather(own, kinds)
            while not request.Test():
                if time.monotonic() > until:
                    return None
                time.sleep(0.01)
        except BaseException:  # MPI does not work any more, or the user is impatient
            return None
        return kinds.tolist()

    @contextmanager
    def told(self) -> Iterator[None]:
        """Let errors that all ranks have pass; any other ends all ranks here."""
        try:
            yield
        except BaseException as error:
            if not (isinstance(error, SystemExit) and not error.code):
                self.settle(error)
            raise

    def guard_the_top(self) -> None:
        """Do the same for errors that nothing catches; of those that all have, rank 0 tells."""
        before = sys.excepthook

        def at_the_top(
            kind: type[BaseException], error: BaseException, trace: TracebackType | None
        ) -> None:
            self.settle(error)
            if self._comm.rank == 0:
                before(kind, error, trace)

        sys.excepthook = at_the_top
