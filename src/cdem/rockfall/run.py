"""The runs of a rockfall on local workers or on Dask, each done only once."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from cdem._version import __version__
from cdem.rockfall.ground import Ground
from cdem.rockfall.rockfall import Rockfall
from cdem.rockfall.starts import Starts
from cdem.rockfall.worker import execute, finished, wish_as_dict
from cdem.study.local_workers import LocalWorkers
from cdem.study.run import Run
from cdem.study.sweep import SweepProgress, dask_workers, execute_all, open_own
from cdem.whole_files import refuse_link, write_json

PROGRAM = "cdem.rockfall.worker"
OWN = "rockfall.json"
"""File that marks the folder of a rockfall."""


@dataclass
class Runs:
    """All runs of a rockfall.

    Attributes:
        rockfall: The file.
        ground: The ground.
        starts: Where blocks start.
        runs: In the order of their numbers.
        folder: Folder of results.
    """

    rockfall: Rockfall
    ground: Ground
    starts: Starts
    runs: list[Run]
    folder: Path

    @property
    def done(self) -> list[Run]:
        """Runs with a track."""
        return [run for run in self.runs if run.result is not None]

    @property
    def waiting(self) -> int:
        """Number of runs without a result."""
        return sum(run.status == "waiting" for run in self.runs)

    @property
    def failed(self) -> list[Run]:
        """Runs that a worker could not execute."""
        return [run for run in self.runs if run.error]


def plan(rockfall: Rockfall, folder: Path) -> Runs:
    """Read the terrain and make the task of every run; nothing is written.

    Raises:
        CaseError: The file, its terrain or its starts are wrong.
    """
    ground = rockfall.make_ground()
    starts = rockfall.make_starts(ground)
    common = {
        "version": __version__,
        "physics": asdict(rockfall.physics(ground, starts)),
        "wish": wish_as_dict(rockfall.wish(starts)),
    }
    digest = hashlib.sha256(json.dumps(common, sort_keys=True).encode())
    of_ground = _digest(ground)
    digest.update(of_ground.encode())
    common |= {
        "folder": str(folder.resolve()),
        "ground": str(folder.resolve() / f"ground_{of_ground[:8]}.npz"),
    }
    runs = []
    for number in range(rockfall.count):
        one = digest.copy()
        one.update(str(number).encode())
        identity = one.hexdigest()
        name = f"{number:05d}_{identity[:8]}"
        task = {**common, "name": name, "identity": identity, "number": number}
        runs.append(Run(name, identity, {"number": number}, task))
    return Runs(rockfall, ground, starts, runs, folder)


def _digest(ground: Ground) -> str:
    digest = hashlib.sha256(repr((ground.west, ground.south, *ground.step)).encode())
    digest.update(repr(ground.heights.shape).encode())
    digest.update(np.ascontiguousarray(ground.heights).tobytes())
    digest.update(np.ascontiguousarray(ground.zone).tobytes())
    return digest.hexdigest()


def run_rockfall(
    rockfall: Rockfall | str | Path,
    folder: str | Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Callable[[SweepProgress], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
) -> Runs:
    """Execute the runs of a rockfall that have no result yet.

    Args:
        rockfall: A `Rockfall`, or the path of its file.
        folder: Folder of results; finished runs in it are used.
        workers: Local processes, each of one thread; None for one per core.
        scheduler: Address of a Dask scheduler, instead of local processes.
        progress: Called a few times per second.
        should_stop: Called as often; True ends with the results so far.

    Raises:
        CaseError: The file, its terrain or its starts are wrong.
        BackendError: Dask is missing, or its scheduler does not answer.
    """
    given = rockfall if isinstance(rockfall, Rockfall) else Rockfall.load(rockfall)
    found = plan(given, Path(folder))
    _open(found)
    waiting: dict[str, list[Run]] = {}
    for run in found.runs:
        run.result = finished(run.task)
        if run.result is None:
            waiting[run.identity] = [run]
    if waiting:
        pool = (
            LocalWorkers(workers, PROGRAM)
            if scheduler is None
            else dask_workers(scheduler, execute)
        )
        with pool as open_pool:
            execute_all(lambda _: None, found.runs, waiting, open_pool, progress, should_stop)
    return found


def _open(found: Runs) -> None:
    """Make the folder, unless it contains other files; store the ground and the input."""
    folder = found.folder
    open_own(folder, OWN, "a rockfall")
    refuse_link(folder / "runs")
    content = found.rockfall.model_dump(mode="json", exclude_unset=True)
    write_json(folder / OWN, {"input": content, "physics": found.runs[0].task["physics"]})
    ground = Path(found.runs[0].task["ground"])
    if not ground.is_file():
        found.ground.write(ground)
