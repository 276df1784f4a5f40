"""Commands that test this installation: verify, benchmark, doctor."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cdem.cli.options import AsJson, Threads
from cdem.errors import CaseError

if TYPE_CHECKING:
    from cdem.verification.runner import Outcome, Problem


def verify(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[NAME]...", help="Problems, or folders of your own; default: quick ones."
        ),
    ] = None,
    full: Annotated[
        bool, typer.Option("--full", help="All problems and variants; takes 15 minutes.")
    ] = False,
    report: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the manual: .html, or .md (table).")
    ] = None,
    threads: Threads = None,
    as_json: AsJson = False,
    listing: Annotated[bool, typer.Option("--list", help="Only list the problems.")] = False,
    paper: Annotated[
        bool, typer.Option("--paper", help="The figures of Feng et al. (2014), in their order.")
    ] = False,
) -> None:
    """Compute problems with known answers and compare; exit status 3 if one is missed."""
    if listing:
        _print_list(_chosen(names, paper=paper))
        return
    manual = None
    if report:
        from cdem.verification.manual import Manual

        manual = Manual(report)
    outcomes = []
    for problem in _chosen(names, paper=paper, quick=not full):
        outcomes.append(_compute(problem, full=full, threads=threads, silent=as_json))
        if manual:  # after each, so that nothing is lost if the next one is stopped
            manual.add(outcomes[-1])
    passed = sum(outcome.passed for outcome in outcomes)
    if as_json:
        print(json.dumps([outcome.as_dict() for outcome in outcomes], indent=2))
    else:
        if paper:
            _print_stored()
        print(f"{passed} of {len(outcomes)} problems pass" + (f"; see {report}" if report else ""))
    if passed < len(outcomes):
        raise typer.Exit(3)


def _chosen(names: list[str] | None, *, paper: bool, quick: bool = False) -> list[Problem]:
    """The problems asked for; all, or quick ones, where none is named."""
    from cdem.verification import runner

    if names and paper:
        raise CaseError("--paper chooses the problems: leave out the names")
    if paper:
        return runner.problems_of_paper()
    found = runner.problems(names or [])
    return [problem for problem in found if names or not quick or problem.quick]


def _print_stored() -> None:
    from cdem.verification.stored import STORED

    for stored in STORED:
        print(stored.text())


def _print_list(chosen: list[Problem]) -> None:
    for problem in chosen:
        print(f"{problem.name:<20}{'' if problem.quick else '(full) '}{problem.title}")


def _compute(problem: Problem, *, full: bool, threads: int | None, silent: bool) -> Outcome:
    """Run a problem and print its outcome."""
    if silent:
        return problem.run(full=full, threads=threads)
    print(f"{problem.name}: {problem.title}", flush=True)
    outcome = problem.run(full=full, threads=threads)
    _print_outcome(outcome)
    return outcome


def _print_outcome(outcome: Outcome) -> None:
    from cdem.verification.runner import HEADINGS

    rows = [HEADINGS, *(check.texts() for check in outcome.checks)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEADINGS))]
    for row in rows if outcome.checks else []:
        print("  " + "  ".join(f"{t:<{w}}" for t, w in zip(row, widths, strict=True)).rstrip())
    if outcome.failure:
        print(f"  FAILED: {outcome.failure}")
    print(f"  {outcome.wall_time:.1f} s", flush=True)


def benchmark(
    full: Annotated[
        bool, typer.Option("--full", help="Also a million tets; needs 8 GB and half an hour.")
    ] = False,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Measure the speed of the kernels against the machine's own limits."""
    from cdem.tools import benchmark as bench

    threads = threads or os.cpu_count() or 1
    limits = bench.machine(threads)
    if not as_json:
        for key, value in limits.items():
            print(
                f"{key}: {value / 1e9:.1f} G/s" if isinstance(value, float) else f"{key}: {value}"
            )
        print(f"{'kernel':<34}{'size':>10}{'thr':>4}{'median':>10} (least .. most)")
    rows = []
    for row in bench.run(list(bench.SIZES)[: 3 if full else 2], threads):
        rows.append(row)
        if not as_json:
            print(row.text(), flush=True)
    if as_json:
        print(json.dumps({"machine": limits, "rows": [vars(row) for row in rows]}, indent=2))


def doctor(as_json: AsJson = False) -> None:
    """Check what works on this machine, and say how to mend the rest."""
    from cdem.tools.doctor import report, text

    rows, healthy = report()
    print(json.dumps(dict(rows), indent=2) if as_json else text(rows))
    if not healthy:
        raise typer.Exit(1)
