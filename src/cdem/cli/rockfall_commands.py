"""The command of rockfall: rockfall."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdem.cli.options import STOPPED, AsJson, Overwrite, Settings, executing, print_paths
from cdem.errors import BackendError, CdemError

if TYPE_CHECKING:
    from cdem.rockfall.result import Result
    from cdem.rockfall.rockfall import Rockfall
    from cdem.rockfall.run import Runs


def rockfall(
    rockfall_file: Annotated[
        Path, typer.Argument(metavar="ROCKFALL.yaml", help="Rockfall file, see docs/rockfall.md.")
    ],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Folder; default NAME.rockfall."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Local processes; default one per core.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="An existing Dask scheduler instead.")
    ] = None,
    settings: Settings = None,
    overwrite: Overwrite = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print no progress.")] = False,
    as_json: AsJson = False,
) -> None:
    """Let hundreds of blocks fall over a terrain; heights, energies and counts at barriers.

    Runs with a result are not repeated: Ctrl-C ends it, the same command continues it, and a
    greater count adds runs. Exit status 3 means that workers have failed.
    """
    if workers and scheduler:
        raise typer.BadParameter("--workers and --scheduler exclude one another")
    if quiet and as_json:
        raise typer.BadParameter("--quiet and --json exclude one another")
    from cdem.rockfall.result import Result
    from cdem.rockfall.rockfall import Rockfall

    given = Rockfall.load(rockfall_file, settings or ())
    folder = output or Path(f"{rockfall_file.stem}.rockfall")
    if overwrite:
        _drop_runs(folder)
    runs = _execute(given, folder, workers, scheduler, silent=quiet, as_json=as_json)
    result = Result(runs)
    paths = _write(result, folder)
    if as_json:
        print(json.dumps(json.loads((folder / "result.json").read_text()), indent=2))
    elif not quiet:
        print(*given.site.projection.notes, result.text(), sep="\n")
        print_paths(paths)
    for said in result.doubts:
        print(f"warning: {said}", file=sys.stderr)
    for run in runs.failed:
        print(f"failed: run {run.task['number']}: {run.error}", file=sys.stderr)
    if runs.waiting:
        print(f"stopped; {runs.waiting} runs left: the same command continues", file=sys.stderr)
        raise typer.Exit(STOPPED)
    if runs.failed:
        raise typer.Exit(3)


def _drop_runs(folder: Path) -> None:
    """Remove the runs of an earlier rockfall; all else is written again."""
    from cdem.rockfall.run import OWN

    if (folder / OWN).is_file() and not (folder / "runs").is_symlink():
        shutil.rmtree(folder / "runs", ignore_errors=True)


def _execute(
    given: Rockfall,
    folder: Path,
    workers: int | None,
    scheduler: str | None,
    *,
    silent: bool,
    as_json: bool,
) -> Runs:
    """Execute the runs that are left, with a line of progress."""
    from cdem.rockfall.run import run_rockfall

    kept = "stopping, finished runs are kept"
    with executing(kept, silent=silent, terminal_only=as_json) as how:
        return run_rockfall(given, folder, workers=workers, scheduler=scheduler, **how)


def _write(result: Result, folder: Path) -> list[Path]:
    """Write tables, maps and pictures; a missing extra costs only what needs it."""
    from cdem.rockfall.maps import rasters_of, write_maps, write_vectors
    from cdem.rockfall.pictures import draw_all

    paths = result.write(folder)
    if not result.rows:
        return paths
    rasters = rasters_of(result)
    paths += write_maps(result, rasters, folder)
    try:
        paths.append(write_vectors(result, folder))
    except BackendError as error:
        print(f"no rockfall.gpkg: {error}", file=sys.stderr)
    try:
        paths += draw_all(result, rasters, folder)
    except CdemError as error:
        print(f"no pictures: {error}", file=sys.stderr)
    return paths
