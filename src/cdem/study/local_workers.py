"""Workers of a sweep on this machine: processes with pipes as their only connection.

No port is open, so other users of the machine cannot connect; nothing is imported from the current
folder.
"""

from __future__ import annotations

import json
import os
import queue
import subprocess
from concurrent.futures import Future, ThreadPoolExecutor
from typing import IO, Any

from cdem._instruction_sets import cores
from cdem.case import child
from cdem.errors import CdemError

TRIES = 3
"""Most starts of a run whose workers crash."""
ALONE = {"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"}
"""Environment of a worker: it has one thread."""
PROGRAM = "cdem.study.worker"
DIED = "its worker crashed repeatedly (out of memory?)"


class LocalWorkers:
    """Processes that execute tasks, each one at a time; a context manager that ends them.

    Args:
        count: Processes; None for one per core that this process may use.
        program: Module that serves tasks, as `cdem.study.worker` does.

    Attributes:
        threads: Number of simultaneous tasks.
        dashboard: Empty: there is no dashboard.
    """

    dashboard = ""

    def __init__(self, count: int | None, program: str = PROGRAM) -> None:
        self.threads = count or cores()
        self._idle: queue.SimpleQueue[_Worker] = queue.SimpleQueue()
        self._all = [_Worker(program) for _ in range(self.threads)]
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
        """Cancel all tasks."""
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
    """A task for a worker."""

    def __init__(self, future: Future[dict[str, Any]]) -> None:
        self._future = future

    @property
    def done(self) -> bool:
        """Whether it has ended."""
        return self._future.done()

    def result(self) -> dict[str, Any]:
        """Its result.

        Raises:
            CdemError: The machine failed, not the case.
        """
        return self._future.result()


class _Worker:
    """One process, started on demand, and again after a crash."""

    def __init__(self, program: str) -> None:
        self._program = program
        self._process: subprocess.Popen[str] | None = None
        self._ended = False

    def execute(self, task: dict[str, Any]) -> dict[str, Any]:
        """The process's answer to a task: "result" or "error"; nothing if it crashed."""
        try:
            asks, tells = self._pipes()
            asks.write(json.dumps(task) + "\n")
            asks.flush()
            return json.loads(tells.readline() or "{}")
        except (BrokenPipeError, ValueError):
            return {}

    def end(self) -> None:
        """End the process at once."""
        self._ended = True
        if self._process is not None:
            self._process.kill()
            self._process.wait()

    def _pipes(self) -> tuple[IO[str], IO[str]]:
        if self._ended:
            raise CdemError("the sweep has ended")
        if self._process is None or self._process.poll() is not None:
            self._process = subprocess.Popen(
                child.module(self._program),
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
                env=os.environ | ALONE,
            )
        assert self._process.stdin is not None and self._process.stdout is not None
        return self._process.stdin, self._process.stdout
