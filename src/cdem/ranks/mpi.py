"""Ranks that are processes: an `Exchange` by MPI, with mpi4py.

Only buffers of numbers go between ranks; nothing is pickled.
"""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cdem._instruction_sets import cores
from cdem.errors import BackendError
from cdem.ranks.exchange import Neighbour, Sent, as_rows, check_link, rows_in, rows_sent
from cdem.ranks.failures import Failures
from cdem.ranks.launch import launched
from cdem.ranks.silence import Watch, time_limit

INSTALL = (
    "pip install 'cdem[mpi]'; on a cluster, for its own MPI: "
    "MPICC=mpicc pip install --no-binary mpi4py mpi4py"
)
Requests = tuple[list[Any], int, int]
"""Persistent requests of `swap`, number of messages and their bytes."""
MOST_CPUS = 4096
"""Numbers of processors of a machine that `Mpi.threads` can tell apart."""


def imported() -> Any:
    """The module mpi4py.MPI; its import starts MPI.

    Raises:
        BackendError: It is missing, or finds no MPI.
    """
    try:
        from mpi4py import MPI
    except ImportError as error:
        raise BackendError(f"several ranks need mpi4py: {INSTALL}") from error
    except RuntimeError as error:  # mpi4py without an MPI
        raise BackendError(f"mpi4py finds no MPI ({error}): {INSTALL}") from error
    return MPI


def first_words(library: str) -> str:
    """Name and version of an MPI, of all that it says of itself."""
    line = re.split(r"[,\n\0]", library.strip())[0]
    return " ".join(line.replace("MPICH Version:", "MPICH").split())


@cache
def world() -> Mpi:
    """The exchange between all ranks of this launch.

    Raises:
        BackendError: mpi4py is missing, or belongs to another MPI than what started the ranks.
    """
    mpi = imported()
    if mpi.COMM_WORLD.size == 1 < launched():
        library = first_words(mpi.Get_library_version())
        raise BackendError(
            f"{launched()} ranks were started, but mpi4py sees one: it uses another MPI ({library}) "
            "than what started them. Use mpiexec of that MPI, or "
            "build mpi4py for this one: MPICC=mpicc pip install --no-binary mpi4py mpi4py"
        )
    exchange = Mpi(mpi.COMM_WORLD)
    exchange.failures.guard_the_top()
    return exchange


