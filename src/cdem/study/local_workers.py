"""Workers of a sweep on this machine: processes that are spoken to by pipes, and by nothing else.

No port is open, so no other user of the machine can enter; nothing is imported from the current
folder.
"""

from __future__ import annotations

import json
import os
import queue
import subprocess
from concurrent.futures import Future, ThreadPoolExecutor
from typing import IO, Any

from cdem.case import child
from cdem.errors import CdemError

TRIES = 3
"""So often a run is begun whose worker dies."""
ALONE = {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}
"""Environment of a worker: it has one thread."""
DIED = "its worker died again and again (out of memory?)"


class LocalWorkers:
    """Processes that execute tasks, each one at a time; a context that ends them.

    Args:
        count: Processes; None for one per core that this process may use.

    Attributes:
        threads: Tasks that are executed at a time.
        dashboard: Address of a page that shows them: there is none.
    """

    dashboard = ""

    def __init__(self, count: int | None) -> None:
        self.threads = count or len(os.sched_getaffinity(0))
        self._idle: queue.SimpleQueue[_Worker] = queue.SimpleQueue()
        self._all = [_Worker() for _ in range(self.threads)]
        for worker in self._all:
            self._idle.put(worker)
        self._pool = ThreadPoolExecutor(self.threads)

    def __enter__(self) -> LocalWorkers:
        return self

    def __exit__(self, *_: object) -> None:
        for worker in self._all:
            worker.end()
        self._pool.shutdown(cancel_futures=True)

    def submit(self, task: dict[str, Any]) -> LocalTask:
        """Let the next free worker execute a task."""
        return LocalTask(self._pool.submit(self._execute, task))

    def cancel(self, _: list[LocalTask]) -> None:
        """Give up what is under way."""
        for worker in self._all:
            worker.end()

    def _execute(self, task: dict[str, Any]) -> dict[str, Any]:
        worker = self._idle.get()
        try:
            for _ in range(TRIES):
                said = worker.execute(task)
                if "result" in said:
                    return said["result"]
                if "error" in said:
                    raise CdemError(said["error"])
            raise CdemError(DIED)
        finally:
            self._idle.put(worker)


class LocalTask:
    """A task that a worker executes now or later."""

    def __init__(self, future: Future[dict[str, Any]]) -> None:
        self._future = future

    @property
    def done(self) -> bool:
        """Whether it has come to an end."""
        return self._future.done()

    def result(self) -> dict[str, Any]:
        """What came of it.

        Raises:
            CdemError: The machine failed, not the case.
        """
        return self._future.result()


class _Worker:
    """One process, which is begun when there is something to do, and again after it has died."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[str] | None = None
        self._ended = False

    def execute(self, task: dict[str, Any]) -> dict[str, Any]:
        """What the process says of a task: "result" or "error"; nothing if it died."""
        try:
            asks, tells = self._pipes()
            asks.write(json.dumps(task) + "\n")
            asks.flush()
            return json.loads(tells.readline() or "{}")
        except (BrokenPipeError, ValueError):
            return {}

    def end(self) -> None:
        """End the process, whatever it does."""
        self._ended = True
        if self._process is not None:
            self._process.kill()
            self._process.wait()

    def _pipes(self) -> tuple[IO[str], IO[str]]:
        if self._ended:
            raise CdemError("the sweep has ended")
        if self._process is None or self._process.poll() is not None:
            self._process = subprocess.Popen(
                child.module("cdem.study.worker"),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                env=os.environ | ALONE,
            )
        assert self._process.stdin is not None and self._process.stdout is not None
        return self._process.stdin, self._process.stdout
