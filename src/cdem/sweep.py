"""Parameter studies: many runs of a case on dask.distributed, each of which is done only once."""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import deepcopy
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from cdem import __version__, sampling
from cdem.case import Case
from cdem.checkpoint import write_json_atomic
from cdem.criterion import Criterion
from cdem.errors import BackendError, CaseError, CdemError
from cdem.formula import Formula, is_formula
from cdem.progress import clock
from cdem.read import Source, load_case_data, put
from cdem.study import Study
from cdem.table import Table, check_results

POLL_SECONDS, LOOK_SECONDS = 0.05, 0.5
"""Wall time between looks at what is finished, and at the workers and the progress [s]."""
DEAF = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)"
"""What local workers begin with: a Ctrl-C is for the sweep, which ends them."""
RESULT_FILE, RESULT_FOLDER = "result.json", "results"


@dataclass
class Run:
    """One run of a study.

    Attributes:
        name: Of its folder, the first digits of `identity`.
        identity: Hash of the resolved case, of what is done with it, and of cdem's version.
        parameters: Value of each parameter.
        task: What a worker needs to execute it.
        result: What came of it, or None while there is none.
        error: Why there is no result, or nothing.
    """

    name: str
    identity: str
    parameters: dict[str, Any]
    task: dict[str, Any] = field(repr=False)
    result: dict[str, Any] | None = field(default=None, repr=False)
    error: str = ""

    @property
    def status(self) -> str:
        """How it ended: that of the run, "found" (critical), "failed", or "waiting"."""
        if self.error or (self.result and "error" in self.result):
            return "failed"
        return self.result["status"] if self.result else "waiting"

    @property
    def why(self) -> str:
        """Why it failed, or nothing."""
        return self.error or str((self.result or {}).get("error", ""))

    def text(self) -> str:
        """Name, parameters and why it failed, in one line."""
        values = ", ".join(f"{name} = {value}" for name, value in self.parameters.items())
        return f"{self.name or 'no case'} ({values}): {self.why}"


@dataclass
class SweepProgress:
    """Where a sweep is.

    Attributes:
        total: Runs of the study.
        finished: Runs that have a result, those of earlier sweeps included.
        failed: Runs that failed.
        time_left: Estimate of the remaining wall time [s], or None.
        dashboard: Address of Dask's dashboard, or nothing.
    """

    total: int
    finished: int
    failed: int
    time_left: float | None
    dashboard: str


def describe(p: SweepProgress) -> tuple[str, float]:
    """One line on where a sweep is, and the part that is done."""
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
    """Execute the runs of a study that have no result yet, and collect all results.

    A script that calls this with local workers needs ``if __name__ == "__main__":`` around the call,
    because every worker imports the script.

    Args:
        study: A `Study`, or the path of a study file.
        folder: Where results go; what an earlier sweep finished there is used.
        workers: Local processes, each of one thread; None for one per core.
        scheduler: Address of a Dask scheduler, instead of local processes. Its workers must see the
            mesh and `folder` under the same paths.
        progress: Called a few times per second.
        should_stop: Asked as often; True ends the sweep with the results so far.

    Raises:
        CaseError: The study or its case is wrong, or a name under ``results`` is.
        BackendError: Dask is missing, or its scheduler cannot be reached any more.
    """
    study = study if isinstance(study, Study) else Study.load(study)
    folder = Path(folder)
    runs = plan(study, folder)
    _open(folder, study)
    table = Table(study, runs)
    for run in runs:
        run.result = finished(run.task)
        check_results(study, run)
    waiting: dict[str, list[Run]] = {}  # runs of the same case are executed once
    for run in runs:
        if run.status == "waiting":
            waiting.setdefault(run.identity, []).append(run)
    if waiting:
        with _cluster(workers, scheduler) as client:
            _execute_all(study, runs, waiting, client, progress, should_stop)
    return table


# ------------------------------------------------------------------ which runs there are


def plan(study: Study, folder: Path) -> list[Run]:
    """Make the case of every run.

    Values that are drawn may be wrong (a cohesion below zero): such a run has an error. Values that
    are written down are the user's mistake.

    Raises:
        CaseError: The case is wrong, or all runs are.
    """
    data, source = load_case_data(study.case_file)
    for holder, key in _files(data):
        holder[key] = str((source.folder / holder[key]).resolve())
    drawn = study.sampling is not None
    runs, first_error = [], None
    for row in sampling.rows(study):
        try:
            runs.append(_make(study, data, source, row, folder))
        except CaseError as error:
            if not drawn:
                raise
            first_error = first_error or error
            runs.append(Run("", "", row, {}, error=str(error)))
    if first_error and all(run.error for run in runs):
        raise first_error
    return runs


