"""How ranks talk: the calls of an exchange, and one for ranks that are threads of this process.

Every rank makes the same calls in the same order, as each waits for all others. `swap` waits for
neighbours only.
"""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

Result = TypeVar("Result")


@dataclass(frozen=True)
class Neighbour:
    """Another rank that gets rows of this one and gives rows to it.

    Attributes:
        rank: The other rank.
        send: Rows that it gets, of the array to send.
        receive: Rows that it gives, of the array to receive.
    """

    rank: int
    send: slice
    receive: slice


@dataclass
class Sent:
    """What this rank has sent, by the name of the call.

    Attributes:
        messages: One for each neighbour in `swap`, else one for each call.
        bytes: Bytes that this rank gave, once, however many ranks got them.
    """

    messages: Counter[str] = field(default_factory=Counter)
    bytes: Counter[str] = field(default_factory=Counter)

    def count(self, call: str, size: int, messages: int = 1) -> None:
        """Add messages of a call, with the sum of their bytes."""
        self.messages[call] += messages
        self.bytes[call] += size


class Exchange(Protocol):
    """What a rank can tell the others, and learn from them.

    Attributes:
        rank: Number of this rank, from 0.
        count: Number of ranks.
        sent: What this rank has sent.
    """

    rank: int
    count: int
    sent: Sent

    def add_up(self, words: NDArray[np.int64]) -> None:
        """Replace words by their sums over all ranks."""

    def gather(self, own: NDArray[np.uint8], all: NDArray[np.uint8]) -> None:
        """Write the bytes of all ranks, as many of each, into `all`, rank after rank."""

    def gather_rows(self, own: NDArray[Any]) -> list[NDArray[Any]]:
        """The arrays of all ranks: of any length, of one type, rows of one shape."""

    def share(self, array: NDArray[Any] | None) -> NDArray[Any]:
        """The array of rank 0; the other ranks give None."""

    def share_text(self, text: str) -> str:
        """The text of rank 0."""

    def link(self, neighbours: Sequence[Neighbour]) -> None:
        """Say which rows `swap` sends and receives from now on."""

    def swap(
        self, send: NDArray[np.float64], receive: NDArray[np.float64], numbers: int = 1
    ) -> None:
        """Send rows to each neighbour and receive theirs.

        Args:
            send: Rows, (rows, numbers), or flat.
            receive: As many numbers in a row.
            numbers: Numbers in a row of flat arrays.
        """


def rows_in(part: slice) -> int:
    """Number of rows of a part."""
    if part.step not in (None, 1) or not 0 <= part.start <= part.stop:
        raise ValueError(f"not a range of rows: {part}")
    return int(part.stop - part.start)


def rows_sent(neighbours: Sequence[Neighbour]) -> dict[int, int]:
    """Number of rows that each neighbour gets, by rank."""
    sent = {other.rank: rows_in(other.send) for other in neighbours}
    if len(sent) < len(neighbours):
        raise ValueError("a rank is a neighbour twice")
    return sent


def as_rows(array: NDArray[np.float64], numbers: int) -> NDArray[np.float64]:
    """A view of an array as rows."""
    return array if array.ndim == 2 else array.reshape(-1, numbers)


def check_link(rank: int, given: dict[int, int], expected: dict[int, int]) -> None:
    """Refuse links that do not fit together.

    Args:
        rank: This rank.
        given: Rows that the other ranks send to it, by rank; ranks that send none may be left out.
        expected: Rows that it receives, by rank.
    """
    for other in sorted(given.keys() | expected.keys()):
        if given.get(other, 0) != expected.get(other, 0):
            raise RuntimeError(
                f"rank {rank} expects {expected.get(other, 0)} rows of rank {other}, "
                f"which sends {given.get(other, 0)}"
            )


class _Room:
    """Where the threads of a group meet.

    A rank may be one meeting ahead of the others' reading, so there are two sets of places, used
    in turn.
    """

    def __init__(self, count: int, timeout: float | None) -> None:
        self.barrier = threading.Barrier(count, timeout=timeout)
        self.places: tuple[list[Any], list[Any]] = ([None] * count, [None] * count)


