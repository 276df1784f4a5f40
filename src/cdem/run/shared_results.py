"""The result folder of a run that ranks share: the first one writes it, for all."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar, cast

from cdem.ranks.first import on_first
from cdem.run.histories import Track, tracks
from cdem.run.result_folder import read_one, row_of

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from cdem.ranks.exchange import Exchange
    from cdem.ranks.shared_core import SharedCore
    from cdem.run.result_folder import Results
    from cdem.run.state import Attributes, RunState

Value = TypeVar("Value")


class SharedResults:
    """The result folder of a shared run, with what `Simulation` asks of `Results`.

    All ranks call the same functions; the first rank does what they say. An error there is one of
    all ranks.

    Attributes:
        folder: The result folder.
        notes: Messages for the user, on the first rank.
    """

    def __init__(self, exchange: Exchange, folder: Path, make: Callable[[], Results]) -> None:
        self._exchange, self.folder = exchange, folder
        self._results = on_first(exchange, make)
        self.notes: list[str] = self._results.notes if self._results else []
        self._tracks: list[Track] = []

    def _do(self, act: Callable[[Results], Value], sim: RunState | None = None) -> Value | None:
        """Do something with the folder, and with the whole state where that is asked for."""
        if sim is not None:
            cast("SharedCore", sim.core).whole()
        return on_first(self._exchange, lambda: act(self._first))

    @property
    def _first(self) -> Results:
        assert self._results is not None
        return self._results

    def open(self, sim: RunState) -> None:
        """See `Results`."""
        self._tracks = tracks(sim)
        self._do(lambda results: results.open(sim), sim)

    def reopen(self, sim: RunState, attributes: Attributes) -> None:
        """See `Results`; no rank has a part of the model yet."""
        self._tracks = tracks(sim)
        self._do(lambda results: results.reopen(sim, attributes))

    def hold(self) -> None:
        """See `Results`."""
        self._do(lambda results: results.hold())

    def release(self) -> None:
        """See `Results`; each rank may call it alone, as after an error."""
        if self._results:
            self._results.release()

    def log(self, text: str) -> None:
        """See `Results`."""
        self._do(lambda results: results.log(text))

    def record(self, sim: RunState, frame: bool) -> None:
        """See `Results`; all ranks make the row, from no more than it asks for."""
        row = row_of(sim, self._tracks)
        self._do(lambda results: results.write(sim, row, frame), sim if frame else None)

    def show_stop(self, sim: RunState) -> None:
        """See `Results`."""
        self._do(lambda results: results.show_stop(sim), sim)

    def checkpoint(self, sim: RunState) -> None:
        """See `Results`."""
        self._do(lambda results: results.checkpoint(sim), sim)

    def read_checkpoint(self) -> tuple[Path, dict[str, NDArray[Any]], Attributes]:
        """See `Results`; the first rank chooses the file, and all read it."""
        read = self._do(lambda results: results.read_checkpoint())
        name = self._exchange.share_text(read[0].name if read else "")
        return read or read_one(self.folder / name)

    def ended(self, sim: RunState) -> str | None:
        """See `Results`."""
        said = self._do(lambda results: results.ended(sim) or "")
        return self._exchange.share_text(said or "") or None

    def finish(self, sim: RunState, status: str) -> None:
        """See `Results`."""
        self._do(lambda results: results.finish(sim, status), sim)

    def fail(self, sim: RunState) -> None:
        """See `Results`."""
        self._do(lambda results: results.fail(sim), sim)