def _make(
    study: Study, data: dict[str, Any], source: Source, row: dict[str, Any], folder: Path
) -> Run:
    """The run with one value of each parameter."""
    data, own = deepcopy(data), Source(source.file, source.places)
    for name, value in row.items():
        if "." not in name:
            continue
        where = study._source.where(("parameters", name))
        unit = study.parameters[name].unit
        written = f"{value!r} {unit}" if unit and isinstance(value, int | float) else value
        put(data, name, written, own, f"{where}: {name} = {written}")
    for path, value in study.set.items():
        where = study._source.where(("set", path))
        put(data, path, _computed(study, ("set", path), value, row), own, f"{where}: {path}")
    case = Case(_source=own, **deepcopy(data))
    search = None
    if study.critical:
        search = study.critical.model_dump()
        search["between"] = _computed(study, ("critical", "between"), study.critical.between, row)
        _check_search(study, case, search)
    identity = _identity(case, search)
    task = {
        "name": identity[:16],
        "identity": identity,
        "version": __version__,
        "folder": str(folder.resolve()),
        "case": data,
        "critical": search,
        "keep": study.keep,
        "parameters": row,
    }
    return Run(identity[:16], identity, row, task)


def _check_search(study: Study, case: Case, search: dict[str, Any]) -> None:
    from cdem.critical import check_last_stage, parameter

    if search["parameter"]:  # else the factor of safety is sought
        where = study._source.where(("critical", "parameter"))
        try:
            parameter(search["parameter"])(case.model_copy(deep=True), search["between"][0])
        except CaseError as error:
            raise CaseError(f"{where}: {error}") from None
    check_last_stage(case)


def _computed(study: Study, keys: tuple[str | int, ...], value: Any, row: dict[str, Any]) -> Any:
    """A value of the study with its formulas computed."""
    if isinstance(value, dict):
        return {k: _computed(study, (*keys, k), v, row) for k, v in value.items()}
    if isinstance(value, list):
        return [_computed(study, (*keys, i), v, row) for i, v in enumerate(value)]
    if not is_formula(value):
        return value
    try:
        return Formula(value).value(row)
    except ValueError as error:
        raise study.error(keys, str(error)) from None


def _identity(case: Case, search: dict[str, Any] | None) -> str:
    """Hash of all that a result depends on; a file of the model counts by what it holds."""
    data = case.model_dump(mode="json")
    for holder, key in _files(data):
        path = case.path_of(holder[key])
        holder[key] = _digest(path, path.stat().st_mtime_ns) if path.is_file() else holder[key]
    whole = {"case": data, "critical": search, "version": __version__}
    return hashlib.sha256(json.dumps(whole, sort_keys=True).encode()).hexdigest()


def _files(data: dict[str, Any]) -> list[tuple[dict[str, Any], str]]:
    """Where the data of a case name a file: the dictionary and its key."""
    model = data.get("model")
    if not isinstance(model, dict):
        return []
    blocks = model.get("blocks")
    bodies = [b for b in blocks if isinstance(b, dict)] if isinstance(blocks, list) else []
    named = [(model, "mesh"), *((body, "file") for body in bodies)]
    return [(holder, key) for holder, key in named if isinstance(holder.get(key), str)]


