"""Parameter studies: many runs of a case on local processes or on Dask, each done only once."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cdem.errors import BackendError, CdemError
from cdem.run.progress import clock
from cdem.study.dask_workers import DaskTask, DaskWorkers, Execute
from cdem.study.local_workers import LocalTask, LocalWorkers
from cdem.study.plan import plan
from cdem.study.results_table import Table, check_results
from cdem.study.run import Run
from cdem.study.samples import SAMPLES, to_keep
from cdem.study.study import Study
from cdem.study.worker import execute, finished
from cdem.whole_files import refuse_link, write_json

POLL_SECONDS, LOOK_SECONDS = 0.05, 0.5
"""Wall time between checks of finished runs, and of workers and progress [s]."""


@dataclass
class SweepProgress:
    """Progress of a sweep.

    Attributes:
        total: Runs of the study.
        finished: Runs with a result, including earlier sweeps.
        failed: Runs that failed.
        time_left: Estimate of the remaining wall time [s], or None.
        dashboard: Address of the dashboard of a Dask scheduler, or nothing.
    """

    total: int
    finished: int
    failed: int
    time_left: float | None
    dashboard: str


def describe(p: SweepProgress) -> tuple[str, float]:
    """Progress in one line, and the fraction done."""
    failed = f", {p.failed} failed" if p.failed else ""
    left = "" if p.time_left is None else f", {clock(p.time_left)} left"
    dashboard = f", dashboard {p.dashboard}" if p.dashboard else ""
    return f"{p.finished} of {p.total} runs{failed}{left}{dashboard}", p.finished / p.total


def run_study(
    study: Study | str | Path,
    folder: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[SweepProgress], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> Table:
    """Execute the runs of a study without a result, and collect all results.

    Args:
        study: A `Study`, or the path of a study file.
        folder: Folder of results; finished runs of an earlier sweep are used.
        workers: Local processes, each of one thread; None for one per core.
        scheduler: Address of a Dask scheduler, instead of local processes. Its workers must see the
            mesh and `folder` under the same paths.
        progress: Called a few times per second.
        should_stop: Called as often; True ends the sweep with the results so far.

    Raises:
        CaseError: The study, its case, or a name under ``results`` is wrong.
        BackendError: Dask is missing, or its scheduler does not answer.
    """
    study = study if isinstance(study, Study) else Study.load(study)
    how: dict[str, Any] = {"workers": workers, "scheduler": scheduler}
    how |= {"progress": progress, "should_stop": should_stop}
    return run_studies([(study, Path(folder))], **how)[0]


def run_studies(
    studies: Sequence[tuple[Study, Path]],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[SweepProgress], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> list[Table]:
    """Execute the runs of several studies on the same workers; see `run_study`.

    Args:
        studies: Each with the folder of its results.

    Returns:
        A table for each study.
    """
    tables = [Table(study, plan(study, folder)) for study, folder in studies]
    runs = [run for table in tables for run in table.runs]
    waiting: dict[str, list[Run]] = {}  # runs of the same case are executed once
    for (study, folder), table in zip(studies, tables, strict=True):
        _open(folder, study, table.runs)
        for run in table.runs:
            run.result = finished(run.task)
            check_results(study, run)
            if run.status == "waiting":
                waiting.setdefault(run.identity, []).append(run)
    owner = {run.identity: table.study for table in tables for run in table.runs}

    def check(run: Run) -> None:
        check_results(owner[run.identity], run)

    if waiting:
        with LocalWorkers(workers) if scheduler is None else dask_workers(scheduler) as pool:
            execute_all(check, runs, waiting, pool, progress, should_stop)
    return tables


def open_own(folder: Path, own: str, what: str) -> None:
    """Make a folder for results, unless it contains other files.

    Args:
        folder: The folder.
        own: Name of the file by which an earlier folder is known.
        what: The kind of results.

    Raises:
        CdemError: It is a file, or contains other files.
    """
    if folder.exists() and not folder.is_dir():
        raise CdemError(f"{folder}: is a file; name another folder with -o")
    if folder.exists() and any(folder.iterdir()) and not (folder / own).is_file():
        raise CdemError(f"{folder}: contains other files than {what}; name another folder with -o")
    folder.mkdir(parents=True, exist_ok=True)


def _open(folder: Path, study: Study, runs: list[Run]) -> None:
    """Make the folder of the sweep, unless it contains other files; store the random values."""
    open_own(folder, "study.json", "a sweep")
    refuse_link(folder / "plots")
    if study.sampling:  # first: no run without stored values
        write_json(folder / SAMPLES, to_keep(study, [run.parameters for run in runs]))
    write_json(folder / "study.json", study.model_dump(mode="json", exclude_unset=True))


@contextmanager
def dask_workers(address: str, execute: Execute = execute) -> Iterator[DaskWorkers]:
    """The workers of an existing Dask scheduler.

    Args:
        address: Of the scheduler.
        execute: Executes a task on a worker.

    Raises:
        BackendError: Dask is missing, or its scheduler does not answer.
    """
    try:
        from distributed import Client
    except ImportError as error:
        raise BackendError(
            f"--scheduler needs dask.distributed; pip install 'cdem[sweep]' ({error})"
        ) from None
    try:
        client = Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise BackendError(f"no Dask scheduler answers at {address}: {error}") from None
    with client:
        yield DaskWorkers(client, execute)


class _Execution:
    """Runs on workers, as many at a time as there are threads.

    Args:
        check: Checks the result of a run for values that its study asks for.
        waiting: Runs to execute; runs of the same case, by identity, are executed once.
        pool: The workers.
    """

    def __init__(
        self,
        check: Callable[[Run], None],
        waiting: dict[str, list[Run]],
        pool: LocalWorkers | DaskWorkers,
    ) -> None:
        self._check, self._pool = check, pool
        self._left, self._count = list(waiting.values()), len(waiting)
        self._under_way: dict[Any, list[Run]] = {}
        self._began = time.perf_counter()

    @property
    def going(self) -> bool:
        """Whether any run is left."""
        return bool(self._left or self._under_way)

    def submit(self, threads: int) -> None:
        """Keep all threads busy, with no queue: a worker that crashes loses only its own run."""
        while self._left and len(self._under_way) < threads:
            same = self._left.pop(0)
            self._under_way[self._pool.submit(same[0].task)] = same

    def collect(self) -> None:
        """Collect finished runs.

        Raises:
            CaseError: The study asks for a value that a result lacks.
        """
        for task in list(self._under_way):
            if task.done:
                for run in (same := self._under_way.pop(task)):
                    _settle(run, task)
                self._check(same[0])

    def cancel(self) -> None:
        """Cancel all tasks."""
        self._pool.cancel(list(self._under_way))

    def time_left(self) -> float | None:
        """Estimate of the remaining wall time [s], or None before the first run ends."""
        done = self._count - len(self._left) - len(self._under_way)
        if not done:
            return None
        return (time.perf_counter() - self._began) / done * (self._count - done)


def execute_all(
    check: Callable[[Run], None],
    runs: list[Run],
    waiting: dict[str, list[Run]],
    pool: LocalWorkers | DaskWorkers,
    progress: Callable[[SweepProgress], None] | None,
    should_stop: Callable[[], bool] | None,
) -> None:
    """Keep all workers busy until all runs are done or the user stops the sweep.

    Args:
        check: Checks the result of a run.
        runs: All runs, for the progress.
        waiting: Runs to execute, by identity.
        pool: The workers.
        progress: Called a few times per second.
        should_stop: Called as often; True ends with the results so far.
    """
    execution = _Execution(check, waiting, pool)
    looked, threads = time.perf_counter(), pool.threads
    while execution.going:
        execution.submit(threads)
        execution.collect()
        if should_stop and should_stop():
            execution.cancel()
            return
        if time.perf_counter() > looked + LOOK_SECONDS or not execution.going:
            looked, threads = time.perf_counter(), pool.threads
            if progress:
                progress(_progress(runs, pool.dashboard, execution.time_left()))
        time.sleep(POLL_SECONDS)


def _progress(runs: list[Run], dashboard: str, time_left: float | None) -> SweepProgress:
    return SweepProgress(
        total=len(runs),
        finished=sum(run.status != "waiting" for run in runs),
        failed=sum(run.status == "failed" for run in runs),
        time_left=time_left,
        dashboard=dashboard,
    )


def _settle(run: Run, task: LocalTask | DaskTask) -> None:
    """Store the result or error of a run."""
    try:
        run.result = task.result()
    except CdemError as error:
        run.error = f"{error} (tried again next time)"
