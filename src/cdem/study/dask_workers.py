"""Workers of a sweep on other machines: the workers of an existing Dask scheduler."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cdem.errors import BackendError, CdemError
from cdem.study.local_workers import DIED
from cdem.study.worker import execute

Execute = Callable[[dict[str, Any]], dict[str, Any]]


class DaskWorkers:
    """The workers of a client of dask.distributed.

    Args:
        client: The client.
        execute: Executes a task on a worker.
    """

    def __init__(self, client: Any, execute: Execute = execute) -> None:
        self._client, self._execute = client, execute

    @property
    def threads(self) -> int:
        """Threads of all workers now; at least one, so that a task waits for the first worker.

        Raises:
            BackendError: The scheduler no longer answers.
        """
        try:
            if self._client.status == "running":
                return max(sum(self._client.nthreads().values()), 1)
        except (OSError, TimeoutError):
            pass
        raise BackendError(
            "the Dask scheduler no longer answers; finished runs are kept: the same command "
            "continues"
        )

    @property
    def dashboard(self) -> str:
        """Address of the scheduler's dashboard, or nothing."""
        return self._client.dashboard_link or ""

    def submit(self, task: dict[str, Any]) -> DaskTask:
        """Let a worker execute a task."""
        return DaskTask(self._client.submit(self._execute, task, pure=False))

    def cancel(self, tasks: list[DaskTask]) -> None:
        """Cancel all tasks."""
        self._client.cancel([task.future for task in tasks])


class DaskTask:
    """A task for a worker.

    Args:
        future: Future of dask.distributed.
    """

    def __init__(self, future: Any) -> None:
        self.future = future

    @property
    def done(self) -> bool:
        """Whether it has ended; if its worker is lost, another computes it again."""
        return self.future.status not in ("pending", "lost")

    def result(self) -> dict[str, Any]:
        """Its result.

        Raises:
            CdemError: The machine failed, not the case.
        """
        from distributed.scheduler import KilledWorker

        try:
            return self.future.result()
        except CdemError:
            raise
        except KilledWorker:
            raise CdemError(DIED) from None
        except Exception as error:
            raise CdemError(f"{type(error).__name__}: {error}") from None