@lru_cache(maxsize=64)
def _digest(path: Path, changed: int) -> str:
    """Hash of a file of the model; read once, not for every run."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _open(folder: Path, study: Study) -> None:
    """Make the folder of the sweep, unless it holds other things."""
    if folder.exists() and not folder.is_dir():
        raise CdemError(f"{folder}: is a file; name another folder with -o")
    if folder.exists() and any(folder.iterdir()) and not (folder / "study.json").is_file():
        raise CdemError(f"{folder}: holds other things than a sweep; name another folder with -o")
    folder.mkdir(parents=True, exist_ok=True)
    write_json_atomic(folder / "study.json", study.model_dump(mode="json", exclude_unset=True))


# ------------------------------------------------------------------ on a worker


def finished(task: dict[str, Any]) -> dict[str, Any] | None:
    """The result of a task that an earlier sweep or worker finished, or None."""
    if not task:
        return None
    folder = Path(task["folder"]) / "runs" / task["name"]
    try:
        result = json.loads((folder / RESULT_FILE).read_text())
    except (OSError, ValueError):
        return None
    if result.get("identity") != task["identity"]:
        return None
    kept = (folder / RESULT_FOLDER / "summary.json").is_file()
    return None if task["keep"] and not task["critical"] and not kept else result


def execute(task: dict[str, Any]) -> dict[str, Any]:
    """Execute one run on a worker, and write its result in one go.

    What the case itself makes fail is a result, too: it would fail again. A full disk or a wrong
    worker is not.

    Raises:
        CdemError: The machine failed, not the case.
    """
    if known := finished(task):
        return known
    if task["version"] != __version__:
        raise BackendError(f"a worker has cdem {__version__}, the sweep {task['version']}")
    for holder, key in _files(task["case"]):
        if not Path(holder[key]).is_file():
            raise BackendError(f"a worker does not see {holder[key]}; it must have the same files")
    folder = Path(task["folder"]) / "runs" / task["name"]
    folder.mkdir(parents=True, exist_ok=True)
    began = time.perf_counter()
    result = {key: task[key] for key in ("name", "identity", "version", "parameters")}
    try:
        case = Case.from_dict(task["case"])
        search = task["critical"]
        result |= _search(case, search) if search else _run(case, task, folder / RESULT_FOLDER)
    except BackendError:
        raise
    except CdemError as error:
        if type(error) is CdemError:
            raise
        result |= {"status": "failed", "error": str(error)}
    result["wall_time"] = time.perf_counter() - began
    write_json_atomic(folder / RESULT_FILE, result)
    return json.loads((folder / RESULT_FILE).read_text())


def _run(case: Case, task: dict[str, Any], folder: Path) -> dict[str, Any]:
    """Run the case as `cdem run` does, from its last checkpoint if it was broken off."""
    from cdem.results import tracks
    from cdem.simulation import Simulation

    if task["keep"]:
        resume = (folder / "checkpoint.h5").is_file()
        simulation = Simulation(case, threads=1, output=folder, resume=resume, overwrite=not resume)
    else:
        simulation = Simulation(case, threads=1)
    status = simulation.run()
    return {
        "status": status,
        "summary": simulation.summary(status),
        "histories": {name: value() for name, value in tracks(simulation)},
    }


def _search(case: Case, search: dict[str, Any]) -> dict[str, Any]:
    """Find the critical value as `cdem critical` does."""
    from cdem.critical import find_critical, parameter, strength_reduction

    vary = strength_reduction() if search["factor"] else parameter(search["parameter"])
    low, high = search["between"]
    found = find_critical(
        case,
        vary,
        (low, high),
        tolerance=search["tolerance"],
        criterion=Criterion(**search["criterion"]),
        threads=1,
    )
    return {"status": "found", "critical": found.as_dict()}


# ------------------------------------------------------------------ on Dask


@contextmanager
def _cluster(workers: int | None, scheduler: str | None) -> Iterator[Any]:
    """A client of a local cluster, or of one that is there already."""
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError as error:
        raise BackendError(
            f"a sweep needs dask.distributed; pip install 'cdem[sweep]' ({error})"
        ) from None
    if scheduler is not None:
        try:
            client = Client(scheduler, timeout=10)
        except (OSError, ValueError) as error:
            raise BackendError(f"no Dask scheduler answers at {scheduler}: {error}") from None
        with client:
            yield client
        return
    # Building a large model may keep a worker from answering for long, and is no fault.
    with (
        dask.config.set({"distributed.scheduler.worker-ttl": None}),
        LocalCluster(
            n_workers=workers,
            threads_per_worker=1,
            memory_limit=None,
            dashboard_address="127.0.0.1:0",
            env={"OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive"},
            preload=[DEAF],
            silence_logs=50,  # critical only: what matters is said in our own words
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


def _execute_all(
    study: Study,
    runs: list[Run],
    waiting: dict[str, list[Run]],
    client: Any,
    progress: Callable[[SweepProgress], None] | None,
    should_stop: Callable[[], bool] | None,
) -> None:
    """Keep every thread of the cluster busy until all runs are done or the user wants to stop."""
    began = looked = time.perf_counter()
    left, todo, threads = list(waiting.values()), len(waiting), _threads(client)
    under_way: dict[Any, list[Run]] = {}
    while left or under_way:
        # No more than there are threads: a worker that dies then takes only its own run with it.
        while left and len(under_way) < threads:
            same = left.pop(0)
            under_way[client.submit(execute, same[0].task, pure=False)] = same
        for future in [f for f in under_way if f.status != "pending"]:
            for run in (same := under_way.pop(future)):
                _settle(run, future)
            check_results(study, same[0])
        if should_stop and should_stop():
            client.cancel(list(under_way))
            return
        if time.perf_counter() > looked + LOOK_SECONDS or not (left or under_way):
            looked = time.perf_counter()
            threads = _threads(client)
            if progress:
                done = todo - len(left) - len(under_way)
                rate = (looked - began) / done if done else None
                progress(_progress(runs, client, rate and rate * (todo - done)))
        time.sleep(POLL_SECONDS)


def _threads(client: Any) -> int:
    """Threads of all workers now; at least one, so that something waits for the first worker.

    Raises:
        BackendError: The scheduler does not answer any more.
    """
    try:
        if client.status == "running":
            return max(sum(client.nthreads().values()), 1)
    except (OSError, TimeoutError):
        pass
    raise BackendError(
        "the Dask scheduler is gone; finished runs are kept: the same command goes on"
    )


def _progress(runs: list[Run], client: Any, time_left: float | None) -> SweepProgress:
    return SweepProgress(
        total=len(runs),
        finished=sum(run.status != "waiting" for run in runs),
        failed=sum(run.status == "failed" for run in runs),
        time_left=time_left,
        dashboard=client.dashboard_link or "",
    )


def _settle(run: Run, future: Any) -> None:
    """Take over what became of a run."""
    from distributed.scheduler import KilledWorker

    if future.status == "finished":
        run.result = future.result()
    elif future.status == "error":
        error = future.exception()
        if isinstance(error, KilledWorker):
            run.error = "its worker died again and again (out of memory?); tried anew next time"
        else:
            said = (
                str(error) if isinstance(error, CdemError) else f"{type(error).__name__}: {error}"
            )
            run.error = f"{said} (tried anew next time)"
