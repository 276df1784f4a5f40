"""The command that runs a case: run."""

from __future__ import annotations

import json
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdem._core_choice import GPU
from cdem.cli.options import (
    STOPPED,
    AllowCode,
    CaseFile,
    Settings,
    Strict,
    Threads,
    allow_own_laws,
    stop_on_signal,
)
from cdem.errors import BackendError, CdemError, UnstableError
from cdem.ranks.launch import launched

if TYPE_CHECKING:
    from cdem.ranks.mpi import Mpi
    from cdem.run.progress import Progress
    from cdem.run.simulation import Simulation


def _tell_of_devices(device: str | None) -> None:
    """Explain that there is no `--device`: the compiled core decides on the device."""
    if device is not None:
        raise BackendError(f"--device: no such option; for a GPU build the core for it, {GPU}")


def run(
    case_file: CaseFile,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Result folder; default CASE.results, here."),
    ] = None,
    settings: Settings = None,
    threads: Threads = None,
    device: Annotated[str | None, typer.Option(hidden=True, callback=_tell_of_devices)] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue from the checkpoint.")] = False,
    force: Annotated[
        bool, typer.Option("--force", help="With --resume: continue with a changed case.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Replace the results in the result folder.")
    ] = False,
    strict: Strict = False,
    allow_code: AllowCode = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print summary.json at the end.")] = False,
) -> None:
    """Run all stages of a case. Ctrl-C stops it cleanly; --resume continues."""
    if resume and overwrite:
        raise typer.BadParameter("--resume and --overwrite exclude one another")
    if force and not resume:
        raise typer.BadParameter("--force goes with --resume; --overwrite replaces results")
    if quiet and as_json:
        raise typer.BadParameter("--quiet and --json exclude one another")
    folder = output or Path(f"{case_file.stem}.results")
    with stop_on_signal() as stop:
        allow_own_laws(case_file, allow_code)
        from cdem.run.progress import busy

        exchange = _exchange()
        silent = quiet or (as_json and not sys.stderr.isatty())
        with busy("building the model", silent=silent):
            from cdem.case.case import Case
            from cdem.run.simulation import Simulation

            simulation = Simulation(
                Case.load(case_file, settings or []),
                threads=_threads(threads, exchange),
                output=folder,
                overwrite=overwrite,
                resume=resume,
                force=force,
                strict=strict,
                exchange=exchange,
            )
        told = _told(folder, exchange)
        status = _run(simulation, told, stop, exchange, quiet=quiet, as_json=as_json)
    if told:
        _tell_end(status, told, quiet=quiet, as_json=as_json)
    if status == "stopped":
        again = _resume_command(case_file, folder, settings or [], threads, allow_code)
        print(f"stopped with a checkpoint; continue with: {again}", file=sys.stderr)
        raise typer.Exit(STOPPED)


def _exchange() -> Mpi | None:
    """How the ranks talk that were started together; None for one alone."""
    if launched() == 1:
        return None
    from cdem.ranks.mpi import world

    return world()


def _told(folder: Path, exchange: Mpi | None) -> Path | None:
    """The result folder, for the rank that tells of it."""
    return folder if exchange is None or exchange.rank == 0 else None


def _threads(wanted: int | None, exchange: Mpi | None) -> int | None:
    """Threads of this process; None for all cores."""
    return wanted if wanted or exchange is None else exchange.threads()


def _tell_end(status: str, folder: Path, *, quiet: bool, as_json: bool) -> None:
    """Print how the run ended."""
    summary = folder / "summary.json"
    if as_json:
        print(summary.read_text().rstrip())
    elif not quiet:
        _tell_unrested(summary)
        print(f"{status}{_but_for(summary)}; results are in {folder}")


def _tell_unrested(summary: Path) -> None:
    """Name the static stages that found no rest, and the bodies that move."""
    from cdem.output.page_facts import unrested

    for line in unrested(json.loads(summary.read_text())):
        print(f"warning: {line}", file=sys.stderr)


def _but_for(summary: Path) -> str:
    """Exceptions to rest: problems on the way, and blocks that still fall or have left."""
    from cdem.output.page_facts import departed, moving, rested

    facts = json.loads(summary.read_text())
    return rested(facts) + (moving(facts) + departed(facts) if facts["status"] == "at rest" else "")


def _run(
    simulation: Simulation,
    folder: Path | None,
    stop: list[str],
    exchange: Mpi | None,
    *,
    quiet: bool,
    as_json: bool,
) -> str:
    """Run, and report in the folder, if any; returns how it ended."""
    from cdem.run.progress import watch

    tty = sys.stderr.isatty()
    silent = quiet or (as_json and not tty)
    if folder and not silent:
        assert simulation.results is not None
        for warning in simulation.audit.warnings + simulation.results.notes:
            print(f"warning: {warning}", file=sys.stderr)
    told = len(simulation.departures)
    with watch(silent=silent, tty=tty) as show:

        def progress(now: Progress) -> None:
            nonlocal told
            for departure in [] if silent else simulation.departures[told:]:
                print(f"warning: {departure.text()}", file=sys.stderr)
            told = len(simulation.departures)
            if show:
                show(now)

        try:
            status = simulation.run(progress, lambda: bool(stop))
        except UnstableError:
            if folder:
                write_report(folder)  # the report shows the places
            if exchange:
                exchange.share_text("")  # all end together, however long the report takes
            raise
    if folder and not _is_reported(folder):
        from cdem.run.progress import busy

        with busy("writing report.html", silent=silent):
            write_report(folder)
    return status


def _is_reported(folder: Path) -> bool:
    """Whether the report belongs to the present summary."""
    page = folder / "report.html"
    return (
        page.is_file() and page.stat().st_mtime_ns >= (folder / "summary.json").stat().st_mtime_ns
    )


def write_report(folder: Path) -> None:
    """Write report.html; results are complete without it, so a failure is only a message."""
    from cdem.output import report

    try:
        report.report(folder)
    except CdemError as error:
        print(f"no report.html: {error}", file=sys.stderr)


def _resume_command(
    case: Path, folder: Path, settings: list[str], threads: int | None, allow_code: bool
) -> str:
    words = ["cdem", "run", str(case), "-o", str(folder), "--resume"]
    words += ["--allow-code"] * allow_code
    for setting in settings:
        words += ["--set", setting]
    return shlex.join(words + ([] if threads is None else ["--threads", str(threads)]))
