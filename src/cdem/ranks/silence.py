"""Ranks that keep others waiting: after a time they are named, and all ranks end.

A thread looks about once a second whether its rank is still in the same call. It talks with the
threads of other ranks by a communicator of its own, so the calls themselves are not slowed.
"""

from __future__ import annotations

import atexit
import os
import threading
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem.errors import BackendError
from cdem.ranks.failures import end

TIMEOUT = 600.0
"""Longest wait for other ranks, unless CDEM_MPI_TIMEOUT tells another [s]."""
ANSWER_TIME = 3.0
"""A rank that works answers within this time [s]."""
TURN, MOST_TURNS = 1.0, 6
"""Where ranks cannot ask, each waits for those below it, so long each and at most [s]: one tells."""
ASK, ANSWER = 1, 2
"""Tags of messages: calls begun, place of the present one in CALLS or -1, seconds in or outside it."""
CALLS = ("add_up", "gather", "gather_rows", "share", "share_text", "link", "swap", "threads")

States = dict[int, NDArray[np.int64] | None]
"""By rank: the three numbers of a message, or None for one that does not answer."""


def time_limit() -> float:
    """Longest wait for other ranks [s].

    Raises:
        BackendError: CDEM_MPI_TIMEOUT is not a positive number.
    """
    text = os.environ.get("CDEM_MPI_TIMEOUT", str(TIMEOUT))
    try:
        limit = float(text)
    except ValueError:
        limit = 0.0
    if not limit > 0:
        raise BackendError(f"CDEM_MPI_TIMEOUT={text}: must be a positive number of seconds")
    return limit


class Watch:
    """Marks the calls of a rank, and ends all ranks when one lasts too long.

    Args:
        mpi: The module mpi4py.MPI.
        communicator: Of the ranks; a copy of it is used.
        limit: Longest wait in a call [s].
    """

    def __init__(self, mpi: Any, communicator: Any, limit: float) -> None:
        self._mpi, self._comm, self._limit = mpi, communicator.Dup(), limit
        self._call = CALLS[0]
        self._marks = 0  # odd within a call
        self._seen, self._since = 0, time.monotonic()
        self._answers: list[Any] = []  # requests keep what they send
        self._over = threading.Event()
        self._asks = mpi.Query_thread() == mpi.THREAD_MULTIPLE
        self._thread = threading.Thread(target=self._look, daemon=True, name="ranks")
        if communicator.size > 1:
            self._thread.start()
            atexit.register(self.stop)

    def during(self, call: str) -> Watch:
        """A block within a call of this name."""
        self._call = call
        return self

    def __enter__(self) -> None:
        self._marks += 1

    def __exit__(self, *error: object) -> None:
        self._marks += 1

    def stop(self) -> None:
        """End the watching."""
        self._over.set()
        self._thread.join(ANSWER_TIME)

    def _look(self) -> None:
        while not self._over.wait(min(1.0, self._limit / 10)):
            state = self._state()
            if self._asks:
                self._answer_all()
            if state[1] >= 0 and self._waited() > self._limit:
                self._complain(state)

    def _waited(self) -> float:
        return time.monotonic() - self._since

    def _state(self) -> NDArray[np.int64]:
        """Calls begun, the present one or -1, and seconds in or outside of it."""
        marks = self._marks
        if marks != self._seen:
            self._seen, self._since = marks, time.monotonic()
        call = CALLS.index(self._call) if marks % 2 else -1
        return np.array([(marks + 1) // 2, call, int(self._waited())])

    def _answer_all(self) -> bool:
        """Answer the ranks that ask; returns whether a lower one did, which will tell the user."""
        status, lower = self._mpi.Status(), False
        while self._comm.Iprobe(tag=ASK, status=status):
            asking = status.Get_source()
            self._comm.Recv(np.empty(3, np.int64), asking, ASK)
            self._answers.append(self._comm.Isend(self._state(), asking, ANSWER))
            lower = lower or asking < self._comm.rank
        return lower

    def _complain(self, state: NDArray[np.int64]) -> None:
        waits = (
            f"rank {self._comm.rank} of {self._comm.size} has waited {self._waited():.0f} s for "
            f"others, in {CALLS[state[1]]} (call {state[0]})"
        )
        if not self._asks:
            time.sleep(TURN * min(self._comm.rank, MOST_TURNS))
            end(self._mpi, f"{waits}; this MPI cannot say for which (CDEM_MPI_TIMEOUT)")
        states = self._ask()
        if states is None or self._is_told_by_lower(states):
            self._since = time.monotonic()
        elif self._state()[0] == state[0] and self._state()[1] == state[1]:  # it still waits
            end(self._mpi, f"{waits}: {silent_ones(states)} (CDEM_MPI_TIMEOUT)")

    def _is_told_by_lower(self, states: States) -> bool:
        """Whether a lower rank has waited so long that it tells the user, or is about to."""
        return any(
            state is not None and state[1] >= 0 and state[2] > self._limit - 2 * ANSWER_TIME
            for rank, state in states.items()
            if rank < self._comm.rank
        )

    def _ask(self) -> States | None:
        """The states of all other ranks, None for one without answer; None if a lower one asks."""
        states: States = {}
        own, requests = self._state(), []
        for other in range(self._comm.size):
            if other != self._comm.rank:
                states[other] = None
                requests.append(self._comm.Isend(own, other, ASK))
        until, status = time.monotonic() + ANSWER_TIME, self._mpi.Status()
        while time.monotonic() < until and any(state is None for state in states.values()):
            if self._answer_all():
                return None
            while self._comm.Iprobe(tag=ANSWER, status=status):
                state = np.empty(3, np.int64)
                self._comm.Recv(state, status.Get_source(), ANSWER)
                states[status.Get_source()] = state
            time.sleep(0.01)
        return states


def silent_ones(states: States) -> str:
    """Say which ranks keep the others waiting.

    Args:
        states: Of the other ranks.
    """
    silent, waiting = [], []
    for rank, state in states.items():
        if state is None:
            silent.append(f"rank {rank} does not answer")
        elif state[1] < 0:
            silent.append(f"rank {rank} computes since {state[2]} s, after call {state[0]}")
        else:
            waiting.append(f"rank {rank} waits in {CALLS[state[1]]} (call {state[0]})")
    told = silent or waiting
    return "; ".join(told[:10]) + ("; and more" if len(told) > 10 else "")