class Mpi:
    """An `Exchange` between the processes of a communicator.

    Args:
        communicator: Of mpi4py; ranks talk by copies of it.

    Attributes:
        library: Name and version of the MPI.
        failures: What ends all ranks after an error.
    """

    def __init__(self, communicator: Any) -> None:
        self._mpi = imported()
        self._comm = communicator.Dup()
        self.library = first_words(self._mpi.Get_library_version())
        self.rank, self.count, self.sent = communicator.rank, communicator.size, Sent()
        self.failures = Failures(self._mpi, communicator)
        self._watch = Watch(self._mpi, communicator, time_limit())
        self._neighbours: list[Neighbour] = []
        self._requests: dict[tuple[int, int, int, int], Requests] = {}

    def add_up(self, words: NDArray[np.int64]) -> None:
        """See `Exchange`."""
        self.sent.count("add_up", words.nbytes)
        with self._watch.during("add_up"):
            self._comm.Allreduce(self._mpi.IN_PLACE, words)

    def gather(self, own: NDArray[np.uint8], all: NDArray[np.uint8]) -> None:
        """See `Exchange`."""
        self.sent.count("gather", own.nbytes)
        with self._watch.during("gather"):
            self._comm.Allgather(own, all)

    def gather_rows(self, own: NDArray[Any]) -> list[NDArray[Any]]:
        """See `Exchange`."""
        own = np.ascontiguousarray(own)
        self.sent.count("gather_rows", own.nbytes)
        size = own.dtype.itemsize * int(np.prod(own.shape[1:]))
        sizes = np.empty((self.count, 2), np.int64)
        with self._watch.during("gather_rows"):
            self._comm.Allgather(np.array([len(own), size]), sizes)
            if (sizes[:, 1] != size).any():
                raise RuntimeError(f"ranks gather rows of different bytes: {sizes[:, 1].tolist()}")
            counts = sizes[:, 0]
            everything = np.empty((counts.sum(), *own.shape[1:]), own.dtype)
            if everything.nbytes:
                row = self._mpi.BYTE.Create_contiguous(size).Commit()
                firsts = np.cumsum(counts) - counts
                to = [everything, (counts, firsts), row]
                self._comm.Allgatherv([own, len(own), row], to)
                row.Free()
        return np.split(everything, np.cumsum(counts)[:-1])

    def share(self, array: NDArray[Any] | None) -> NDArray[Any]:
        """See `Exchange`."""
        kind = ""
        if array is not None and self.rank == 0:
            if array.dtype.hasobject or array.dtype.names:
                raise TypeError(f"numbers can be shared, not {array.dtype}")
            kind = " ".join([array.dtype.str, *map(str, array.shape)])
        with self._watch.during("share"):
            dtype, *shape = self._told(kind).split()
            told: NDArray[Any] = np.empty([int(length) for length in shape], dtype)
            if array is not None and self.rank == 0:
                self.sent.count("share", array.nbytes)
                told[...] = array
            else:
                self.sent.count("share", 0)
            if told.nbytes:
                item = self._mpi.BYTE.Create_contiguous(told.dtype.itemsize).Commit()
                self._comm.Bcast([told, told.size, item])
                item.Free()
        return told

    def share_text(self, text: str) -> str:
        """See `Exchange`."""
        self.sent.count("share_text", 0 if self.rank else len(text.encode()))
        with self._watch.during("share_text"):
            return self._told(text)

    def _told(self, text: str) -> str:
        given = np.frombuffer(text.encode(), np.uint8)
        length = np.array([given.size])
        self._comm.Bcast(length)
        told = given.copy() if self.rank == 0 else np.empty(length[0], np.uint8)
        self._comm.Bcast(told)
        return told.tobytes().decode()

    def link(self, neighbours: Sequence[Neighbour]) -> None:
        """See `Exchange`."""
        sent, given = np.zeros((2, self.count), np.int64)
        for other, rows in rows_sent(neighbours).items():
            sent[other] = rows
        with self._watch.during("link"):
            self._comm.Alltoall(sent, given)
        expected = {other.rank: rows_in(other.receive) for other in neighbours}
        check_link(self.rank, dict(enumerate(given.tolist())), expected)
        self._neighbours = list(neighbours)
        self._forget_requests()

    def swap(
        self, send: NDArray[np.float64], receive: NDArray[np.float64], numbers: int = 1
    ) -> None:
        """See `Exchange`; the arrays are contiguous, and quickest if they are the same each time."""
        rows, into = as_rows(send, numbers), as_rows(receive, numbers)
        key = (send.ctypes.data, receive.ctypes.data, send.size, rows.shape[1])
        if key not in self._requests:
            self._requests[key] = self._prepare(rows, into)
        requests, messages, size = self._requests[key]
        self.sent.count("swap", size, messages)
        with self._watch.during("swap"):
            self._mpi.Prequest.Startall(requests)
            self._mpi.Prequest.Waitall(requests)

    def _prepare(self, rows: NDArray[np.float64], into: NDArray[np.float64]) -> Requests:
        """Requests of `swap` for these arrays."""
        if len(self._requests) >= 8:  # arrays that come and go
            self._forget_requests()
        requests = [
            self._comm.Recv_init(into[other.receive], other.rank)
            for other in self._neighbours
            if rows_in(other.receive)
        ]
        given = [other for other in self._neighbours if rows_in(other.send)]
        requests += [self._comm.Send_init(rows[other.send], other.rank) for other in given]
        return requests, len(given), sum(rows[other.send].nbytes for other in given)

    def _forget_requests(self) -> None:
        for requests, _, _ in self._requests.values():
            for request in requests:
                request.Free()
        self._requests.clear()

    def threads(self) -> int:
        """Threads for this rank: its processors, shared with the ranks that have the same ones."""
        own = np.zeros(MOST_CPUS, np.uint8)
        if hasattr(os, "sched_getaffinity"):  # not on macOS
            own[[cpu for cpu in os.sched_getaffinity(0) if cpu < MOST_CPUS]] = 1
        here = self._comm.Split_type(self._mpi.COMM_TYPE_SHARED)
        everyone = np.empty((here.size, MOST_CPUS), np.uint8)
        with self._watch.during("threads"):
            here.Allgather(own, everyone)
        here.Free()
        alike = int((everyone == own).all(axis=1).sum())
        return max(1, cores() // alike)