class Threads:
    """An `Exchange` between threads of this process, for tests and for trying a model.

    Made by `group`; `run_ranks` starts the threads.
    """

    def __init__(self, rank: int, count: int, room: _Room) -> None:
        self.rank, self.count, self.sent = rank, count, Sent()
        self._room, self._turn = room, 0
        self._neighbours: list[Neighbour] = []

    @staticmethod
    def group(count: int, timeout: float | None = None) -> list[Threads]:
        """The exchanges of all ranks.

        Args:
            count: Number of ranks.
            timeout: Longest wait for other ranks [s]; None for no limit.
        """
        room = _Room(count, timeout)
        return [Threads(rank, count, room) for rank in range(count)]

    def meet(self, call: str, given: Any) -> list[Any]:
        """Give something to all ranks, in a call of this name, and get what each gives."""
        places = self._room.places[self._turn]
        self._turn = 1 - self._turn
        places[self.rank] = (call, given)
        self._room.barrier.wait()
        if any(other != call for other, _ in places):
            calls = ", ".join(f"rank {rank} {other}" for rank, (other, _) in enumerate(places))
            raise RuntimeError(f"ranks meet in different calls: {calls}")
        return [theirs for _, theirs in places]

    def abort(self) -> None:
        """Let all ranks that wait, and all that come, fail with `BrokenBarrierError`."""
        self._room.barrier.abort()

    def add_up(self, words: NDArray[np.int64]) -> None:
        """See `Exchange`."""
        self.sent.count("add_up", words.nbytes)
        np.sum(self.meet("add_up", words.copy()), axis=0, out=words)

    def gather(self, own: NDArray[np.uint8], all: NDArray[np.uint8]) -> None:
        """See `Exchange`."""
        self.sent.count("gather", own.nbytes)
        np.concatenate(self.meet("gather", own.copy()), out=all)

    def gather_rows(self, own: NDArray[Any]) -> list[NDArray[Any]]:
        """See `Exchange`."""
        self.sent.count("gather_rows", own.nbytes)
        return [theirs.copy() for theirs in self.meet("gather_rows", own.copy())]

    def share(self, array: NDArray[Any] | None) -> NDArray[Any]:
        """See `Exchange`."""
        given = None if array is None or self.rank else array.copy()
        self.sent.count("share", 0 if given is None else given.nbytes)
        told: NDArray[Any] = self.meet("share", given)[0]
        return told.copy()

    def share_text(self, text: str) -> str:
        """See `Exchange`."""
        self.sent.count("share_text", 0 if self.rank else len(text.encode()))
        told: str = self.meet("share_text", text)[0]
        return told

    def link(self, neighbours: Sequence[Neighbour]) -> None:
        """See `Exchange`."""
        links = self.meet("link", rows_sent(neighbours))
        given = {other: link.get(self.rank, 0) for other, link in enumerate(links)}
        check_link(self.rank, given, {other.rank: rows_in(other.receive) for other in neighbours})
        self._neighbours = list(neighbours)

    def swap(
        self, send: NDArray[np.float64], receive: NDArray[np.float64], numbers: int = 1
    ) -> None:
        """See `Exchange`."""
        rows, into = as_rows(send, numbers), as_rows(receive, numbers)
        parts = {other.rank: rows[other.send].copy() for other in self._neighbours}
        for part in parts.values():
            self.sent.count("swap", part.nbytes, messages=int(part.size > 0))
        given = self.meet("swap", parts)
        for other in self._neighbours:
            into[other.receive] = given[other.rank][self.rank]


def run_ranks(
    count: int, act: Callable[[Threads], Result], timeout: float | None = None
) -> list[Result]:
    """Run a function on each rank, a thread for each.

    Args:
        count: Number of ranks.
        act: Gets the exchange of its rank.
        timeout: Longest wait of a rank for others [s]; None for no limit.

    Returns:
        What the function returned on each rank.

    Raises:
        BaseException: The first error of a rank; it ends the waiting of all others.
    """
    results: dict[int, Result] = {}
    errors: list[BaseException] = []

    def be_rank(exchange: Threads) -> None:
        try:
            results[exchange.rank] = act(exchange)
            exchange.meet("its end", None)
        except BaseException as error:
            errors.append(error)
            exchange.abort()

    group = Threads.group(count, timeout)
    threads = [threading.Thread(target=be_rank, args=(exchange,)) for exchange in group]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for error in sorted(errors, key=lambda e: isinstance(e, threading.BrokenBarrierError)):
        if isinstance(error, threading.BrokenBarrierError):
            raise RuntimeError(f"a rank waited longer than {timeout} s for the others") from error
        raise error
    return [results[rank] for rank in range(count)]
