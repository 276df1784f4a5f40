"""Commands that run a case many times: critical, sweep."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cdem.cli.options import (
    STOPPED,
    AllowCode,
    CaseFile,
    Settings,
    Threads,
    allow_own_laws,
    allow_own_laws_of_study,
    executing,
    print_paths,
)
from cdem.errors import CaseError, CdemError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from cdem.case.case import Case
    from cdem.study.critical import Critical, FactorOfSafety
    from cdem.study.results_table import Table

MOST_BODIES = 5
"""Bodies of a failed trial that the end of `cdem critical` names."""
Limits = Annotated[
    list[str] | None,
    typer.Option(
        "--criterion",
        metavar="NAME=VALUE",
        help="Change a limit of the criterion: travel, far, stall_steps or most_steps; repeatable.",
    ),
]
Travel = Annotated[
    str | None,
    typer.Option(
        metavar="LENGTH", help="A model that rests after more travel has failed: --travel '1 cm'."
    ),
]

IgnoreBelow = Annotated[
    str | None,
    typer.Option(
        metavar="VOLUME",
        help="Take out bodies of less volume that move, and go on: --ignore-below '2 m3'. Default: "
        "1e-4 of the volume of groups that are not fixed.",
    ),
]
ReportPage = Annotated[
    bool,
    typer.Option("--report", help="With --factor: write a page for a client, CASE.factor.html."),
]
OneGroup = Annotated[
    str | None,
    typer.Option(
        "--group", help="Only bodies with blocks of this group count; others are taken out."
    ),
]


def critical(
    case_file: CaseFile,
    between: Annotated[
        tuple[str, str] | None,
        typer.Option(
            metavar="RESTS FAILS",
            help="A value that rests, one that fails: --between 20 50; optional with --factor.",
        ),
    ] = None,
    parameter: Annotated[
        str | None, typer.Option(metavar="PATH", help="Value of the case to vary.")
    ] = None,
    factor: Annotated[
        bool,
        typer.Option(
            "--factor",
            help="Find the factor of safety of all strengths instead: with strengths kept as joints "
            "slip, and with the laws as written where these lose strength.",
        ),
    ] = False,
    tolerance: Annotated[float, typer.Option(help="Width of the bracket to reach.")] = 0.01,
    limits: Limits = None,
    travel: Travel = None,
    ignore_below: IgnoreBelow = None,
    group: OneGroup = None,
    report: ReportPage = False,
    settings: Settings = None,
    threads: Threads = None,
    allow_code: AllowCode = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON at the end.")] = False,
) -> None:
    """Find the value at which a case fails, by bisection of its last, static stage.

    A trial fails when a body gains speed under an unbalanced force that does not fall, or moves by
    the mean face size, or finds no rest in a million steps. With --factor the last stage first
    rests with strengths a hundred times as high; trials then start from the last stable state.

    Writes CASE.factor.json, or CASE.PATH.json, after each trial; draws CASE[.PATH].failed.png."""
    if (parameter is None) == (not factor):
        raise typer.BadParameter("give either --parameter PATH or --factor")
    if parameter and not between:
        raise typer.BadParameter("--parameter needs --between: a value that rests, one that fails")
    if report and not factor:
        raise typer.BadParameter("--report goes with --factor")
    ends = _two_numbers(between) if between else None
    allow_own_laws(case_file, allow_code)
    from cdem.case.case import Case
    from cdem.study.criterion import Criterion
    from cdem.whole_files import write_json

    file = Path(f"{case_file.stem}.{parameter or 'factor'}.json")
    case = Case.load(case_file, settings or [])
    given = {"most_moved": travel, "ignore_below": ignore_below, "group": group}
    criterion = Criterion.read([*(limits or []), *(f"{k}={v}" for k, v in given.items() if v)])
    print(f"a trial {criterion.text()}", file=sys.stderr)
    same: dict[str, Any] = {"tolerance": tolerance, "criterion": criterion, "threads": threads}
    find = partial(_find_value, parameter) if parameter else partial(_find_factor, report)
    result, lines = find(case, ends, file, same)
    write_json(file, result)
    print(json.dumps(result, indent=2) if as_json else "\n".join(lines))


Found = tuple[dict[str, Any], list[str]]
"""All results of a search, and lines for people."""


def _find_value(
    name: str, case: Case, ends: tuple[float, float] | None, file: Path, same: dict[str, Any]
) -> Found:
    from cdem.study.critical import find_critical, parameter

    report = partial(_tell_trial, name, file)
    found = find_critical(case, parameter(name), ends, tell=_warn, report=report, **same)
    _draw_failure(found, name, file.with_suffix(".failed.png"))
    return {"parameter": name} | found.as_dict(), [_bracket(name, found)]


def _find_factor(
    page: bool, case: Case, ends: tuple[float, float] | None, file: Path, same: dict[str, Any]
) -> Found:
    from cdem.study.critical import find_factor

    found = find_factor(case, ends, tell=_warn, report=partial(_tell_factor, file), **same)
    image = _draw_failure(found.kept, "factor", file.with_name(f"{file.stem[:-7]}.failed.png"))
    if page:
        from cdem.study.safety_page import write_safety_page

        write_safety_page(file.with_suffix(".html"), case, found, image)
        print(f"page for a client: {file.with_suffix('.html')}", file=sys.stderr)
    return found.as_dict(), list(_factor_lines(found))


def _bracket(name: str, found: Critical) -> str:
    return f"{name}: rests at {found.stable:.6g}, fails at {found.failed:.6g}"


def _factor_lines(found: FactorOfSafety) -> Iterator[str]:
    """The results of a search for the factor of safety, for people."""
    yield _bracket("factor, strengths kept", found.kept)
    yield from _failure_lines(found.kept)
    if found.written is None:
        yield "no law as written loses strength: the factor is the same"
        return
    yield _bracket("factor, laws as written", found.written)
    yield from _failure_lines(found.written)
    broken = [
        f"{100 * part:.2g} % of {name}" for name, part in found.written.broken.items() if part
    ]
    yield (
        f"  {', '.join(found.may_lose)} may lose strength as written; broken at rest at "
        f"{found.written.stable:.6g}: {', '.join(broken) or 'nothing'}"
    )


def _failure_lines(found: Critical) -> Iterator[str]:
    """Slip below the critical value, what fails just above, and what was too small to count."""
    if caution := found.caution():
        yield f"  warning: {caution}"
    trial = found.trial_that_failed
    for body in trial.bodies[:MOST_BODIES]:
        yield f"  fails at {found.failed:.6g}: {body.text()}"
    if len(trial.bodies) > MOST_BODIES:
        yield f"  and {len(trial.bodies) - MOST_BODIES} smaller bodies"
    if trial.chips:
        volume = sum(body.volume for body in trial.chips)
        yield f"  not counted (--ignore-below): {len(trial.chips)} bodies, {volume:.3g} m3 in all"


def _warn(warnings: list[str]) -> None:
    for warning in warnings:
        print(f"warning: {warning}", file=sys.stderr)


def _two_numbers(words: tuple[str, str]) -> tuple[float, float]:
    try:
        first, second = map(float, words)
    except ValueError:
        first = second = math.nan
    if not (math.isfinite(first) and math.isfinite(second)):
        raise typer.BadParameter(
            "--between takes two numbers with a space between them: --between 20 50; got "
            + " ".join(words)
        )
    return first, second


def _tell_trial(name: str, file: Path, found: Critical) -> None:
    """Print the newest trial and write all of them."""
    from cdem.whole_files import write_json

    write_json(file, {"parameter": name} | found.as_dict())
    _print_trial(name, found)


def _tell_factor(file: Path, kind: str, found: Critical) -> None:
    """The same of a search for the factor; the file gets its last form at the end."""
    from cdem.whole_files import write_json

    write_json(file, {"parameter": "factor", "strengths": kind} | found.as_dict())
    _print_trial(f"{kind}: factor", found)


def _print_trial(name: str, found: Critical) -> None:
    trial = found.trials[-1]
    low, high = sorted((found.stable, found.failed))
    verdict = "stable" if trial.stable else "fails"
    bracket = f"; between {low:.6g} and {high:.6g}" if high > low else ""
    chips = f", {len(trial.chips)} bodies too small to count were taken out" if trial.chips else ""
    print(
        f"{name} = {trial.value:.6g}: {verdict}: {trial.saw} ({trial.steps:,} steps, {trial.why}"
        f"{chips}){bracket}",
        file=sys.stderr,
        flush=True,
    )


def _draw_failure(found: Critical, name: str, file: Path) -> NDArray[np.uint8] | None:
    """Draw the failed model into a file; the picture, or None where there can be none."""
    from cdem.output.render import picture, write_image

    assert found.body is not None  # a search ends with a trial that failed
    try:
        image = picture([found.body], "displacement", [f"{name} = {found.failed:.6g}"])
        write_image(file, image)
    except CdemError as error:
        print(f"no picture of the failure: {error}", file=sys.stderr)
        return None
    print(f"picture of the failed model: {file}", file=sys.stderr)
    return image


def sweep(
    study_file: Annotated[Path, typer.Argument(metavar="STUDY.yaml", help="Study file.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="Folder for all results; default STUDY.sweep, here."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="Local one-thread processes; default all cores.")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Use this Dask scheduler instead.")
    ] = None,
    allow_code: AllowCode = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
) -> None:
    """Run a study: many variants of a case. Finished runs are never repeated.

    Ctrl-C ends it; the same command continues it. Exit status 3 means that runs have failed.
    """
    if quiet and as_json:
        raise typer.BadParameter("--quiet and --json exclude one another")
    if workers and scheduler:
        raise typer.BadParameter("--workers and --scheduler exclude one another")
    allow_own_laws_of_study(study_file, allow_code)
    from cdem.study.study import Study
    from cdem.study.sweep import run_study

    folder = output or Path(f"{study_file.stem}.sweep")
    with executing("stopping, finished runs are kept", silent=quiet, terminal_only=as_json) as how:
        study = Study.load(study_file)
        table = run_study(study, folder, workers=workers, scheduler=scheduler, **how)
    paths = table.write(folder)
    if not quiet:
        _warn(table.warnings)
        paths += _draw_plots(table, folder)
    if as_json:
        print(json.dumps(table.as_dict(), indent=2))
    elif not quiet:
        print_paths(paths)
    for run in table.failed:
        print(f"failed: {run.text()}", file=sys.stderr)
    if table.waiting:
        print(f"stopped; {table.waiting} runs left: the same command continues", file=sys.stderr)
        raise typer.Exit(STOPPED)
    if table.failed:
        raise typer.Exit(3)


def _draw_plots(table: Table, folder: Path) -> list[Path]:
    """Draw a study's plots; the table needs none of them, so a missing extra is only a message."""
    from cdem.study.plots import draw_all

    try:
        return draw_all(table, folder / "plots")
    except CdemError as error:
        if isinstance(error, CaseError) and not table.failed:
            raise
        print(f"no plots: {error}", file=sys.stderr)
        return []
