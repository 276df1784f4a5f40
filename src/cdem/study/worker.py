"""Executes one run of a sweep once, and stores its result.

As a program it is a worker of `cdem.study.local_workers`: it reads a task as JSON from each line of
stdin, and writes an answer into each line of stdout.
"""

from __future__ import annotations

import json
import os
import queue
import signal
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cdem._version import __version__
from cdem.case.case import Case
from cdem.case.named_files import files_of
from cdem.case.source import Source
from cdem.errors import BackendError, CdemError
from cdem.study.criterion import Criterion
from cdem.whole_files import refuse_link, write_json

if TYPE_CHECKING:
    from cdem.study.critical import Tell

RESULT_FILE, RESULT_FOLDER = "result.json", "results"


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
    """Execute one run on a worker, and write its result as a whole.

    A failure caused by the case is a result too: it would recur. A full disk or a wrong
    worker is not.

    Raises:
        CdemError: The machine failed, not the case.
    """
    if known := finished(task):
        return known
    if task["version"] != __version__:
        raise BackendError(f"a worker has cdem {__version__}, the sweep {task['version']}")
    for holder, key in files_of(task["case"]):
        if not Path(holder[key]).is_file():
            raise BackendError(f"a worker cannot read {holder[key]}; give it the same files")
    folder = Path(task["folder"]) / "runs" / task["name"]
    for part in (folder.parent, folder, folder / RESULT_FOLDER):
        refuse_link(part)
    folder.mkdir(parents=True, exist_ok=True)
    began = time.perf_counter()
    result = {key: task[key] for key in ("name", "identity", "version", "parameters")}
    warnings: list[str] = []
    tell = warnings.extend
    try:
        case = Case(_source=Source.of(task["source"]), **task["case"])
        kept = folder / RESULT_FOLDER
        search = task["critical"]
        result |= _search(case, search, tell) if search else _run(case, task, kept, tell)
    except BackendError:
        raise
    except CdemError as error:
        if type(error) is CdemError:
            raise
        result |= {"status": "failed", "error": str(error)}
    result["warnings"] = warnings
    result["wall_time"] = time.perf_counter() - began
    write_json(folder / RESULT_FILE, result)
    return json.loads((folder / RESULT_FILE).read_text())


def _run(case: Case, task: dict[str, Any], folder: Path, tell: Tell) -> dict[str, Any]:
    """Run the case like `cdem run`, from its last checkpoint if it was interrupted."""
    from cdem.run.checkpoint import has_checkpoint
    from cdem.run.histories import tracks
    from cdem.run.simulation import Simulation

    if task["keep"]:
        resume = has_checkpoint(folder)
        simulation = Simulation(case, threads=1, output=folder, resume=resume, overwrite=not resume)
    else:
        simulation = Simulation(case, threads=1)
    tell(simulation.audit.warnings)
    status = simulation.run()
    return {
        "status": status,
        "summary": simulation.summary(status),
        "histories": {
            name: float(value)
            for track in tracks(simulation)
            for name, value in zip(track.names, track.values(), strict=True)
        },
    }


def _search(case: Case, search: dict[str, Any], tell: Tell) -> dict[str, Any]:
    """Find the critical value like `cdem critical`; a factor is that with strengths kept."""
    from cdem.study.critical import find_critical, parameter, strength_reduction
    from cdem.study.strengths import keep_strengths

    if search["factor"]:
        case = keep_strengths(case)[0]
    vary = strength_reduction(keep=True) if search["factor"] else parameter(search["parameter"])
    low, high = search["between"]
    found = find_critical(
        case,
        vary,
        (low, high),
        tolerance=search["tolerance"],
        criterion=Criterion(**search["criterion"]),
        threads=1,
        tell=tell,
    )
    return {"status": "found", "critical": found.as_dict()}


def serve(execute: Callable[[dict[str, Any]], dict[str, Any]] = execute) -> None:
    """Execute tasks from stdin until it closes: the sweep has then ended, and so does this process."""
    signal.signal(
        signal.SIGINT, signal.SIG_IGN
    )  # a Ctrl-C is for the sweep, which ends its workers
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    tasks: queue.SimpleQueue[str] = queue.SimpleQueue()

    def listen() -> None:
        for line in sys.stdin:
            tasks.put(line)
        os._exit(0)  # also in the middle of a run

    threading.Thread(target=listen, daemon=True).start()
    while True:
        task = json.loads(tasks.get())
        try:
            said: dict[str, Any] = {"result": execute(task)}
        except CdemError as error:
            said = {"error": str(error)}
        except Exception as error:
            said = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(said), file=answers, flush=True)


if __name__ == "__main__":
    serve()
